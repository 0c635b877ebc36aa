# SPDX-License-Identifier: Apache-2.0
import json
import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from small_implant import femur, inserts, patch

from condyle.contact import (
    FastError,
    LinearVolumeLaw,
    Mesh,
    MeshContact,
    fast_error,
    measure_fast_error,
    mesh_contact,
)


def dished(medial: bool) -> Mesh:
    """A shallow dish, 20 mm wide, under one half of the rounded femur."""
    flat = patch(0.0, -0.021 if medial else 0.021, 0.01, 16, up=True)
    vertices = flat.vertices.copy()
    x, z = vertices[:, 0] - 0.003, np.abs(vertices[:, 2]) - 0.021
    vertices[:, 1] = 0.0073 + 9.0 * x**2 + 7.0 * z**2
    return Mesh(vertices, flat.faces)


def rounded_femur() -> Mesh:
    """Two condyles of 25 mm radius, one over each dish, open above; normals out."""
    angles, z = np.meshgrid(np.linspace(0.3, 2.84, 50), np.linspace(-0.032, 0.032, 50))
    radius = 0.023 - 0.002 * np.cos(2 * np.pi * z / 0.042)
    vertices = np.stack([-radius * np.cos(angles), -radius * np.sin(angles), z], -1).reshape(-1, 3)
    corner = np.arange(49)[:, None] * 50 + np.arange(49)
    a, b = corner.ravel(), corner.ravel() + 50
    faces = np.concatenate([np.stack([a, a + 1, b + 1], 1), np.stack([a, b + 1, b], 1)])
    return Mesh(vertices, faces.astype(np.int32))


def contact(folder: Path | None, modulus: float = 9.3e9) -> MeshContact:
    return MeshContact(
        rounded_femur(),
        dished(True),
        dished(False),
        "right",
        law=LinearVolumeLaw(modulus=modulus),
        evaluation="fast",
        cache_directory=folder,
    )


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the pair's distance field, and its record."""
    folder = tmp_path_factory.mktemp("built")
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(fast_error, "_POSES", 1)
        contact(folder)
    return folder


@pytest.fixture
def folder(built: Path, tmp_path: Path) -> Path:
    """A folder with the pair's distance field, and no record."""
    for field in built.glob("*.field"):
        shutil.copy(field, tmp_path)
    return tmp_path


@pytest.fixture
def measured(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[FastError]]:
    """What was measured, as it is."""
    errors: list[FastError] = []

    def counted(*arguments: object, **options: object) -> FastError:
        errors.append(measure_fast_error(*arguments, **options, poses=24, threads=1))  # type: ignore[arg-type]
        return errors[-1]

    monkeypatch.setattr(mesh_contact, "measure_fast_error", counted)
    yield errors


def records(folder: Path) -> list[Path]:
    return sorted(folder.glob("*.fast_error.json"))


def test_the_error_is_measured_once_a_pair_and_kept_beside_its_field(
    folder: Path, measured: list[FastError]
) -> None:
    first = contact(folder)
    (record,) = records(folder)  # as soon as the contact is there
    assert first.fast_error is not None
    assert first.fast_error.status == "measured"
    assert contact(folder).fast_error == first.fast_error
    assert len(measured) == 1
    assert list(folder.glob("*.field"))

    contact(folder, modulus=5e9)  # another law is another pair
    assert len(measured) == 2
    assert len(records(folder)) == 2
    assert record in records(folder)


def test_the_record_says_what_was_measured(folder: Path, measured: list[FastError]) -> None:
    error = contact(folder).fast_error
    assert error is not None
    assert error.total is not None
    assert error.sides is not None
    assert 12 <= error.poses <= 24
    assert error.total.count == error.poses
    assert error.poses <= error.sides.count <= 2 * error.poses
    assert sum(row.total.count for row in error.by_load) == error.poses
    # A tube of 1.2 mm facets: the chord's sagitta is 7 µm, so the error is there, and small.
    assert 0.0 < error.total.force_median < error.total.force_p99 <= error.total.force_worst < 0.2
    assert error.total.force_of_tolerance_p99 <= error.total.force_of_tolerance_worst
    assert len(error.total.worst_pose) == 6
    assert f"{error.total.force_p99:.2%} of force" in error.sentence()
    assert FastError.from_json(json.loads(json.dumps(error.to_json()))) == error


def test_a_record_that_is_not_whole_is_measured_anew_and_replaced(
    folder: Path, measured: list[FastError]
) -> None:
    error = contact(folder).fast_error
    (record,) = records(folder)
    sound = record.read_text(encoding="utf-8")
    content = json.loads(sound)
    content["fast_error"]["total"]["force_p99"] *= 0.1  # flattering
    stale = json.loads(sound)
    stale["of"]["spacing"] = 1e-3
    for damaged in ("", sound[:-40], "[]", "{}", "\x00", json.dumps(content), json.dumps(stale)):
        record.write_text(damaged, encoding="utf-8")
        before = len(measured)
        assert contact(folder).fast_error == error
        assert len(measured) == before + 1
        assert record.read_text(encoding="utf-8") == sound
    record.unlink()
    record.mkdir()  # nothing can be put there
    assert contact(folder).fast_error == error


def test_without_a_folder_it_is_measured_when_asked_for(measured: list[FastError]) -> None:
    one = contact(None)
    assert measured == []
    assert one.fast_error is one.fast_error
    assert len(measured) == 1


def test_exact_has_no_error(tmp_path: Path) -> None:
    exact = MeshContact(femur(), *inserts(), "right", cache_directory=tmp_path)
    assert exact.fast_error is None
    assert list(tmp_path.iterdir()) == []


def test_where_there_is_no_seat_the_record_says_so(tmp_path: Path) -> None:
    high = Mesh(
        femur().vertices + np.array([0.0, 0.0, 0.4]), femur().faces
    )  # far beside the insert
    one = MeshContact(high, *inserts(), "right", evaluation="fast", cache_directory=tmp_path)
    error = one.fast_error
    assert error is not None
    assert error.status.startswith("not measured: no seated pose (")
    assert error.total is None
    assert error.sentence() == f"fast evaluation: error against exact {error.status}"
    again = MeshContact(high, *inserts(), "right", evaluation="fast", cache_directory=tmp_path)
    assert again.fast_error == error
