"""The line by which commands say at their start what the sandbox does not prevent."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from simworlds.sandbox.confinement.confined_command import Sandbox


def warn(sandbox: Sandbox) -> None:
    """Prints one line on stderr, if a wall is down."""
    if sandbox.warning:
        click.echo(sandbox.warning, err=True)
