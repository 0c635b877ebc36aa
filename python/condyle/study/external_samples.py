# SPDX-License-Identifier: Apache-2.0
"""Studies that train on samples which they do not make: ``[sampling] dataset``.

There is a dataset and no reference contact: nothing can be sampled, simulated for comparison or
shown as pressure, and stages that would need it are not there.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

import condyle
from condyle.errors import CondyleError
from condyle.study.context import StudyContext
from condyle.study.run_directory import digest_of_file
from condyle.study.schema import Study

#: Stages that need a reference contact.
WITH_REFERENCE: Final = ("implant", "body", "reference", "simulate")


def has_stage(study: Study, stage: str) -> bool:
    """Whether a study has a stage."""
    if stage == "body" and study.body is None:
        return False
    return study.sampling.dataset is None or stage not in WITH_REFERENCE


def require_stage(study: Study, stage: str) -> None:
    """Refuses a stage that a study has not.

    Raises:
        CondyleError: see above.
    """
    if not has_stage(study, stage):
        raise CondyleError(
            f"study {study.name}: stage '{stage}' needs a reference contact, and this study takes its "
            f"samples from {study.sampling.dataset} (sampling.dataset); it can train, evaluate and report"
        )


def adopt_samples(context: StudyContext) -> bool:
    """Stage ``sample`` of such a study: checks the dataset, every part of it, and tells its counts."""
    from condyle.sampling import Dataset

    directory = context.samples_directory
    inputs = {"manifest": _manifest_digest(directory), "version": condyle.__version__}

    def work() -> list[Path]:
        context.reporter.stage("sample", f"samples from {directory}")
        data = Dataset.read(directory)
        train, test = (int((data.split == name).sum()) for name in ("train", "test"))
        table = {
            "manifest_sha256": inputs["manifest"],
            "provenance": data.manifest.get("provenance"),
            "domains": [
                {name: entry[name] for name in ("domain", "train", "test")}
                for entry in data.manifest["domains"]
            ],
            "train": train,
            "test": test,
        }
        context.reporter.finished("sample", f"{train} samples for training, {test} for testing")
        return [context.directory.write_table("external_samples", table)]

    return context.directory.run_stage("sample", inputs, work)


def _manifest_digest(directory: Path) -> str:
    file = directory / "manifest.json"
    if not file.exists():
        raise CondyleError(
            f"sampling.dataset = {directory}: holds no manifest.json: it is not a dataset of samples "
            "(condyle samples import makes one of a table)"
        )
    return digest_of_file(file)
