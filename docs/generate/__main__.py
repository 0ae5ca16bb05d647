"""Writes or checks the generated pages: ``python -m docs.generate [--check]``."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from docs.generate.pages import outdated, write

_DOCS = Path(__file__).resolve().parents[1]


@click.command()
@click.option("--check", is_flag=True, help="Write nothing; exit with 1 if a page is out of date.")
@click.option("--folder", type=click.Path(path_type=Path), default=_DOCS, help="The folder of the pages.")
def main(check: bool, folder: Path) -> None:
    """Write the generated pages."""
    if not check:
        write(folder)
    elif names := outdated(folder):
        click.echo(f"Out of date in {folder}: {', '.join(names)}. Run: make docs", err=True)
        sys.exit(1)


if __name__ == "__main__":
    main()
