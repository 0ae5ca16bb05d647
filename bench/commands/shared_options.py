"""Options and helpers that several ``simworlds bench`` commands share."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from simworlds.terminal import options
from simworlds.terminal.finite_range import FiniteRange

if TYPE_CHECKING:
    from bench.audit.untrusted_blend import BlenderOptions
    from simworlds.llm.prices import Price

_PATH = click.Path(path_type=Path)
MEMORY = FiniteRange(0.25, 4096)  # GiB: with less, Blender does not start


with_blender_version = options.combine(options.VERSION, options.EXECUTABLE)
with_audit_options = options.combine(
    click.option(
        "--read",
        type=_PATH,
        multiple=True,
        help="A further folder that Blender may read, e.g. of linked files.",
    ),
    click.option(
        "--seconds",
        type=FiniteRange(1, 86_400),
        default=120.0,
        show_default=True,
        help="Time limit for auditing one file.",
    ),
    click.option(
        "--memory",
        type=MEMORY,
        default=4.0,
        show_default=True,
        help="Memory limit for Blender (GiB).",
    ),
    with_blender_version,
)


def blender_options(given: dict[str, Any]) -> BlenderOptions:
    """The values of ``with_audit_options``."""
    from bench.audit.untrusted_blend import GIB, BlenderOptions  # noqa: PLC0415 - not for --help

    return BlenderOptions(
        given["blender"],
        given["blender_exe"],
        given["seconds"],
        int(given["memory"] * GIB),
        tuple(folder.expanduser().resolve() for folder in given["read"]),
    )


def price_of(text: str | None) -> Price | None:
    """The value of ``--price``. Raises UsageError."""
    from simworlds.llm.prices import read_price  # noqa: PLC0415 - not for --help

    try:
        return None if text is None else read_price(text)
    except ValueError as error:
        raise click.UsageError(str(error)) from error


def judge_cache(given: Path | None) -> Path:
    """The folder of the judge's cached answers: the given one, or SimWorlds' own."""
    from simworlds.settings import cache_folder, home_folder  # noqa: PLC0415 - not for --help

    return given or cache_folder(home_folder()) / "judge"


def tell_on_terminal(doing: object) -> None:
    """Prints progress on a terminal; elsewhere nothing, for what takes seconds only."""
    if sys.stderr.isatty():
        click.echo(f"{doing} …", err=True)
