# SPDX-License-Identifier: Apache-2.0
"""A mesh contact in another process: made again from what it was made from."""

import pickle
from pathlib import Path

import numpy as np
import pytest
from small_implant import femur, inserts

from condyle.contact import Derivatives, FaceLayers, MeshContact, ThinLayerLinearLaw

POSES = np.array(
    [[0.0011, 0.01812, -0.0004, 0.0013, 0.021, -0.004], [-0.0007, 0.0181, 0.0003, -0.001, 0.0, 0.0]]
)


def made(**settings: object) -> MeshContact:
    return MeshContact(femur(), *inserts(), "right", **settings)


def test_a_contact_arrives_with_law_layers_and_settings_and_gives_the_same_bits() -> None:
    law = ThinLayerLinearLaw(youngs_modulus=437e6, poissons_ratio=0.43, thickness=0.0083)
    layers = FaceLayers(youngs_modulus=510e6, poissons_ratio=0.41, thickness=0.0071)
    contact = made(
        law=law, integration="both", plausible_depth=1.7e-3, insert_layers=(layers, layers),
        femur_layers=layers,
    )  # fmt: skip
    there = pickle.loads(pickle.dumps(contact))
    assert type(there) is MeshContact
    assert there.mesh_hashes() == contact.mesh_hashes()
    assert there.settings.plausible_depth == 1.7e-3
    assert there.settings.pair.integration == contact.settings.pair.integration
    assert there.law_parameters() == contact.law_parameters()
    here, again = (c.evaluate(POSES, Derivatives.stiffness, 1) for c in (contact, there))
    assert np.all(np.abs(here.wrench[:, :, 1]) > 1.0)
    assert np.array_equal(here.wrench, again.wrench)
    assert np.array_equal(here.stiffness, again.stiffness)
    # The layers did travel: without them the loads are others.
    bare = made(law=law, integration="both").evaluate(POSES, Derivatives.none, 1)
    assert not np.array_equal(bare.wrench, here.wrench)


def test_distance_fields_are_kept_where_this_machine_keeps_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("CONDYLE_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "own"))
    (tmp_path / "shared").mkdir()

    def kept_at(sent: bytes) -> Path:
        return Path(pickle.loads(sent).settings.pair.cache_directory)

    sent = pickle.dumps(made(cache_directory=tmp_path / "shared"))
    assert kept_at(sent) == tmp_path / "shared"
    (tmp_path / "shared").rename(tmp_path / "moved")
    assert kept_at(sent) == tmp_path / "own" / "condyle"
    nowhere = pickle.dumps(made())
    assert kept_at(nowhere) == Path()
    monkeypatch.setenv("CONDYLE_CACHE", str(tmp_path / "told"))
    assert kept_at(sent) == kept_at(nowhere) == tmp_path / "told"


def test_a_fast_contact_arrives_without_measuring_its_error_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from condyle.contact import mesh_contact

    monkeypatch.delenv("CONDYLE_CACHE", raising=False)
    with monkeypatch.context() as patch:
        patch.setattr(mesh_contact, "stored_fast_error", lambda *_: None)
        contact = made(evaluation="fast", cache_directory=tmp_path)
    monkeypatch.setattr(mesh_contact, "measure_fast_error", None)  # would raise
    there = pickle.loads(pickle.dumps(contact))
    assert [file.suffix for file in tmp_path.iterdir()] == [".field"]
    wrenches = [c.evaluate(POSES, Derivatives.none, 1).wrench for c in (contact, there)]
    assert np.array_equal(*wrenches)
    assert np.any(wrenches[0] != 0.0)
