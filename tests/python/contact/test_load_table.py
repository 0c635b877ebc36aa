# SPDX-License-Identifier: Apache-2.0
import csv
from pathlib import Path

import numpy as np
import pytest

from condyle.contact import MeshContact, evaluate_table, read_poses, write_table
from condyle.conventions import LOAD_COLUMNS, POSE_COLUMNS, SIDES
from condyle.errors import InputDataError

NUMBERS = (*LOAD_COLUMNS, "volume", "area", "max_depth")
HEADER = [*POSE_COLUMNS, *(f"{side}_{n}" for side in SIDES for n in NUMBERS), "status"]


@pytest.fixture(scope="module")
def dm(data: Path) -> MeshContact:
    folder = data / "implants" / "dm"
    return MeshContact.from_files(
        femur=folder / "femur_contact.stl",
        insert=folder / "insert_contact.stl",
        units="m",
        side_of_body="right",
    )


def rows_of(file: Path) -> list[dict[str, str]]:
    with file.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def test_the_real_implant_agrees_with_two_independent_programs(
    dm: MeshContact, data: Path, tmp_path: Path
) -> None:
    out = tmp_path / "loads.csv"
    poses = read_poses(data / "checks" / "dm_poses.csv")
    write_table(out, evaluate_table(dm, poses, threads=1))
    found, expected = rows_of(out), rows_of(data / "checks" / "dm_loads.csv")
    assert list(found[0]) == HEADER
    assert len(found) == len(expected) == 20
    for i, (ours, theirs) in enumerate(zip(found, expected, strict=True)):
        assert [float(ours[c]) for c in POSE_COLUMNS] == poses[i].tolist()
        assert ours["status"] == "ok"
        for side in SIDES:
            a, b = (
                np.array([float(row[f"{side}_{n}"]) for n in NUMBERS]) for row in (ours, theirs)
            )
            force, moment = np.linalg.norm(b[:3]), np.linalg.norm(b[3:6])
            # The file carries six digits; its two makers agree within 4e-6.
            assert np.abs(a[:3] - b[:3]).max() <= 1e-4 * force + 0.01
            assert np.abs(a[3:6] - b[3:6]).max() <= 1e-4 * moment + 0.001
            np.testing.assert_allclose(a[6:], b[6:], rtol=1e-4, atol=0.0)
            if not b.any():
                assert not a.any()


def test_the_table_does_not_depend_on_threads(contact: MeshContact) -> None:
    rng = np.random.default_rng(5)
    poses = np.array([0.001, 0.0176, 0.0, 0.0, 0.0, 0.0]) + rng.normal(0.0, 2e-3, (30, 6))
    one, three = (evaluate_table(contact, poses, threads=t) for t in (1, 3))
    assert list(one) == HEADER
    assert any(text != "ok" for text in one["status"])
    for name in HEADER:
        np.testing.assert_array_equal(one[name], three[name])


def test_a_status_fits_one_field(contact: MeshContact, tmp_path: Path) -> None:
    deep = np.array([[0.001, 0.0155, 0.0, 0.0, 0.0, 0.0]])
    write_table(tmp_path / "t.csv", evaluate_table(contact, deep))
    assert rows_of(tmp_path / "t.csv")[0]["status"] == (
        "medial: depth 2.8 mm is more than the plausible 2 mm; "
        "lateral: depth 2.8 mm is more than the plausible 2 mm"
    )
    assert sorted(p.name for p in tmp_path.iterdir()) == ["t.csv"]


@pytest.mark.parametrize("shape", [(6,), (3, 5), (2, 2, 6)])
def test_poses_of_another_shape_are_refused(contact: MeshContact, shape: tuple[int, ...]) -> None:
    with pytest.raises(InputDataError, match="must be \\(n, 6\\)"):
        evaluate_table(contact, np.zeros(shape))
