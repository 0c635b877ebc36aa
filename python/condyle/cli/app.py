# SPDX-License-Identifier: Apache-2.0
"""The command's root: options that all commands share, and what becomes of errors."""

import os
import sys
from typing import Annotated

import typer

import condyle
from condyle.cli import (
    contact,
    contact_map,
    implant,
    model,
    opensim,
    samples,
    simulate,
    stages,
    surrogate,
)
from condyle.cli.console import errors
from condyle.errors import CondyleError

app = typer.Typer(
    name="condyle",
    help="Knee-replacement contact, equilibrium and neural surrogates.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
)
contact_map.add_to(contact.app)
app.add_typer(contact.app, name="contact")
app.add_typer(implant.app, name="implant")
app.add_typer(model.app, name="model")
app.add_typer(opensim.app, name="opensim")
app.add_typer(samples.app, name="samples")
app.add_typer(surrogate.app, name="surrogate")
stages.add_to(app)
simulate.add_to(app)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"condyle {condyle.__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version."
        ),
    ] = False,
) -> None:
    """Options before any command."""


def main() -> None:
    """Runs the command; a caller's mistake ends in one line on standard error and exit code 2.

    CONDYLE_TRACEBACK=1 in the environment shows where an error came from.
    """
    try:
        app()
    except (CondyleError, ValueError, OSError, ImportError) as error:
        if os.environ.get("CONDYLE_TRACEBACK"):
            raise
        errors.print(f"condyle: {error}", highlight=False, markup=False, soft_wrap=True)
        sys.exit(2)
    except KeyboardInterrupt:
        errors.print("condyle: interrupted; what is finished is kept, the same command resumes")
        sys.exit(130)
