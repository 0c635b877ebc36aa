# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from condyle.evaluation import (
    kinematics_error_table,
    sample_error_table,
    simulation_load_error_table,
)
from condyle.report import render_tables

pytest.importorskip("matplotlib")

from condyle.report.implant_figures import implant_figure
from condyle.report.sample_figures import domain_figure, parity_figure
from condyle.report.simulation_figures import Trace, kinematics_figure, loads_figure
from condyle.report.style import house_style, save

RNG = np.random.default_rng(8)
POSES = RNG.normal(0.0, 0.01, (60, 6))
WRENCHES = RNG.uniform(1.0, 900.0, (60, 2, 6))
DOMAINS = np.repeat([2, 4], 30)


def test_tables_show_every_row_and_round_for_reading():
    rows = sample_error_table(DOMAINS, WRENCHES, WRENCHES + 1234.5)
    text = render_tables(
        "knee",
        {
            "samples": {
                "domains": [
                    {
                        "domain": 2, "train": 8, "test": 2, "candidates": 20, "acceptance": 0.5,
                        "evaluations_per_accepted": 6.25,
                    }
                ]
            },
            "sample_errors": rows,
            "simulation_loads": simulation_load_error_table("gait", WRENCHES, WRENCHES + 0.25),
            "simulation_kinematics": kinematics_error_table("gait", POSES, POSES),
            "times": [{"what": "gait", "reference_s": 3.0, "surrogate_s": 0.5}],
        },
    )  # fmt: skip
    assert text.startswith("# knee\n")
    assert "| 2 | 8 | 2 | 20 | 50.0 % | 6.2 |" in text
    assert "| all | lateral | 1234 (1234) |" in text
    assert "| gait | medial_Fy | N | 0.25 | 0.25 |" in text
    assert "| gait | 3 | 0.5 | 6 |" in text


def test_a_run_without_results_has_a_title_only():
    assert render_tables("knee", {}) == "# knee\n"


def test_figures_are_drawn_and_the_same_data_give_the_same_bytes(tmp_path):
    time = np.linspace(0.0, 1.0, 60)
    traces = [Trace(label, time, WRENCHES, POSES) for label in ("reference", "surrogate")]
    rows = sample_error_table(DOMAINS, WRENCHES, WRENCHES + 1.0)
    vertices = np.array(
        [[0.0, 0.0, 0.0], [0.02, 0.001, 0.0], [0.0, 0.002, 0.03], [0.02, 0.0, 0.03]]
    )
    faces = np.array([[0, 2, 1], [1, 2, 3]], dtype=np.int32)
    drawings = {
        "loads": lambda: loads_figure("gait", traces),
        "kinematics": lambda: kinematics_figure("gait", traces),
        "samples": lambda: domain_figure(POSES, WRENCHES, DOMAINS, {"gait": (POSES, WRENCHES)}),
        "parity": lambda: parity_figure(WRENCHES, WRENCHES + 1.0, rows),
        "implant": lambda: implant_figure(
            (vertices, faces),
            [(vertices, faces)],
            [np.array([0.0, 2e6])],
            np.eye(3),
            np.zeros(3),
            "knee",
        ),
    }
    with house_style():
        for name, draw in drawings.items():
            first, second = (
                save(draw(), tmp_path / f"{name}_{i}.png").read_bytes() for i in (1, 2)
            )
            assert len(first) > 5000, name
            assert first == second, name
