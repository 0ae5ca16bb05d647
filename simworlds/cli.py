"""The command ``simworlds``. It loads only the subcommand that is called, so that look-ups start at once."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from difflib import get_close_matches
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from simworlds.errors import NO_ROOM, OF_PATHS
from simworlds.terminal.streams import discard_output, guard_streams

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

_FAILED, _INTERRUPTED = 2, 130
# Numpy starts a thread for each core to multiply matrices with; that takes longer than the rest of loading it.
_MATRIX_THREADS = "OPENBLAS_NUM_THREADS"
_MULTIPLYING = frozenset({"bench"})  # commands that multiply large ones
_COMPLETION = "_SIMWORLDS_COMPLETE"  # a shell sets it when it asks for completions


class _Command(NamedTuple):
    module: str
    attribute: str
    help: str


_COMMANDS = {
    "bench": _Command("bench.commands.bench", "bench", "Score scenes of any system: 4DBuildBench."),
    "check": _Command("kb_check.command.cli", "check", "Check Python code against Blender's API, unrun."),
    "demo": _Command("agents.commands.runs", "demo", "Play a transcript in a real Blender; no key needed."),
    "docs": _Command("kb_serve.cli", "docs", "Query the knowledge base."),
    "doctor": _Command("agents.commands.doctor", "doctor", "Check whether a live Blender can run here."),
    "edit": _Command(
        "agents.commands.runs", "edit", "Edit a scene as described, and leave the rest unchanged."
    ),
    "extension": _Command(
        "agents.commands.extension", "extension", "Build or install the extension for an open Blender."
    ),
    "kb": _Command("kb_build.cli", "kb", "Build, inspect, check and compare knowledge bases."),
    "make": _Command("agents.commands.runs", "make", "Make a scene from a sentence."),
    "mcp": _Command("agents.commands.mcp", "mcp", "Serve a live Blender and its documentation over MCP."),
    "replay": _Command("agents.commands.runs", "replay", "Replay a run's recorded answers as a new run."),
    "migrate": _Command(
        "kb_check.migrate.cli", "migrate", "Rewrite scripts and add-ons for another Blender."
    ),
    "resume": _Command("agents.commands.runs", "resume", "Continue a run."),
    "runs": _Command("agents.commands.runs", "runs", "List the runs."),
    "serve": _Command("kb_serve.cli", "serve", "Serve blender_docs and blender_check over MCP."),
    "show": _Command("agents.commands.runs", "show", "Show the state of a run."),
    "stubs": _Command("kb_check.stubs.cli", "stubs", "Write typed stubs for type checkers and editors."),
    "verify": _Command(
        "agents.commands.verify", "verify", "Check a .blend by the scene protocol and a plan."
    ),
}


class _Lazy(click.Group):
    """A group that loads only the command that is called, and guards what it prints.

    What may end any command is told here: Ctrl-C (what a KeyboardInterrupt says of files is told with it), a full disk,
    a path that cannot be used.
    """

    def main(self, *args: Any, **options: Any) -> Any:
        """See click."""
        if not os.environ.get(_COMPLETION):  # which is printed as bytes; nothing in it is anybody else's text
            guard_streams()
        try:
            try:
                return super().main(*args, complete_var=_COMPLETION, **options)
            finally:
                with suppress(BrokenPipeError):
                    sys.stdout.flush()  # what print has kept until now
        except OSError as error:
            if error.errno in OF_PATHS and error.filename is not None:
                click.echo(f"Error: {error.filename} cannot be used: {error.strerror}.", err=True)
                sys.exit(_FAILED)
            if error.errno not in NO_ROOM:
                raise
            with suppress(OSError):
                click.echo(
                    f"Error: {error.filename or 'The output'} cannot be written: {error.strerror}.", err=True
                )
            discard_output()
            sys.exit(_FAILED)

    def invoke(self, ctx: click.Context) -> Any:
        """See click."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as interrupt:
            click.echo(" ".join(["Interrupted.", *map(str, interrupt.args)]), err=True)
            ctx.exit(_INTERRUPTED)
        except (ImportError, AttributeError) as error:  # of what a system lacks
            if _should_work(ctx.invoked_subcommand or ""):
                raise
            raise _NeedsBlender(
                "This command needs a live Blender, which does not run on this system. Run it in WSL. What needs no "
                "Blender works here: docs, serve, check, migrate, stubs, kb fetch."
            ) from error

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
        if cmd_name not in _MULTIPLYING:
            os.environ.setdefault(_MATRIX_THREADS, "1")
        command = getattr(import_module(entry.module), entry.attribute)
        assert isinstance(command, click.Command)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """See click. Names that are near to one that does not exist are told, as click does for options."""
        unknown = self.get_command(ctx, args[0]) is None and not ctx.resilient_parsing
        if unknown and (near := get_close_matches(args[0], _COMMANDS)):
            ctx.fail(f"No such command {args[0]!r}. Did you mean {' or '.join(map(repr, near))}?")
        return super().resolve_command(ctx, args)

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        """Completes names without loading the commands."""
        from click.shell_completion import CompletionItem  # noqa: PLC0415 - for a shell alone

        named = [
            CompletionItem(name, help=entry.help)
            for name, entry in sorted(_COMMANDS.items())
            if name.startswith(incomplete)
        ]
        return [*named, *click.Command.shell_complete(self, ctx, incomplete)]

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Lists them without loading any."""
        del ctx
        with formatter.section("Commands"):
            formatter.write_dl([(name, entry.help) for name, entry in sorted(_COMMANDS.items())])


def _should_work(name: str) -> bool:
    """Whether a command is to work on this system: those of ``agents`` and ``bench`` need a live Blender."""
    from simworlds.operating_system import SYSTEM  # noqa: PLC0415 - seldom

    return SYSTEM.limits_processes or _COMMANDS[name].module.partition(".")[0] not in {"agents", "bench"}


class _NeedsBlender(click.ClickException):
    exit_code = 2


@click.group(cls=_Lazy, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(None, "-V", "--version", package_name="simworlds", prog_name="simworlds")
def main() -> None:
    """From a sentence to a simulated scene: with a knowledge base, a live Blender and a verifier."""
