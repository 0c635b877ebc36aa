# SPDX-License-Identifier: Apache-2.0
"""Parameters of the parametric knee replacement: one frozen, validated dataclass and its presets.

Use :func:`preset` for a complete, plausible design and :func:`dataclasses.replace` to vary it.
Default numbers follow circle fits of two cruciate-retaining implants, rounded to a middle size.

Sagittal angles are *surface angles*: the angle of the outward normal from straight down, positive
posteriorly. With the femur flexed by the same angle, that point of the condyle is its lowest.
"""

import math
from dataclasses import dataclass, fields, replace
from typing import Final, Literal, get_args

from condyle.conventions import SideOfBody
from condyle.errors import InputDataError

CoronalProfile = Literal["flat", "curved"]

_DEG: Final = math.pi / 180.0


@dataclass(frozen=True, kw_only=True)
class ImplantParameters:
    """A bicondylar cruciate-retaining knee replacement (lengths in m, angles in rad).

    Attributes:
        side_of_body: "left" or "right"; a left implant is the right one mirrored in z.
        coronal_profile: "flat" (flat condyles on flat compartments, the hard test for contact) or
            "curved" (round condyles in round compartments).
        femoral_distal_radius: sagittal radius from `trochlear_angle` to `distal_end_angle` [m].
        femoral_mid_radius: sagittal radius from `mid_start_angle` to `mid_end_angle` [m].
        femoral_posterior_radius: sagittal radius from `posterior_start_angle` on [m].
        trochlear_angle: surface angle where the distal radius begins (negative: anterior) [rad].
        distal_end_angle: surface angle where the distal radius ends [rad].
        mid_start_angle: surface angle where the mid radius begins; between the two the radius
            changes smoothly: curvature is continuous (equal angles: tangent only) [rad].
        mid_end_angle: surface angle where the mid radius ends [rad].
        posterior_start_angle: surface angle where the posterior radius begins [rad].
        femoral_ap: anterior-posterior size of the femoral component, condyle to flange [m].
        femoral_ml: medial-lateral size of the femoral component [m].
        distal_point_height: depth of the condyles' lowest point below Fo at zero flexion [m].
        distal_point_offset: distance of that lowest point behind Fo [m].
        posterior_condyle_height: top of the posterior condyles above the lowest point [m].
        flange_height: top of the anterior flange above Fo [m].
        flange_width: medial-lateral width of the flange at its top [m].
        condyle_spacing: distance between the two condyles' centre lines [m].
        femoral_edge_radius: radius of the outer edge of the condyles [m]. With "flat", the condyle
            is flat up to |z| = femoral_ml / 2 - femoral_edge_radius, evenly about its centre line.
        femoral_flank_radius: coronal radius of the inner flank of the condyles ("flat" only) [m].
        femoral_coronal_radius: coronal radius of the condyles ("curved" only) [m].
        coronal_conformity: insert / femur coronal radius, greater than 1 ("curved" only) [-].
        side_depth: depth to which the outer and notch walls of the condyles reach, measured inwards
            from the condyle's ridge along the normal [m].
        groove_depth: depth of the trochlear groove below the condyles' ridge [m].
        notch_angle: surface angle of the front of the intercondylar notch [rad].
        notch_width: width of the intercondylar notch [m].
        insert_sagittal_radius: sagittal radius of the dished compartments [m].
        insert_ap: anterior-posterior size of the insert's contact surface [m].
        insert_ml: medial-lateral size of the insert's contact surface [m].
        insert_ap_offset: centre of the insert's contact surface, forward of To [m].
        dish_height: height of the dish's floor above To (at x = 0) [m].
        anterior_lip_height: height of the anterior lip above the floor [m].
        posterior_lip_height: height of the posterior lip above the floor [m].
        eminence_flank_radius: coronal radius of the eminence's flank ("flat" only) [m].
        eminence_height: height of the eminence's ridge above the dish at x = 0 [m].
        posterior_slope: fall of the insert towards posterior; the surface is sheared,
            y += x tan(slope), so that it stays a height field [rad].
        mesh_edge_length: edge length of the meshes in the contact region [m].

    Raises:
        InputDataError: a field is not a finite number, out of its range, or at odds with another.
    """

    side_of_body: SideOfBody = "right"
    coronal_profile: CoronalProfile = "flat"
    femoral_distal_radius: float = 38.0e-3
    femoral_mid_radius: float = 26.0e-3
    femoral_posterior_radius: float = 17.5e-3
    trochlear_angle: float = -40.0 * _DEG
    distal_end_angle: float = 5.0 * _DEG
    mid_start_angle: float = 10.0 * _DEG
    mid_end_angle: float = 60.0 * _DEG
    posterior_start_angle: float = 80.0 * _DEG
    femoral_ap: float = 65.0e-3
    femoral_ml: float = 72.0e-3
    distal_point_height: float = 35.0e-3
    distal_point_offset: float = 6.8e-3
    posterior_condyle_height: float = 38.0e-3
    flange_height: float = 20.0e-3
    flange_width: float = 50.0e-3
    condyle_spacing: float = 50.0e-3
    femoral_edge_radius: float = 4.0e-3
    femoral_flank_radius: float = 14.0e-3
    femoral_coronal_radius: float = 25.0e-3
    coronal_conformity: float = 1.1
    side_depth: float = 7.0e-3
    groove_depth: float = 5.6e-3
    notch_angle: float = -26.0 * _DEG
    notch_width: float = 19.0e-3
    insert_sagittal_radius: float = 54.0e-3
    insert_ap: float = 44.0e-3
    insert_ml: float = 74.0e-3
    insert_ap_offset: float = 2.5e-3
    dish_height: float = 6.0e-3
    anterior_lip_height: float = 4.9e-3
    posterior_lip_height: float = 3.1e-3
    eminence_flank_radius: float = 19.0e-3
    eminence_height: float = 6.7e-3
    posterior_slope: float = 0.0
    mesh_edge_length: float = 0.8e-3

    def __post_init__(self) -> None:
        """Refuses parameters that do not make a knee replacement."""
        _check_choices(self)
        _check_ranges(self)
        _check_relations(self)

    @property
    def condyle_centre(self) -> float:
        """|z| of a condyle's centre line [m]."""
        return 0.5 * self.condyle_spacing

    @property
    def flat_half_width(self) -> float:
        """Half the width of the condyle's flat part [m]; 0 for the curved profile."""
        if self.coronal_profile == "curved":
            return 0.0
        return 0.5 * self.femoral_ml - self.femoral_edge_radius - self.condyle_centre

    @property
    def insert_coronal_radius(self) -> float:
        """Coronal radius of the insert's compartments, inwards of their flat part [m]."""
        if self.coronal_profile == "curved":
            return self.coronal_conformity * self.femoral_coronal_radius
        return self.eminence_flank_radius


#: field -> (low, high) inclusive, SI. Wide enough for the smallest and largest knees.
_LENGTH_LIMITS: Final[dict[str, tuple[float, float]]] = {
    "femoral_distal_radius": (20e-3, 80e-3),
    "femoral_mid_radius": (12e-3, 60e-3),
    "femoral_posterior_radius": (8e-3, 40e-3),
    "femoral_ap": (40e-3, 95e-3),
    "femoral_ml": (45e-3, 100e-3),
    "distal_point_height": (15e-3, 60e-3),
    "distal_point_offset": (-10e-3, 20e-3),
    "posterior_condyle_height": (20e-3, 60e-3),
    "flange_height": (5e-3, 40e-3),
    "flange_width": (25e-3, 90e-3),
    "condyle_spacing": (30e-3, 70e-3),
    "femoral_edge_radius": (1e-3, 8e-3),
    "femoral_flank_radius": (5e-3, 40e-3),
    "femoral_coronal_radius": (12e-3, 60e-3),
    "side_depth": (3e-3, 12e-3),
    "groove_depth": (1e-3, 10e-3),
    "notch_width": (8e-3, 35e-3),
    "insert_sagittal_radius": (22e-3, 200e-3),
    "insert_ap": (28e-3, 65e-3),
    "insert_ml": (45e-3, 100e-3),
    "insert_ap_offset": (-8e-3, 8e-3),
    "dish_height": (-30e-3, 30e-3),
    "anterior_lip_height": (0.2e-3, 15e-3),
    "posterior_lip_height": (0.2e-3, 15e-3),
    "eminence_flank_radius": (6e-3, 60e-3),
    "eminence_height": (1e-3, 15e-3),
    "mesh_edge_length": (0.1e-3, 3e-3),
}
_ANGLE_LIMITS: Final[dict[str, tuple[float, float]]] = {
    "trochlear_angle": (-70.0 * _DEG, -25.0 * _DEG),
    "distal_end_angle": (-15.0 * _DEG, 45.0 * _DEG),
    "mid_start_angle": (-15.0 * _DEG, 60.0 * _DEG),
    "mid_end_angle": (10.0 * _DEG, 95.0 * _DEG),
    "posterior_start_angle": (20.0 * _DEG, 105.0 * _DEG),
    "notch_angle": (-30.0 * _DEG, -10.0 * _DEG),
    "posterior_slope": (-15.0 * _DEG, 15.0 * _DEG),
}
_PURE_LIMITS: Final[dict[str, tuple[float, float]]] = {"coronal_conformity": (1.0, 3.0)}
#: Not multiplied by `size`: the mesh keeps its resolution on a small or large implant.
_NOT_SCALED: Final = ("mesh_edge_length",)


def preset(
    name: CoronalProfile, *, size: float = 1.0, side_of_body: SideOfBody = "right"
) -> ImplantParameters:
    """Returns a complete design.

    Args:
        name: "flat" (flat for 18 mm < |z| < 32 mm, spacing 50 mm) or "curved" (coronal radius
            25 mm in 27.5 mm, spacing 48 mm).
        size: factor on every length but the mesh's edge, 0.75 to 1.35.
        side_of_body: "left" or "right".

    Raises:
        InputDataError: unknown preset or side, or `size` out of range.
    """
    if name not in get_args(CoronalProfile):
        raise InputDataError(f"preset = {name!r}: must be one of {get_args(CoronalProfile)}")
    if not 0.75 <= size <= 1.35:  # also refuses NaN
        raise InputDataError(f"preset size = {size!r}: must lie in [0.75, 1.35]")
    base = ImplantParameters(side_of_body=side_of_body)
    if name == "curved":
        base = replace(base, coronal_profile="curved", condyle_spacing=48e-3)
    lengths = (key for key in _LENGTH_LIMITS if key not in _NOT_SCALED)
    return replace(base, **{key: size * getattr(base, key) for key in lengths})


def _check_choices(parameters: ImplantParameters) -> None:
    for name, allowed in (
        ("side_of_body", get_args(SideOfBody)),
        ("coronal_profile", get_args(CoronalProfile)),
    ):
        value = getattr(parameters, name)
        if value not in allowed:
            raise InputDataError(f"implant {name} = {value!r}: must be one of {allowed}")


def _check_ranges(parameters: ImplantParameters) -> None:
    limits = [(_LENGTH_LIMITS, " m"), (_ANGLE_LIMITS, " rad"), (_PURE_LIMITS, "")]
    units = {
        name: (low, high, unit) for table, unit in limits for name, (low, high) in table.items()
    }
    for item in fields(parameters):
        if item.name not in units:
            continue
        low, high, unit = units[item.name]
        value = getattr(parameters, item.name)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputDataError(f"implant {item.name} = {value!r}: must be a number")
        if not low <= value <= high:  # also refuses NaN
            raise InputDataError(
                f"implant {item.name} = {value:.6g}{unit}: "
                f"must lie in [{low:.6g}, {high:.6g}]{unit}"
            )


def _require_greater(what: str, value: float, limit_of: str, limit: float, unit: str) -> None:
    if not value > limit:
        raise InputDataError(
            f"implant {what} = {value:.6g} {unit}: must be greater than "
            f"{limit_of} = {limit:.6g} {unit}"
        )


def _check_relations(p: ImplantParameters) -> None:
    """Refuses numbers that are each plausible but do not make a knee together."""
    for what, value, limit_of, limit in (
        ("mid_start_angle", p.mid_start_angle, "distal_end_angle", p.distal_end_angle),
        ("posterior_start_angle", p.posterior_start_angle, "mid_end_angle", p.mid_end_angle),
    ):
        if value < limit:
            raise InputDataError(
                f"implant {what} = {value:.6g} rad: must not be less than "
                f"{limit_of} = {limit:.6g} rad"
            )
    _require_greater("mid_end_angle", p.mid_end_angle, "mid_start_angle", p.mid_start_angle, "rad")
    _require_greater("distal_end_angle", p.distal_end_angle, "notch_angle", p.notch_angle, "rad")
    _require_greater("notch_angle", p.notch_angle, "trochlear_angle", p.trochlear_angle, "rad")
    largest = max(p.femoral_distal_radius, p.femoral_mid_radius, p.femoral_posterior_radius)
    _require_greater(
        "insert_sagittal_radius",
        p.insert_sagittal_radius,
        "the largest femoral radius",
        largest,
        "m",
    )
    _require_greater(
        "femoral_posterior_radius", p.femoral_posterior_radius, "side_depth", p.side_depth, "m"
    )
    _require_greater("side_depth", p.side_depth, "femoral_edge_radius", p.femoral_edge_radius, "m")
    _require_greater("femoral_ml", p.femoral_ml, "flange_width", p.flange_width, "m")
    _require_greater("condyle_spacing", p.condyle_spacing, "notch_width", p.notch_width, "m")
    if p.coronal_profile == "curved":
        _require_greater(
            "insert coronal radius (coronal_conformity x femoral_coronal_radius)",
            p.insert_coronal_radius,
            "femoral_coronal_radius",
            p.femoral_coronal_radius,
            "m",
        )
    else:
        _require_greater(
            "eminence_flank_radius",
            p.eminence_flank_radius,
            "femoral_flank_radius",
            p.femoral_flank_radius,
            "m",
        )
        _require_greater(
            "femoral_ml / 2 - femoral_edge_radius",
            p.condyle_centre + p.flat_half_width,
            "condyle_spacing / 2",
            p.condyle_centre,
            "m",
        )
