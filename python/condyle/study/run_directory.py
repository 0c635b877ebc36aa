# SPDX-License-Identifier: Apache-2.0
"""The directory of one study's run: where each result is, and which stage made it from what."""

import hashlib
import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from condyle.whole_files import write_whole


def digest_of_data(data: Any) -> str:
    """SHA-256 of JSON data, independent of the order of keys."""
    text = json.dumps(data, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def digest_of_file(file: Path) -> str:
    """SHA-256 of a file's bytes."""
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


@dataclass(frozen=True)
class RunDirectory:
    """Paths below ``runs/<name>``."""

    root: Path

    @property
    def implant(self) -> Path:
        """Meshes of the implant as they were used, STL in metres."""
        return self.root / "implant"

    @property
    def cache(self) -> Path:
        """What can be computed again: distance fields."""
        return self.root / "cache"

    @property
    def simulations(self) -> Path:
        """Simulated activities, one CSV an activity and contact model."""
        return self.root / "simulations"

    @property
    def samples(self) -> Path:
        """The dataset."""
        return self.root / "samples"

    @property
    def training(self) -> Path:
        """Checkpoints, the record and the loss history."""
        return self.root / "training"

    @property
    def surrogate(self) -> Path:
        """The surrogate by the ONNX contract."""
        return self.root / "surrogate.onnx"

    @property
    def surrogate_wrench(self) -> Path:
        """The surrogate's wrench-only file."""
        return self.root / "surrogate_wrench.onnx"

    @property
    def surrogate_float32(self) -> Path:
        """The surrogate computed in float32."""
        return self.root / "surrogate_float32.onnx"

    @property
    def tables(self) -> Path:
        """Results of the evaluation and simulation stages, one JSON each, merged in tables.json."""
        return self.root / "tables"

    @property
    def figures(self) -> Path:
        """Figures, PNG."""
        return self.root / "figures"

    def write_table(self, name: str, data: Any) -> Path:
        """Writes one table's data as JSON."""
        file = self.tables / f"{name}.json"
        write_whole(file, json.dumps(data, indent=1) + "\n")
        return file

    def read_table(self, name: str) -> Any:
        """Reads a table that a stage wrote; None where it has not run."""
        file = self.tables / f"{name}.json"
        return json.loads(file.read_text(encoding="utf-8")) if file.exists() else None

    def stage_record(self, stage: str) -> Path:
        """Where a stage notes the inputs it ran on and the outputs it made."""
        return self.root / "stages" / f"{stage}.json"

    def run_stage(
        self, stage: str, inputs: Any, work: Callable[[], Iterable[Path]], force: bool = False
    ) -> bool:
        """Runs a stage unless it has run on the same inputs and its outputs are still what it made.

        Args:
            stage: its name.
            inputs: JSON data that decides the stage's outputs (settings, digests of files).
            work: does it, and returns the files it made.
            force: run even if nothing has changed.

        Returns:
            True if the work was done, False if it was skipped.
        """
        record = self.stage_record(stage)
        digest = digest_of_data(inputs)
        if not force and self._is_current(record, digest):
            return False
        record.unlink(missing_ok=True)  # an interrupted stage must not look finished
        outputs = {str(f.relative_to(self.root)): digest_of_file(f) for f in sorted(work())}
        text = json.dumps({"inputs": digest, "outputs": outputs}, indent=1) + "\n"
        write_whole(record, text)
        return True

    def _is_current(self, record: Path, digest: str) -> bool:
        try:
            known = json.loads(record.read_text(encoding="utf-8"))
            return known["inputs"] == digest and all(
                digest_of_file(self.root / name) == made for name, made in known["outputs"].items()
            )
        except (OSError, ValueError, KeyError):
            return False  # a damaged record or a missing output: run again

    def stage_outputs(self, stage: str) -> dict[str, str] | None:
        """Digests of a finished stage's outputs by relative path; None where it has not finished."""
        record = self.stage_record(stage)
        if not record.exists():
            return None
        outputs: dict[str, str] = json.loads(record.read_text(encoding="utf-8"))["outputs"]
        return outputs
