# SPDX-License-Identifier: Apache-2.0
"""The examples of the documentation run, and say what they say."""

import json
import re
from pathlib import Path

import numpy as np

from condyle.model import MusculoskeletalModel, surface_files

ROOT = Path(__file__).parents[3]


def test_the_python_example_runs_as_printed(monkeypatch, capsys):
    text = (ROOT / "docs" / "musculoskeletal.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    monkeypatch.chdir(ROOT)
    names = {}
    exec(compile(example, "docs/musculoskeletal.md", "exec"), names)
    first, second = capsys.readouterr().out.splitlines()
    assert first == "('elbow_flexion',)"
    assert second.startswith("{'converged'} ")
    assert second.endswith(" (51, 2, 1)")
    assert len(names["figure"].axes) >= 2


def test_the_mapping_of_meshes_places_them_as_measured(dm_folder, tmp_path):
    """docs/examples/dm_surfaces.json against the placements that come with the shared data."""
    measured = json.loads((dm_folder / "dm_model_summary.json").read_text(encoding="utf-8"))
    frames = measured["implant_frames"]
    model = {
        "format": "condyle-model",
        "version": 1,
        "name": "three bones",
        "bodies": [{"name": frame["body"], "mass": 1} for frame in frames.values()],
        "joints": [
            {"name": f"j{i}", "parent": {"body": "ground"}, "child": {"body": frame["body"]}}
            for i, frame in enumerate(frames.values())
        ],
        "coordinates": [],
        "contact_surfaces": [
            {"name": name, "frame": {"body": frame["body"]}, "mesh": f"{name}.stl"}
            for name, frame in frames.items()
        ],
    }
    (tmp_path / "bones.json").write_text(json.dumps(model), encoding="utf-8")
    bones = MusculoskeletalModel.read(tmp_path / "bones.json")
    mapping = json.loads((ROOT / "docs" / "examples" / "dm_surfaces.json").read_text())
    for surface in mapping["contact_surfaces"]:
        # The example's way to the data is that of a checkout beside it.
        surface["mesh"] = str(dm_folder.parents[1] / "implants" / "dm" / Path(surface["mesh"]).name)
    (tmp_path / "surfaces.json").write_text(json.dumps(mapping), encoding="utf-8")
    found = surface_files(bones, [tmp_path / "surfaces.json"])
    assert set(found) == set(frames)
    for name, frame in frames.items():
        assert found[name].body == frame["body"]
        # The file's angles have 9 digits.
        np.testing.assert_allclose(
            found[name].placement, frame["aligned_mesh_to_body"], rtol=0, atol=2e-9
        )
