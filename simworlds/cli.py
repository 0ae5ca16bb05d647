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
    "bench": _Command("bench.commands.bench", "bench", "Score scenes of any system: 4DBuildBench."),
    "demo": _Command(
        "agents.commands.runs", "demo", "Play a session without a key: real Blender, written answers."
    ),
    "docs": _Command("kb_serve.cli", "docs", "Ask the knowledge base."),
    "doctor": _Command("agents.commands.doctor", "doctor", "Find out whether a live Blender can work here."),
    "edit": _Command("agents.commands.runs", "edit", "Change a scene as told, and leave the rest alone."),
    "kb": _Command("kb_build.cli", "kb", "Build, look into, check and compare knowledge bases."),
    "make": _Command("agents.commands.runs", "make", "Make a scene from a sentence."),
    "mcp": _Command("agents.commands.mcp", "mcp", "Serve a live Blender and blender_docs over MCP."),
    "replay": _Command(
        "agents.commands.runs", "replay", "Play a run's recorded answers, as a run of its own."
    ),
    "resume": _Command("agents.commands.runs", "resume", "Go on with a run."),
    "runs": _Command("agents.commands.runs", "runs", "List the runs."),
    "serve": _Command("kb_serve.cli", "serve", "Serve blender_docs over MCP."),
    "show": _Command("agents.commands.runs", "show", "Show how a run stands."),
    "verify": _Command(
        "agents.commands.verify", "verify", "Check a .blend by the scene protocol and a plan."
    ),
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
    """From a sentence to a simulated scene, and what that needs: a knowledge base, a live Blender, a verifier."""
