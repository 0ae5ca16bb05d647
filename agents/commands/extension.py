"""The command ``simworlds extension``: builds and installs what connects an open Blender."""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path
from typing import NoReturn

import click

from simworlds.terminal import options

_HERE = click.Path(file_okay=False, resolve_path=True, path_type=Path)


@click.group()
def extension() -> None:
    """Build or install the extension that lets SimWorlds work in the Blender that is open."""


@extension.command()
@click.option(
    "--to", "folder", type=_HERE, default=".", help="Folder for the .zip. Default: the current one."
)
def build(*, folder: Path) -> None:
    """Write the extension as a .zip, for Blender 4.2 and later, and as an add-on for 3.4 to 4.1."""
    from agents.blender.extension import CannotInstall  # noqa: PLC0415 - not for --help
    from agents.blender.extension import build as build_in  # noqa: PLC0415

    try:
        click.echo(build_in(folder))
    except CannotInstall as error:
        _fail(str(error))


@extension.command()
@options.EXECUTABLE
def install(*, blender_exe: Path | None) -> None:
    """Install and enable the extension in a Blender, for this user.

    In Blender's sidebar (N), the tab SimWorlds then has a button that starts it.
    """
    from agents.blender.extension import CannotInstall  # noqa: PLC0415 - not for --help
    from agents.blender.extension import build as build_in  # noqa: PLC0415
    from agents.blender.extension import install as install_in  # noqa: PLC0415

    blender = str(blender_exe) if blender_exe is not None else shutil.which("blender")
    if blender is None:
        _fail("There is no blender on PATH. Name the program with --blender-exe.")
    try:
        with tempfile.TemporaryDirectory() as folder:
            version = install_in(build_in(Path(folder)), Path(blender))
    except CannotInstall as error:
        _fail(str(error))
    click.echo(f"Installed in Blender {version}. In its sidebar (N), press Start in the tab SimWorlds.")


def _fail(message: str) -> NoReturn:
    """Ends the command as others end that cannot do what they are asked for."""
    click.echo(f"Error: {message}", err=True)
    sys.exit(2)
