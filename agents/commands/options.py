"""Options that several commands share: which Blender to use, and in which sandbox."""

from __future__ import annotations

from pathlib import Path

import click

from simworlds.errors import UserError
from simworlds.releases import minor_of


def _checked(_context: click.Context, _parameter: click.Parameter, value: str | None) -> str | None:
    if value is not None:
        try:
            minor_of(value)
        except UserError as error:
            raise click.BadParameter(str(error)) from error
    return value


VERSION = click.option(
    "--blender", metavar="VERSION", callback=_checked, help="Blender version. Default: this environment's."
)
EXECUTABLE = click.option(
    "--blender-exe",
    type=click.Path(path_type=Path),
    envvar="BLENDER_EXE",
    show_envvar=True,
    help="The Blender to use instead of bpy.",
)
SANDBOX = click.option(
    "--sandbox",
    type=click.Choice(["bubblewrap", "landlock", "none"]),
    help="What confines Blender. Default: the strongest that works.",
)
