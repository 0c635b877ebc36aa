# SPDX-License-Identifier: Apache-2.0
"""The sampled domains, and how well a surrogate reproduces held-out samples."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from condyle.conventions import LOAD_COLUMNS, LOAD_UNITS, SIDES
from condyle.report.sample_coverage import coverage_figure
from condyle.report.sample_pairs import AT_THE_EDGE, EDGE_VARIABLES, pair_figure
from condyle.report.sample_rejections import rejection_figure
from condyle.report.sample_space import SampleSpace
from condyle.report.style import COLOURS, house_style, save
from condyle.sampling import ReferenceCurves

#: Bottom to top: the domains of few samples would be hidden behind domain 5's.
_EDGE_ORDER: Final = (5, 3, 4, 6)


def write_sample_figures(
    directory: Path, folder: Path, curves: ReferenceCurves | None = None
) -> list[Path]:
    """Draw a dataset into PNG files; the same dataset gives the same bytes.

    - ``samples_loaded.png``: pairs of the domains with the activities' loads, and of samples that
      know no domains;
    - ``samples_edge.png``: pairs of the domains at the edge of contact, y and θx with them;
    - ``samples_coverage.png``: each variable against what was drawn;
    - ``samples_rejections.png``: where candidates were rejected, and why.

    Args:
        directory: the dataset's, complete.
        folder: for the figures; those that an earlier dataset had and this one has not are removed.
        curves: the reference curves, drawn with the samples.

    Returns:
        The files written, those that apply.

    Raises:
        InputDataError: not a complete dataset, a part is damaged, or the folder cannot be written.
    """
    space = SampleSpace.read(directory, curves)
    loaded = [domain for domain in space.domains if domain not in AT_THE_EDGE]
    edge = [domain for domain in _EDGE_ORDER if domain in space.domains]
    with house_style():
        figures = {
            "loaded": pair_figure(space, loaded[::-1]) if loaded else None,
            "edge": pair_figure(space, edge, EDGE_VARIABLES) if edge else None,
            "coverage": coverage_figure(space),
            "rejections": rejection_figure(space),
        }
        made = []
        for name, figure in figures.items():
            file = folder / f"samples_{name}.png"
            if figure is None:
                file.unlink(missing_ok=True)
            else:
                made.append(save(figure, file))
    return made


def parity_figure(
    reference: NDArray[np.float64],
    surrogate: NDArray[np.float64],
    statistics: list[dict[str, object]],
) -> Figure:
    """Surrogate against reference for every load of both sides over held-out samples.

    Args:
        reference: wrenches (n, 2, 6) [N, Nm].
        surrogate: wrenches at the same poses.
        statistics: rows of the sample error table; those of domain ``all`` label the panels.
    """
    labels = {(r["side"], r["load"]): r for r in statistics if r["domain"] == "all"}
    figure = Figure(figsize=(12, 4.8), layout="constrained")
    axes = figure.subplots(2, 6)
    for s, side in enumerate(SIDES):
        for i, load in enumerate(LOAD_COLUMNS):
            axis = axes[s, i]
            x, y = reference[:, s, i], surrogate[:, s, i]
            low, high = float(min(x.min(), y.min())), float(max(x.max(), y.max()))
            axis.plot([low, high], [low, high], color="#888888", lw=0.8)
            axis.plot(x, y, ".", ms=2, color=COLOURS[side], alpha=0.5, rasterized=True)
            row = labels.get((side, load))
            if row is not None:
                r2 = row["loaded_r2"]
                shown = f"R² {r2:.5f}\n" if isinstance(r2, float) else ""
                text = f"{shown}RMSE {row['rmse']:.3g} {LOAD_UNITS[i]}"
                axis.text(0.04, 0.96, text, transform=axis.transAxes, va="top", fontsize=7)
            axis.set_title(f"{side} {load} [{LOAD_UNITS[i]}]", fontsize=8)
            axis.tick_params(labelsize=6)
    figure.supxlabel("reference")
    figure.supylabel("surrogate")
    figure.suptitle(f"Held-out samples ({len(reference)}): surrogate against reference")
    return figure
