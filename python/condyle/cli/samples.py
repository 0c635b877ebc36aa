# SPDX-License-Identifier: Apache-2.0
"""``condyle samples``: datasets from elsewhere, and figures of any dataset."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import typer

from condyle.cli.console import console, print_table

app = typer.Typer(help="Datasets of samples (docs/samples.md).", no_args_is_help=True)

Dataset = Annotated[Path, typer.Argument(help="Directory of a dataset.")]


@app.command(name="import")
def import_command(
    file: Annotated[
        Path,
        typer.Argument(
            help="CSV or Parquet: x, y, z, theta_x, theta_y, theta_z, medial_Fx ... medial_Mz, "
            "lateral_Fx ... lateral_Mz; domain and split if there are any."
        ),
    ],
    into: Annotated[Path, typer.Option(help="Directory of the dataset, new or empty.")],
    source: Annotated[
        str, typer.Option(help="Where the samples are from, in words: program, model, author.")
    ],
    side_of_body: Annotated[Literal["left", "right"], typer.Option(help="Which knee.")],
    length_unit: Annotated[Literal["m", "mm"], typer.Option(help="Of x, y, z.")] = "m",
    angle_unit: Annotated[Literal["rad", "deg"], typer.Option(help="Of the angles.")] = "rad",
    force_unit: Annotated[Literal["N", "kN"], typer.Option(help="Of the forces.")] = "N",
    moment_unit: Annotated[Literal["Nm", "Nmm"], typer.Option(help="Of the moments.")] = "Nm",
    seed: Annotated[int, typer.Option(min=0, help="Of the split into train and test.")] = 2017,
    test_share: Annotated[
        float, typer.Option(min=0.01, max=0.9, help="Share of the rows for testing.")
    ] = 0.15,
) -> None:
    """Makes a dataset of another program's poses and loads, to train a surrogate on."""
    from condyle.sampling import TableUnits, import_samples

    report = import_samples(
        file,
        into,
        source=source,
        side_of_body=side_of_body,
        units=TableUnits(length_unit, angle_unit, force_unit, moment_unit),
        seed=seed,
        test_share=test_share,
    )
    done = "holds these already" if report.unchanged else "written"
    console.print(
        f"{into}: {done}, {report.train} samples for training and {report.test} for testing; "
        f"loaded: medial {report.loaded[0]}, lateral {report.loaded[1]}",
        highlight=False, markup=False, soft_wrap=True,
    )  # fmt: skip
    if any(report.pulling):
        console.print(
            f"Fy < 0: medial {report.pulling[0]}, lateral {report.pulling[1]}; "
            "a surrogate takes these sides for lifted off",
            highlight=False, soft_wrap=True,
        )  # fmt: skip
    shown = report.pose_range * np.repeat([1e3, 180 / np.pi], 3)
    rows = [
        [name, f"{low:.3f}", f"{high:.3f}"]
        for name, low, high in zip(
            ("x [mm]", "y [mm]", "z [mm]", "theta_x [deg]", "theta_y [deg]", "theta_z [deg]"),
            *shown,
            strict=True,
        )
    ]
    print_table("poses as read", ("coordinate", "least", "greatest"), rows)


@app.command()
def figures(
    dataset: Dataset,
    into: Annotated[Path, typer.Option(help="Folder for the figures.")],
    curves: Annotated[
        Path | None, typer.Option(help="Reference curves to draw with them, .csv.")
    ] = None,
) -> None:
    """Draws a dataset: pairs of variables, coverage, and where candidates were rejected."""
    from condyle.report.sample_figures import write_sample_figures
    from condyle.sampling import read_table

    known = None if curves is None else read_table(curves)
    for file in write_sample_figures(dataset, into, known):
        console.print(str(file), highlight=False, markup=False, soft_wrap=True)
