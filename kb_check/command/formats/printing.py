"""Prints what was found, in the form that is asked for; only that form is loaded."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from typing import TextIO

    from kb_check.command.report import Report


def print_report(report: Report, form: str | None, stream: TextIO) -> None:
    """Prints a report on a stream: ``json``, ``sarif``, ``github``, or else text, with colours on a terminal."""
    if form == "json":
        from kb_check.command.formats.json_document import as_json  # noqa: PLC0415 - one of them is used

        click.echo(as_json(report), stream)
    elif form == "sarif":
        from kb_check.command.formats.sarif import as_sarif  # noqa: PLC0415

        click.echo(as_sarif(report), stream)
    elif form == "github":
        from kb_check.command.formats.github import github_lines  # noqa: PLC0415

        for line in github_lines(report):
            click.echo(line, stream)
    else:
        _print_text(report, stream)


def _print_text(report: Report, stream: TextIO) -> None:
    from kb_check.command.formats.text import text_lines  # noqa: PLC0415 - not for --json

    if not stream.isatty():
        for line in text_lines(report):
            click.echo("".join(text for text, _ in line), stream)
        return
    from rich.text import Text  # noqa: PLC0415 - only for a terminal

    from simworlds.terminal.console import Console  # noqa: PLC0415

    console = Console(stream)
    for line in text_lines(report):
        console.print(Text.assemble(*line), soft_wrap=True)
