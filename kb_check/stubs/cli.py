"""The command ``simworlds stubs``."""

from __future__ import annotations

import sys
from contextlib import closing
from pathlib import Path

import click

from simworlds.errors import UserError

_ERROR = 2
_MEGABYTE = 1_000_000
_MOST_NAMED = 5


@click.command()
@click.argument("version", required=False)
@click.option(
    "--out", type=click.Path(path_type=Path, file_okay=False), required=True, help="Folder to write into."
)
@click.option(
    "--base",
    type=click.Path(path_type=Path, dir_okay=False),
    help="The file of a base, instead of a VERSION.",
)
@click.option("--docs", "with_docs", is_flag=True, help="Add a sentence about each name.")
@click.option("--wheel", is_flag=True, help="Write a wheel, to install or to publish.")
def stubs(*, version: str | None, out: Path, base: Path | None, with_docs: bool, wheel: bool) -> None:
    """Write typed stubs of Blender's Python API, for pyright, mypy and editors.

    VERSION is that of a knowledge base, by default that of the Blender in use. Exit code: 0, or 2 on errors.
    """
    if version and base:
        raise click.UsageError("VERSION and --base exclude each other.")
    from kb_check.stubs.package import write_folder, write_wheel  # noqa: PLC0415 - not for --help
    from kb_serve.in_use import tell_of_other  # noqa: PLC0415 - likewise
    from simworlds.terminal.progress import shown_progress  # noqa: PLC0415 - likewise

    try:
        source = base or _base(version)
        with shown_progress(in_logs=False) as progress:
            progress("Writing stubs", 0, None)
            if wheel:
                target, written = write_wheel(source, out, with_docs=with_docs)
            else:
                target, written = out, write_folder(source, out, with_docs=with_docs)
    except UserError as error:
        click.echo(f"Error: {error}", err=True)
        sys.exit(_ERROR)
    except OSError as error:
        click.echo(f"Error: {error.filename or out} cannot be written: {error.strerror or error}.", err=True)
        sys.exit(_ERROR)
    if not (version or base):
        tell_of_other(written.blender)
    click.echo(
        f"{target}: Blender {written.blender}, {written.files} files, {written.size / _MEGABYTE:.1f} MB"
    )
    if written.left_out:
        named = ", ".join(written.left_out[:_MOST_NAMED])
        more = len(written.left_out) - _MOST_NAMED
        click.echo(
            f"Left out, as Python cannot spell them: {named}" + (f" and {more} more" if more > 0 else "")
        )


def _base(version: str | None) -> Path:
    from kb_serve.bases import Bases  # noqa: PLC0415 - not for --help
    from simworlds.settings import home_folder  # noqa: PLC0415 - likewise

    with closing(Bases(home_folder(), default=version)) as bases:
        return bases.file()
