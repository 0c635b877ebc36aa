# SPDX-License-Identifier: Apache-2.0
"""How the built-in load cases are made: knots, and smooth curves through them.

Between knots (p_a, y_a) and (p_b, y_b) a curve is a half-cosine,

    y = y_a + (y_b - y_a) (1 - cos(π (p - p_a)/(p_b - p_a)))/2,

which is how the first 14 % of a published copy of the ISO 14243 flexion and axial force tables are
built (every row reproduced to 0.2 N and 0.01 deg). What the knots rest on is written into the
files' headers. Nothing here is the text of a standard.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

Knots = Sequence[tuple[float, float]]

# Percent of the cycle, degrees and newtons. To 13 % (flexion 15 %): confirmed rows; valley at 25 %:
# inferred from the 14 % row; beyond: widely quoted.
GAIT_FLEXION_DEG: Final[Knots] = ((0, 0), (15, 16), (40, 5), (72, 58), (100, 0))
GAIT_AXIAL_N: Final[Knots] = (
    (0, 167.6),
    (3, 1887.3),
    (7, 1174.6),
    (13, 2600.0),
    (25, 839.1),
    (45, 2433.5),
    (60, 167.6),
    (100, 167.6),
)
# Smooth curves through the quoted extremes of the force-controlled test only: AP -265 to +110 N, IE -1 to +6 Nm.
# Where in the cycle they lie is Condyle's choice.
GAIT_AP_N: Final[Knots] = ((0, 0), (4, 110), (13, -180), (25, -60), (45, -265), (60, 0), (100, 0))
GAIT_IE_NM: Final[Knots] = ((0, 0), (6, -1), (25, 1), (48, 6), (62, 0), (100, 0))

# Percent of a squat (down, hold, up), for a body weight of 750 N: 2.5 body weights in the deepest position.
BODY_WEIGHT_N: Final = 750.0
SQUAT_FLEXION_DEG: Final[Knots] = ((0, 0), (45, 90), (55, 90), (100, 0))
SQUAT_AXIAL_BW: Final[Knots] = ((0, 0.6), (45, 2.5), (55, 2.5), (100, 0.6))
SQUAT_AP_BW: Final[Knots] = ((0, 0), (45, -0.12), (55, -0.12), (100, 0))
SQUAT_IE_NM: Final[Knots] = ((0, 0), (45, 3), (55, 3), (100, 0))

# Percent of a gait cycle with a turn in stance, for the same body weight. Flexion is the gait's; the first peak is
# the greater one (2.6 body weights), and the torque turns over from -5 to 8 Nm.
TURN_AXIAL_BW: Final[Knots] = (
    (0, 0.22),
    (5, 2.2),
    (9, 1.7),
    (15, 2.6),
    (29, 1.4),
    (47, 2.4),
    (62, 0.22),
    (100, 0.22),
)
TURN_AP_BW: Final[Knots] = (
    (0, 0),
    (5, 0.10),
    (16, -0.20),
    (30, -0.10),
    (47, -0.30),
    (62, 0),
    (100, 0),
)
TURN_IE_NM: Final[Knots] = ((0, 0), (10, -5), (30, 2), (45, 8), (62, 0), (100, 0))

# Percent of a rise from a chair (seated, up, standing), for the same body weight: 2.46 body weights just after
# leaving the seat.
CHAIR_FLEXION_DEG: Final[Knots] = ((0, 85), (15, 87), (75, 3), (100, 3))
CHAIR_AXIAL_BW: Final[Knots] = ((0, 0.3), (10, 0.4), (35, 2.46), (75, 1.07), (100, 1.07))
CHAIR_AP_BW: Final[Knots] = ((0, 0), (35, -0.17), (75, 0), (100, 0))
CHAIR_IE_NM: Final[Knots] = ((0, 0), (35, 3), (70, -1), (100, 0))

# Percent of one swing of the unloaded leg (back, forth, back), for the same body weight.
SWING_FLEXION_DEG: Final[Knots] = ((0, 15), (35, 70), (75, 2), (100, 15))
SWING_AXIAL_BW: Final[Knots] = ((0, 0.10), (25, 0.18), (50, 0.08), (75, 0.22), (100, 0.10))
SWING_AP_BW: Final[Knots] = ((0, 0), (25, 0.01), (50, 0), (75, -0.01), (100, 0))
SWING_IE_NM: Final[Knots] = ((0, 0), (30, -0.2), (65, 0.3), (100, 0))

_COLUMNS: Final = "time_s,flexion_deg,axial_force_N,ap_force_N,ie_torque_Nm"
_SIGNS: Final = (
    "Signs: flexion positive; axial force >= 0 presses the femur onto the tibia; ap_force_N and ie_torque_Nm act on",
    "the TIBIA, positive anterior and positive inward (internal rotation).",
)

GAIT_HEADER: Final = (
    "ISO-like gait for a force-controlled knee simulator. Not the standard's text, no claim of compliance;",
    "replace it freely.",
    *_SIGNS,
    "Flexion and axial force: piecewise half-cosines. Knots to 13 % of the cycle (flexion: 15 %) reproduce a",
    "published copy of the ISO 14243-3 table (github.com/zulianp/utopia, utopia_fe/data/wear/iso-14243-3.csv,",
    "which holds 0-14 % only) to 0.2 N and 0.01 deg; parts -1 and -3 share these two curves as far as known.",
    "The valley of 839 N at 25 % is inferred from the 14 % row; later knots and the peaks of 2600 N and 58 deg",
    "are widely quoted, not confirmed.",
    "AP force and torque: smooth curves through widely quoted extremes of part -1 (-265 to 110 N; -1 to 6 Nm).",
    "Their SHAPE and timing are not known here and are Condyle's own.",
    "Edition: the source's AP displacements are negative, as in the 2014 edition of part -3; AP and torque",
    "polarity changed between 2004 and 2014. Results depend on edition and polarity: Wang et al. 2018,",
    "PLOS ONE, e0206496.",
    "One cycle of 1 s (1 Hz), 101 points.",
)
SQUAT_HEADER: Final = (
    "Squat-like load case, illustrative: 0 to 90 deg of flexion and back, axial force to 2.5 body weights of",
    "750 N (1875 N).",
    *_SIGNS,
    "Order of magnitude after in vivo loads of instrumented knees (Bergmann et al. 2014, PLOS ONE, e0086035),",
    "as widely quoted, not confirmed point by point; curve shapes, AP force (to -0.12 body weights) and torque",
    "(to 3 Nm) are Condyle's own.",
    "One squat of 4 s, 101 points. Replace it freely.",
)
TURN_HEADER: Final = (
    "Gait-like load case with a turn in stance, illustrative; body weight 750 N.",
    *_SIGNS,
    "Flexion: as in iso_like_gait.csv. Axial force: peak 2.6 body weights, the mean peak of level walking (261 %) in",
    "five instrumented knees (Kutzner et al. 2010, J Biomech 43, 2164). Torque: to 8 Nm, below the 10.5 Nm that",
    "instrumented knees reached in walking (Bergmann et al. 2014, PLOS ONE, e0086035). AP force: to -0.30 body",
    "weights, the peak shear of walking (D'Lima et al. 2007, J Biomech 40, S11). Only these peaks are quoted: that a",
    "turn loads the knee like this, and every curve's shape, timing and sign, are Condyle's own.",
    "One cycle of 1.2 s, 101 points. Replace it freely.",
)
CHAIR_HEADER: Final = (
    "Chair-rise-like load case, illustrative: from 87 deg of flexion to standing; body weight 750 N.",
    *_SIGNS,
    "Axial force: peak 2.46 body weights, the mean peak of standing up in five instrumented knees, and 1.07 at the",
    "end, their two-legged stance (Kutzner et al. 2010, J Biomech 43, 2164); D'Lima et al. 2007 (J Biomech 40, S11)",
    "found 2.5. AP force: to -0.17 body weights, the peak shear of D'Lima et al. Only these peaks are quoted; timing,",
    "signs, torque (-1 to 3 Nm) and the curves' shapes are Condyle's own.",
    "One rise of 2.5 s, 101 points. Replace it freely.",
)
SWING_HEADER: Final = (
    "Unloaded-leg-swing-like load case, illustrative: 2 to 70 deg of flexion under what muscles alone press on the",
    "knee, 60 to 165 N (0.08 to 0.22 body weights of 750 N).",
    *_SIGNS,
    "The upper end is the force that simulators apply in the swing phase of gait (167.6 N, see iso_like_gait.csv);",
    "Marra et al. 2017 have such an activity among their reference curves but print no loads of it. Everything else",
    "is Condyle's own.",
    "One swing of 1.5 s, 101 points. Replace it freely.",
)


def half_cosines(knots: Knots, percent: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values (n,) at ``percent`` (n,) of the piecewise half-cosine through ``knots``."""
    positions = np.array([p for p, _ in knots], dtype=np.float64)
    values = np.array([y for _, y in knots], dtype=np.float64)
    piece = np.clip(np.searchsorted(positions, percent, side="right") - 1, 0, len(knots) - 2)
    share = (percent - positions[piece]) / (positions[piece + 1] - positions[piece])
    blend = 0.5 * (1.0 - np.cos(math.pi * share))
    return values[piece] + (values[piece + 1] - values[piece]) * blend


def iso_like_gait() -> str:
    """Text of ``iso_like_gait.csv``."""
    knots = (GAIT_FLEXION_DEG, GAIT_AXIAL_N, GAIT_AP_N, GAIT_IE_NM)
    return _text(GAIT_HEADER, 1.0, 1.0, *knots)


def squat_like() -> str:
    """Text of ``squat_like.csv``."""
    knots = (SQUAT_FLEXION_DEG, SQUAT_AXIAL_BW, SQUAT_AP_BW, SQUAT_IE_NM)
    return _text(SQUAT_HEADER, 4.0, BODY_WEIGHT_N, *knots)


def turn_like_gait() -> str:
    """Text of ``turn_like_gait.csv``."""
    knots = (GAIT_FLEXION_DEG, TURN_AXIAL_BW, TURN_AP_BW, TURN_IE_NM)
    return _text(TURN_HEADER, 1.2, BODY_WEIGHT_N, *knots)


def chair_rise_like() -> str:
    """Text of ``chair_rise_like.csv``."""
    knots = (CHAIR_FLEXION_DEG, CHAIR_AXIAL_BW, CHAIR_AP_BW, CHAIR_IE_NM)
    return _text(CHAIR_HEADER, 2.5, BODY_WEIGHT_N, *knots)


def leg_swing_like() -> str:
    """Text of ``leg_swing_like.csv``."""
    knots = (SWING_FLEXION_DEG, SWING_AXIAL_BW, SWING_AP_BW, SWING_IE_NM)
    return _text(SWING_HEADER, 1.5, BODY_WEIGHT_N, *knots)


def _text(
    header: Sequence[str],
    duration: float,
    force_unit: float,
    flexion: Knots,
    axial: Knots,
    ap: Knots,
    torque: Knots,
) -> str:
    """A file of 101 points over ``duration`` [s]; axial and AP knots are in ``force_unit`` [N]."""
    percent = np.linspace(0.0, 100.0, 101)
    return _csv(
        header,
        duration * percent / 100.0,
        half_cosines(flexion, percent),
        force_unit * half_cosines(axial, percent),
        force_unit * half_cosines(ap, percent),
        half_cosines(torque, percent),
    )


def _csv(header: Sequence[str], *columns: NDArray[np.float64]) -> str:
    # Four decimals: 0.1 mN and 1e-4 deg, far below what the source knows; adding 0 turns -0 into 0.
    rows = [
        ",".join(f"{value + 0.0:.4f}" for value in np.round(row, 4))
        for row in np.column_stack(columns)
    ]
    return "\n".join([*(f"# {line}" for line in header), _COLUMNS, *rows]) + "\n"
