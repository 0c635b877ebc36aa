# SPDX-License-Identifier: Apache-2.0
"""A design is either plausible as a whole or refused with field, value and limit."""

import math
from dataclasses import fields, replace

import pytest

from condyle.errors import InputDataError
from condyle.implants import ImplantParameters, generate, preset


def test_size_scales_every_length_and_no_angle_or_ratio() -> None:
    small, large = preset("curved", size=0.83), preset("curved", size=1.21)
    kept = {"mesh_edge_length", "coronal_conformity", "posterior_slope"}
    for item in fields(ImplantParameters):
        a, b = getattr(small, item.name), getattr(large, item.name)
        if isinstance(a, str) or item.name in kept or item.name.endswith("_angle"):
            assert a == b, item.name
        else:
            assert b / a == pytest.approx(1.21 / 0.83, rel=1e-14), item.name


def test_the_flat_preset_is_flat_between_18_and_32_mm() -> None:
    p = preset("flat")
    assert p.condyle_centre - p.flat_half_width == pytest.approx(18e-3, abs=1e-15)
    assert p.condyle_centre + p.flat_half_width == pytest.approx(32e-3, abs=1e-15)


@pytest.mark.parametrize("name", ["flat", "curved"])
@pytest.mark.parametrize("size", [0.75, 1.35])
def test_presets_generate_at_both_ends_of_the_size_range(name: str, size: float) -> None:
    p = replace(preset(name, size=size), mesh_edge_length=2e-3)  # type: ignore[arg-type]
    assert len(generate(p).femur.faces) > 500


MISTAKES = [
    (
        "flat",
        {"femoral_distal_radius": 0.5},
        "femoral_distal_radius = 0.5 m: must lie in [0.02, 0.08] m",
    ),
    ("flat", {"femoral_ap": math.nan}, "femoral_ap = nan m: must lie in [0.04, 0.095] m"),
    ("flat", {"femoral_ml": "72"}, "femoral_ml = '72': must be a number"),
    ("flat", {"insert_ml": True}, "insert_ml = True: must be a number"),
    (
        "flat",
        {"notch_angle": -22.0},
        "notch_angle = -22 rad: must lie in [-0.523599, -0.174533] rad",
    ),
    (
        "flat",
        {"side_of_body": "middle"},
        "side_of_body = 'middle': must be one of ('left', 'right')",
    ),
    (
        "flat",
        {"coronal_profile": "round"},
        "coronal_profile = 'round': must be one of ('flat', 'curved')",
    ),
    (
        "flat",
        {"insert_sagittal_radius": 0.036},
        "insert_sagittal_radius = 0.036 m: must be greater than the largest femoral radius = 0.038",
    ),
    (
        "curved",
        {"coronal_conformity": 1.0},
        "femoral_coronal_radius) = 0.025 m: must be greater than femoral_coronal_radius = 0.025 m",
    ),
    (
        "flat",
        {"eminence_flank_radius": 0.013},
        "eminence_flank_radius = 0.013 m: must be greater than femoral_flank_radius = 0.014 m",
    ),
    (
        "flat",
        {"mid_start_angle": 0.05},
        "mid_start_angle = 0.05 rad: must not be less than distal_end_angle = 0.0872665 rad",
    ),
    (
        "flat",
        {"flange_width": 0.08},
        "femoral_ml = 0.072 m: must be greater than flange_width = 0.08 m",
    ),
    ("flat", {"femoral_ap": 0.09}, "femoral_ap = 0.09 m: needs an anterior radius of 0.1"),
    (
        "flat",
        {"posterior_condyle_height": 0.025},
        "posterior_condyle_height = 0.025 m: must lie in [0.03",
    ),
    (
        "flat",
        {"distal_point_height": 0.033, "flange_height": 0.0055},
        "flange_height = 0.0055 m: must be at least 0.0069",
    ),
    ("flat", {"anterior_lip_height": 0.012}, "anterior_lip_height = 0.012 m: must lie in [0.004"),
    ("flat", {"eminence_height": 0.009}, "eminence_height = 0.009 m: must not exceed 0.0073"),
    ("curved", {"femoral_edge_radius": 0.0069}, "side_depth = 0.007 m: must be greater than 0.0"),
    ("curved", {"groove_depth": 0.002}, "groove_depth = 0.002 m: must be greater than 0.0"),
    ("curved", {"femoral_coronal_radius": 0.0121}, "sine 0.9877, which must lie in [0, 0.95]"),
]


@pytest.mark.parametrize(("name", "changes", "message"), MISTAKES)
def test_a_mistake_names_field_value_and_limit(name: str, changes: dict, message: str) -> None:
    with pytest.raises(InputDataError) as caught:
        generate(replace(preset(name), **changes))  # type: ignore[arg-type]
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"name": "round"}, "preset = 'round': must be one of ('flat', 'curved')"),
        ({"name": "flat", "size": 2.0}, "preset size = 2.0: must lie in [0.75, 1.35]"),
        ({"name": "flat", "size": math.nan}, "preset size = nan: must lie in [0.75, 1.35]"),
    ],
)
def test_an_impossible_preset_is_refused(arguments: dict, message: str) -> None:
    with pytest.raises(InputDataError) as caught:
        preset(**arguments)
    assert message in str(caught.value)
