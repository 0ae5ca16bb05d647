"""Applies the fixes of findings to text and to files."""

from __future__ import annotations

import difflib
import io
import os
import re
import shutil
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from kb_check.text.edits import Text, apart, largest
from kb_check.text.reading import read_source
from kb_check.text.salvage import is_valid
from simworlds.files import staged_file
from simworlds.terminal.exact import print_exact

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from kb_check.findings import Finding, Fix
    from kb_check.text.source import Source

_CONTROL = re.compile(rb"[\x00-\x1f\x7f]")
_QUOTED = re.compile(rb'[\x00-\x1f\x7f"\\]')


@dataclass(frozen=True, slots=True)
class Fixed:
    """A text after its fixes, and how many there were."""

    text: str
    count: int


def is_fixable(finding: Finding, *, unsafe: bool) -> bool:
    """Whether a finding has a fix that is to be applied: a sure one, or any."""
    return finding.fix is not None and (finding.fix.sure or unsafe)


def apply_fixes(source: Source, findings: Iterable[Finding], *, unsafe: bool = False) -> Fixed:
    """Applies fixes in order; one that overlaps an earlier one is left for the next round.

    One after which the text would not parse is left out. Nothing is changed in a notebook, and in what could not be
    read.
    """
    nothing = Fixed(source.text, 0)
    if source.cells or source.fault:
        return nothing
    fixes = [each.fix for each in findings if each.fix is not None and is_fixable(each, unsafe=unsafe)]
    done = after_fixes(Text.original(source.text), fixes)
    return Fixed(done.text.code, done.count) if done.text.code != source.text else nothing


@dataclass(frozen=True, slots=True)
class FixedText:
    """A text after its fixes, with where its lines came from, and how many there were."""

    text: Text
    count: int


def after_fixes(text: Text, fixes: Iterable[Fix]) -> FixedText:
    """The same of a text, in order, whatever the fixes are."""
    first_line = text.code[: text.code.find("\n") + 1]
    newline = "\r\n" if "\r\n" in first_line else "\n"

    def fixed(some: Sequence[Fix]) -> Text:
        edits = (edit for fix in some for edit in fix.edits)
        return text.edited(replace(edit, text=edit.text.replace("\n", newline)) for edit in edits)

    together = list(apart(text, fixes, lambda fix: fix.edits))
    chosen = largest(together, lambda some: is_valid(fixed(some).code))
    return FixedText(fixed(chosen), len(chosen))


def write_fixed(path: Path, before: bytes, after: bytes) -> None:
    """Writes a file whole, with its permissions. Raises OSError, also when it is not any more what it was."""
    real = path.resolve()
    if not real.is_file():
        raise OSError("it is not a file")
    if real.read_bytes() != before:
        raise OSError(f"{path} was changed meanwhile")
    with staged_file(real) as part:
        part.write_bytes(after)
        shutil.copymode(real, part)


def unified_diff(name: str, before: bytes, after: bytes) -> bytes:
    """The changes of one file, as ``diff -u`` writes them: to the byte, so that they can be applied."""
    shown = _header_name(name)
    # Lines end where patch sees them end.
    old, new = io.BytesIO(before).readlines(), io.BytesIO(after).readlines()
    lines = difflib.diff_bytes(difflib.unified_diff, old, new, shown, shown)
    return b"".join(
        line if line.endswith(b"\n") else line + b"\n\\ No newline at end of file\n" for line in lines
    )


def _header_name(name: str) -> bytes:
    """A file's name as a diff's header has it, so that neither a space nor a new line ends it too soon."""
    data = os.fsencode(name)
    if _CONTROL.search(data):
        escaped = _QUOTED.sub(lambda match: b"\\%03o" % match[0][0], data)
        return b'"%s"' % escaped
    return data + b"\t" if b" " in data else data


def print_diff(name: str, before: bytes, after: bytes) -> None:
    """Prints the changes of one file."""
    print_exact(unified_diff(name, before, after), read_source(before, name).encoding)
