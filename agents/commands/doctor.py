"""The command ``simworlds doctor``: tries what works on this machine."""

from __future__ import annotations

import json
import sys
from contextlib import closing
from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from simworlds.terminal import options

if TYPE_CHECKING:
    from pathlib import Path

    from rich.console import Group
    from rich.text import Text

    from agents.commands.doctor_checks import BlenderChoice, DoctorResult, State
    from simworlds.sandbox.confinement.confined_command import Kind
    from simworlds.terminal.console import Console

_NEEDED = ("Blender", "Start", "Sandbox")  # without these Blender cannot work, or must not
_SIGNS: dict[State, tuple[str, str]] = {"good": ("✓", "green"), "poor": ("!", "yellow"), "bad": ("✗", "red")}


@click.command()
@options.VERSION
@options.EXECUTABLE
@options.SANDBOX
@click.option("--install", is_flag=True, help="Install Blender (about 350 MB) if there is none.")
@click.option("--json", "as_json", is_flag=True, help="Print all results as JSON.")
def doctor(
    *, blender: str | None, blender_exe: Path | None, sandbox: Kind | None, install: bool, as_json: bool
) -> None:
    """Test what a live Blender needs on this machine, and report what is missing. Nothing is installed unasked.

    Exits with 0 if Blender can work here, otherwise with 1.
    """
    if sys.platform == "win32":
        raise click.ClickException("A live Blender needs Linux or macOS. On Windows, use the Linux of WSL.")
    from agents.commands.doctor_checks import BlenderChoice  # noqa: PLC0415
    from simworlds.terminal.console import Console  # noqa: PLC0415 - not for --help

    results = _run_checks(BlenderChoice(blender, blender_exe, sandbox, install), Console(sys.stderr))
    well = all(result.state != "bad" for result in results if result.name in _NEEDED)
    if as_json:
        data = {"works": well, "findings": [asdict(result) for result in results]}
        click.echo(json.dumps(data, indent=2, ensure_ascii=False))
    else:
        Console(sys.stdout).print(_page(results, well))
    sys.exit(0 if well else 1)


def _run_checks(choice: BlenderChoice, console: Console) -> list[DoctorResult]:
    """The result of each check; on a terminal, what is being done is shown meanwhile."""
    from rich.text import Text  # noqa: PLC0415 - not for --help

    from agents.commands.doctor_checks import checks  # noqa: PLC0415 - not for --help

    results: list[DoctorResult] = []
    with console.status("") as status, closing(checks(choice)) as each:
        for doing, check in each:
            status.update(Text(f"{doing} …", "dim"))
            results.append(check())
    return results


def _page(results: list[DoctorResult], well: bool) -> Group:
    from rich.console import Group  # noqa: PLC0415 - not for --json
    from rich.table import Table  # noqa: PLC0415 - not for --json
    from rich.text import Text  # noqa: PLC0415

    page = Table.grid(padding=(0, 2, 0, 0))
    page.add_column(no_wrap=True)
    page.add_column(no_wrap=True)
    page.add_column(overflow="fold")
    for result in results:
        sign, colour = _SIGNS[result.state]
        page.add_row(Text(sign, colour), Text(result.name, "bold"), Text(result.text))
        below = Table.grid(padding=(0, 1, 0, 0))
        if result.place:
            page.add_row("", "", Text(result.place, "dim"))
        for line in result.keeps:
            below.add_row(Text("+", "green"), Text(line, "dim"))
        for line in result.lacks:
            below.add_row(Text("-", "yellow"), Text(f"does not prevent: {line}"))
        if result.advice:
            below.add_row(Text("→", "bold cyan"), Text(result.advice, "cyan"))
        if below.row_count:
            page.add_row("", "", below)
    return Group(page, "", _verdict([result.name for result in results if result.state == "poor"], well), "")


def _verdict(poor: list[str], well: bool) -> Text:
    from rich.text import Text  # noqa: PLC0415 - not for --json

    if not well:
        return Text("✗  Blender cannot work here.", "bold red")
    without = f", but check: {', '.join(poor)}" if poor else ""
    return Text(f"✓  Blender can work here{without}.", "bold green")
