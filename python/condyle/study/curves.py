# SPDX-License-Identifier: Apache-2.0
"""What a study samples around: its reference curves, and the directions in which loads are sampled."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from condyle.study.context import StudyContext
from condyle.study.curve_sections import (
    ActivityCurvesSection,
    ConformityCurvesSection,
    TableCurvesSection,
)
from condyle.study.simulation_files import read_simulation

if TYPE_CHECKING:
    from condyle.sampling import ReferenceCurves, StaticEquilibriumSolver


@dataclass(frozen=True)
class CurvesFound:
    """Reference curves, and what there is to tell of them.

    Attributes:
        curves: these.
        told: in a sentence.
        bounds: of ``conformity``, one row a flexion; None otherwise.
    """

    curves: ReferenceCurves
    told: str
    bounds: list[dict[str, Any]] | None = None


def make_curves(context: StudyContext, solver: StaticEquilibriumSolver) -> CurvesFound:
    """The reference curves of the study, whichever way it asks for.

    Args:
        context: the study; of kind ``activities``, its reference stage has run.
        solver: static equilibria on the reference contact, for kind ``conformity``.
    """
    from condyle.sampling import ReferenceCurves

    section = context.study.sampling.curves
    if isinstance(section, TableCurvesSection):
        curves = section.read()
        files = ", ".join(file.name for file in section.files)
        return CurvesFound(curves, f"reference curves from {files}: {', '.join(curves.names)}")
    if isinstance(section, ConformityCurvesSection):
        return _from_conformity(context, section, solver)
    assert isinstance(section, ActivityCurvesSection)
    activities = {}
    for name in section.names or context.activities:
        trace = read_simulation(context.directory.simulations / f"{name}_reference.csv")
        found = trace["converged"]
        activities[name] = (
            trace["time"][found],
            trace["poses"][found],
            trace["wrenches"][found],
        )
    curves = ReferenceCurves.from_activities(activities)
    return CurvesFound(curves, f"reference curves from {len(activities)} simulated activities")


def curves_file(context: StudyContext) -> Path:
    """Where the sample stage puts the curves that it sampled around, whichever way they were made."""
    return context.directory.tables / "reference_curves.csv"


def _from_conformity(
    context: StudyContext, section: ConformityCurvesSection, solver: StaticEquilibriumSolver
) -> CurvesFound:
    from condyle.sampling.conformity import conformity_bounds
    from condyle.sampling.conformity_curves import conformity_curves

    bounds = conformity_bounds(context.reference, solver, section.settings())
    rows = bounds.to_json()
    widest = ", ".join(
        f"{name} {min(row[key][0] for row in rows):.1f} to {max(row[key][1] for row in rows):.1f} {unit}"
        for name, key, unit in (
            ("x", "x_mm", "mm"),
            ("z", "z_mm", "mm"),
            ("theta_y", "theta_y_deg", "deg"),
        )
    )
    told = (
        f"reference curves from the implant's conformity: 0 to {rows[-1]['flexion_deg']:.0f} deg, "
        f"from the settled pose {widest}"
    )
    return CurvesFound(conformity_curves(bounds, solver), told, rows)


def sensitive_directions(context: StudyContext) -> tuple[tuple[str, ...], str, dict[str, Any]]:
    """The directions to sample loads in, a sentence about them, and the table's entry.

    Raises:
        InputDataError: the study leaves it to the implant, and that has others than can be solved for.
        CondyleError: the implant does not tell, since the femur finds no seat that bears a load.
    """
    from condyle.sampling.equilibrium_protocol import SENSITIVE_COLUMNS
    from condyle.sampling.sensitive_directions import find_sensitive_directions, require_solvable

    asked = context.study.sampling.sensitive_directions
    if asked != "auto":
        return (
            asked,
            f"sensitive directions {', '.join(asked)}, as the study says",
            {"used": list(asked)},
        )
    found = find_sensitive_directions(context.reference)
    require_solvable(found)
    used = SENSITIVE_COLUMNS
    return used, found.sentence(), {"used": list(used), **found.to_json()}
