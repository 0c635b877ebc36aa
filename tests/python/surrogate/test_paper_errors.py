# SPDX-License-Identifier: Apache-2.0
"""Errors beside the paper's Table 2."""

import numpy as np
import pytest

from condyle.conventions import LOAD_COLUMNS, SIDES
from condyle.evaluation import sample_error_table
from condyle.surrogate.paper_errors import PAPER_ERRORS, errors_markdown, paper_comparison


def rows_with(offset: float, domains: tuple[int, ...] = (2, 5, 7)) -> list[dict]:
    """Errors that are ``offset`` throughout, of 20 loaded samples a domain."""
    reference = np.random.default_rng(4).uniform(5.0, 800.0, (20 * len(domains), 2, 6))
    return sample_error_table(np.repeat(domains, 20), reference, reference + offset)


def test_the_printed_table_is_whole():
    assert set(PAPER_ERRORS) == {(str(d), side) for d in range(2, 7) for side in SIDES}
    for figures in PAPER_ERRORS.values():
        assert len(figures) == len(LOAD_COLUMNS)
        # An RMSE never exceeds the largest error; both are rounded as printed.
        assert all(0 <= rmse <= largest for rmse, largest in figures)
    # Two of the figures that the text of the paper repeats.
    assert PAPER_ERRORS["2", "lateral"][LOAD_COLUMNS.index("Fy")] == (69, 1863)
    assert PAPER_ERRORS["2", "medial"][LOAD_COLUMNS.index("Fy")] == (18, 462)


def test_only_what_the_paper_printed_is_compared():
    comparison = paper_comparison(rows_with(1.0))
    assert {cell["domain"] for cell in comparison} == {"2", "5"}
    assert len(comparison) == 2 * 2 * 6 * 2
    cells = {(c["domain"], c["side"], c["load"], c["measure"]): c for c in comparison}
    fy = cells["2", "medial", "Fy", "rmse"]
    assert fy["value"] == pytest.approx(1.0)
    assert (fy["paper"], fy["above"]) == (18, False)
    assert cells["2", "medial", "Mx", "rmse"]["above"]  # 1 Nm against 0.44
    assert not cells["2", "medial", "Mx", "max_error"]["above"]  # 1 Nm against 9.7


@pytest.mark.parametrize(("value", "above"), [(0.0049, False), (0.0051, True)])
def test_a_printed_zero_stands_for_less_than_half_its_last_digit(value, above):
    assert PAPER_ERRORS["5", "lateral"][LOAD_COLUMNS.index("My")][0] == 0
    cells = paper_comparison(rows_with(value))
    (cell,) = (
        c
        for c in cells
        if (c["domain"], c["side"], c["load"], c["measure"]) == ("5", "lateral", "My", "rmse")
    )
    assert cell["above"] is above


def test_the_text_shows_both_and_names_what_is_above():
    text = errors_markdown(rows_with(0.1, (4,)))
    assert (
        "| 4 | medial | here | 0.1 (0.1) | 0.1 (0.1) | 0.1 (0.1) | 0.1 (0.1) | **0.1** (0.1) |"
        in text
    )
    assert "|  |  | paper | 2.1 (23) | 9.9 (108) | 3.9 (41) | 0.26 (2.3) | 0.07 (0.58) |" in text
    # 0.07 in My on both sides is all that 0.1 exceeds in domain 4.
    assert (
        "2 of 24 figures are above the paper's (bold): domain 4 medial My RMSE, domain 4 lateral My RMSE."
        in text
    )
    assert "| all | medial | here |" in text


def test_far_above_everywhere_no_list_is_made():
    text = errors_markdown(rows_with(3000.0, (2, 4)))
    assert "48 of 48 figures are above the paper's (bold). The paper's" in text


def test_samples_without_the_papers_domains_are_not_compared():
    text = errors_markdown(rows_with(1.0, (0,)))
    assert "paper" not in text
    assert "| 0 | medial | here | 1 (1) |" in text


def test_r2_is_told_where_there_is_load():
    reference = np.random.default_rng(6).uniform(5.0, 800.0, (40, 2, 6))
    reference[20:] = 0.0  # domain 6 is in the air
    rows = sample_error_table(np.repeat([2, 6], 20), reference, reference * 1.001)
    table = errors_markdown(rows).split("R² over loaded samples")[1]
    assert "| 2 | medial | 0.9999" in table
    assert "| 6 |" not in table
