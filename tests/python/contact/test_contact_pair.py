# SPDX-License-Identifier: Apache-2.0
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from small_implant import femur as coarse_femur
from small_implant import inserts
from typer.testing import CliRunner

from condyle.cli.app import app
from condyle.contact import (
    ContactPair,
    Derivatives,
    FaceLayers,
    LinearVolumeLaw,
    Mesh,
    MeshContact,
    ThinLayerLinearLaw,
    ThinLayerLogarithmicLaw,
    read_mesh,
    refine_mesh,
    write_mesh,
)
from condyle.errors import InputDataError


@cache
def femur() -> Mesh:
    return refine_mesh(coarse_femur(), 6e-3)


POSE = np.array([[0.001, 0.0175, 0.0005, 0.01, -0.02, 0.015]])
LOGARITHMIC = ThinLayerLogarithmicLaw(youngs_modulus=463e6, poissons_ratio=0.46, thickness=0.01)


def pair(**options: object) -> ContactPair:
    medial, lateral = inserts()
    return ContactPair(femur(), {"medial": medial, "lateral": lateral}, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("of_pair", "of_knee"), [("fixed", "insert"), ("moving", "femur"), ("both", "both")]
)
def test_a_knee_is_a_pair(of_pair: str, of_knee: str) -> None:
    loads = pair(integration=of_pair).evaluate(POSE, stiffness=True)
    knee = MeshContact(femur(), *inserts(), "right", integration=of_knee)  # type: ignore[arg-type]
    expected = knee.evaluate(POSE, Derivatives.stiffness, 1)
    np.testing.assert_array_equal(loads.wrench, expected.wrench)
    np.testing.assert_array_equal(loads.stiffness, expected.stiffness)
    detail = knee.evaluate_details(POSE, 1)
    for name in ("energy", "volume", "area", "border_area", "max_depth", "peak_pressure"):
        np.testing.assert_array_equal(getattr(loads, name), getattr(detail, name), err_msg=name)
    np.testing.assert_array_equal(loads.centre_of_pressure, detail.centre_of_pressure)
    assert loads.wrench[0, 0, 1] > 100.0


def test_both_is_the_mean_of_the_two() -> None:
    fixed, moving, both = (
        pair(integration=name).evaluate(POSE, stiffness=True)
        for name in ("fixed", "moving", "both")
    )
    assert fixed.stiffness is not None and moving.stiffness is not None
    np.testing.assert_allclose(both.wrench, 0.5 * (fixed.wrench + moving.wrench), rtol=1e-14)
    np.testing.assert_allclose(both.stiffness, 0.5 * (fixed.stiffness + moving.stiffness))
    assert abs(fixed.wrench[0, 0, 1] - moving.wrench[0, 0, 1]) > 1.0


def test_the_result_does_not_depend_on_threads() -> None:
    poses = np.repeat(POSE, 9, axis=0)
    poses[:, 1] -= np.linspace(0.0, 1e-3, 9)
    contact = pair(integration="both")
    one, three = (contact.evaluate(poses, stiffness=True, threads=n) for n in (1, 3))
    assert one.wrench.tobytes() == three.wrench.tobytes()
    assert one.stiffness is not None and three.stiffness is not None
    assert one.stiffness.tobytes() == three.stiffness.tobytes()


def test_layers_equal_to_the_laws_own_change_nothing() -> None:
    medial, lateral = inserts()
    same = FaceLayers(youngs_modulus=463e6, poissons_ratio=0.46, thickness=0.01)
    layered = pair(law=LOGARITHMIC, fixed_layers={"medial": same, "lateral": same})
    expected = pair(law=LOGARITHMIC).evaluate(POSE)
    np.testing.assert_allclose(layered.evaluate(POSE).wrench, expected.wrench, rtol=1e-14)
    knee = MeshContact(
        femur(), medial, lateral, "right", law=LOGARITHMIC, insert_layers=(same, same)
    )
    got = knee.evaluate(POSE, Derivatives.none, 1).wrench
    np.testing.assert_allclose(got, expected.wrench, rtol=1e-14)


@pytest.mark.parametrize("evaluation", ["exact", "fast"])
def test_a_layer_twice_as_thick_where_it_is_so_is_half_as_hard(evaluation: str) -> None:
    law = ThinLayerLinearLaw(youngs_modulus=463e6, poissons_ratio=0.46, thickness=0.01)
    medial, _ = inserts()
    thickness = np.full(len(medial.faces), 0.02)
    thick = FaceLayers(youngs_modulus=463e6, poissons_ratio=0.46, thickness=thickness)
    mixed = pair(law=law, evaluation=evaluation, fixed_layers={"medial": thick}).evaluate(POSE)
    whole = pair(law=law, evaluation=evaluation).evaluate(POSE)
    np.testing.assert_allclose(mixed.wrench[0, 0], 0.5 * whole.wrench[0, 0], rtol=1e-12)
    # Not a linear law's own path any more: the same to rounding.
    np.testing.assert_allclose(mixed.wrench[0, 1], whole.wrench[0, 1], rtol=1e-12)
    peaks = mixed.peak_pressure[0] / whole.peak_pressure[0]
    np.testing.assert_allclose(peaks, [0.5, 1.0], rtol=1e-12)


def test_layers_follow_their_faces_through_the_fast_order() -> None:
    medial, _ = inserts()
    rng = np.random.default_rng(8)
    layers = FaceLayers(
        youngs_modulus=463e6,
        poissons_ratio=0.46,
        thickness=rng.uniform(0.005, 0.02, len(medial.faces)),
    )
    exact, fast = (
        pair(law=LOGARITHMIC, evaluation=name, fixed_layers={"medial": layers}).evaluate(POSE)
        for name in ("exact", "fast")
    )
    # A box is flat: the field is as good as the triangles but for single precision.
    np.testing.assert_allclose(fast.wrench[0, 0, 1], exact.wrench[0, 0, 1], rtol=1e-5)


def test_mistakes_are_named() -> None:
    medial, lateral = inserts()
    one = FaceLayers(youngs_modulus=1e6, poissons_ratio=0.4, thickness=0.01)
    with pytest.raises(InputDataError, match=r"fixed_layers names 'button': must be one of"):
        pair(law=LOGARITHMIC, fixed_layers={"button": one})
    with pytest.raises(ValueError, match="the law linear_volume has no elastic layer"):
        pair(law=LinearVolumeLaw(), fixed_layers={"medial": one})
    short = FaceLayers(youngs_modulus=1e6, poissons_ratio=0.4, thickness=[0.01, 0.01])
    with pytest.raises(InputDataError, match=r"thickness of shape \(2,\): must be a number, or"):
        pair(law=LOGARITHMIC, fixed_layers={"medial": short})
    bad = np.full(len(medial.faces), 0.01)
    bad[3] = -0.01
    with pytest.raises(InputDataError, match=r"face 3: .*thickness"):
        pair(
            law=LOGARITHMIC,
            fixed_layers={
                "medial": FaceLayers(youngs_modulus=1e6, poissons_ratio=0.4, thickness=bad)
            },
        )
    with pytest.raises(ValueError, match="integration is 'tibia'"):
        pair(integration="tibia")
    with pytest.raises(ValueError, match="no compartment"):
        ContactPair(femur(), {})
    with pytest.raises(InputDataError, match=r"poses of shape \(6,\): must be \(n, 6\)"):
        pair().evaluate(POSE[0])
    with pytest.raises(ValueError, match="theta_x"):
        pair().evaluate(np.array([[0.0, 0.0, 0.0, np.nan, 0.0, 0.0]]))
    with pytest.raises(InputDataError, match="compartment 'button': must be one of"):
        pair().face_pressure(POSE[0], "button")
    holed = medial.vertices.copy()
    holed[0, 0] = np.nan
    with pytest.raises(ValueError, match=r"finite|nan"):
        ContactPair(femur(), {"lateral": lateral, "holed": Mesh(holed, medial.faces)})


@pytest.mark.parametrize(("implant", "x", "z"), [("dm", 38.037, 3.25), ("jw", 42.968, 7.25)])
def test_a_patellar_button_touches_the_trochlea_where_it_should(
    data: Path, implant: str, x: float, z: float
) -> None:
    folder = data / "implants" / implant
    trochlea = read_mesh(folder / "femur_contact.stl", "m")
    button = read_mesh(folder / "patella_contact.stl", "m")
    patella = ContactPair(button, {"trochlea": trochlea})
    poses = np.zeros((3, 6))
    poses[:, 0] = 1e-3 * (x + np.array([0.02, -0.02, -0.5]))
    poses[:, 1:3] = 5e-3, 1e-3 * z
    loads = patella.evaluate(poses)
    # The published touch is of the triangles; ours of the centroids of 0.5 mm faces.
    assert loads.max_depth[0, 0] == 0.0
    assert 5e-6 < loads.max_depth[1, 0] < 3e-5
    # Pushed forward, off the trochlea; as far as the rigid bodies overlap.
    assert loads.wrench[2, 0, 0] > 300.0
    assert 0.45e-3 < loads.max_depth[2, 0] < 0.5e-3
    assert loads.border_area[2, 0] == 0.0
    pressure = patella.face_pressure(poses[2], "trochlea")
    assert pressure.max() == loads.peak_pressure[2, 0]
    assert len(pressure) == len(trochlea.faces)


def test_the_command_writes_a_table(tmp_path: Path) -> None:
    medial, lateral = inserts()
    for name, mesh in (("femur", femur()), ("inner", medial), ("outer", lateral)):
        write_mesh(tmp_path / f"{name}.stl", mesh)
    names = ["x", "y", "z", "theta_x", "theta_y", "theta_z"]
    pd.DataFrame(POSE, columns=names).to_csv(tmp_path / "poses.csv", index=False)
    arguments = ["contact", "pair", "--moving", str(tmp_path / "femur.stl"), "--units", "m"]
    for name in ("inner", "outer"):
        arguments += ["--fixed", str(tmp_path / f"{name}.stl")]
    arguments += ["--poses", str(tmp_path / "poses.csv"), "--out", str(tmp_path / "loads.csv")]
    result = CliRunner().invoke(app, [*arguments, "--integration", "both"])
    assert result.exit_code == 0, result.output
    table = pd.read_csv(tmp_path / "loads.csv")
    expected = pair(integration="both").evaluate(POSE)
    np.testing.assert_allclose(table["inner_Fy"], expected.wrench[:, 0, 1], rtol=1e-5)  # STL: float
    np.testing.assert_allclose(table["outer_Mx"], expected.wrench[:, 1, 3], rtol=1e-5)
    np.testing.assert_allclose(table["outer_max_depth"], expected.max_depth[:, 1], rtol=1e-4)


def test_faces_far_from_an_open_border_are_no_overlap(data: Path) -> None:
    folder = data / "implants" / "dm"
    meshes = {
        name: read_mesh(folder / f"{name}_contact{side}.stl", "m")
        for name, side in (("femur", ""), ("insert", "_medial"))
    }
    pose = [[7.63e-3, 44.627e-3, -0.769e-3, -0.00139, 0.04887, -0.69811]]
    knee = ContactPair(meshes["femur"], {"medial": meshes["insert"]}, integration="moving")
    # The femur leaves the insert over its edge there, by some mm²; 2 200 mm² of it, centimetres from
    # the open border, lie on the inner side of the border's continuation and mean nothing.
    assert 1e-6 < knee.evaluate(pose).border_area[0, 0] < 1e-4
