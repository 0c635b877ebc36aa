# SPDX-License-Identifier: Apache-2.0
"""Stage ``train``: the surrogate, as ONNX files, with the record of its training."""

import json
import math
from pathlib import Path
from typing import Any

import condyle
from condyle.errors import CondyleError
from condyle.study.context import StudyContext
from condyle.whole_files import write_whole


def run(context: StudyContext) -> bool:
    """Trains on the dataset's training split, calibrates trust on the test split, exports and checks the files."""
    inputs = {
        **context.study.canonical("training"),
        "samples": context.outputs_of("sample"),
        "version": condyle.__version__,
    }
    return context.directory.run_stage("train", inputs, lambda: _train(context))


def _provenance(identity: dict[str, Any]) -> dict[str, Any]:
    """Where the samples are from, if not from a study."""
    provenance = identity.get("provenance")
    return {} if provenance is None else {"provenance": provenance}


def _train(context: StudyContext) -> list[Path]:
    from condyle.sampling import Dataset
    from condyle.training.onnx_export import (
        SurrogateMetadata,
        export_onnx,
        export_wrench_only_onnx,
    )
    from condyle.training.parity import check_parity
    from condyle.training.settings import TrainingSettings
    from condyle.training.train import train_two_stage
    from condyle.training.trust import TrustModel

    section, directory = context.study.training, context.directory
    dataset = Dataset.read(context.samples_directory)
    train, test = dataset.split == "train", dataset.split == "test"
    context.reporter.stage(
        "train", f"{int(train.sum())} samples, {section.neurons} neurons x {section.hidden_layers}"
    )
    settings = TrainingSettings(
        hidden_layers=section.hidden_layers,
        neurons=section.neurons,
        max_epochs=section.max_epochs,
        time_budget_s=math.inf if section.time_budget_s is None else section.time_budget_s,
        seed=section.seed,
        threads=section.threads,
    )

    def progress(net: str, epoch: int, loss: float, gamma: float, _: float, left: float) -> None:
        note = f"epoch {epoch}, mse {loss:.2e}, γ {gamma:.0f}, at most {left:.0f} s left"
        context.reporter.progress(f"net {net}", epoch / settings.max_epochs, note)

    directory.training.mkdir(parents=True, exist_ok=True)
    checkpoint = directory.training / "checkpoint.pt"
    surrogate, record = train_two_stage(
        dataset.poses[train],
        dataset.wrenches[train],
        settings,
        progress=progress,
        checkpoint=checkpoint,
    )
    trust = TrustModel.calibrate(
        surrogate,
        dataset.poses[train],
        dataset.wrenches[train],
        dataset.poses[test],
        dataset.wrenches[test],
        train_domain=dataset.domain[train],
        definitions=dataset.manifest.get("domains", ()),
    )
    identity = context.identity()
    metadata = SurrogateMetadata(
        side_of_body=identity["side_of_body"],
        implant=identity["implant"],
        contact_law=identity["contact_law"],
        training=record.to_dict(history=False)
        | {"samples": context.outputs_of("sample"), **_provenance(identity)},
    )
    export_onnx(directory.surrogate, surrogate, trust, metadata)
    export_wrench_only_onnx(directory.surrogate_wrench, surrogate, trust, metadata)
    parity = check_parity(directory.surrogate, surrogate, dataset.poses[test], trust)
    if not parity.agrees:
        raise CondyleError(
            f"{directory.surrogate}: differs from the networks it was exported from: {parity.excess}"
        )
    record_file = directory.training / "record.json"
    write_whole(record_file, json.dumps(record.to_dict(), indent=1) + "\n")
    checkpoint.unlink(missing_ok=True)
    epochs = ", ".join(f"net {net.name} {net.epochs} epochs" for net in record.nets)
    context.reporter.finished("train", epochs)
    return [directory.surrogate, directory.surrogate_wrench, record_file]
