# SPDX-License-Identifier: Apache-2.0
"""Where a study's reference curves come from, and what it says of the sensitive directions."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from condyle.activities import BUILT_IN
from condyle.errors import InputDataError
from condyle.sampling import write_csv
from condyle.sampling.evaluate import equilibrium_solver
from condyle.study import Study, StudyRun, read_study
from condyle.study.curve_sections import ConformityCurvesSection
from condyle.study.curves import CurvesFound, make_curves, sensitive_directions

SMALL = {
    "name": "small",
    "activities": ["leg_swing_like", "squat_like"],
    "implant": {"preset": "curved", "side_of_body": "left", "mesh_edge_mm": 2.5},
    "contact": {"evaluation": "exact"},
}
FLEXIONS = {"kind": "conformity", "max_flexion_deg": 30}


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Runs with the activities simulated."""
    runs = tmp_path_factory.mktemp("runs")
    context(runs).run("reference")
    return runs


def context(runs: Path, **sampling: object) -> StudyRun:
    return StudyRun(Study.model_validate(SMALL | {"sampling": sampling}), runs, threads=2)


def found(runs: Path, **sampling: object) -> CurvesFound:
    study = context(runs, **sampling).context
    return make_curves(study, equilibrium_solver(study.reference, max_depth=2e-3, threads=2))


def test_the_default_activities_are_all_built_in_ones(tmp_path: Path) -> None:
    (tmp_path / "knee.toml").write_text("")
    study = read_study(tmp_path / "knee.toml")
    assert study.activities == BUILT_IN
    assert study.sampling.curves.kind == "activities"
    assert study.sampling.sensitive_directions == "auto"


def test_a_table_stands_for_the_activities_that_it_was_written_from(reference: Path) -> None:
    simulated = found(reference)
    assert simulated.told == "reference curves from 2 simulated activities"
    assert simulated.curves.names == tuple(SMALL["activities"])
    file = reference / "mine.csv"
    write_csv(simulated.curves, file)
    table = {"kind": "table", "files": [str(file)]}
    read = found(reference, curves=table)
    assert read.told == "reference curves from mine.csv: leg_swing_like, squat_like"
    assert read.curves.content_hash() == simulated.curves.content_hash()


def test_tables_count_by_their_curves_and_not_by_their_place(reference: Path) -> None:
    def canonical(file: Path) -> dict[str, Any]:
        study = context(reference, curves={"kind": "table", "files": [str(file)]}).context.study
        return study.canonical("sampling")

    here, there = reference / "here.csv", reference / "there.csv"
    write_csv(found(reference).curves, here)
    there.write_bytes(here.read_bytes())
    assert canonical(here) == canonical(there)
    there.write_text(there.read_text().replace("leg_swing_like", "kick"))
    assert canonical(here) != canonical(there)


def test_conformity_needs_no_curves_and_tells_its_bounds(reference: Path) -> None:
    measured = found(reference, curves=FLEXIONS)
    assert measured.told.startswith("reference curves from the implant's conformity: 0 to 30 deg")
    assert measured.bounds is not None
    assert [round(row["flexion_deg"]) for row in measured.bounds] == [0, 15, 30]
    for row in measured.bounds:
        assert row["x_mm"][0] < 0 < row["x_mm"][1]
    assert measured.curves.names == ("conformity",)
    assert np.degrees(measured.curves.table(("theta_z",)).min()) == pytest.approx(-30.0)


def test_the_sensitive_directions_are_the_implants_or_the_studys(reference: Path) -> None:
    used, told, table = sensitive_directions(context(reference).context)
    assert used == ("y", "theta_x")
    assert told.startswith("sensitive directions under 1000 N: y (")
    assert table["used"] == table["found"] == ["y", "theta_x"]
    asked = context(reference, sensitive_directions=["y"]).context
    used, told, table = sensitive_directions(asked)
    assert used == ("y",)
    assert told == "sensitive directions y, as the study says"
    assert table == {"used": ["y"]}


def test_sections_are_in_si() -> None:
    section = ConformityCurvesSection(
        kind="conformity", travel_x_mm=3.1, travel_theta_y_deg=7.0, axial_force_BW=(0.2, 4.0)
    )
    settings = section.settings()
    assert settings.travel_x == pytest.approx(3.1e-3)
    assert settings.travel_theta_y == pytest.approx(np.radians(7.0))
    assert (settings.low_force, settings.high_force) == (0.2, 4.0)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("curves = {kind = 'guess'}", "sampling.curves.kind = 'guess': must be one of activities, table, conformity"),
        ("curves = {files = []}", "sampling.curves.kind: is missing: must be one of activities"),
        ("curves = {kind = 'table'}", "sampling.curves.files: is missing"),
        ("curves = {kind = 'table', files = []}", "sampling.curves.files = []: "),
        ("curves = {kind = 'table', files = ['a.sto']}", "a.sto: cannot be read as a table of reference curves"),
        (
            "curves = {kind = 'conformity', travel_mm = 3}",
            "sampling.curves.travel_mm: unknown key (value 3); known: ap_shear_BW, axial_force_BW",
        ),
        (
            "curves = {kind = 'conformity', travel_x_mm = 0.01}",
            "sampling.curves.travel_x_mm = 0.01: input should be greater than or equal to 0.1",
        ),
        (
            "curves = {kind = 'conformity', axial_force_BW = [0.1, 2.0]}",
            "sampling.curves: conformity: high_force is 2.0; it must be 2.3 to 10",
        ),
        (
            "sensitive_directions = ['x']",
            "sampling.sensitive_directions: ['x']: must be \"auto\", [\"y\", \"theta_x\"] or [\"y\"]",
        ),
        ("sensitive_directions = 'y'", "sampling.sensitive_directions: 'y': must be \"auto\""),
    ],
)  # fmt: skip
def test_mistakes_are_named(tmp_path: Path, text: str, said: str) -> None:
    file = tmp_path / "knee.toml"
    file.write_text(f"[sampling]\n{text}\n")
    with pytest.raises(InputDataError) as caught:
        read_study(file)
    message = str(caught.value)
    assert message.startswith(f"{file}: ")
    assert said in message
    assert "\n" not in message


def test_tables_are_found_beside_the_study(tmp_path: Path) -> None:
    rows = "\n".join(f"{t},0.003,0.031,0.001,0.01,0.02,-0.5,{800 + t},3.2" for t in (0.0, 0.5, 1.0))
    (tmp_path / "stairs.csv").write_text(f"time,x,y,z,theta_x,theta_y,theta_z,Fy,Mx\n{rows}\n")
    file = tmp_path / "knee.toml"
    file.write_text("[sampling]\ncurves = {kind = 'table', files = ['stairs.csv']}\n")
    assert read_study(file).sampling.curves.files == (tmp_path / "stairs.csv",)
