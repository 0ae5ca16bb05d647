"""Paths of code, as commands take them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from click import Context, Parameter


class CodePath(click.Path):
    """A file or a folder, or - for standard input. An empty text is refused: ``Path("")`` is the current folder."""

    def __init__(self) -> None:
        super().__init__(path_type=Path, allow_dash=True)

    def convert(self, value: Any, param: Parameter | None, ctx: Context | None) -> Any:
        """See click."""
        if value == "":
            self.fail("It is empty. Give a file or a folder; . is the current one.", param, ctx)
        return super().convert(value, param, ctx)
