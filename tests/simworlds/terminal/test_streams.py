"""Whatever is printed, logged or raised, and by whichever way: nothing in it steers a terminal."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from typing import TYPE_CHECKING, cast

import click
import pytest
from click.testing import CliRunner
from hostile_text import HOSTILE, on_terminal, steering
from places import REPO
from rich.markdown import Markdown
from rich.table import Table
from rich.text import Text

from simworlds.cli import main
from simworlds.terminal.console import Console
from simworlds.terminal.lines import write_line
from simworlds.terminal.streams import GuardedStream, visible

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import TextIO

_AS_COMMAND = """
import logging, sys, traceback, warnings
import click
from hostile_text import HOSTILE
from simworlds.cli import main

def fail():
    raise RuntimeError(HOSTILE)

def usage():
    raise click.UsageError(HOSTILE)

def trace():
    try:
        fail()
    except RuntimeError:
        traceback.print_exc()

def drawn():
    from rich.text import Text
    from simworlds.terminal.console import Console
    from simworlds.terminal.live_view import LiveView
    class View(LiveView):
        def draw(self):
            return Text(HOSTILE)
    with View(Console(sys.stderr), 4, vanishes=True):
        print(HOSTILE)
        click.echo(HOSTILE, err=True)

WAYS = {
    "print": lambda: print(HOSTILE),
    "echo": lambda: click.echo(HOSTILE),
    "secho": lambda: click.secho(HOSTILE, err=True),
    "write": lambda: sys.stdout.writelines([HOSTILE, HOSTILE]),
    "log": lambda: logging.getLogger("any").warning("Lost: %s", HOSTILE),
    "warn": lambda: warnings.warn(HOSTILE),
    "trace": trace,
    "fail": fail,
    "usage": usage,
    "drawn": drawn,
}
command = click.Command("say", params=[click.Argument(["way"])], callback=lambda way: WAYS[way]())
main.get_command = lambda ctx, name: command
main(prog_name="simworlds")
"""
WAYS = ("print", "echo", "secho", "write", "log", "warn", "trace", "fail", "usage", "drawn")


def environment(**more: str) -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": os.pathsep.join((str(REPO), str(REPO / "tests"))), **more}


@pytest.mark.parametrize("coding", ["utf-8", "ascii"])
@pytest.mark.parametrize("way", WAYS)
def test_no_way_of_printing_gets_around_the_guard(way: str, coding: str) -> None:
    command = [sys.executable, "-c", _AS_COMMAND, "say", way]
    done = subprocess.run(
        command, env=environment(PYTHONIOENCODING=coding), capture_output=True, check=False, timeout=60
    )
    printed = (done.stdout + done.stderr).decode(coding)
    assert "evil" in printed, printed
    assert steering(printed) == []


@pytest.mark.parametrize("way", WAYS)
def test_no_way_of_printing_gets_around_the_guard_on_a_terminal(way: str) -> None:
    printed = on_terminal([sys.executable, "-c", _AS_COMMAND, "say", way], environment())
    assert "evil" in printed
    assert "\\u001b[31;5;7m" in printed  # shown, and not obeyed
    assert steering(printed, is_terminal=True) == []


def leaves(command: click.Command, words: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """The words of every command that is not a group."""
    if not isinstance(command, click.Group):
        yield words
        return
    context = click.Context(command)
    for name in command.list_commands(context):
        below = command.get_command(context, name)
        assert below is not None
        yield from leaves(below, (*words, name))


@pytest.mark.parametrize("words", [*leaves(main)], ids=" ".join)
def test_a_command_answers_hostile_words_without_repeating_them(
    words: tuple[str, ...], tmp_path: os.PathLike[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SIMWORLDS_HOME", str(tmp_path))
    result = CliRunner().invoke(main, [*words, f"--{HOSTILE}"])
    assert result.exit_code == 2
    assert "evil" in result.output
    assert steering(result.output) == []


def test_json_stays_the_same_data() -> None:
    data = {HOSTILE: [HOSTILE, "plain", "\u200b\U0001f44d"]}
    stream = io.StringIO()
    GuardedStream(stream).write(json.dumps(data, ensure_ascii=False, indent=1))
    assert steering(stream.getvalue()) == []
    assert json.loads(stream.getvalue()) == data


def test_harmless_text_is_not_changed() -> None:
    text = "Größe\t▒ 日本語 \u00a0\u200d👩\u200d🚀 עברית\n"
    assert visible(text) == text


def test_a_line_of_progress_is_visible() -> None:
    stream = io.StringIO()
    write_line(stream, HOSTILE)
    assert steering(stream.getvalue()) == []
    assert stream.getvalue().count("\n") == 1


def test_the_console_keeps_its_styles_and_columns_and_nothing_else() -> None:
    stream = io.StringIO()
    console = Console(
        cast("TextIO", GuardedStream(stream)), force_terminal=True, color_system="truecolor", width=80
    )
    table = Table("name", title=HOSTILE)
    table.add_row(HOSTILE)
    console.print(table, Text("bold", "bold"), HOSTILE, Markdown(f"[a page](http://page) {HOSTILE}"))
    with console.status(Text(HOSTILE)):
        pass
    assert "\x1b[1mbold\x1b[0m" in stream.getvalue()
    assert "[/red]" in stream.getvalue()
    assert steering(stream.getvalue(), is_terminal=True) == []
