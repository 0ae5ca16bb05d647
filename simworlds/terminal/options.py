"""Options that commands of several packages share: which Blender to use, and in which sandbox."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from simworlds.errors import UserError
from simworlds.releases import minor_of
from simworlds.settings import expanded

if TYPE_CHECKING:
    from collections.abc import Callable

    Command = TypeVar("Command", bound=Callable[..., Any])


def combine(*options: Callable[[Command], Command]) -> Callable[[Command], Command]:
    """Several options as one decorator."""

    def add(command: Command) -> Command:
        for option in reversed(options):
            command = option(command)
        return command

    return add


def _checked(_context: click.Context, _parameter: click.Parameter, value: str | None) -> str | None:
    if value is not None:
        try:
            minor_of(value)
        except UserError as error:
            raise click.BadParameter(str(error)) from error
    return value


class _Program(click.Path):
    """An executable, or the folder that it is in: as an absolute path, which holds wherever it is used later."""

    def __init__(self) -> None:
        super().__init__(path_type=Path)

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> Any:  # as of click.Path
        """The path, also of a program that is found by its name, and of one in the environment that begins with
        ``~``.
        """
        path = expanded(Path(shutil.which(value) or value)).absolute()
        if not path.exists():
            self.fail(
                f"There is no Blender at {path}. Give the path of the program, or of its folder.", param, ctx
            )
        return super().convert(path, param, ctx)


VERSION = click.option(
    "--blender", metavar="VERSION", callback=_checked, help="Blender version. Default: this environment's."
)
EXECUTABLE = click.option(
    "--blender-exe",
    type=_Program(),
    envvar="BLENDER_EXE",
    show_envvar=True,
    help="The Blender to use instead of bpy.",
)
SANDBOX = click.option(
    "--sandbox",
    type=click.Choice(["bubblewrap", "landlock", "none"]),
    help="What confines Blender. Default: the strongest that works.",
)
