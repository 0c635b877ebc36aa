# SPDX-License-Identifier: Apache-2.0
"""whole_files, part_files and run_log: what is on the disk is whole, checked and one process's."""

import errno
import json
import os
import re
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

from condyle.errors import InputDataError
from condyle.sampling.part_files import (
    SAMPLE_SCHEMA,
    encode_part,
    read_part,
    read_part_record,
)
from condyle.sampling.run_log import RunLog
from condyle.whole_files import remove_leftovers, to_canonical_json, write_whole


def small_table() -> pa.Table:
    rng = np.random.default_rng(8)
    values = {"candidate": np.arange(50), "domain": np.full(50, 2), "split": ["train", "test"] * 25}
    columns = [
        pa.array(values.get(field.name, rng.integers(0, 9, 50)), field.type)
        for field in SAMPLE_SCHEMA
    ]
    return pa.table(columns, schema=SAMPLE_SCHEMA)


@pytest.mark.parametrize("failing", ["fsync", "replace"])
def test_a_full_disk_keeps_the_old_file_and_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failing: str
) -> None:
    path = tmp_path / "parts" / "a.parquet"
    write_whole(path, b"old")

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, failing, full)
    message = f"{re.escape(str(path))} cannot be written: No space left on device; finished files"
    with pytest.raises(InputDataError, match=message):
        write_whole(path, b"new content")
    assert [file.name for file in path.parent.iterdir()] == ["a.parquet"]
    assert path.read_bytes() == b"old"


def test_what_a_killed_process_left_is_removed_and_nothing_else(tmp_path: Path) -> None:
    write_whole(tmp_path / "deep" / "a.parquet", b"whole")
    (tmp_path / "deep" / "b.parquet.tmp").write_bytes(b"ha")
    remove_leftovers(tmp_path)
    assert [file.name for file in (tmp_path / "deep").iterdir()] == ["a.parquet"]


def test_canonical_json_is_one_text_a_value() -> None:
    assert to_canonical_json({"b": 0.1, "a": [1]}) == to_canonical_json({"a": [1], "b": 0.1})
    with pytest.raises(ValueError, match="not JSON compliant"):
        to_canonical_json({"a": float("nan")})


def test_a_part_gives_back_table_and_record_and_its_bytes_are_its_content(tmp_path: Path) -> None:
    record = {"design": "abc", "domain": 2}
    content = encode_part(small_table(), record)
    assert content == encode_part(small_table(), dict(reversed(record.items())))
    path = tmp_path / "part.parquet"
    path.write_bytes(content)
    assert read_part_record(path) == record
    assert read_part(path).to_pydict() == small_table().to_pydict()
    assert read_part(path, ["split"]).column_names == ["split"]
    assert read_part(path).schema.field("theta_y").metadata[b"unit"] == b"rad"
    assert read_part(path).schema.field("lateral_Mx").metadata[b"unit"] == b"Nm"


def damage(content: bytes, how: str) -> bytes:
    middle = len(content) // 3
    return {
        "truncated": content[: len(content) - 57],
        "flipped": content[:40] + bytes([content[40] ^ 0x10]) + content[41:],
        "hole": content[:middle] + bytes(64) + content[middle + 64 :],
        "empty": b"",
    }[how]


@pytest.mark.parametrize("how", ["truncated", "flipped", "hole", "empty"])
def test_a_damaged_part_is_named_with_what_to_do(tmp_path: Path, how: str) -> None:
    path = tmp_path / "part.parquet"
    path.write_bytes(damage(encode_part(small_table(), {"design": "abc"}), how))
    message = f"{re.escape(str(path))} is damaged.*remove this file and sample again"
    with pytest.raises(InputDataError, match=message):
        read_part(path)


def test_a_parquet_file_of_someone_else_is_not_a_part(tmp_path: Path) -> None:
    path = tmp_path / "part.parquet"
    pa.parquet.write_table(pa.table({"a": [1]}), path)
    with pytest.raises(InputDataError, match="damaged or not a part of this dataset"):
        read_part_record(path)


def test_one_process_at_a_time_and_the_log_says_how_it_ended(tmp_path: Path) -> None:
    def stopped() -> None:
        with RunLog(tmp_path) as log:
            log.write("start")
            with pytest.raises(InputDataError, match="another process is sampling into it"):
                RunLog(tmp_path)
            raise RuntimeError("power cut")

    with pytest.raises(RuntimeError):
        stopped()
    with RunLog(tmp_path) as log:
        log.write("again")
    lines = [line.split(" ", 1)[1] for line in (tmp_path / "run.log").read_text().splitlines()]
    assert lines == ["start", "stopped by RuntimeError: power cut", "again"]


def test_a_directory_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text(json.dumps({}))
    with pytest.raises(InputDataError, match="file/samples cannot be written: Not a directory"):
        RunLog(tmp_path / "file" / "samples")
