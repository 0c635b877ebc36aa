# SPDX-License-Identifier: Apache-2.0
"""Marker kinematics by OpenSim's InverseKinematicsSolver, and the low-pass that follows.

At each time frame OpenSim minimises Σ w |marker of the model − marker measured|² over the coordinates
that are free; locked ones stay, coupled ones follow. A missing marker has no weight there.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from condyle.errors import InputDataError
from condyle.opensim.library import OpenSimModel, load_model, opensim_library
from condyle.opensim.low_pass import low_pass
from condyle.opensim.markers import Markers, read_markers
from condyle.opensim.motion import write_sto

Array = npt.NDArray[np.float64]

FILTER_HZ: Final = 6.0


@dataclass(frozen=True)
class InverseKinematicsResult:
    """Coordinates over time, and how well the markers fit.

    Attributes:
        model: Name of the model's file.
        source: Name of the markers' file.
        times: (T) [s].
        coordinates: n names, all coordinates of the model in its order.
        raw: (T, n) as solved [rad, m].
        values: (T, n) filtered; ``raw`` where no filter was asked for.
        filter_hz: Cut-off [Hz]; 0: none.
        markers: k names of the markers that were followed.
        errors: (T, k) distance between model and measurement [m], before the filter; NaN: missing.
        unknown: Markers of the file that the model does not have.
        not_measured: Markers of the model that the file does not have, or never sees.
        without_weight: Markers of both that have weight 0, or are not in the list of weights.
    """

    model: str
    source: str
    times: Array
    coordinates: tuple[str, ...]
    raw: Array
    values: Array
    filter_hz: float
    markers: tuple[str, ...]
    errors: Array
    unknown: tuple[str, ...]
    not_measured: tuple[str, ...]
    without_weight: tuple[str, ...]

    @property
    def rms(self) -> Array:
        """(T) root mean square over the markers that are seen [m]."""
        return np.asarray(np.sqrt(np.nanmean(self.errors**2, axis=1)))

    @property
    def marker_rms(self) -> Array:
        """(k) root mean square over time [m]."""
        return np.asarray(np.sqrt(np.nanmean(self.errors**2, axis=0)))

    @property
    def filter_in_words(self) -> str:
        """What was filtered, for a header or a screen."""
        if self.filter_hz == 0.0:
            return "not filtered"
        return (
            f"low-pass {self.filter_hz:g} Hz, zero-lag 4th-order Butterworth "
            "(2nd order, forward and backward)"
        )


def inverse_kinematics(
    file: Path,
    markers_file: Path,
    *,
    weights: Mapping[str, float] | Path | None = None,
    filter_hz: float = FILTER_HZ,
    start: float | None = None,
    end: float | None = None,
    axes: str = "x,y,z",
    accuracy: float = 1e-5,
    progress: Callable[[int, int], None] | None = None,
) -> InverseKinematicsResult:
    """Finds the coordinates that bring a model's markers closest to measured ones.

    Args:
        file: .osim.
        markers_file: .trc or .c3d.
        weights: By marker's name or pattern, others 1; or an OpenSim file with IKMarkerTasks
            (ik_setup.xml), then only its markers are followed. None: all 1.
        filter_hz: Cut-off of the low-pass [Hz]; 0 for none.
        start: First time to solve [s]; None: the file's.
        end: Last time [s]; None: the file's.
        axes: As :func:`condyle.opensim.markers.read_markers`.
        accuracy: Of the solution, as OpenSim's tool has it.
        progress: Called with (time frames done, of how many).

    Raises:
        InputDataError: A file cannot be used; no marker in common; a weight for no marker; a filter
            that does not fit; a time frame that OpenSim could not solve.
    """
    loaded = load_model(file)
    markers = read_markers(markers_file, axes).between(start, end)
    own = [marker.getName() for marker in loaded.model.getMarkerSet()]
    common = _shared(markers, own, file)
    sightings = np.isfinite(markers.positions[..., 0]).sum(axis=0)
    seen = {name for name, n in zip(markers.names, sightings.tolist(), strict=True) if n}
    given = _weights(weights, common)
    followed = [name for name in common if name in seen and given.get(name, 0.0) > 0.0]
    if not followed:
        raise InputDataError(f"{markers_file}: no marker is left to follow: all have weight 0")
    raw, errors = _solve(loaded, markers, followed, given, accuracy, progress)
    return InverseKinematicsResult(
        model=file.name,
        source=markers_file.name,
        times=markers.times,
        coordinates=tuple(c.getName() for c in loaded.model.getCoordinateSet()),
        raw=raw,
        values=low_pass(markers.times, raw, filter_hz, source=str(markers_file))
        if filter_hz
        else raw,
        filter_hz=filter_hz,
        markers=tuple(followed),
        errors=errors,
        unknown=tuple(name for name in markers.names if name not in own),
        not_measured=tuple(name for name in own if name not in seen),
        without_weight=tuple(n for n in common if n in seen and n not in followed),
    )


def write_coordinates(file: Path, result: InverseKinematicsResult) -> None:
    """Writes the coordinates as .sto in SI and radians; its header says what was done."""
    notes = [
        f"inverse kinematics of {result.model} to the markers of {result.source}",
        f"coordinates: {result.filter_in_words}; rad, m, s",
        f"marker RMS before filtering: mean {1e3 * result.rms.mean():.2f} mm, "
        f"worst time frame {1e3 * result.rms.max():.2f} mm",
    ]
    write_sto(file, "Coordinates", notes, result.times, result.coordinates, result.values)


def _shared(markers: Markers, own: list[str], file: Path) -> list[str]:
    common = [name for name in markers.names if name in own]
    if not common:
        raise InputDataError(
            f"{markers.source}: none of its markers ({', '.join(markers.names)}) is in {file.name} "
            f"(which has {', '.join(own) or 'none'})"
        )
    return common


def _weights(weights: Mapping[str, float] | Path | None, names: list[str]) -> dict[str, float]:
    if weights is None:
        return dict.fromkeys(names, 1.0)
    if isinstance(weights, Path):
        return _weights_of_tasks(weights)
    found = dict.fromkeys(names, 1.0)
    for pattern, weight in weights.items():
        fits = [name for name in names if fnmatchcase(name, pattern)]
        if not fits:
            raise InputDataError(
                f"weight of '{pattern}': fits no marker that model and file share: "
                f"{', '.join(names)}"
            )
        if not (np.isfinite(weight) and weight >= 0.0):
            raise InputDataError(f"weight of '{pattern}' is {weight}: must be 0 or more")
        found |= dict.fromkeys(fits, float(weight))
    return found


def _weights_of_tasks(file: Path) -> dict[str, float]:
    try:
        root = ElementTree.parse(file).getroot()
    except OSError as error:
        raise InputDataError(f"{file}: cannot be read: {error.strerror or error}") from error
    except ElementTree.ParseError as error:
        raise InputDataError(f"{file}: no XML: {error}") from error
    tasks = {
        task.get("name", ""): float(task.findtext("weight", "0"))
        for task in root.iter("IKMarkerTask")
        if task.findtext("apply", "true").strip() == "true"
    }
    if not tasks:
        raise InputDataError(f"{file}: no <IKMarkerTask> that is applied")
    if any(t.findtext("apply", "true").strip() == "true" for t in root.iter("IKCoordinateTask")):
        raise InputDataError(f"{file}: an <IKCoordinateTask> is applied: only markers are followed")
    return tasks


def _solve(
    loaded: OpenSimModel,
    markers: Markers,
    followed: list[str],
    weights: dict[str, float],
    accuracy: float,
    progress: Callable[[int, int], None] | None,
) -> tuple[Array, Array]:
    """Coordinates (T, n) and marker errors (T, k)."""
    library = opensim_library()
    columns = [markers.names.index(name) for name in followed]
    measured = markers.positions[:, columns]
    reference = _reference(markers.times, followed, measured, weights)
    solver = library.InverseKinematicsSolver(
        loaded.model, reference, library.SimTKArrayCoordinateReference()
    )
    solver.setAccuracy(accuracy)
    stations = [loaded.model.getMarkerSet().get(name) for name in followed]
    coordinates = list(loaded.model.getCoordinateSet())
    state, n = loaded.state, len(markers.times)
    raw, modelled = np.empty((n, len(coordinates))), np.empty(measured.shape)
    for frame, time in enumerate(markers.times):
        state.setTime(float(time))
        try:
            if frame == 0:
                solver.assemble(state)
            # As OpenSim's tool does, the first time frame too.
            solver.track(state)
        except RuntimeError as error:
            raise InputDataError(
                f"{markers.source}: OpenSim found no posture at {time:g} s: "
                f"{' '.join(str(error).split())}"
            ) from error
        loaded.model.realizePosition(state)
        raw[frame] = [coordinate.getValue(state) for coordinate in coordinates]
        for k, station in enumerate(stations):
            p = station.getLocationInGround(state)
            modelled[frame, k] = [p.get(i) for i in range(3)]
        if progress is not None:
            progress(frame + 1, n)
    return raw, np.linalg.norm(modelled - measured, axis=2)


def _reference(times: Array, names: list[str], measured: Array, weights: dict[str, float]) -> Any:
    """``opensim.MarkersReference`` of positions (T, k, 3), NaN where missing."""
    library = opensim_library()
    table = library.TimeSeriesTableVec3()
    table.setColumnLabels(names)
    for time, row in zip(times, measured, strict=True):
        vectors = library.RowVectorVec3(len(names))
        for k, p in enumerate(row):
            vectors[k] = library.Vec3(float(p[0]), float(p[1]), float(p[2]))
        table.appendRow(float(time), vectors)
    table.addTableMetaDataString("Units", "m")
    rate = (len(times) - 1) / (times[-1] - times[0]) if len(times) > 1 else 1.0
    table.addTableMetaDataString("DataRate", str(rate))
    set_ = library.SetMarkerWeights()
    for name in names:
        set_.cloneAndAppend(library.MarkerWeight(name, weights[name]))
    return library.MarkersReference(table, set_)
