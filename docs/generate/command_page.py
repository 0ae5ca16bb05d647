"""The page of the command line: the help of ``simworlds`` and of all commands below it."""

from __future__ import annotations

import pkgutil
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from docs.generate.markdown import GENERATED, page

if TYPE_CHECKING:
    from collections.abc import Iterator

_PYPROJECT = Path(__file__).resolve().parents[2] / "pyproject.toml"
_WIDTH = 100


def command_page() -> str:
    """The help of all commands, as Markdown."""
    parts = ["# Commands", GENERATED]
    for path, text in _helps(_command(), "simworlds", None):
        parts += [f"## `{path}`", f"```text\n{text}\n```"]
    return page(*parts)


def _command() -> click.Command:
    """The command that the project installs."""
    project = tomllib.loads(_PYPROJECT.read_text(encoding="utf-8"))["project"]
    command = pkgutil.resolve_name(project["scripts"]["simworlds"])
    assert isinstance(command, click.Command)
    return command


def _helps(command: click.Command, name: str, parent: click.Context | None) -> Iterator[tuple[str, str]]:
    settings: dict[str, Any] = {
        "terminal_width": _WIDTH,
        "max_content_width": _WIDTH,
        **command.context_settings,
    }
    context = click.Context(command, info_name=name, parent=parent, **settings)
    yield context.command_path, command.get_help(context)
    if isinstance(command, click.Group):
        for below in command.list_commands(context):
            subcommand = command.get_command(context, below)
            assert subcommand is not None
            yield from _helps(subcommand, below, context)
