"""The command ``simworlds kb pack``."""

from __future__ import annotations

import sys
from contextlib import closing
from typing import TYPE_CHECKING

import click

from simworlds.errors import UserError, remedy
from simworlds.terminal.output_file import OutputFile

if TYPE_CHECKING:
    from pathlib import Path

_ERROR = 2


@click.command()
@click.argument("version", required=False)
@click.option(
    "--tokens",
    "budget",
    type=click.IntRange(500, 100_000),
    default=8000,
    show_default=True,
    help="The most that it may have: 2000 for a rules file, 8000 for a project's knowledge, 32000 for a long context.",
)
@click.option(
    "--topic", default="", help="Only what belongs to it: a chapter of the manual, as 'rigid body'."
)
@click.option("--output", type=OutputFile(), help="Write it to this file.")
def pack(version: str | None, budget: int, topic: str, output: Path | None) -> None:
    """Write what a model most needs of one Blender version, for clients without MCP.

    VERSION is that of a base that was built, by default the newest. The pack is Markdown: how the work of the usual
    topics is done, sockets, real defaults, names that are gone with what took their place, the most used members.
    """
    from kb_serve.locate import find_base  # noqa: PLC0415 - not for --help
    from kb_serve.packs.pack import write_pack  # noqa: PLC0415
    from kb_serve.reader import BaseReader  # noqa: PLC0415
    from simworlds.files import write_whole  # noqa: PLC0415

    try:
        with closing(BaseReader(find_base(version))) as reader:
            text = write_pack(reader, budget, topic.strip())
        if output is None:
            click.echo(text, nl=False)
        else:
            write_whole(output, text)
            click.echo(f"{output}: {len(text.encode()):,} bytes, at most {budget:,} tokens.", err=True)
    except OSError as error:
        click.echo(
            f"Error: {output} cannot be written: {error}. {remedy(error)}, or name another file", err=True
        )
        sys.exit(_ERROR)
    except UserError as error:
        click.echo(f"Error: {error}", err=True)
        sys.exit(_ERROR)
