# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

from typer.testing import CliRunner

from condyle.cli.app import app
from condyle.implants import generate, preset, write_implant


def test_fast_keeps_its_field_and_its_error_where_it_is_told_to(tmp_path: Path) -> None:
    write_implant(tmp_path, generate(preset("curved")))
    names = "x,y,z,theta_x,theta_y,theta_z"
    (tmp_path / "poses.csv").write_text(f"{names}\n0.0068,0.0405,0,0,0,0\n", encoding="utf-8")
    cache = tmp_path / "cache"
    arguments = ["contact", "eval", "--femur", f"{tmp_path}/femur.stl", "--units", "m"]
    arguments += ["--insert", f"{tmp_path}/insert.stl", "--side-of-body", "right"]
    arguments += ["--poses", f"{tmp_path}/poses.csv", "--evaluation", "fast", "--cache", str(cache)]
    outputs, tables = [], []
    for name in ("first.csv", "again.csv"):
        result = CliRunner().invoke(app, [*arguments, "--out", str(tmp_path / name)])
        assert result.exit_code == 0, result.output
        outputs.append(result.output.splitlines()[0])
        tables.append((tmp_path / name).read_bytes())
        kept = sorted(file.name for file in cache.iterdir())
        assert [file.endswith(".field") for file in kept].count(True) == 1
        assert [file.endswith(".fast_error.json") for file in kept].count(True) == 1
        assert len(kept) == 2
    assert outputs[0] == outputs[1]
    assert "over 400 plausible poses" in outputs[0]
    assert tables[0] == tables[1]
