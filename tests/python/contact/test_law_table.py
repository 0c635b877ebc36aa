# SPDX-License-Identifier: Apache-2.0
import pytest

from condyle.contact import read_table_law
from condyle.errors import InputDataError


def test_millimetres_and_megapascals_or_si_in_any_order(tmp_path):
    file = tmp_path / "law.csv"
    file.write_text(
        "# a test of 3 points\npressure_MPa, depth_mm, note\n0,0,a\n0.9,0.13,b\n\n23,1.1,c\n"
    )
    law = read_table_law(file)
    assert law.depth == pytest.approx((0.0, 1.3e-4, 1.1e-3), rel=1e-15)
    assert law.pressure == pytest.approx((0.0, 0.9e6, 23e6), rel=1e-15)
    file.write_text("depth_m,pressure_Pa\n0,0\n1.3e-4,9e5\n1.1e-3,23e6\n")
    assert read_table_law(file).depth == (0.0, 1.3e-4, 1.1e-3)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "is empty: columns depth_mm, pressure_MPa are needed"),
        (
            "depth,pressure_MPa\n0,0\n",
            r"must have one column depth_m or depth_mm \(columns: depth, pressure_MPa\)",
        ),
        (
            "depth_mm,depth_m,pressure_MPa\n0,0,0\n",
            r"must have one column depth_m or depth_mm \(columns: depth_mm, depth_m, pressure_MPa\)",
        ),
        ("depth_mm,pressure_MPa\n0,0\n1\n", "line 3 has 1 values: must be 2"),
        (
            "depth_mm,pressure_MPa\n0,0\n1,two\n",
            "line 3, column 'pressure_MPa': 'two' is not a number",
        ),
        ("depth_mm,pressure_MPa\n0,0\n1,nan\n", "line 3: depth 0.001 m, pressure nan Pa: must be"),
        (
            "depth_mm,pressure_MPa\n0.1,0\n1,2\n",
            r"line 2: depth 0.0001 m, pressure 0 Pa: the first point must be \(0, 0\)",
        ),
        (
            "depth_mm,pressure_MPa\n0,0\n1,2\n1,3\n",
            r"line 4: depth 0.001 m, pressure 3e\+06 Pa: depth must rise from line to line",
        ),
        (
            "# c\ndepth_mm,pressure_MPa\n0,0\n1,2\n2,1\n",
            r"line 5: depth 0.002 m, pressure 1e\+06 Pa: pressure must not fall",
        ),
        ("depth_mm,pressure_MPa\n0,0\n", "contact law table: 1 points: must be at least 2"),
        ("depth_mm,pressure_MPa\n0,0\n1,0\n", "contact law table: every pressure is 0 Pa"),
    ],
)
def test_a_mistake_names_file_line_and_value(tmp_path, text, said):
    file = tmp_path / "law.csv"
    file.write_text(text)
    with pytest.raises(InputDataError, match=rf"law\.csv: {said}"):
        read_table_law(file)


def test_a_missing_file_and_a_file_of_another_kind_are_named(tmp_path):
    with pytest.raises(InputDataError, match=r"none\.csv: cannot be read: No such file"):
        read_table_law(tmp_path / "none.csv")
    (tmp_path / "law.xlsx").write_bytes(b"PK\x03\x04\xff\xfe")
    with pytest.raises(InputDataError, match=r"law\.xlsx: is not a text file"):
        read_table_law(tmp_path / "law.xlsx")
