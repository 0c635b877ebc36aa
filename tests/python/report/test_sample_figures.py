# SPDX-License-Identifier: Apache-2.0
import dataclasses
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("matplotlib")
sys.path.insert(0, str(Path(__file__).parents[1] / "sampling"))

from external_knee import external_table
from spring_contact import SpringSolver, spring_curves

from condyle.report.sample_coverage import BINS, coverage_figure, coverage_table
from condyle.report.sample_figures import write_sample_figures
from condyle.report.sample_pairs import EDGE_VARIABLES, LOADED_VARIABLES, pair_figure
from condyle.report.sample_rejections import rejection_figure
from condyle.report.sample_space import SampleSpace, convex_hull, spread
from condyle.report.style import save
from condyle.sampling import DomainTarget, SamplingPlan, TableUnits, import_samples, sample

NAMES = ["samples_loaded", "samples_edge", "samples_coverage", "samples_rejections"]


@pytest.fixture(scope="module")
def directory(tmp_path_factory) -> Path:
    """All six domains of the springs."""
    folder = tmp_path_factory.mktemp("six")
    targets = tuple(DomainTarget(d, 80, 0 if d == 1 else 10) for d in range(1, 7))
    plan = SamplingPlan(targets, seed=9, pilot=32, chunk_rows=100, envelope_points=5)
    sample(plan, spring_curves(), SpringSolver(), folder, {"side_of_body": "right"})
    return folder


@pytest.fixture(scope="module")
def space(directory) -> SampleSpace:
    return SampleSpace.read(directory, spring_curves())


@pytest.fixture(scope="module")
def imported(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("imported")
    external_table(400).to_parquet(folder / "knee.parquet")
    units = TableUnits("mm", "deg", "N", "Nmm")
    import_samples(
        folder / "knee.parquet", folder / "data", source="rollers", side_of_body="right", units=units
    )  # fmt: skip
    return folder / "data"


def test_all_figures_of_six_domains_are_written(directory, tmp_path):
    made = write_sample_figures(directory, tmp_path, spring_curves())
    assert [file.stem for file in made] == NAMES
    assert all(file.stat().st_size > 20_000 for file in made)


def test_the_same_dataset_gives_the_same_bytes(directory, space, tmp_path):
    again = SampleSpace.read(directory, spring_curves())
    for name, draw in (
        ("pairs", lambda s: pair_figure(s, [1, 6], ("x", "y", "Fy"), most_points=50)),
        ("rejections", rejection_figure),
    ):
        files = [
            save(draw(s), tmp_path / f"{name}_{i}.png", 50) for i, s in enumerate((space, again))
        ]
        assert files[0].read_bytes() == files[1].read_bytes(), name


def test_samples_from_elsewhere_have_no_edge_and_no_rejections(imported, tmp_path):
    (tmp_path / "samples_edge.png").write_bytes(b"of an earlier dataset")
    made = write_sample_figures(imported, tmp_path)
    assert [file.stem for file in made] == ["samples_loaded", "samples_coverage"]
    assert not (tmp_path / "samples_edge.png").exists()


def test_variables_are_shown_in_readable_units(imported):
    table = external_table(400)
    columns = SampleSpace.read(imported).columns
    # To SI and back: a few roundings.
    assert np.allclose(columns["y"], table["y"], rtol=1e-14)
    assert np.allclose(columns["theta_z"], table["theta_z"], rtol=1e-14)
    assert np.allclose(columns["Fy"], table["medial_Fy"] + table["lateral_Fy"], rtol=1e-14)
    # A sum of two moments that may cancel: the roundings are the larger one's.
    assert np.allclose(columns["Mx"], (table["medial_Mx"] + table["lateral_Mx"]) / 1e3, atol=1e-11)


def test_all_panels_of_the_lower_triangle_and_all_domains_are_there(space):
    figure = pair_figure(space, [2, 1], LOADED_VARIABLES)
    n = len(LOADED_VARIABLES)
    assert sum(axis.get_visible() for axis in figure.axes) == n * (n + 1) // 2
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[:2] == ["2 global: 90 samples", "1 time-varying envelopes: 80 samples"]
    assert f"reference curves: {', '.join(spring_curves().names)}" in labels


def test_a_far_domain_leaves_the_near_ones_most_of_the_height(space):
    figure = pair_figure(space, [5, 3, 4, 6], EDGE_VARIABLES)
    n = len(EDGE_VARIABLES)
    axis = figure.axes[n]  # row y, column x
    near = space.columns["y"][np.isin(space.domain, (3, 4, 5))]
    far = space.columns["y"][space.domain == 6]
    to_axis = axis.transData + axis.transAxes.inverted()
    bottom, top, end = (to_axis.transform((0, y))[1] for y in (near.min(), near.max(), far.max()))
    assert far.max() - far.min() > 3 * (near.max() - near.min())
    assert 0.5 < top - bottom < 0.8
    assert 0 < bottom < top < end < 1


def test_the_shown_are_spread_and_do_not_depend_on_the_order():
    ids = np.arange(5000, dtype=np.uint64)
    shown = spread(ids, 400)
    assert len(set(shown.tolist())) == 400
    # Uniform ids: the mean of n of them lies within 4 standard errors of the middle.
    assert abs(shown.mean() - 2500) < 4 * 5000 / np.sqrt(12 * 400)
    assert np.array_equal(ids[::-1][spread(ids[::-1], 400)], ids[shown])
    assert len(spread(ids[:30], 400)) == 30


def test_the_hull_holds_all_points_and_has_their_corners():
    rng = np.random.default_rng(5)
    points = rng.normal(size=(300, 2)) @ np.array([[2.0, 0.3], [-0.7, 1.1]])
    hull = convex_hull(points)
    edges = np.roll(hull, -1, axis=0) - hull
    offset = points[:, None] - hull
    cross = edges[:, 0] * offset[..., 1] - edges[:, 1] * offset[..., 0]
    # Twice a triangle's area from coordinates of order 8: rounding of some eps · 64.
    assert cross.min() > -1e-13
    assert {tuple(corner) for corner in hull} <= {tuple(point) for point in points}
    assert 4 < len(hull) < 60


def test_coverage_is_of_what_was_drawn(space):
    rows = {(row["domain"], row["variable"]): row for row in coverage_table(space)}
    assert len(rows) == 6 * 8
    # Solved for, so not drawn; prescribed and never rejected, so reached wholly.
    assert rows[2, "y"]["reached"] is None
    assert rows[5, "y"]["reached"] == 1.0
    # Statics leave out the corners of domain 4's Fy-Mx rectangle, not an end of its Fy.
    assert rows[4, "Mx"]["reached"] < 1.0
    assert rows[4, "Mx"]["drawn_high"] == pytest.approx(5.0, rel=0.05)
    chosen = space.domain == 4
    half = {**space.columns, "Fy": np.where(chosen, space.columns["Fy"] / 2, space.columns["Fy"])}
    halved = coverage_table(dataclasses.replace(space, columns=half))
    (row,) = [r for r in halved if r["domain"] == 4 and r["variable"] == "Fy"]
    assert row["reached"] <= (BINS // 2 + 1) / BINS
    assert len(coverage_figure(space).axes) == 6 * 8


def test_rejections_are_told_with_their_counts(space):
    figure = rejection_figure(space)
    titles = [axis.get_title(loc="left") for axis in figure.axes]
    candidates = space.candidates[4]
    (title,) = [t for t in titles if t.startswith("4 contact boundary")]
    assert f"{(candidates.status == 'no_equilibrium').sum()} no equilibrium" in title
    everything = {
        number: dataclasses.replace(c, status=np.full(len(c.status), "accepted"))
        for number, c in space.candidates.items()
    }
    assert rejection_figure(dataclasses.replace(space, candidates=everything)) is None
