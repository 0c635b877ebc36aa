# SPDX-License-Identifier: Apache-2.0
"""DM's knee in treadmill gait: simulated secondary kinematics beside fluoroscopy, and contact force in body weights.

    OMP_NUM_THREADS=1 .venv/bin/python tests/benchmarks/dm_fluoroscopy.py [--figures FOLDER]

Subject DM of the 6th Grand Challenge Competition to Predict In Vivo Knee Loads (CONDYLE_DATA, or shared/data beside
the project; needs `opensim` for the first run). The trial is the one at fluoroscopy's speed, the window all whole
cycles of the right foot that are in the kinematics. The measurement is of one other cycle: it has no clock and says
nothing of heel strike, so it is shifted to where its flexion lies nearest to the trial's; nothing else is fitted, and
no parameter of the simulation knows the measurement. Prints tables; draws three pictures; read in docs/validation.md.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Final

import numpy as np
from dm_trial import (
    BODY_WEIGHT,
    CACHE,
    DATA,
    DM,
    FRAME_RATE,
    MUSCLES,
    NEGLIGIBLE_FORCE,
    ROOT,
    DmTrial,
    dm_contacts,
    even_clock,
    read_dm_trial,
)
from fluoroscopy_gait import Fluoroscopy, other_readings, read_fluoroscopy, vertical_gaps

from condyle.contact import MeshContact
from condyle.conventions import SIDES
from condyle.evaluation.simulation_errors import KINEMATICS
from condyle.fdk import TrialSimulation, simulate_trial
from condyle.markdown import markdown_table
from condyle.report.comparison_figure import KinematicsCurve, comparison_figure
from condyle.report.cycle_force_figure import PublishedPeak, cycle_force_figure
from condyle.report.gait_cycles import (
    POINTS,
    best_shift,
    heel_strikes,
    normalised_cycles,
    shifted_cycle,
)
from condyle.report.style import house_style, save

TRIAL: Final = "DM_ngait_tmf_slow1"
#: Kinematics are at hand to here [s].
END: Final = 5.99
#: Before the first heel strike, for the solver to come from a time frame of swing [s].
LEAD: Final = 0.1
#: Peak total force in level gait, of knees that measure it.
PUBLISHED: Final = (
    PublishedPeak("treadmill, 0.45–1.3 m/s\n(D'Lima 2013)", 1.9, 2.3),
    PublishedPeak("level walking\n(D'Lima 2013)", 2.5, 2.8),
)
#: The leg has pushed off by here: from then on there is little load on the knee [percent].
PUSHED_OFF: Final = 60
#: Of smaller pictures for docs.
DPI: Final = 100
FACTORS: Final = np.array([factor for _, _, factor in KINEMATICS])


@dataclass(frozen=True)
class Gait:
    """A simulated trial cut into cycles.

    Attributes:
        found: the simulation.
        strikes: (k + 1,) heel strikes [s].
        toe_off: (k,) where swing begins [percent].
        speed: of the belt, by the heel's marker while the foot is flat [m/s].
        kinematics: (k, 101, 6) clinical [deg, mm].
        wrenches: (k, 101, 2, 6) medial, lateral [N, Nm].
    """

    found: TrialSimulation
    strikes: np.ndarray
    toe_off: np.ndarray
    speed: float
    kinematics: np.ndarray
    wrenches: np.ndarray


def main() -> None:
    """Prints the tables and draws the pictures."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--figures", type=Path, default=ROOT / "docs" / "figures")
    parser.add_argument("--cache", type=Path, default=CACHE)
    parser.add_argument(
        "--keep-clock",
        action="store_true",
        help="leave the trial's times rounded to ms, as recorded",
    )
    options = parser.parse_args()
    gait, subject = simulate(options.cache, repair_clock=not options.keep_clock)
    measured = read_fluoroscopy(DM / "fluoroscopy" / "fluoroscopy_gait.csv")
    print_simulation(gait, subject)
    print_readings(measured, gait)
    mean = gait.kinematics.mean(axis=0)
    flexion = KINEMATICS.index(("flexion", "deg", FACTORS[0]))
    shift, left = best_shift(FACTORS[0] * measured.kinematics[:, flexion], mean[:, flexion])
    shown = shifted_cycle(FACTORS * measured.kinematics, shift)
    print(
        f"\nfluoroscopy shifted by {shift:+d} % of the cycle: flexion then differs by {left:.1f}° RMS\n"
    )
    print(kinematics_table(gait, shown))
    print(force_table(gait))
    draw(options.figures, gait, shown)


def simulate(cache: Path, *, repair_clock: bool) -> tuple[Gait, DmTrial]:
    """All whole cycles of the right foot."""
    table = np.genfromtxt(DM / "trials" / TRIAL / "grf.csv", delimiter=",", names=True)
    force, clock = table["ground_force_2_vy"], table["time"]  # plate 2 is under the right foot
    strikes = heel_strikes(clock, force, threshold=NEGLIGIBLE_FORCE)
    strikes = strikes[strikes < END]
    window = strikes[0] - LEAD, min(strikes[-1] + LEAD, END)
    subject = read_dm_trial(TRIAL, *window, cache, repair_clock=repair_clock)
    found = simulate_trial(subject.model, subject.trial, dm_contacts(subject, "fast"), MUSCLES)
    on_ground = [
        float(np.mean(force[(clock >= a) & (clock < b)] > NEGLIGIBLE_FORCE))
        for a, b in pairwise(strikes)
    ]
    gait = Gait(
        found=found,
        strikes=strikes,
        toe_off=100.0 * np.array(on_ground),
        speed=belt_speed(strikes),
        kinematics=normalised_cycles(
            found.times, FACTORS * found.kinematics("tibiofemoral"), strikes
        ),
        wrenches=normalised_cycles(found.times, found.wrenches[:, 0], strikes),
    )
    return gait, subject


def belt_speed(strikes: np.ndarray) -> float:
    """How fast the heel's marker moves between 20 and 40 percent of the cycles [m/s]."""
    table = np.genfromtxt(DM / "trials" / TRIAL / "markers.csv", delimiter=",", names=True)
    speeds = []
    for begin, end in pairwise(strikes):
        share = (table["time"] - begin) / (end - begin)
        flat = (share > 0.2) & (share < 0.4)
        speeds.append(np.polyfit(table["time"][flat], table["R_Heel_x"][flat], 1)[0])
    return float(np.abs(np.mean(speeds)))


def clock_roughness() -> tuple[float, float]:
    """RMS of the heel's marker about cubics through 9 samples, by the recorded clock and by an even one [mm].

    The camera's own curve is smooth: whichever clock leaves less is nearer to the camera's.
    """
    table = np.genfromtxt(DM / "trials" / TRIAL / "markers.csv", delimiter=",", names=True)
    recorded, heel = table["time"], 1e3 * table["R_Heel_x"]
    left = []
    for clock in (recorded, even_clock(recorded, FRAME_RATE)):
        windows = [slice(i - 4, i + 5) for i in range(4, len(clock) - 4)]
        fits = [np.polyfit(clock[w] - clock[w].mean(), heel[w], 3) for w in windows]
        rest = [
            heel[w] - np.polyval(fit, clock[w] - clock[w].mean())
            for w, fit in zip(windows, fits, strict=True)
        ]
        left.append(_rms(np.concatenate(rest)))
    return left[0], left[1]


def print_simulation(gait: Gait, subject: DmTrial) -> None:
    """What was simulated, and how well."""
    found = gait.found
    recorded, even = clock_roughness()
    print(f"{TRIAL}: {found.summary}; clock repaired by up to {1e3 * subject.clock_repair:.2f} ms")
    print(
        f"heel marker, RMS about local cubics: {recorded:.2f} mm by the recorded clock, {even:.2f} mm by an even one"
    )
    print(f"heel strikes at {', '.join(f'{strike:.3f}' for strike in gait.strikes)} s; toe off at "
          f"{', '.join(f'{percent:.0f}' for percent in gait.toe_off)} %; belt {gait.speed:.2f} m/s")  # fmt: skip
    largest = np.abs(found.reserves).max(axis=0)
    reserves = ", ".join(
        f"{name} {value:.1f}" for name, value in zip(found.balanced, largest, strict=True)
    )
    print(f"largest reserve moments, Nm: {reserves}")


def print_readings(measured: Fluoroscopy, gait: Gait) -> None:
    """Whether the measured columns are read as they are meant: then the parts touch."""
    implant = DATA / "implants" / "dm"
    contact = MeshContact.from_files(
        femur=implant / "femur_contact.stl",
        insert=implant / "insert_contact.stl",
        units="m",
        side_of_body="right",
        evaluation="fast",
    )
    identity = measured.rotations @ measured.rotations.transpose(0, 2, 1)
    print("\nfluoroscopy, as read")
    print(f"- R is a rotation within {np.abs(identity - np.eye(3)).max():.0e}, "
          f"its determinant at least {np.linalg.det(measured.rotations).min():.6f}")  # fmt: skip
    clinical = FACTORS[0] * measured.kinematics[:, 0]
    print(f"- clinical flexion {clinical.min():.1f} to {clinical.max():.1f}°, the file's own (about z) within "
          f"{np.abs(clinical - measured.flexion).max():.2f}°")  # fmt: skip
    gaps = vertical_gaps(contact, measured.poses)
    print(
        f"- vertical gaps by these meshes are the file's within {1e3 * np.abs(gaps - measured.gaps).max():.3f} mm\n"
    )
    rows = {name: vertical_gaps(contact, poses) for name, poses in other_readings(measured).items()}
    rows["simulated, for comparison"] = vertical_gaps(
        contact, np.ascontiguousarray(gait.found.poses[:, 0])
    )
    print(markdown_table(
        ["read as", *(f"{side} gap mm" for side in SIDES)],
        [[name, *(_range(1e3 * value[:, s], 2) for s in range(2))] for name, value in rows.items()],
    ), end="")  # fmt: skip


def kinematics_table(gait: Gait, shown: np.ndarray) -> str:
    """Ranges and differences of the mean cycle; ``shown`` is (101, 6) measured [deg, mm]."""
    mean = gait.kinematics.mean(axis=0)
    loaded = np.arange(POINTS) <= PUSHED_OFF
    rows = []
    for i, (name, unit, _) in enumerate(KINEMATICS):
        difference = mean[:, i] - shown[:, i]
        offset = difference[loaded].mean()
        rows.append(
            [
                f"{name.replace('_', ' ')} [{unit}]",
                _range(shown[:, i]),
                _range(mean[:, i]),
                f"{_rms(difference):.1f}",
                f"{_rms(difference[loaded]):.1f}",
                f"{_rms(difference[~loaded]):.1f}",
                f"{offset:+.1f}",
                f"{_rms(difference[loaded] - offset):.1f}",
                f"{gait.kinematics[:, :, i].std(axis=0, ddof=1).mean():.1f}",
            ]
        )
    header = [
        "quantity", "measured", "simulated", "RMS difference", f"to {PUSHED_OFF} %", f"from {PUSHED_OFF} %",
        f"mean difference to {PUSHED_OFF} %", "RMS about it", "SD between simulated cycles",
    ]  # fmt: skip
    return markdown_table(header, rows)


def force_table(gait: Gait) -> str:
    """Peaks of every cycle in body weights."""
    total = gait.wrenches.sum(axis=2)[:, :, :3]
    rows = []
    for number, (force, sides) in enumerate(zip(total, gait.wrenches, strict=True), start=1):
        size = np.linalg.norm(force, axis=1)
        peak = int(size.argmax())
        rows.append(
            [
                str(number),
                f"{size[peak] / BODY_WEIGHT:.2f}",
                f"{force[:, 1].max() / BODY_WEIGHT:.2f}",
                str(peak),
                *(f"{sides[:, s, 1].max() / BODY_WEIGHT:.2f}" for s in range(2)),
                f"{sides[peak, 0, 1] / force[peak, 1]:.0%}",
            ]
        )
    header = [
        "cycle", "peak resultant BW", "peak axial BW", "at % of cycle", "peak medial BW",
        "peak lateral BW", "medial share at the peak",
    ]  # fmt: skip
    return markdown_table(header, rows)


def draw(folder: Path, gait: Gait, shown: np.ndarray) -> None:
    """The pictures of docs/validation.md."""
    percent = np.arange(float(POINTS))
    cycles = gait.kinematics / FACTORS
    mean, measured = cycles.mean(axis=0), shown / FACTORS
    band = (cycles.min(axis=0), cycles.max(axis=0))
    names = [name for name, _, _ in KINEMATICS]
    title = f"DM, treadmill gait at {gait.speed:.1f} m/s"
    label = f"simulated, mean and range of {len(cycles)} cycles"
    over_cycle = [
        KinematicsCurve("fluoroscopy, one cycle", percent, measured, measured=True),
        KinematicsCurve(label, percent, mean, band),
    ]
    over_flexion = [
        KinematicsCurve(name, FACTORS[0] * values[:, 0], values, measured=known)
        for name, values, known in (
            ("fluoroscopy, one cycle", measured, True),
            (f"simulated, mean of {len(cycles)} cycles", mean, False),
        )
    ]
    with house_style():
        figures = {
            "dm_fluoroscopy": comparison_figure(
                title, over_cycle, along="gait cycle [%]", quantities=names
            ),
            "dm_fluoroscopy_flexion": comparison_figure(title, over_flexion),
            "dm_contact_force": cycle_force_figure(
                f"{title}: compression of the knee",
                gait.wrenches[:, :, :, 1],
                BODY_WEIGHT,
                toe_off=float(gait.toe_off.mean()),
                published=PUBLISHED,
            ),
        }
        for name, figure in figures.items():
            print(save(figure, folder / f"{name}.png", DPI))


def _range(values: np.ndarray, digits: int = 1) -> str:
    return f"{values.min():.{digits}f}..{values.max():.{digits}f}"


def _rms(values: np.ndarray | Sequence[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


if __name__ == "__main__":
    main()
