"""Checks a list of documented identifiers against a base: which resolve, and why the others do not."""

from __future__ import annotations

import re
import zlib
from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.errors import KBBuildError
from kb_build.index.analysis import key
from kb_build.symbols.api_names import interface_part

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

WANTED = 0.995
"""The share of a reference's identifiers that must resolve exactly."""

_INVENTORY = b"# Sphinx inventory version 2"
_ENTRY = re.compile(r"(?P<name>.+?)\s+(?P<domain>\w+):(?P<role>\S+)\s+-?\d+\s+\S*\s+.*")
_IDENTIFIER = re.compile(r"[A-Za-z_]\w*(\.\w+)*")


@dataclass(frozen=True, slots=True)
class ReferenceResolution:
    """How many identifiers of a reference resolve: ``exact`` of ``total``; the others by reason."""

    total: int
    exact: int
    others: Mapping[str, tuple[str, ...]]

    @property
    def share(self) -> float:
        """The share that resolves exactly; 1 for an empty list."""
        return self.exact / self.total if self.total else 1.0


def read_reference(path: Path) -> list[str]:
    """The identifiers in a Sphinx ``objects.inv`` (its Python domain), or in a text file, one on each line.

    In a text file, blank lines and those that begin with ``#`` are passed over. Raises KBBuildError when the
    file is neither.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise KBBuildError(f"{path} cannot be read: {error}") from error
    try:
        identifiers = list(_inventory(data) if data.startswith(_INVENTORY) else _lines(data))
    except (UnicodeDecodeError, zlib.error, ValueError) as error:
        raise KBBuildError(
            f"{path} is neither a Sphinx inventory nor a list with one identifier on each line: {error}"
        ) from error
    return list(dict.fromkeys(identifiers))


def _inventory(data: bytes) -> Iterator[str]:
    head = data.split(b"\n", 4)
    if len(head) < 5:
        raise ValueError("the inventory is cut off")
    for line in zlib.decompress(head[4]).decode().splitlines():
        entry = _ENTRY.fullmatch(line.rstrip())
        if entry and entry["domain"] == "py":
            yield entry["name"]


def _lines(data: bytes) -> Iterator[str]:
    for number, line in enumerate(data.decode("utf-8-sig").splitlines(), start=1):
        text = line.strip()
        if not text or text.startswith("#"):
            continue
        if not _IDENTIFIER.fullmatch(text):
            raise ValueError(f"line {number} is {text[:60]!r}")
        yield text


def resolve(identifiers: Iterable[str], bases: Mapping[str, str]) -> ReferenceResolution:
    """Looks every identifier up in ``bases``: path → the path of its base class, for all symbols."""
    spelled: dict[str, list[str]] = defaultdict(list)
    for path in bases:
        spelled[key(path)].append(path)
    exact, total = 0, 0
    others: dict[str, list[str]] = defaultdict(list)
    for identifier in identifiers:
        total += 1
        if identifier in bases:
            exact += 1
        else:
            reason, instead = _explain(identifier, bases, spelled)
            others[reason].append(f"{identifier} → {instead}" if instead else identifier)
    return ReferenceResolution(total, exact, {reason: tuple(rows) for reason, rows in sorted(others.items())})


def _explain(identifier: str, bases: Mapping[str, str], spelled: Mapping[str, list[str]]) -> tuple[str, str]:
    """(why an identifier is not there, what is there instead)."""
    owner, _, name = identifier.rpartition(".")
    if (ancestor := _inherited(owner, name, bases)) is not None:
        return "inherited: the base class has it", ancestor
    if owner in bases and owner.rpartition(".")[2] == name:
        return "alias: the reference repeats the owner's name", owner
    if same := spelled.get(key(identifier)):
        return "alias: spelled in another way", same[0]
    if any(map(interface_part, identifier.split("."))):
        return "interface: its class is not registered in this Blender", ""
    if owner in bases:
        return "removed or added: the owner is there, the name is not", owner
    return "removed or absent: neither the name nor its owner is there", ""


def _inherited(owner: str, name: str, bases: Mapping[str, str]) -> str | None:
    seen: set[str] = set()
    while (owner := bases.get(owner, "")) and owner not in seen:
        seen.add(owner)
        if f"{owner}.{name}" in bases:
            return f"{owner}.{name}"
    return None
