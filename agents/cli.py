"""The command ``simworlds``. Commands are loaded when they are asked for: a look-up must start at once."""

from __future__ import annotations

from importlib import import_module
from typing import NamedTuple

import click


class _Command(NamedTuple):
    module: str
    attribute: str
    help: str


_COMMANDS = {
    "docs": _Command("kb_serve.cli", "docs", "Ask the knowledge base."),
    "kb": _Command("kb_build.cli", "kb", "Build, look into, check and compare knowledge bases."),
    "serve": _Command("kb_serve.cli", "serve", "Serve blender_docs over MCP."),
}


class _Lazy(click.Group):
    """A group that knows its commands by name and loads the one that is called."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The names, sorted."""
        del ctx
        return sorted(_COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command of that name, loaded now."""
        del ctx
        entry = _COMMANDS.get(cmd_name)
        if entry is None:
            return None
        command = getattr(import_module(entry.module), entry.attribute)
        assert isinstance(command, click.Command)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Lists them without loading any."""
        del ctx
        with formatter.section("Commands"):
            formatter.write_dl([(name, entry.help) for name, entry in sorted(_COMMANDS.items())])


@click.group(cls=_Lazy, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="simworlds", prog_name="simworlds")
def main() -> None:
    """A knowledge base of Blender's Python API and manual: build it, ask it, serve it to coding agents."""
