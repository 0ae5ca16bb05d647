"""The type of options that name a file to write."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

import click

from simworlds.settings import expanded


class OutputFile(click.Path):
    """The path of a file in a folder that is there, as a slip of the pen shall make no folders, and that takes files,
    as the work that the file is for may be long.
    """

    def __init__(self) -> None:
        super().__init__(dir_okay=False, path_type=Path)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """See click."""
        path = Path(os.fsdecode(super().convert(value, param, ctx)))
        folder = expanded(path).absolute().parent
        if not folder.is_dir():
            self.fail(f"There is no folder {folder}. Make it first, or name another file.", param, ctx)
        try:
            tempfile.TemporaryFile(dir=folder).close()
        except OSError as error:
            self.fail(f"No file can be written to {folder}: {error.strerror}. Name another one.", param, ctx)
        return path
