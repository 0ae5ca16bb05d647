"""The command ``simworlds bench``. Subcommands are loaded when they are called."""

from __future__ import annotations

from importlib import import_module

import click

# Command → the module that defines it, its attribute there, and its line in the list.
_COMMANDS = {
    "audit": ("bench.commands.audit", "audit", "Audit a .blend by a scene's spec."),
    "blenderbench": ("bench.commands.blenderbench", "blenderbench", "Score edits on BlenderBench."),
    "judge": ("bench.commands.judge", "judge", "Judge frames by a prompt, item by item."),
    "estimate": ("bench.commands.report", "estimate", "Estimate how long a larger sweep takes."),
    "report": ("bench.commands.report", "report", "Print the tables of results, and write their page."),
    "rescore": ("bench.commands.sweep", "rescore", "Score results again where something changed."),
    "run": ("bench.commands.sweep", "run", "Score a system on the benchmark's scenes."),
    "list": ("bench.commands.scenes", "list_scenes", "List the scenes."),
    "show": ("bench.commands.scenes", "show", "Show a scene: its prompt, actors and checks."),
    "validate": (
        "bench.commands.validate",
        "validate",
        "Validate the benchmark itself: references, mutations, counterfeits.",
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
        if cmd_name not in _COMMANDS:
            return None
        module, attribute, _ = _COMMANDS[cmd_name]
        command = getattr(import_module(module), attribute)
        assert isinstance(command, click.Command)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Lists them without loading any."""
        del ctx
        with formatter.section("Commands"):
            formatter.write_dl([(name, told) for name, (_, _, told) in sorted(_COMMANDS.items())])


@click.group(cls=_Lazy, context_settings={"help_option_names": ["-h", "--help"]})
def bench() -> None:
    """4DBuildBench: score the .blend files of any system by the data that Blender reads from them."""
