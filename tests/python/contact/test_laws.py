# SPDX-License-Identifier: Apache-2.0
import dataclasses
import pickle

import numpy as np
import pytest
from small_implant import femur, inserts

from condyle.contact import (
    ContactLaw,
    LinearVolumeLaw,
    MeshContact,
    PowerLaw,
    TableLaw,
    ThinLayerLinearLaw,
    ThinLayerLogarithmicLaw,
    pressure_modulus,
    youngs_modulus,
)
from condyle.errors import InputDataError

LAYER = {"youngs_modulus": 463e6, "poissons_ratio": 0.46, "thickness": 7.3e-3}
M = 463e6 * 0.54 / (1.46 * 0.08)  # (1 - ν)E/((1 + ν)(1 - 2ν))
POINTS = ([0.0, 1.3e-4, 1.1e-3], [0.0, 0.9e6, 23.0e6])
DEPTHS = np.array([[2.9e-5, 1.1e-4], [4.7e-4, 0.9e-3]])

#: Law, its name, its pressure in closed form.
LAWS = [
    (LinearVolumeLaw(modulus=4.7e9), "linear_volume", lambda d: 4.7e9 * d),
    (ThinLayerLinearLaw(**LAYER), "thin_layer_linear", lambda d: M * d / 7.3e-3),
    (
        ThinLayerLogarithmicLaw(**LAYER),
        "thin_layer_logarithmic",
        lambda d: -M * np.log(1 - d / 7.3e-3),
    ),
    (PowerLaw(coefficient=2.3e13, exponent=2.35), "power", lambda d: 2.3e13 * d**2.35),
    (TableLaw(depth=POINTS[0], pressure=POINTS[1]), "table", lambda d: np.interp(d, *POINTS)),
]
each_law = pytest.mark.parametrize(("law", "name", "formula"), LAWS, ids=[n for _, n, _ in LAWS])


@each_law
def test_the_pressure_is_the_laws_formula(law, name, formula):
    assert law.name == name
    pressure = law.pressure_at(DEPTHS)
    assert pressure.shape == DEPTHS.shape
    # log(1 - s) of a rounded 1 - s: eps/s of the value, s down to 4e-3.
    np.testing.assert_allclose(pressure, formula(DEPTHS), rtol=1e-13)
    assert law.pressure_at(3e-4) == law.pressure_at([3e-4])[0]


@each_law
def test_the_pressure_and_its_rate_are_the_derivatives_of_the_energy(law, name, formula):
    # Central differences over ±1e-5 d: error 1e-10 of the value; rounding of W eps/1e-5 times 70.
    step = 1e-5 * DEPTHS
    slope = (law.energy_at(DEPTHS + step) - law.energy_at(DEPTHS - step)) / (2 * step)
    np.testing.assert_allclose(law.pressure_at(DEPTHS), slope, rtol=3e-9)
    slope = (law.pressure_at(DEPTHS + step) - law.pressure_at(DEPTHS - step)) / (2 * step)
    np.testing.assert_allclose(law.pressure_rate_at(DEPTHS), slope, rtol=3e-9)


@each_law
def test_there_is_nothing_without_penetration(law, name, formula):
    for values in (law.energy_at, law.pressure_at, law.pressure_rate_at):
        np.testing.assert_array_equal(values([0.0, -1e-3]), 0.0)


@each_law
def test_a_law_is_a_value(law, name, formula):
    copy = pickle.loads(pickle.dumps(law))
    assert copy == law
    assert hash(copy) == hash(law)
    assert copy.describe() == law.describe()
    with pytest.raises(dataclasses.FrozenInstanceError):
        setattr(law, dataclasses.fields(law)[0].name, 1.0)


def test_a_law_tells_every_parameter_with_its_unit():
    layer = {"youngs_modulus_Pa": 463e6, "poissons_ratio": 0.46, "thickness_m": 7.3e-3}
    assert [law.describe() for law, _, _ in LAWS] == [
        {"name": "linear_volume", "modulus_N_per_m3": 4.7e9},
        {"name": "thin_layer_linear", **layer},
        {"name": "thin_layer_logarithmic", **layer},
        {"name": "power", "coefficient_Pa_per_m^n": 2.3e13, "exponent": 2.35},
        {
            "name": "table",
            "depth_0_m": 0.0,
            "pressure_0_Pa": 0.0,
            "depth_1_m": 1.3e-4,
            "pressure_1_Pa": 0.9e6,
            "depth_2_m": 1.1e-3,
            "pressure_2_Pa": 23.0e6,
        },
    ]
    assert LinearVolumeLaw().parameters == {"modulus_N_per_m3": 9.3e9}
    assert [law.core.has_layer for law, _, _ in LAWS] == [False, True, True, False, False]


@each_law
def test_a_plane_pressed_into_a_plane_carries_the_laws_pressure(law, name, formula):
    contact = MeshContact(femur(), *inserts(), "right", law=law)
    depth, touch, area = 0.7e-3, 0.0073 + 0.011, 0.012**2
    pose = np.array([[0.001, touch - depth, 0.0005, 0.0, 0.0, 0.0]])
    detail = contact.evaluate_details(pose, 1)
    # The depth comes out of coordinates of 0.02: 1e-17 in 7e-4, and the exponent is 2.35.
    np.testing.assert_allclose(detail.peak_pressure[0], formula(depth), rtol=1e-12)
    np.testing.assert_allclose(detail.wrench[0, :, 1], formula(depth) * area, rtol=1e-12)
    np.testing.assert_allclose(detail.energy[0], law.energy_at(depth) * area, rtol=1e-12)
    assert contact.law_name() == name
    assert dict(contact.law_parameters()) == law.parameters


def test_modulus_and_layer_convert_into_each_other():
    modulus = pressure_modulus(**LAYER)
    assert modulus == pytest.approx(M / 7.3e-3, rel=1e-14)
    back = youngs_modulus(modulus=modulus, poissons_ratio=0.46, thickness=7.3e-3)
    assert back == pytest.approx(463e6, rel=1e-14)
    np.testing.assert_allclose(
        ThinLayerLinearLaw(**LAYER).pressure_at(DEPTHS),
        LinearVolumeLaw(modulus=modulus).pressure_at(DEPTHS),
        rtol=1e-15,
    )


def test_the_usual_modulus_is_softer_than_polyethylene_as_the_documentation_says():
    soft = [
        youngs_modulus(modulus=LinearVolumeLaw().modulus, poissons_ratio=0.46, thickness=h)
        for h in (5e-3, 10e-3)
    ]
    # Quoted to two digits.
    assert soft == pytest.approx([10e6, 20e6], rel=0.01)


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (
            lambda: LinearVolumeLaw(modulus=-1.5),
            r"contact law linear_volume: modulus is -1.5 N/m\^3: must be finite and greater than 0",
        ),
        (
            lambda: ThinLayerLinearLaw(**LAYER | {"youngs_modulus": 0.0}),
            "contact law thin_layer_linear: youngs_modulus is 0 Pa: must be finite and greater",
        ),
        (
            lambda: ThinLayerLogarithmicLaw(**LAYER | {"poissons_ratio": 0.5}),
            "contact law thin_layer_logarithmic: poissons_ratio is 0.5: must be between -1 and 0.5",
        ),
        (
            lambda: PowerLaw(coefficient=2.3e13, exponent=0.97),
            "contact law power: exponent is 0.97: must be finite and at least 1; below 1 the",
        ),
        (
            lambda: TableLaw(depth=(0.0, 1e-3), pressure=(0.0, -1e6)),
            r"contact law table: pressure 1 is -1e\+06 Pa: must be at least the one before, 0 Pa",
        ),
        (
            lambda: TableLaw(depth=((0.0, 1e-3),), pressure=(0.0, 1e6)),
            r"contact law table: depth has shape \(1, 2\): must be \(n,\)",
        ),
        (
            lambda: pressure_modulus(**LAYER | {"thickness": -7e-3}),
            "thickness is -0.007 m: must be finite and greater than 0",
        ),
        (
            lambda: youngs_modulus(modulus=np.nan, poissons_ratio=0.46, thickness=7e-3),
            r"modulus is nan N/m\^3: must be finite and greater than 0",
        ),
    ],
)
def test_what_is_out_of_range_is_refused(make, text):
    with pytest.raises(InputDataError, match=text):
        make()


def test_any_law_is_a_contact_law():
    assert all(isinstance(law, ContactLaw) for law, _, _ in LAWS)
