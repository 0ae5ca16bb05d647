"""Which socket stands at which place of a node, in which Blender: a script that asks by index gets another one where
Blender has put a socket before it.

The file is a table. Its columns: ``node``, ``side``, ``place``, and one for each version, with the name of the socket
there; empty where there is none. It has the nodes whose places differ between versions, and all their places.
"""

from __future__ import annotations

import csv
import io
import re
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from kb_build.errors import StoreError
from kb_build.symbols.api_names import SIDES
from simworlds.releases import minor_of, version_key

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kb_build.symbols.records import Symbol

PLACES_FILE = Path(__file__).resolve().parents[2] / "corpora" / "history" / "socket_places.csv"
_COLUMNS = ["node", "side", "place"]
_BY_PLACE = re.compile(rf"({'|'.join(SIDES)})\[(\d+)\]")

# (class of a node, side) → the names of the sockets there, in order; empty for what cannot be asked for by its place.
Places = dict[tuple[str, str], list[str]]


def places_of(symbols: Iterable[Symbol]) -> Places:
    """Where the sockets of one Blender's nodes stand."""
    found: defaultdict[tuple[str, str], dict[int, str]] = defaultdict(dict)
    for symbol in symbols:
        for subscript in symbol.subscripts if symbol.kind == "socket" else ():
            if match := _BY_PLACE.fullmatch(subscript):
                found[symbol.owner, match[1]][int(match[2])] = symbol.label
    return {key: [names.get(at, "") for at in range(max(names) + 1)] for key, names in found.items()}


@dataclass(frozen=True, slots=True)
class SocketPlaces:
    """The places of several versions: full version → its places."""

    versions: Mapping[str, Places]

    def before(self, version: str) -> tuple[str, ...]:
        """The known versions, as ``4.2``, before one; oldest first."""
        return tuple(
            minor_of(known)
            for known in sorted(self.versions, key=version_key)
            if version_key(minor_of(known)) < version_key(minor_of(version))
        )

    def names(self, version: str, node: str, side: str) -> list[str] | None:
        """The names of a node's sockets in a minor version; None where that is not known, or has not changed."""
        places = next((rows for known, rows in self.versions.items() if minor_of(known) == version), {})
        return places.get((node, side))

    def to_text(self) -> str:
        """The file's content."""
        text = io.StringIO(newline="")
        table = csv.writer(text, lineterminator="\n")
        versions = sorted(self.versions, key=version_key)
        table.writerow((*_COLUMNS, *versions))
        nodes = {key for places in self.versions.values() for key in places}
        for node, side in sorted(nodes):
            columns = [self.versions[version].get((node, side), []) for version in versions]
            if len({tuple(column) for column in columns if column}) < 2:
                continue
            for place in range(max(map(len, columns))):
                cells = [column[place] if place < len(column) else "" for column in columns]
                table.writerow((node, side, place, *cells))
        return text.getvalue()

    @classmethod
    def from_text(cls, text: str) -> SocketPlaces:
        """The inverse of :meth:`to_text`, as far as the file has it. Raises ValueError."""
        head, *rows = csv.reader(io.StringIO(text, newline=""))
        count = len(_COLUMNS)
        if head[:count] != _COLUMNS or any(len(row) != len(head) for row in rows):
            raise ValueError(
                f"its columns are {', '.join(head)[:60]}, not {', '.join(_COLUMNS)} and versions"
            )
        found: dict[str, Places] = {version: {} for version in head[count:]}
        for node, side, _, *cells in rows:
            for version, name in zip(found, cells, strict=True):
                found[version].setdefault((node, side), []).append(name)
        return cls(found)

    @classmethod
    def load(cls, path: Path | None = None) -> SocketPlaces:
        """The places in a file; by default the one that comes with the package. Raises StoreError."""
        source = path or PLACES_FILE
        try:
            return cls.from_text(source.read_text(encoding="utf-8"))
        except (OSError, ValueError, csv.Error) as error:
            raise StoreError(
                f"{source} has no readable places of sockets ({error}); make it again: simworlds kb history"
            ) from error
