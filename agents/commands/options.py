"""Options that several commands share: which Blender to use, and in which sandbox."""

from __future__ import annotations

from pathlib import Path

import click

VERSION = click.option("--blender", metavar="VERSION", help="Blender version. Default: this environment's.")
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
