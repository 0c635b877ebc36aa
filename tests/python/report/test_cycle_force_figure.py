# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from condyle.errors import InputDataError

pytest.importorskip("matplotlib")

from condyle.report.cycle_force_figure import PublishedPeak, cycle_force_figure
from condyle.report.style import COLOURS, house_style, save

WEIGHT = 686.0
PERCENT = np.linspace(0.0, 100.0, 101)
#: Three cycles of different heights, medial 1.5 times lateral.
SHAPE = np.sin(np.pi * PERCENT / 100.0)[:, None] * np.array([600.0, 400.0])
CYCLES = np.array([0.9, 1.0, 1.4])[:, None, None] * SHAPE
PUBLISHED = [PublishedPeak("treadmill", 1.9, 2.3), PublishedPeak("one value", 2.61, 2.61)]


def test_cycles_are_thin_their_mean_thick_and_all_in_body_weights():
    figure = cycle_force_figure("gait", CYCLES, WEIGHT)
    (axis,) = figure.axes
    expected = {"total": CYCLES.sum(axis=2), "medial": CYCLES[:, :, 0], "lateral": CYCLES[:, :, 1]}
    for name, forces in expected.items():
        *single, mean = [line for line in axis.lines if line.get_color() == COLOURS[name]]
        assert len(single) == 3
        for line, cycle in zip(single, forces, strict=True):
            np.testing.assert_allclose(line.get_ydata(), cycle / WEIGHT)
            np.testing.assert_array_equal(line.get_xdata(), PERCENT)
            assert line.get_linewidth() < mean.get_linewidth()
        np.testing.assert_allclose(mean.get_ydata(), forces.mean(axis=0) / WEIGHT)
        assert mean.get_label() == name
    assert [text.get_text() for text in figure.legends[0].get_texts()] == list(expected)
    assert (axis.get_xlim(), axis.get_ylim()[0]) == ((0.0, 100.0), 0.0)
    assert axis.get_ylabel() == "compression [BW]"


def test_published_peaks_are_shades_at_their_height_with_their_source():
    figure = cycle_force_figure("gait", CYCLES, WEIGHT, toe_off=71.0, published=PUBLISHED)
    (axis,) = figure.axes
    shades = [(p.get_y(), p.get_y() + p.get_height()) for p in axis.patches]
    assert shades[0] == pytest.approx((1.9, 2.3))
    low, high = shades[1]
    assert low < 2.61 < high < 2.65
    assert [text.get_text() for text in axis.texts] == ["treadmill", "one value", "toe off"]
    assert any(np.array_equal(line.get_xdata(), [71.0, 71.0]) for line in axis.lines)


def test_what_cannot_be_drawn_is_refused():
    with pytest.raises(InputDataError, match=r"shape \(101, 2\): must be \(cycles, 101, 2\)"):
        cycle_force_figure("gait", SHAPE, WEIGHT)
    with pytest.raises(InputDataError, match=r"shape \(0, 101, 2\)"):
        cycle_force_figure("gait", CYCLES[:0], WEIGHT)
    with pytest.raises(InputDataError, match="body_weight is 0 N: must be positive"):
        cycle_force_figure("gait", CYCLES, 0.0)


def test_the_same_data_give_the_same_bytes(tmp_path):
    with house_style():
        first, second = (
            save(
                cycle_force_figure("gait", CYCLES, WEIGHT, published=PUBLISHED),
                tmp_path / f"{i}.png",
            ).read_bytes()
            for i in (1, 2)
        )
    assert first == second
