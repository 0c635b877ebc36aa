# SPDX-License-Identifier: Apache-2.0
"""Tables of reference curves: CSV and OpenSim storage say the same, and every mistake is named with its line."""

from pathlib import Path

import numpy as np
import pytest

from condyle.errors import InputDataError
from condyle.sampling import CURVE_COLUMNS, ReferenceCurves, read_table, read_tables, write_csv

HEADER = "activity,time,x,y,z,theta_x,theta_y,theta_z,Fy,Mx"
ROW = "walk,{},0.003,0.031,0.001,0.01,0.02,-0.5,812.5,3.25"


def test_a_csv_table_gives_back_what_was_written(curves: ReferenceCurves, tmp_path: Path) -> None:
    write_csv(curves, tmp_path / "curves.csv")
    back = read_table(tmp_path / "curves.csv")
    assert back.names == ("walk", "squat")
    assert back.content_hash() == curves.content_hash()


def test_a_csv_table_without_activities_is_one_named_after_the_file(tmp_path: Path) -> None:
    path = tmp_path / "stairs.csv"
    rows = [ROW.format(time).removeprefix("walk,") for time in (0.0, 0.25)]
    path.write_text("\n".join([HEADER.removeprefix("activity,"), *rows]))
    curves = read_table(path)
    assert curves.names == ("stairs",)
    assert curves.curves[0].column("Fy").tolist() == [812.5, 812.5]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "curves.csv: holds no rows"),
        (HEADER.replace(",Mx", "") + "\n" + ROW.format(0), "curves.csv: the column Mx is missing"),
        (f"{HEADER}\n{ROW.format(0)}\n{ROW.format('later')}", "line 3: time is 'later'; a number"),
        (f"{HEADER}\n{ROW.format(0)}\nwalk,0.1,0.2", "line 3: y is None; a number"),
        (f"{HEADER}\n{ROW.format(0)}\n{ROW.format(0)}", "curves.csv: .*time does not increase"),
    ],
)
def test_bad_tables_are_refused_by_file_and_line(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "curves.csv"
    path.write_text(text)
    with pytest.raises(InputDataError, match=message):
        read_table(path)


def test_a_missing_table_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputDataError, match=r"nowhere\.csv: cannot be read.*No such file"):
        read_table(tmp_path / "nowhere.csv")


def storage(curves: ReferenceCurves, folder: Path, name: str, in_degrees: str) -> Path:
    """One activity as OpenSim writes it, angles in degrees where asked for."""
    (curve,) = (c for c in curves.curves if c.name == name)
    values = curve.values.copy()
    if in_degrees == "yes":
        values[:, 3:6] = np.degrees(values[:, 3:6])
    # Not in our order, and with a column that is not ours.
    order = [7, 0, 2, 1, 5, 4, 3, 6]
    labels = ["time", "knee_angle_r", *(CURVE_COLUMNS[i] for i in order)]
    rows = [
        "\t".join([f"{time:.17g}", "12.5", *(f"{row[i]:.17g}" for i in order)])
        for time, row in zip(curve.time, values, strict=True)
    ]
    path = folder / f"{name}.sto"
    header = [name, "version=1", f"nRows={len(rows)}", "nColumns=10", f"inDegrees={in_degrees}"]
    path.write_text("\n".join([*header, "", "endheader", "\t".join(labels), *rows]) + "\n")
    return path


@pytest.mark.parametrize("in_degrees", ["yes", "no"])
def test_an_opensim_table_says_what_the_csv_table_says(
    curves: ReferenceCurves, tmp_path: Path, in_degrees: str
) -> None:
    back = read_tables([storage(curves, tmp_path, name, in_degrees) for name in curves.names])
    assert back.names == curves.names
    for before, after in zip(curves.curves, back.curves, strict=True):
        np.testing.assert_array_equal(after.time, before.time)
        # 17 digits are exact; degrees and back are two roundings.
        tolerance = 4 * np.finfo(float).eps if in_degrees == "yes" else 0.0
        np.testing.assert_allclose(after.values, before.values, rtol=tolerance)


def test_the_motion_ending_is_read_the_same(curves: ReferenceCurves, tmp_path: Path) -> None:
    sto = storage(curves, tmp_path, "walk", "yes")
    mot = sto.rename(tmp_path / "walk.MOT")
    assert read_table(mot).names == ("walk",)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("endheader", "end", "no line 'endheader'"),
        ("nRows=90", "nRows=91", "the header says nrows = 91; the table has 90"),
        ("nColumns=10", "nColumns=9", "the header says ncolumns = 9; the table has 10"),
        ("inDegrees=no\n", "", "the header says inDegrees = None; yes or no is needed"),
        ("inDegrees=no", "inDegrees=maybe", "the header says inDegrees = maybe; yes or no"),
        ("\ttheta_y\t", "\tie\t", "the column theta_y is missing; needed are time, x"),
        ("\tknee_angle_r\t", "\tx\t", "the column x is there twice"),
        ("\t12.5\t", "\t", "line 9: 9 values; 10 columns are labelled"),
    ],
)
def test_a_bad_opensim_table_is_refused_by_file_and_line(
    curves: ReferenceCurves, tmp_path: Path, old: str, new: str, message: str
) -> None:
    path = storage(curves, tmp_path, "walk", "no")
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(InputDataError) as caught:
        read_table(path)
    assert message in str(caught.value)
    assert str(caught.value).startswith(str(path))


def test_a_value_that_is_no_number_is_named_by_line_and_column(
    curves: ReferenceCurves, tmp_path: Path
) -> None:
    path = storage(curves, tmp_path, "walk", "no")
    lines = path.read_text().splitlines()
    lines[11] = "\t".join(["0.2", "1", "high", *lines[11].split("\t")[3:]])
    path.write_text("\n".join(lines))
    with pytest.raises(InputDataError, match=r"walk\.sto, line 12: Mx is 'high'; a number"):
        read_table(path)


def test_degrees_taken_for_radians_are_refused(curves: ReferenceCurves, tmp_path: Path) -> None:
    path = storage(curves, tmp_path, "squat", "yes")
    path.write_text(path.read_text().replace("inDegrees=yes", "inDegrees=no"))
    with pytest.raises(InputDataError, match=r"squat\.sto: .*theta_. is -.* at most 3\.14159 rad"):
        read_table(path)


def test_an_activity_in_two_files_is_refused(curves: ReferenceCurves, tmp_path: Path) -> None:
    path = storage(curves, tmp_path, "walk", "no")
    write_csv(curves, tmp_path / "all.csv")
    with pytest.raises(InputDataError, match="'walk' is there twice"):
        read_tables([path, tmp_path / "all.csv"])


def test_an_unknown_ending_names_the_known_ones(tmp_path: Path) -> None:
    with pytest.raises(InputDataError, match=r"curves\.xlsx: .* must end in \.csv, \.sto, \.mot"):
        read_table(tmp_path / "curves.xlsx")
