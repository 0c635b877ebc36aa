# SPDX-License-Identifier: Apache-2.0
"""``condyle surrogate``: what a surrogate file says of itself."""

import json
from pathlib import Path
from typing import Annotated

import typer

from condyle.cli.console import console

app = typer.Typer(help="Surrogate files (ONNX contract v1).", no_args_is_help=True)


@app.callback()
def _surrogate() -> None:
    """Keeps ``info`` a subcommand although it is the only one."""


@app.command()
def info(
    file: Annotated[Path, typer.Argument(help="Surrogate, .onnx")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")] = False,
) -> None:
    """Prints a surrogate's contract, implant, contact law, domains, errors and training record."""
    from condyle.surrogate import describe

    description = describe(file)
    if as_json:
        typer.echo(json.dumps(description, indent=2))
        return
    for key, value in description.items():
        console.print(f"[bold]{key}[/bold]")
        text = value if isinstance(value, str) else json.dumps(value, indent=2)
        console.print(text, highlight=False, markup=False)
