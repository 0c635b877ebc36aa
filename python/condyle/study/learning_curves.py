# SPDX-License-Identifier: Apache-2.0
"""Learning curves of a study: held-out errors against the number of samples, and against training time.

Each point is a training as the study's ``[training]`` says, on a part of the training samples; the test samples are the
same for all. The parts are nested and hold the same share of every domain. Points live in ``learning/`` of the run,
by what they depend on: a finished one is kept, an unfinished one goes on from its checkpoint.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np
from numpy.typing import NDArray

import condyle
from condyle.errors import CondyleError, InputDataError
from condyle.evaluation import sample_error_table
from condyle.report.learning_curves import render_learning_curves
from condyle.study.context import StudyContext
from condyle.study.run_directory import digest_of_data
from condyle.study.training import TrainingProgress, trainer, training_settings
from condyle.whole_files import write_whole

if TYPE_CHECKING:
    from condyle.sampling import Dataset
    from condyle.training.snapshots import Surrogate

SHARES: Final = (0.125, 0.25, 0.5, 1.0)
MINUTES: Final = (5.0, 15.0, 30.0, 60.0)


@dataclass(frozen=True)
class LearningPlan:
    """Which points.

    Attributes:
        shares: of the training samples, in (0, 1], ascending.
        minutes: training times at which errors are told; each costs nothing.
        every: epochs between the networks kept for the curve over time, of the largest share.
        seed: of the parts.
    """

    shares: tuple[float, ...] = SHARES
    minutes: tuple[float, ...] = MINUTES
    every: int = 5
    seed: int = 1

    def __post_init__(self) -> None:
        """Refuses what cannot be meant."""
        if not self.shares or not all(0 < share <= 1 for share in self.shares):
            raise InputDataError(
                f"learning curves: shares are {self.shares}; each must be above 0, at most 1"
            )
        if not all(minutes > 0 for minutes in self.minutes):
            raise InputDataError(
                f"learning curves: minutes are {self.minutes}; each must be above 0"
            )
        if self.every < 1:
            raise InputDataError(f"learning curves: every is {self.every}; it must be at least 1")

    @classmethod
    def of(
        cls,
        shares: Sequence[float] | None,
        minutes: Sequence[float] | None,
        *,
        every: int = 5,
        seed: int = 1,
    ) -> Self:
        """The plan in order, with the defaults where nothing is given."""
        chosen = tuple(sorted(set(shares or SHARES))), tuple(sorted(set(minutes or MINUTES)))
        return cls(*chosen, every=every, seed=seed)


def nested_order(domain: NDArray[np.integer[Any]], seed: int) -> NDArray[np.int64]:
    """Rows in an order whose beginnings, of any length, hold the same share of every domain.

    Args:
        domain: (n,) of the rows.
        seed: of the order within a domain.
    """
    place = np.empty(len(domain))
    generator = np.random.default_rng(seed)
    for number in np.unique(domain):
        rows = np.flatnonzero(domain == number)
        # The k-th of a domain's m rows stands where k/m of all rows stand.
        place[generator.permutation(rows)] = (np.arange(len(rows)) + 0.5) / len(rows)
    order: NDArray[np.int64] = np.argsort(place, kind="stable")
    return order


def learning_curves(context: StudyContext, plan: LearningPlan) -> bool:
    """Trains the points that are missing; writes learning_curves.md, a table and a figure into the run.

    Returns:
        False if all of it was there, made from the same inputs.

    Raises:
        CondyleError: the samples are not there, or the study searches for an architecture.
    """
    if context.study.training.search.enabled:
        raise CondyleError(
            f"study {context.study.name}: learning curves need one architecture for all points: set "
            "training.hidden_layers and training.neurons to what the search found, and search = false"
        )
    inputs = {**_point_inputs(context), "plan": asdict(plan)}
    return context.directory.run_stage("learn", inputs, lambda: _learn(context, plan))


def _point_inputs(context: StudyContext) -> dict[str, Any]:
    return {
        **context.study.canonical("training"),
        "samples": context.outputs_of("sample"),
        "version": condyle.__version__,
    }


def _learn(context: StudyContext, plan: LearningPlan) -> list[Path]:
    from condyle.report.learning_figure import learning_figure
    from condyle.report.style import house_style, save
    from condyle.sampling import Dataset

    dataset = Dataset.read(context.samples_directory)
    rows = np.flatnonzero(dataset.split == "train")
    order = rows[nested_order(dataset.domain[rows], plan.seed)]
    counts = [max(1, round(share * len(order))) for share in plan.shares]
    context.reporter.stage("learn", f"{', '.join(map(str, counts))} samples")
    points = []
    for count in counts:
        points.append(_point(context, plan, dataset, order[:count], is_last=count == counts[-1]))
    table = {
        "architecture": context.study.training.architecture,
        "test_samples": int((dataset.split == "test").sum()),
        "minutes": list(plan.minutes),
        "points": points,
    }
    directory = context.directory
    text = directory.root / "learning_curves.md"
    with house_style():
        figure = save(learning_figure(table), directory.figures / "learning_curves.png")
    shown = figure.relative_to(directory.root).as_posix()
    write_whole(text, render_learning_curves(context.study.name, table, shown))
    context.reporter.finished("learn", f"{text}")
    return [directory.write_table("learning_curves", table), text, figure]


def _point(
    context: StudyContext,
    plan: LearningPlan,
    dataset: Dataset,
    rows: NDArray[np.int64],
    is_last: bool,
) -> dict[str, Any]:
    """One training's result: from its file if it has finished, else trained."""
    from condyle.training.snapshots import SnapshotRecorder, read_snapshots, surrogate_over_time

    inputs = _point_inputs(context) | {"rows": len(rows), "seed": plan.seed}
    if is_last:
        inputs["every"] = plan.every
    folder = context.directory.root / "learning" / f"{len(rows)}-{digest_of_data(inputs)[:12]}"
    result = folder / "point.json"
    if result.exists():
        finished: dict[str, Any] = json.loads(result.read_text(encoding="utf-8"))
        return finished
    folder.mkdir(parents=True, exist_ok=True)
    checkpoint = folder / "checkpoint.pt"
    section = context.study.training
    progress = TrainingProgress(context.reporter, section.architecture, f"{len(rows)} samples, ")
    surrogate, record = trainer(section)(
        dataset.poses[rows],
        dataset.wrenches[rows],
        training_settings(section),
        progress=SnapshotRecorder(folder, checkpoint, plan.every, progress)
        if is_last
        else progress,
        checkpoint=checkpoint,
    )
    point = {
        "samples": len(rows),
        "seconds": sum(record.wall_times_s.values()),
        "epochs": {net.name: net.epochs for net in record.nets},
        "stop_reasons": {net.name: net.stop_reason for net in record.nets},
        "errors": _errors(dataset, surrogate),
        "over_time": [
            {
                "seconds": timed.seconds,
                "epochs": list(timed.epochs),
                "losses": list(timed.losses),
                "errors": [r for r in _errors(dataset, timed.surrogate) if r["domain"] == "all"],
            }
            for timed in surrogate_over_time(surrogate, read_snapshots(folder))
        ],
    }
    write_whole(result, json.dumps(point, indent=1) + "\n")
    for unfinished in (checkpoint, *folder.glob("snapshot_*.npz")):
        unfinished.unlink(missing_ok=True)
    return point


def _errors(dataset: Dataset, surrogate: Surrogate) -> list[dict[str, Any]]:
    test = dataset.split == "test"
    predicted = surrogate.wrench(dataset.poses[test])
    return sample_error_table(dataset.domain[test], dataset.wrenches[test], predicted)
