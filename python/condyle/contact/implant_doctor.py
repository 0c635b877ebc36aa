# SPDX-License-Identifier: Apache-2.0
"""The mesh doctor: what is wrong with an implant's meshes, what reading repairs, and what the user should do.

Use :func:`examine_mesh` for a file, :func:`examine_implant` for a pair before its first simulation. An
``error`` makes a contact impossible; a ``warning`` makes it doubtful; ``repaired`` is what reading the file
has put right. Nothing is raised for what is wrong with the meshes: it is what the examination is about.
Faces that cross each other elsewhere are not looked for.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any, Final, Literal

import numpy as np

from condyle._core.geometry import Mesh
from condyle.contact.contact_map import contact_map
from condyle.contact.implant_files import read_implant
from condyle.contact.mesh_contact import MeshContact
from condyle.contact.mesh_files import MeshFile, Units, inspect_mesh
from condyle.contact.mesh_refinement import mean_edge_length
from condyle.conventions import SIDES, SideOfBody
from condyle.fdk.seating import first_touch, load_seated, seated_pose

Severity = Literal["error", "warning", "repaired"]
Part = Literal["femur", "insert", "insert_medial", "insert_lateral", "mesh"]

#: A femoral component or an insert, longest side of its bounding box [mm]: the smallest and largest sizes on offer.
_USUAL_SIZE_MM: Final = {"femur": (50.0, 95.0), "insert": (50.0, 95.0)}
#: The middle of both compartments may lie this far from z = 0 [mm].
_OFF_CENTRE_MM: Final = 3.0
#: Loaded faces a side under the trial load: fewer make pressures and stiffness jump from face to face.
_FEWEST_LOADED_FACES: Final = 60
_TRIAL_LOAD: Final = 1000.0  # [N]


@dataclass(frozen=True)
class Finding:
    """One thing about a part: what it is, and what to do about it."""

    severity: Severity
    part: str
    text: str
    advice: str


@dataclass(frozen=True)
class MeshExamination:
    """One file.

    Attributes:
        part: What it is meant to be.
        file: Its name as given.
        before: Counts and sizes as in the file; empty if it could not be read.
        after: The same after the repairs of reading.
        findings: In order of severity.
    """

    part: str
    file: str
    before: dict[str, Any] = field(default_factory=dict)
    after: dict[str, Any] = field(default_factory=dict)
    findings: tuple[Finding, ...] = ()


@dataclass(frozen=True)
class TrialContact:
    """The pair put together.

    Attributes:
        first_touch_y_mm: Of the femoral origin at x = z = 0, rotations zero [mm]; None where nothing touches there.
        seat_status: converged, no_contact, no_clearance or slides_off.
        seat_mm: x, y, z of the seated pose [mm].
        load: Total Fy of the trial [N].
        load_status: Of the equilibrium at the seated x and z: converged, or why not.
        Fy: Medial and lateral [N].
        max_depth_mm: Of each side [mm].
        area_mm2: Of each side [mm²].
        peak_pressure_mpa: Of each side [MPa].
        loaded_faces: Of each side.
    """

    first_touch_y_mm: float | None
    seat_status: str
    seat_mm: tuple[float, float, float]
    load: float
    load_status: str
    Fy: tuple[float, float] = (0.0, 0.0)
    max_depth_mm: tuple[float, float] = (0.0, 0.0)
    area_mm2: tuple[float, float] = (0.0, 0.0)
    peak_pressure_mpa: tuple[float, float] = (0.0, 0.0)
    loaded_faces: tuple[int, int] = (0, 0)


@dataclass(frozen=True)
class ImplantExamination:
    """A pair: its parts, what concerns them together, and a trial contact where one is possible."""

    parts: tuple[MeshExamination, ...]
    findings: tuple[Finding, ...]
    trial: TrialContact | None

    @property
    def all_findings(self) -> tuple[Finding, ...]:
        """Of the parts and of the pair."""
        return (*(f for part in self.parts for f in part.findings), *self.findings)

    @property
    def errors(self) -> tuple[Finding, ...]:
        """What makes a contact impossible."""
        return tuple(f for f in self.all_findings if f.severity == "error")

    def as_dict(self) -> dict[str, Any]:
        """Plain values, for JSON."""
        return asdict(self)


def examine_mesh(file: MeshFile, units: Units, part: Part = "mesh") -> MeshExamination:
    """Examines one file.

    Args:
        file: STL, OBJ, PLY or OFF.
        units: Unit of its numbers.
        part: What it is meant to be; ``mesh`` if that is not known.
    """
    try:
        before, after = inspect_mesh(file, units)
    except ValueError as error:
        return MeshExamination(part, str(file), findings=(_unreadable(part, file, str(error)),))
    found = [*_lasting(part, after), *_size(part, after), *_repairs(part, before, after)]
    return MeshExamination(part, str(file), before, after, tuple(found))


def examine_implant(
    *,
    femur: MeshFile,
    insert: MeshFile | None = None,
    insert_medial: MeshFile | None = None,
    insert_lateral: MeshFile | None = None,
    units: Units,
    side_of_body: SideOfBody,
) -> ImplantExamination:
    """Examines a pair: each file, the two together, and a trial contact under 1 kN. Arguments as :func:`read_implant`.

    Raises:
        InputDataError: The arguments do not go together (the files' own faults are findings).
    """
    files = {"femur": femur, "insert": insert, "insert_medial": insert_medial}
    files |= {"insert_lateral": insert_lateral}
    parts = tuple(examine_mesh(f, units, p) for p, f in files.items() if f is not None)  # type: ignore[arg-type]
    if any(f.severity == "error" for part in parts for f in part.findings):
        return ImplantExamination(parts, (), None)
    try:
        meshes = read_implant(
            femur=femur,
            insert=insert,
            insert_medial=insert_medial,
            insert_lateral=insert_lateral,
            units=units,
            side_of_body=side_of_body,
        )
        contact = MeshContact(**meshes, side_of_body=side_of_body)
    except ValueError as error:
        what, _, remedy = str(error).rpartition(": ")
        return ImplantExamination(parts, (Finding("error", "pair", what, _sentence(remedy)),), None)
    trial = _trial(contact)
    found = (*_placing(contact), *_doubts(contact, trial))
    return ImplantExamination(parts, found, trial)


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:] + ("" if text.endswith((".", "?")) else ".")


def _unreadable(part: str, file: MeshFile, error: str) -> Finding:
    text = error.removeprefix(f"{file}: ")
    if "--units" in text:
        what, _, remedy = text.partition("; ")
        return Finding("error", part, what, _sentence(remedy))
    return Finding("error", part, text, "Export the part again as a triangle mesh (binary STL).")


def _lasting(part: str, after: dict[str, Any]) -> list[Finding]:
    """What reading does not repair."""
    found = []
    if after["inconsistent_edges"]:
        found.append(
            Finding(
                "error",
                part,
                f"the surface has no two sides: windings disagree at {after['inconsistent_edges']} edges",
                "Remove the twisted strip, or export the part again from its solid.",
            )
        )
    if after["non_manifold_edges"]:
        found.append(
            Finding(
                "error" if part == "femur" else "warning",
                part,
                f"{after['non_manifold_edges']} edges are shared by more than two faces",
                "Remove inner walls and overlapping sheets: inside and outside are not defined there.",
            )
        )
    if after["closed"] and after["volume_cm3"] < 0.0:
        found.append(
            Finding("error", part, "the solid is inside out", "Reverse its faces (flip normals).")
        )
    if after["boundary_loops"] > after["components"]:
        holes = after["boundary_loops"] - after["components"]
        found.append(
            Finding(
                "warning",
                part,
                f"{after['boundary_loops']} open borders on {after['components']} surface(s): perhaps {holes} hole(s)",
                "Fill them where contact can reach: a face that meets a border does not count.",
            )
        )
    if after["components"] > 4:
        found.append(
            Finding(
                "warning",
                part,
                f"{after['components']} separate pieces",
                "Delete what is not the articulating surface, or join vertices that should be one.",
            )
        )
    if after["sliver_faces"]:
        found.append(
            Finding(
                "warning",
                part,
                f"{after['sliver_faces']} faces are slivers less than 1 µm wide",
                "Harmless unless many; mesh the surface again if contact reaches them.",
            )
        )
    return found


def _size(part: str, after: dict[str, Any]) -> list[Finding]:
    usual = _USUAL_SIZE_MM.get(part)
    if usual is None:
        return []
    size = float(np.max(np.subtract(after["highest_mm"], after["lowest_mm"])))
    if usual[0] <= size <= usual[1]:
        return []
    text = f"{size:.4g} mm across; a {part} is usually {usual[0]:.0f} to {usual[1]:.0f} mm"
    return [
        Finding(
            "warning", part, text, "Check the file's unit (mm, m or inch), and that it is whole."
        )
    ]


def _repairs(part: str, before: dict[str, Any], after: dict[str, Any]) -> list[Finding]:
    """What reading put right."""
    texts = {
        "duplicate_vertices": "vertices at the same place, joined",
        "degenerate_faces": "faces without area, dropped",
        "duplicate_faces": "repeated faces, dropped",
        "unused_vertices": "vertices in no face, dropped",
    }
    found = [f"{before[key]} {text}" for key, text in texts.items() if before[key] > after[key]]
    if before["inconsistent_edges"] > after["inconsistent_edges"]:
        found.append(
            f"windings that disagreed at {before['inconsistent_edges']} edges, made to agree"
        )
    return [Finding("repaired", part, text, "Nothing to do.") for text in found]


def _placing(contact: MeshContact) -> list[Finding]:
    """How the insert lies in its frame."""
    z = [np.asarray(m.vertices)[:, 2] for m in (contact.insert_medial, contact.insert_lateral)]
    middle = 1e3 * 0.5 * (min(v.min() for v in z) + max(v.max() for v in z))
    found = []
    if abs(middle) > _OFF_CENTRE_MM:
        text = f"the insert's middle lies at z = {middle:.3g} mm"
        advice = "Move it to z = 0, where it is split into medial and lateral, or give both compartments."
        found.append(Finding("warning", "insert", text, advice))
    return found


def _trial(contact: MeshContact) -> TrialContact:
    middle = first_touch(contact, np.zeros(6))
    seat = seated_pose(contact)
    x, y, z = (1e3 * float(v) for v in seat.pose[:3])
    touch_mm = 1e3 * float(middle.pose[1]) if middle.converged else None
    if not seat.converged:
        return TrialContact(touch_mm, seat.status, (x, y, z), _TRIAL_LOAD, "not tried")
    loaded = load_seated(contact, seat, _TRIAL_LOAD, theta_x=0.0)
    if not loaded.converged[0]:
        return TrialContact(touch_mm, seat.status, (x, y, z), _TRIAL_LOAD, str(loaded.status[0]))
    sides = contact_map(contact, loaded.poses[0]).sides
    of = [sides[name] for name in SIDES]
    return TrialContact(
        touch_mm,
        seat.status,
        (x, y, z),
        _TRIAL_LOAD,
        str(loaded.status[0]),
        Fy=_pair([s.wrench[1] for s in of]),
        max_depth_mm=_pair([1e3 * s.depth.max() for s in of]),
        area_mm2=_pair([1e6 * s.area for s in of]),
        peak_pressure_mpa=_pair([1e-6 * s.pressure.max() for s in of]),
        loaded_faces=(int((of[0].depth > 0.0).sum()), int((of[1].depth > 0.0).sum())),
    )


def _pair(values: list[Any]) -> tuple[float, float]:
    return float(values[0]), float(values[1])


def _doubts(contact: MeshContact, trial: TrialContact) -> list[Finding]:
    """What the trial says about the pair."""
    if trial.seat_status != "converged":
        return [_no_seat(trial)]
    if trial.load_status != "converged":
        text = f"the seated pair does not carry {trial.load:.0f} N: {trial.load_status}"
        return [Finding("warning", "pair", text, "Look at both parts together in a viewer.")]
    found = []
    for name, mesh, faces, area in zip(
        SIDES,
        (contact.insert_medial, contact.insert_lateral),
        trial.loaded_faces,
        trial.area_mm2,
        strict=True,
    ):
        if faces == 0:
            text = f"carries nothing of {trial.load:.0f} N in the seated pose"
            advice = "Check that the compartments are level and belong to this femur."
            found.append(Finding("warning", f"insert_{name}", text, advice))
        elif faces < _FEWEST_LOADED_FACES:
            edge, wanted = mean_edge_length(mesh), _edge_for(mesh, faces)
            text = f"{faces} faces ({1e3 * edge:.2g} mm wide) carry {trial.load:.0f} N on {area:.3g} mm²: coarse"
            advice = f"Mesh the insert with edges of {1e3 * wanted:.2g} mm for smooth pressures and stiffness."
            found.append(Finding("warning", f"insert_{name}", text, advice))
    return found


def _edge_for(mesh: Mesh, faces: int) -> float:
    """Edge length that brings the loaded faces to what is wanted [m]."""
    return mean_edge_length(mesh) * float(np.sqrt(faces / _FEWEST_LOADED_FACES))


def _no_seat(trial: TrialContact) -> Finding:
    if trial.seat_status == "no_clearance":
        text = "the femur is in contact with the insert however high it is lifted"
        advice = (
            "Check that both files are in their frames (femur in F, insert in T), x anterior, y up."
        )
    elif trial.seat_status == "no_contact":
        text = "the femur passes the insert without touching it"
        advice = (
            "Check that both files are in their frames (femur in F, insert in T), x anterior, y up."
        )
    else:
        text = "the femur finds no lowest place on the insert and slides off"
        advice = "Check which way is anterior (x) and up (y), and that the insert is dished."
    return Finding("error", "pair", text, advice)
