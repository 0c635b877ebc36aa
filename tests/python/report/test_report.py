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
from condyle.report.sample_figures import parity_figure
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
                        "domain": 2, "name": "global", "train": 8, "test": 2, "paper_train": 27_253,
                        "paper_test": 3_416, "candidates": 20, "accepted": 10, "acceptance": 0.5,
                        "rejected": {"no_equilibrium": 9, "overclosure": 1}, "two_sided": 7,
                        "evaluations_per_accepted": 6.25,
                    }
                ],
                "train": 8,
                "test": 2,
            },
            "sample_errors": rows,
            "simulation_loads": simulation_load_error_table("gait", WRENCHES, WRENCHES + 0.25),
            "simulation_kinematics": kinematics_error_table("gait", POSES, POSES),
            "times": [{"what": "gait", "reference_s": 3.0, "surrogate_s": 0.5}],
        },
    )  # fmt: skip
    assert text.startswith("# knee\n")
    row = "| 2 global | 8 | 2 | 27253 | 3416 | 20 | 10 (50.0 %) | 9 no_equilibrium, 1 overclosure |"
    assert row + " 70.0 % | 6.2 |" in text
    assert "| sum | 8 | 2 | 27253 | 3416 |" in text
    assert "| all | lateral | here | 1234 (1234) |" in text
    assert "| gait | medial | surrogate | 0.25 (0.25) | 0.25 (0.25) |" in text
    assert "| gait | surrogate | 3 | 0.5 | 6 |" in text


def test_times_say_how_many_evaluations_were_the_references():
    row = {
        "what": "gait", "contact": "hybrid", "reference_s": 3.0, "surrogate_s": 1.5,
        "evaluations": 340, "reference_evaluations": 12,
    }  # fmt: skip
    text = render_tables("knee", {"times": [row]})
    assert "| gait | hybrid | 3 | 1.5 | 2 | 340 | 12 |" in text


def test_the_error_of_the_fast_contact_is_told_by_load():
    wrench = {
        "count": 31, "force_median": 1e-4, "force_p99": 0.0042, "force_worst": 0.006,
        "force_of_tolerance_p99": 0.87, "force_of_tolerance_worst": 1.6,
        "moment_median": 2e-4, "moment_p99": 0.0053, "moment_worst": 0.007,
        "moment_of_tolerance_p99": 0.91, "moment_of_tolerance_worst": 1.2, "worst_pose": [0.0] * 6,
    }  # fmt: skip
    row = {"from_force": 60.0, "to_force": 200.0, "sides": wrench, "total": wrench}
    error = {
        "status": "measured", "spacing": 3e-4, "poses": 31, "sides": wrench, "total": wrench,
        "by_load": [row],
    }  # fmt: skip
    text = render_tables("knee", {"fast_error": error})
    assert "31 plausible poses; field of 0.30 mm" in text
    assert "| 60–200 N | 31 | 0.42% | 0.53% | 0.87 | 0.91 |" in text
    assert "| all | 31 | 0.42% |" in text
    unknown = {**error, "status": "not measured: no seated pose", "total": None}
    assert "Error not measured: no seated pose." in render_tables("knee", {"fast_error": unknown})


def test_samples_from_elsewhere_are_told_with_their_source():
    provenance = {
        "source": "rollers", "file": "knee.csv", "sha256": "0123456789abcdef", "split": {"by": "keyed hash"},
        "units": {"length": "mm", "angle": "deg", "force": "kN", "moment": "Nmm"},
    }  # fmt: skip
    domains = [{"domain": 0, "train": 80, "test": 14}, {"domain": 4, "train": 5, "test": 1}]
    text = render_tables(
        "knee", {"external_samples": {"provenance": provenance, "domains": domains}}
    )
    assert "rollers (knee.csv, in mm, deg, kN, Nmm, SHA-256 0123456789ab…; split by" in text
    assert "| none | 80 | 14 |\n| 4 | 5 | 1 |" in text
    assert "rollers" not in render_tables(
        "knee", {"external_samples": {"provenance": None, "domains": domains}}
    )


def test_figures_are_shown_by_their_paths():
    text = render_tables("knee", {}, ["figures/parity.png"])
    assert text.endswith("## Figures\n\n![parity](figures/parity.png)\n")


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
