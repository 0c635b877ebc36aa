# SPDX-License-Identifier: Apache-2.0
"""Stage ``train``: the surrogate, as ONNX files, with its card and the record of its training."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import condyle
from condyle.errors import CondyleError
from condyle.evaluation import sample_error_table
from condyle.study.context import StudyContext
from condyle.study.training import (
    TrainingProgress,
    searched_settings,
    trainer,
)
from condyle.whole_files import write_whole

if TYPE_CHECKING:
    from condyle.sampling import Dataset
    from condyle.study.training_section import TrainingSection
    from condyle.training import SurrogateMetadata, TrainingRecord
    from condyle.training.potential import PotentialSurrogate
    from condyle.training.two_stage import TwoStageSurrogate


def run(context: StudyContext) -> bool:
    """Trains on the dataset's training split, calibrates trust on the test split, exports and checks the files."""
    inputs = {
        **context.study.canonical("training"),
        "samples": context.outputs_of("sample"),
        "version": condyle.__version__,
    }
    return context.directory.run_stage("train", inputs, lambda: _train(context))


def _train(context: StudyContext) -> list[Path]:
    from condyle.sampling import Dataset
    from condyle.surrogate import write_model_card

    section, directory = context.study.training, context.directory
    dataset = Dataset.read(context.samples_directory)
    train = dataset.split == "train"
    context.reporter.stage("train", _what(section, int(train.sum())))
    directory.training.mkdir(parents=True, exist_ok=True)
    checkpoint = directory.training / "checkpoint.pt"
    search_checkpoint = directory.training / "search.pt"
    samples = dataset.poses[train], dataset.wrenches[train]
    settings, search = searched_settings(section, *samples, search_checkpoint, context.reporter)
    surrogate, record = trainer(section)(
        *samples,
        settings,
        progress=TrainingProgress(context.reporter, section.architecture),
        checkpoint=checkpoint,
    )
    extra = {} if search is None else {"architecture_search": search}
    _export(context, surrogate, dataset, _metadata(context, surrogate, record, dataset, extra))
    cards = write_model_card(directory.surrogate, record.wall_times_s)
    record_file = directory.training / "record.json"
    write_whole(record_file, json.dumps(record.to_dict() | extra, indent=1) + "\n")
    for unfinished in (checkpoint, search_checkpoint):
        unfinished.unlink(missing_ok=True)
    said = ", ".join(f"net {n.name} {n.epochs} epochs ({n.stop_reason})" for n in record.nets)
    context.reporter.finished("train", said)
    files = [directory.surrogate, directory.surrogate_wrench, directory.surrogate_float32]
    return [*files, record_file, *cards]


def _what(section: TrainingSection, samples: int) -> str:
    size = f"{section.neurons} neurons x {section.hidden_layers}"
    if section.search.enabled:
        size = "layers and neurons searched for"
    return f"{samples} samples, {section.architecture}, {size}"


def _metadata(
    context: StudyContext,
    surrogate: TwoStageSurrogate | PotentialSurrogate,
    record: TrainingRecord,
    dataset: Dataset,
    extra: dict[str, Any],
) -> SurrogateMetadata:
    """What the file says of itself; among it the errors over held-out samples, by domain."""
    from condyle.surrogate.card import HELD_OUT, pack_rows
    from condyle.training import SurrogateMetadata

    test = dataset.split == "test"
    errors = sample_error_table(
        dataset.domain[test], dataset.wrenches[test], surrogate.wrench(dataset.poses[test])
    )
    identity = context.identity()
    # Where the samples are from, if not from a study.
    if (provenance := identity.get("provenance")) is not None:
        extra = {**extra, "provenance": provenance}
    return SurrogateMetadata(
        side_of_body=identity["side_of_body"],
        implant=identity["implant"],
        contact_law=identity["contact_law"],
        training={
            **record.to_dict(history=False),
            "samples": context.outputs_of("sample"),
            HELD_OUT: pack_rows(errors),
            **extra,
        },
    )


def _export(
    context: StudyContext,
    surrogate: TwoStageSurrogate | PotentialSurrogate,
    dataset: Dataset,
    metadata: SurrogateMetadata,
) -> None:
    """Calibrates trust, writes the files and compares the full one with the networks."""
    from condyle.training import (
        TrustModel,
        check_parity,
        export_float32_onnx,
        export_onnx,
        export_wrench_only_onnx,
    )

    directory = context.directory
    train, test = dataset.split == "train", dataset.split == "test"
    trust = TrustModel.calibrate(
        surrogate,
        dataset.poses[train],
        dataset.wrenches[train],
        dataset.poses[test],
        dataset.wrenches[test],
        train_domain=dataset.domain[train],
        definitions=dataset.manifest.get("domains", ()),
    )
    export_onnx(directory.surrogate, surrogate, trust, metadata)
    export_wrench_only_onnx(directory.surrogate_wrench, surrogate, trust, metadata)
    export_float32_onnx(directory.surrogate_float32, surrogate, trust, metadata)
    parity = check_parity(directory.surrogate, surrogate, dataset.poses[test], trust)
    if not parity.agrees:
        raise CondyleError(
            f"{directory.surrogate}: differs from the networks it was exported from: {parity.excess}"
        )
