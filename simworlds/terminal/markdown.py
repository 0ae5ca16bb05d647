"""Prints Markdown: laid out on a terminal, as it is for a file or a pipe."""

from __future__ import annotations

import sys

import click


def print_markdown(text: str) -> None:
    """Prints the text on standard output."""
    if not sys.stdout.isatty():
        click.echo(text)
        return
    from rich.markdown import Markdown  # noqa: PLC0415 - loading it takes as long as a query

    from simworlds.terminal.console import Console  # noqa: PLC0415

    Console(sys.stdout).print(Markdown(text, hyperlinks=False))
