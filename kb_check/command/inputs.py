"""What the command is to check: files and folders that are named, and standard input."""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kb_check.command.files import find_files
from kb_check.command.project import LoadedFile
from kb_check.command.run import load
from kb_check.text.source import MOST_BYTES

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from kb_check.command.configuration import Configuration
    from kb_check.command.project import Group

_STDIN_NAME = "<stdin>"


@dataclass(slots=True)
class Inputs:
    """The files, read, with sentences about what could not be read and about what the configuration leaves out.

    ``typed`` is what standard input gave, if it was read: the content of a file of these.
    """

    groups: list[Group]
    faults: list[str]
    left_out: list[str] = field(default_factory=list)
    typed: bytes | None = None


def read_inputs(
    paths: Sequence[Path],
    configuration: Configuration,
    *,
    reads_stdin: bool = False,
    stdin_name: Path | None = None,
    gitignore: bool = True,
) -> Inputs:
    """Reads the files at and below paths, and standard input, which is checked as the file ``stdin_name`` if that is
    given.
    """
    faults: list[str] = []
    typed = _typed(faults) if reads_stdin else None
    given = {stdin_name: typed} if stdin_name and typed is not None else {}
    named = [*given, *paths]
    found = find_files(named, configuration.exclude, configuration.folder, gitignore=gitignore, unsaved=given)
    faults += found.faults
    groups = load(found.groups, faults, given)
    if typed is not None and not given:
        groups.append((LoadedFile(_STDIN_NAME, typed),))
    left_out = [f"{path} was left out: {configuration.file} excludes it." for path in found.excluded]
    return Inputs(groups, faults, left_out, typed)


def _typed(faults: list[str]) -> bytes | None:
    data = sys.stdin.buffer.read(MOST_BYTES + 1)
    if len(data) <= MOST_BYTES:
        return data
    faults.append(f"Standard input is larger than {MOST_BYTES >> 20} MiB.")
    return None
