# SPDX-License-Identifier: Apache-2.0
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "sampling"))

from external_knee import external_table


def test_a_table_of_another_program_becomes_a_dataset(condyle, tmp_path):
    external_table(300).to_csv(tmp_path / "knee.csv", index=False)
    command = [
        "samples", "import", "knee.csv", "--into", "data", "--source", "rollers", "--side-of-body", "right",
        "--length-unit", "mm", "--angle-unit", "deg",
    ]  # fmt: skip
    refused = condyle(*command, folder=tmp_path)
    assert refused.returncode == 2
    assert refused.stderr.startswith("condyle: knee.csv, line ")
    assert "is Nm the file's unit?" in refused.stderr
    assert not (tmp_path / "data").exists()
    done = condyle(*command, "--moment-unit", "Nmm", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "255 samples for training and 45 for testing" in done.stdout
    assert (tmp_path / "data" / "manifest.json").exists()
