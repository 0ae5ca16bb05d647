"""The history of the API: which identifier exists in which Blender version.

The file is a table, CSV in gzip. Its columns: ``path``; ``items_of``, the shared enumeration whose items a property or
parameter has (they are then not listed again); and one for each version: 1 where it has the symbol, 0 where it lacks
it, ? where that is not known. A version of three numbers, 4.2.23, was asked itself; one of two, 2.79, is known from
stubs of its API reference.
"""

from __future__ import annotations

import csv
import gzip
import io
import zlib
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from kb_build.errors import StoreError
from kb_build.symbols.paths import split_path
from simworlds.errors import UserError
from simworlds.releases import minor_of, version_key

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kb_build.blender.extract_reader import Extract
    from kb_build.symbols.records import Symbol

HISTORY_FILE = Path(__file__).resolve().parents[2] / "corpora" / "history" / "api.csv.gz"
COLUMNS = ["path", "items_of"]  # and one for each version
SHARED = "rna_enum_"  # how Blender names enumerations that many properties have
# What everything stands in: no history has it.
TOP = frozenset({"", "bpy.types", "bpy.ops", "bpy.context"})
_LACKS, _HAS, _UNKNOWN = "01?"


def history_paths(extract: Extract) -> Iterator[str]:
    """The identifiers of one Blender: its symbols, their parameters and enum items.

    What every class repeats from its base (the reference lists it on each) is as old as the class: left out.
    """
    for symbol in extract.symbols:
        if symbol.same_as or symbol.is_class_lookup:
            continue
        yield from paths_of(symbol)


def paths_of(symbol: Symbol) -> Iterator[str]:
    """The identifiers of a symbol, its enum items, its parameters and their items."""
    yield symbol.path
    for item in symbol.enum_items:
        yield f"{symbol.path}:{item.identifier}"
    for parameter in symbol.parameters:
        path = f"{symbol.path}({parameter.name})"
        yield path
        for item in parameter.enum_items:
            yield f"{path}:{item.identifier}"


def is_module(path: str) -> bool:
    """Whether a path is that of a module which is in no other."""
    return not {".", ":"}.intersection(path) and not path.startswith(SHARED)


def is_from_stubs(patch: str) -> bool:
    """Whether a version of the file is known from stubs: ``2.79``, rather than ``4.2.23``."""
    return patch.count(".") == 1


@dataclass(frozen=True, slots=True)
class RemovedSpan:
    """A symbol that a version lacks, and the versions that have it: the latest ones before, or else the first behind.

    ``gone`` is the first version known to lack it after ``last``; empty for what only newer versions have. Of these
    ``lacked`` is the last version known to lack it before ``first``, empty where that is the one just before.
    """

    path: str
    first: str
    last: str
    gone: str
    lacked: str = ""


class Arrival(NamedTuple):
    """Since when a version has a symbol.

    ``first`` is the first version that is known to; ``lacked`` the last one before that is known to lack it, empty for
    none, and ``is_sure`` whether that is the one just before; ``is_return``: an older one had it as well.
    """

    path: str
    first: str
    lacked: str
    is_sure: bool
    is_return: bool


@dataclass(slots=True)
class ApiHistory:
    """The known versions (minor ones, oldest first) and what existed in which.

    ``patches`` are the full versions that were looked at, in the same order. ``masks`` hold one bit a
    version, lowest the oldest, set where it has the symbol; ``unknown`` likewise where nothing is known;
    ``shared`` names the enumeration whose items a property or parameter has.
    """

    versions: tuple[str, ...]
    patches: tuple[str, ...]
    masks: dict[str, int]
    shared: dict[str, str] = field(default_factory=dict[str, str])
    unknown: dict[str, int] = field(default_factory=dict[str, int])

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
        patches = tuple(sorted((*self.patches, version), key=version_key))
        number = patches.index(version)
        has = set(paths)
        below = (1 << number) - 1

        def widened(mask: int) -> int:
            return mask & below | (mask & ~below) << 1

        masks: dict[str, int] = {}
        unknown: dict[str, int] = {}
        for path, mask, hidden in self.symbols():
            masks[path] = widened(mask) | (path in has) << number
            if hidden:
                unknown[path] = widened(hidden)
        masks.update((path, 1 << number) for path in has if path not in masks)
        return ApiHistory(tuple(map(minor_of, patches)), patches, masks, unknown=unknown)

    def mask(self, path: str) -> int:
        """One bit a version, lowest the oldest; 0 for what no known version has."""
        return self._cells(path)[0]

    def before(self, version: str) -> int:
        """The bits of the versions before one (minor or full) that is known."""
        return (1 << (self._number(version) or 0)) - 1

    def exists(self, path: str, version: str) -> bool | None:
        """Whether a version (minor or full) has the symbol; None where that is not known."""
        number = self._number(version)
        if number is None:
            return None
        mask, unknown = self._cells(path)
        return None if unknown >> number & 1 else bool(mask >> number & 1)

    def span(self, path: str) -> tuple[str, str] | None:
        """The first and the last known version that have the symbol; None when none has."""
        mask = self.mask(path)
        if not mask:
            return None
        return self.versions[(mask & -mask).bit_length() - 1], self.versions[mask.bit_length() - 1]

    def paths(self, version: str) -> Iterator[str]:
        """Everything that a version has, the items of shared enumerations included."""
        number = self._number(version)
        if number is None:
            return
        yield from (path for path, mask, _ in self.symbols() if mask >> number & 1)

    def doubted(self, version: str) -> Iterator[str]:
        """Everything of which it is not known whether a version has it, the items of shared enumerations included."""
        number = self._number(version)
        if number is None:
            return
        yield from (path for path, _, unknown in self.symbols() if unknown >> number & 1)

    def modules(self, version: str) -> tuple[str, ...]:
        """The modules that a version has, and those of which that is not known: a build may be made without some."""
        return tuple(filter(is_module, (*self.paths(version), *self.doubted(version))))

    def removed_from(self, version: str) -> Iterator[RemovedSpan]:
        """What other versions have and this one lacks: gone, or not there yet."""
        number = self._number(version)
        if number is None:
            return
        for path, mask, unknown in self.symbols():
            if (mask | unknown) >> number & 1 or not mask:
                continue
            before = mask & (1 << number) - 1
            position = (before or mask & -mask).bit_length() - 1
            lacking = ~(mask | unknown)
            behind = lacking >> position
            end = position + (behind & -behind).bit_length() - 1
            last = (mask & (1 << end) - 1).bit_length() - 1
            first = _first_of_run(mask, lacking, position)
            gone = self.versions[end] if before else ""
            lacked = (lacking & (1 << first) - 1).bit_length() - 1
            in_doubt = not before and 0 <= lacked < first - 1
            yield RemovedSpan(
                path,
                self.versions[first],
                self.versions[last],
                gone,
                self.versions[lacked] if in_doubt else "",
            )

    def symbols(self) -> Iterator[tuple[str, int, int]]:
        """(path, mask, unknown) of everything, the items of shared enumerations at each of their places included."""
        for path, mask in self.masks.items():
            yield path, mask, self.unknown.get(path, 0)
        items: defaultdict[str, list[tuple[str, int, int]]] = defaultdict(list)
        for path, mask in self.masks.items():
            if path.startswith(SHARED) and ":" in path:
                name, _, item = path.partition(":")
                items[name].append((item, mask, self.unknown.get(path, 0)))
        for path, enumeration in self.shared.items():
            own, hidden = self.masks[path], self.unknown.get(path, 0)
            for item, mask, unknown in items[enumeration]:
                if mask & own:
                    yield f"{path}:{item}", mask & own, hidden | own & unknown

    def arrivals(self, version: str) -> Iterator[Arrival]:
        """Since when the version has what it has, without a gap. Nothing for what the oldest version has."""
        number = self._number(version)
        if number is None:
            return
        full = (2 << number) - 1
        for path, mask, unknown in self.symbols():
            if mask >> number & 1 and mask & full != full:
                first = _first_of_run(mask, ~(mask | unknown), number)
                if first:
                    before = (1 << first) - 1
                    lacking = ~(mask | unknown) & before
                    last = self.versions[lacking.bit_length() - 1] if lacking else ""
                    is_sure = lacking.bit_length() == first
                    yield Arrival(path, self.versions[first], last, is_sure, bool(mask & before))

    def to_bytes(self) -> bytes:
        """The file's content. Equal histories give equal bytes (with one release of zlib)."""
        text = io.StringIO(newline="")
        table = csv.writer(text, lineterminator="\n")
        table.writerow((*COLUMNS, *self.patches))
        for path, mask in sorted(self.masks.items()):
            unknown = self.unknown.get(path, 0)
            cells = (
                _UNKNOWN if unknown >> number & 1 else _HAS if mask >> number & 1 else _LACKS
                for number in range(len(self.patches))
            )
            table.writerow((path, self.shared.get(path, ""), *cells))
        return gzip.compress(text.getvalue().encode(), mtime=0)

    @classmethod
    def from_bytes(cls, data: bytes) -> ApiHistory:
        """The inverse of :meth:`to_bytes`. Raises OSError, EOFError, zlib.error, csv.Error, ValueError or UserError."""
        head, _, body = gzip.decompress(data).decode().partition("\n")
        columns = head.split(",")
        patches = tuple(columns[len(COLUMNS) :])
        if (
            columns[: len(COLUMNS)] != COLUMNS
            or not patches
            or [*patches] != sorted(patches, key=version_key)
        ):
            raise ValueError(f"its columns are {head[:60]!r}, not {', '.join(COLUMNS)} and versions")
        masks: dict[str, int] = {}
        shared: dict[str, str] = {}
        hidden: dict[str, int] = {}
        known: dict[str, tuple[int, int]] = {}  # rows have one of few hundred ends
        width = 2 * len(patches)
        # A cell is one character, so that a row's end has always the same length; only what precedes it is quoted.
        for row in body.splitlines():
            cells = row[-width:]
            if cells not in known:
                known[cells] = _read_cells(cells, len(patches), row)
            start = row[:-width]
            path, enumeration = (
                next(csv.reader([start])) if start[:1] == '"' else start.split(",")
            )  # fmt: skip
            masks[path], unknown = known[cells]
            if enumeration:
                shared[path] = enumeration
            if unknown:
                hidden[path] = unknown
        return cls(tuple(map(minor_of, patches)), patches, masks, shared, hidden)

    def _cells(self, path: str) -> tuple[int, int]:
        """(mask, unknown) of a path."""
        if path in self.masks or ":" not in path:
            return self.masks.get(path, 0), self.unknown.get(path, 0)
        above, _, item = split_path(path)
        enumeration = self.shared.get(above)
        if not enumeration:
            return 0, 0
        own, item = self.masks[above], f"{enumeration}:{item}"
        return own & self.masks.get(item, 0), self.unknown.get(above, 0) | own & self.unknown.get(item, 0)

    def _number(self, version: str) -> int | None:
        minor = minor_of(version)
        return self.versions.index(minor) if minor in self.versions else None


def _first_of_run(mask: int, lacking: int, position: int) -> int:
    """The first version that has a symbol, of those up to ``position`` between which none is known to lack it."""
    below = lacking & (1 << position) - 1
    start = below.bit_length()
    run = mask >> start
    return start + (run & -run).bit_length() - 1


def _read_cells(cells: str, count: int, row: str) -> tuple[int, int]:
    """(mask, unknown) of a row's end, ``,1,0,?``. Raises ValueError for anything else."""
    values = cells[1::2]
    if len(values) != count or cells[::2] != "," * count or values.strip(_LACKS + _HAS + _UNKNOWN):
        raise ValueError(f"the row {row[:60]!r} does not end in {count} cells of 0, 1 or ?")
    return tuple(
        sum(1 << number for number, value in enumerate(values) if value == wanted)
        for wanted in (_HAS, _UNKNOWN)
    )  # pyright: ignore[reportReturnType]
