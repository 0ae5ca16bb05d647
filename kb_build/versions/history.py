"""The history of the API: which identifier exists in which Blender version.

The file is a table, CSV in gzip. Its columns: ``path``; ``items_of``, the shared enumeration whose items a property or
parameter has (they are then not listed again); and one for each version, 1 where it has the symbol.
"""

from __future__ import annotations

import csv
import gzip
import io
import re
import zlib
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from kb_build.errors import StoreError
from simworlds.errors import UserError
from simworlds.releases import minor_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kb_build.blender.extract_reader import Extract

HISTORY_FILE = Path(__file__).resolve().parents[2] / "corpora" / "history" / "api.csv.gz"
COLUMNS = ["path", "items_of"]  # and one for each version
_PATH = re.compile(r'(.*)\.(inputs|outputs)\["(.*)"\]|(.*)\(([^()]*)\)', re.DOTALL)
_SHARED = "rna_enum_"


def version_key(version: str) -> tuple[int, ...]:
    """For sorting versions as numbers."""
    return tuple(int(part) for part in version.split("."))


def history_paths(extract: Extract) -> Iterator[str]:
    """The identifiers of one Blender: its symbols, their parameters and enum items.

    What every class repeats from its base (the reference lists it on each) is as old as the class: left out.
    """
    for symbol in extract.symbols:
        if any(flag.startswith("same-as:") for flag in symbol.flags) or ".bl_rna_get_subclass" in symbol.path:
            continue
        yield symbol.path
        for item in symbol.enum_items:
            yield f"{symbol.path}:{item.identifier}"
        for parameter in symbol.parameters:
            path = f"{symbol.path}({parameter.name})"
            yield path
            for item in parameter.enum_items:
                yield f"{path}:{item.identifier}"


def split_path(path: str) -> tuple[str, str, str]:
    """Splits a path into (path above, mark, name). Marks: ``.`` member, ``(`` parameter, ``:`` enum item, ``<`` input
    and ``>`` output of a node. Enum items follow the last ``:`` of a path.
    """
    if match := _PATH.fullmatch(path):
        if match[2]:
            return match[1], "<" if match[2] == "inputs" else ">", match[3]
        return match[4], "(", match[5]
    above, colon, item = path.partition(":")
    if colon and not above.endswith('"]') and '["' in above:
        # A colon inside a socket's name.
        above, colon, item = path.rpartition('"]:')
        return f'{above}"]', ":", item
    if colon:
        return above, ":", item
    above, _, name = path.rpartition(".")
    return above, ".", name


def _runs(mask: int) -> Iterator[tuple[int, int]]:
    """(first, last) of each unbroken run of set bits."""
    position = 0
    while mask >> position:
        if not mask >> position & 1:
            position += 1
            continue
        first = position
        while mask >> position & 1:
            position += 1
        yield first, position - 1


@dataclass(slots=True)
class ApiHistory:
    """The known versions (minor ones, oldest first) and what existed in which.

    ``patches`` are the full versions that were looked at, in the same order. ``masks`` hold one bit a
    version, lowest the oldest; ``shared`` names the enumeration whose items a property or parameter has.
    """

    versions: tuple[str, ...]
    patches: tuple[str, ...]
    masks: dict[str, int]
    shared: dict[str, str] = field(default_factory=dict[str, str])

    @classmethod
    def of(cls, paths: Mapping[str, Iterable[str]]) -> ApiHistory:
        """The history of these full versions and their paths (see :func:`history_paths`)."""
        patches = tuple(sorted(paths, key=version_key))
        masks: defaultdict[str, int] = defaultdict(int)
        for number, version in enumerate(patches):
            for path in paths[version]:
                masks[path] |= 1 << number
        _fill_unbuilt(masks, len(patches))
        plain = dict(masks)
        return cls(tuple(map(minor_of, patches)), patches, *_share(plain))

    @classmethod
    def load(cls, path: Path | None = None) -> ApiHistory:
        """The history in a file; by default the one that comes with the package. Raises StoreError."""
        source = path or HISTORY_FILE
        try:
            return cls.from_bytes(source.read_bytes())
        except (OSError, EOFError, zlib.error, csv.Error, ValueError, UserError) as error:
            raise StoreError(
                f"{source} is not a readable history ({error}); make it again: simworlds kb history"
            ) from error

    def including(self, version: str, paths: Iterable[str]) -> ApiHistory:
        """This history, and where it does not know the version, with that full version's paths added."""
        if self._number(version) is not None:
            return self
        known = {patch: set(self.paths(patch)) for patch in self.patches}
        return ApiHistory.of({**known, version: paths})

    def mask(self, path: str) -> int:
        """One bit a version, lowest the oldest; 0 for what no known version has."""
        mask = self.masks.get(path)
        if mask is not None or ":" not in path:
            return mask or 0
        above, _, item = split_path(path)
        enumeration = self.shared.get(above)
        return self.masks[above] & self.masks.get(f"{enumeration}:{item}", 0) if enumeration else 0

    def exists(self, path: str, version: str) -> bool | None:
        """Whether a version (minor or full) has the symbol; None for a version that is not known."""
        number = self._number(version)
        return None if number is None else bool(self.mask(path) >> number & 1)

    def span(self, path: str) -> tuple[str, str] | None:
        """The first and the last known version that have the symbol; None when none has."""
        runs = list(_runs(self.mask(path)))
        return (self.versions[runs[0][0]], self.versions[runs[-1][1]]) if runs else None

    def paths(self, version: str) -> Iterator[str]:
        """Everything that a version has, the items of shared enumerations included."""
        number = self._number(version)
        if number is None:
            return
        yield from (path for path, mask in self.symbols() if mask >> number & 1)

    def removed_from(self, version: str) -> Iterator[tuple[str, str, str]]:
        """(path, first, last) of what other versions have and this one lacks: gone, or not there yet.

        The span is the latest one before ``version``, or else the earliest one behind it.
        """
        number = self._number(version)
        if number is None:
            return
        for path, mask in self.symbols():
            if not mask >> number & 1:
                before = mask & ((1 << number) - 1)
                first, last = list(_runs(before))[-1] if before else next(_runs(mask))
                yield path, self.versions[first], self.versions[last]

    def symbols(self) -> Iterator[tuple[str, int]]:
        """(path, mask) of everything, the items of shared enumerations at each of their places included."""
        yield from self.masks.items()
        items: defaultdict[str, list[tuple[str, int]]] = defaultdict(list)
        for path, mask in self.masks.items():
            if path.startswith(_SHARED) and ":" in path:
                name, _, item = path.partition(":")
                items[name].append((item, mask))
        for path, enumeration in self.shared.items():
            own = self.masks[path]
            yield from ((f"{path}:{item}", mask & own) for item, mask in items[enumeration] if mask & own)

    def since(self, version: str) -> dict[str, str]:
        """What the version has → since which one without a gap; only where that is not the oldest known."""
        number = self._number(version)
        if number is None:
            return {}
        full = (2 << number) - 1
        since: dict[str, str] = {}
        for path, mask in self.symbols():
            if mask >> number & 1 and mask & full != full:
                first = next(first for first, last in _runs(mask) if last >= number)
                since[path] = self.versions[first]
        return since

    def to_bytes(self) -> bytes:
        """The file's content. Equal histories give equal bytes (with one release of zlib)."""
        text = io.StringIO(newline="")
        table = csv.writer(text, lineterminator="\n")
        table.writerow((*COLUMNS, *self.patches))
        for path, mask in sorted(self.masks.items()):
            cells = (mask >> number & 1 for number in range(len(self.patches)))
            table.writerow((path, self.shared.get(path, ""), *cells))
        return gzip.compress(text.getvalue().encode(), mtime=0)

    @classmethod
    def from_bytes(cls, data: bytes) -> ApiHistory:
        """The inverse of :meth:`to_bytes`. Raises OSError, EOFError, zlib.error, csv.Error, ValueError or UserError."""
        table = csv.reader(io.StringIO(gzip.decompress(data).decode(), newline=""))
        head = next(table, [])
        patches = tuple(head[len(COLUMNS) :])
        if head[: len(COLUMNS)] != COLUMNS or not patches or [*patches] != sorted(patches, key=version_key):
            raise ValueError(
                f"its columns are {', '.join(head)[:60]!r}, not {', '.join(COLUMNS)} and versions"
            )
        masks: dict[str, int] = {}
        shared: dict[str, str] = {}
        by_cells: dict[str, int] = {}
        for row in table:
            cells = "".join(row[len(COLUMNS) :])
            if cells not in by_cells:
                if len(row) != len(head):
                    raise ValueError(f"line {table.line_num} has {len(row)} cells, not {len(head)}")
                by_cells[cells] = int(cells[::-1], 2)
            masks[row[0]] = by_cells[cells]
            if row[1]:
                shared[row[0]] = row[1]
        return cls(tuple(map(minor_of, patches)), patches, masks, shared)

    def _number(self, version: str) -> int | None:
        minor = minor_of(version)
        return self.versions.index(minor) if minor in self.versions else None


def _fill_unbuilt(masks: dict[str, int], count: int) -> None:
    """A whole module missing between two versions that have it was left out of that build, not of Blender."""
    for root in [path for path in masks if "." not in path and not path.startswith(_SHARED)]:
        for number in range(1, count - 1):
            bit = 1 << number
            around = bit >> 1, masks[root] >> (number + 1)
            if not masks[root] & bit and masks[root] & around[0] and around[1]:
                for path, mask in masks.items():
                    if (path == root or path.startswith(f"{root}.")) and mask & around[0] and mask > bit:
                        masks[path] = mask | bit


def _share(masks: dict[str, int]) -> tuple[dict[str, int], dict[str, str]]:
    """Takes out the items of properties and parameters that have those of a shared enumeration."""
    items: defaultdict[str, dict[str, int]] = defaultdict(dict)
    for path, mask in masks.items():
        above, mark, name = split_path(path)
        if mark == ":":
            items[above][name] = mask
    by_names: defaultdict[frozenset[str], list[str]] = defaultdict(list)
    holders: defaultdict[str, list[str]] = defaultdict(list)
    for name in sorted(path for path in items if path.startswith(_SHARED)):
        for item in items[name]:
            holders[item].append(name)
        by_names[frozenset(items[name])].append(name)
    shared: dict[str, str] = {}
    for path, own in items.items():
        if path.startswith(_SHARED):
            continue
        rarest = min((holders.get(item, []) for item in own), key=len)
        for name in rarest:
            if {item: mask & masks[path] for item, mask in items[name].items() if mask & masks[path]} == own:
                shared[path] = name
                break
    dropped = {f"{path}:{item}" for path in shared for item in items[path]}
    return {path: mask for path, mask in masks.items() if path not in dropped}, shared
