# SPDX-License-Identifier: Apache-2.0
import json
import os
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from external_knee import external_table

from condyle.conventions import POSE_COLUMNS, WRENCH_COLUMNS
from condyle.errors import InputDataError
from condyle.sampling import Dataset, TableUnits, import_samples, read_candidates

UNITS = TableUnits("mm", "deg", "N", "Nmm")
#: From the file's units to SI, in its columns' order.
FACTORS = np.array([1e-3] * 3 + [np.pi / 180] * 3 + ([1.0] * 3 + [1e-3] * 3) * 2)
ROWS = 700


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return external_table(ROWS)


@pytest.fixture
def run(table, tmp_path):
    """Imports the table, some of it changed, and reads it back."""

    def run(change=lambda table: table, name="knee.csv", into="data", **options) -> Dataset:
        file, changed = tmp_path / name, change(table.copy())
        if file.suffix == ".csv":
            changed.to_csv(file, index=False, float_format=lambda value: repr(float(value)))
        else:
            changed.to_parquet(file)
        given = {"source": "rollers", "side_of_body": "right", "units": UNITS} | options
        import_samples(file, tmp_path / into, **given)
        return Dataset.read(tmp_path / into)

    return run


@pytest.mark.parametrize("name", ["knee.csv", "knee.parquet"])
def test_the_rows_come_back_in_si(run, table, name):
    data = run(name=name)
    wanted = table.to_numpy() * FACTORS
    # One multiplication by the factor on either side: at most its rounding.
    assert np.allclose(data.poses, wanted[:, :6], rtol=1e-15, atol=0)
    assert np.allclose(data.wrenches.reshape(ROWS, 12), wanted[:, 6:], rtol=1e-15, atol=0)
    assert np.array_equal(data.candidate, np.arange(ROWS))
    assert np.array_equal(data.two_sided, (data.wrenches[:, :, 1] > 0).all(axis=1))
    assert 0 < data.two_sided.sum() < ROWS
    assert set(data.domain) == {0}
    assert np.isnan(data.prescribed_loads).all()


def test_pandas_alone_reads_what_was_imported(run, tmp_path):
    data = run()
    frame = pd.read_parquet(tmp_path / "data" / "samples")
    assert np.array_equal(frame[list(POSE_COLUMNS)].to_numpy(), data.poses)
    assert np.array_equal(frame[list(WRENCH_COLUMNS)].to_numpy(), data.wrenches.reshape(-1, 12))
    assert frame["split"].tolist() == data.split.tolist()


def test_the_manifest_says_where_they_are_from_and_nothing_of_a_plan(run, tmp_path):
    import hashlib

    run(seed=3, test_share=0.2)
    text = (tmp_path / "data" / "manifest.json").read_text()
    manifest = json.loads(text)
    assert manifest["provenance"] == {
        "kind": "imported",
        "file": "knee.csv",
        "sha256": hashlib.sha256((tmp_path / "knee.csv").read_bytes()).hexdigest(),
        "source": "rollers",
        "units": {"length": "mm", "angle": "deg", "force": "N", "moment": "Nmm"},
        "split": {"by": "keyed hash", "seed": 3, "test_share": 0.2},
        "rows": ROWS,
    }
    assert manifest["domains"] == [{"domain": 0, "train": 560, "test": 140}]
    assert not {"design_hash", "plan", "curves"} & set(manifest)
    assert str(tmp_path) not in text
    with pytest.raises(InputDataError, match="imported, without candidates"):
        read_candidates(tmp_path / "data", 0)


def test_the_split_is_the_seeds_and_spread_over_the_rows(run):
    first, same, other = run(seed=1), run(seed=1, into="b"), run(seed=2, into="c")
    assert np.array_equal(first.split, same.split)
    assert not np.array_equal(first.split, other.split)
    test = np.flatnonzero(first.split == "test")
    assert len(test) == round(0.15 * ROWS)
    # Uniform rows: the mean of n of them lies within 4 standard errors of the middle.
    assert abs(test.mean() - ROWS / 2) < 4 * ROWS / np.sqrt(12 * len(test))


def test_the_files_own_domains_and_split_are_kept(run):
    domain = np.where(np.arange(ROWS) % 3 == 0, 2, 4)
    split = np.where(np.arange(ROWS) < 600, "train", "test")
    data = run(lambda t: t.assign(domain=domain, split=split))
    assert np.array_equal(data.domain, domain)
    assert np.array_equal(data.split, split)
    assert data.manifest["provenance"]["split"] == {"by": "column split of the file"}
    assert [d["domain"] for d in data.manifest["domains"]] == [2, 4]


def test_a_second_import_changes_nothing_and_another_one_is_refused(run, tmp_path):
    run()
    before = {path: os.stat(path).st_mtime_ns for path in (tmp_path / "data").rglob("*")}
    run()
    assert before == {path: os.stat(path).st_mtime_ns for path in (tmp_path / "data").rglob("*")}
    with pytest.raises(InputDataError, match="holds other samples"):
        run(lambda t: t.iloc[1:])


def test_what_a_killed_import_left_is_replaced_and_foreign_files_are_not(run, tmp_path):
    left = tmp_path / "data" / "samples" / "imported-part-00007.parquet"
    left.parent.mkdir(parents=True)
    left.write_bytes(b"half a part")
    assert len(run()) == ROWS
    assert not left.exists()
    foreign = tmp_path / "other" / "thesis.docx"
    foreign.parent.mkdir()
    foreign.write_bytes(b"kept")
    with pytest.raises(InputDataError, match=r"thesis\.docx.*new or empty"):
        run(into="other")
    assert foreign.read_bytes() == b"kept"


def _set(row, column, value):
    def change(table):
        table[column] = table[column].astype(object if isinstance(value, str) else float)
        table.loc[row, column] = value
        return table

    return change


def _repeat(table):
    table.loc[20, list(POSE_COLUMNS)] = table.loc[11, list(POSE_COLUMNS)]
    return table


def _swap_sides(table):
    names = {n: n.replace("medial", "lateral") for n in WRENCH_COLUMNS if "medial" in n}
    return table.rename(columns=names | {b: a for a, b in names.items()})


def _lift(side):
    return lambda table: table.assign(**{n: 0.0 for n in WRENCH_COLUMNS if n.startswith(side)})


def _pull(table):
    forces = [name for name in WRENCH_COLUMNS if name.startswith("lateral")]
    table[forces] *= -1.0
    return table


@pytest.mark.parametrize(
    ("change", "options", "said"),
    [
        (lambda t: t.drop(columns="theta_y"), {}, r"the column theta_y is missing \(1 of 18 are\)"),
        (_set(7, "z", np.nan), {}, r"knee\.csv, line 9: z is empty; a finite number is needed"),
        (_set(7, "z", np.inf), {}, r"knee\.csv, line 9: z is inf; a finite number"),
        (_set(4, "y", "n/k"), {}, r"knee\.csv, line 6: y is 'n/k'; a number is needed"),
        (_set(4, "y", 1200.0), {}, r"line 6: y is 1200 mm; at most 1000 mm either way"),
        (_set(0, "lateral_Fz", -6e4), {}, r"line 2: lateral_Fz is -60000 N; at most 50000 N"),
        (lambda t: t, {"units": TableUnits()}, r"x is .* m; at most 1 m either way is plausible"),
        (lambda t: t, {"units": TableUnits("mm", "rad", "N", "Nmm")}, "theta_y is .* rad; at most 3.14159 rad"),
        (lambda t: t, {"units": TableUnits("mm", "deg")}, "is Nm the file's unit"),
        (lambda t: t / [*[1e3] * 6, *[1.0] * 12], {}, "y varies by .* mm over all rows; at least 0.01 mm"),
        (lambda t: t.assign(theta_y=2.5), {}, "theta_y is 2.5 deg in every row"),
        (_repeat, {}, r"line 22: the pose is that of line 13; .*\(1 are repeated\)"),
        (_lift("medial"), {}, "the medial side's loads are zero in all 700 rows"),
        (_lift(""), {}, "the medial side's loads are zero in all 700 rows"),
        (_pull, {}, r"lateral_Fy is -.* compression is Fy > 0"),
        (_swap_sides, {}, "are the columns of the sides swapped"),
        (lambda t: t, {"side_of_body": "left"}, "is side_of_body right"),
        (lambda t: t.iloc[:199], {}, "has 199 rows of samples; at least 200"),
        (lambda t: t.assign(domain=9), {}, r"line 2: domain is 9; it must be 1 to 6"),
        (lambda t: t.assign(split="train"), {}, "no row has split = 'test'"),
        (lambda t: t.assign(split="validation"), {}, "line 2: split is 'validation'"),
        (lambda t: t, {"source": " "}, "source is empty"),
        (lambda t: t, {"test_share": 0.95}, "test_share is 0.95; it must be 0.01 to 0.9"),
        (lambda t: t, {"name": "knee.parquet", "change": _set(7, "z", np.nan)}, r"knee\.parquet, row 7: z is"),
    ],
)  # fmt: skip
def test_what_no_knee_does_is_refused(run, tmp_path, change, options, said):
    with pytest.raises(InputDataError, match=said):
        run(**({"change": change} | options))
    assert not (tmp_path / "data").exists()


def test_files_that_are_no_table_are_refused(tmp_path):
    options = {"source": "s", "side_of_body": "left"}
    for name, content, said in [
        ("a.csv", b"x;y;z\n1;2;3\n", "semicolons; commas are needed"),
        ("a.parquet", b"x,y,z\n", "cannot be read as Parquet"),
        ("empty.csv", b"", "cannot be read as CSV"),
        ("twice.csv", b"x,x\n1,2\n", "the column x is there 2 times"),
    ]:
        (tmp_path / name).write_bytes(content)
        with pytest.raises(InputDataError, match=said):
            import_samples(tmp_path / name, tmp_path / "data", **options)
    with pytest.raises(InputDataError, match=r"none\.csv"):
        import_samples(Path(tmp_path / "none.csv"), tmp_path / "data", **options)
    with pytest.raises(InputDataError, match="length unit is 'inch'; it must be one of m, mm"):
        TableUnits("inch")
