"""What takes the place of removed symbols: the reviewed table, and what follows from it for one version.

``corpora/history/successors.csv`` has the columns ``old``; ``new``, one path or several with ``|`` between, best first,
or nothing where nothing takes its place; ``how``, a sentence; ``version``, the first to be written so; ``source``,
where that is said. A star in ``old`` stands for a part of a name and is the same in ``new``; several are in their turn.
"""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass, replace
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING

from kb_build.errors import StoreError
from kb_build.flow.blender.facts import LOST_MODULES
from kb_build.known_prefixes import KnownPrefixes
from kb_build.symbols.paths import joined_path, split_path
from kb_build.versions.history import TOP
from simworlds.releases import version_key

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping

    from kb_build.versions.history import ApiHistory, RemovedSpan

SUCCESSORS_FILE = Path(__file__).resolve().parents[2] / "corpora" / "history" / "successors.csv"
COLUMNS = ["old", "new", "how", "version", "source"]
_OTHERWISE = "It is used in another way."
_HELD_BY_NAME = re.compile(r"""\.get\(['"]""")  # how something is asked for that others are kept beside
_STEPS = 5  # names that were renamed more often than that are none


@dataclass(frozen=True, slots=True)
class Succession:
    """A row of the table; see the module. ``new`` is empty where nothing takes the place of ``old``."""

    old: str
    new: tuple[str, ...]
    how: str
    version: str
    source: str


def load_successors(path: Path | None = None) -> list[Succession]:
    """The table; by default the one that comes with the package. Raises StoreError."""
    source = path or SUCCESSORS_FILE
    try:
        with source.open(encoding="utf-8", newline="") as file:
            table = csv.reader(file)
            if next(table, []) != COLUMNS:
                raise ValueError(f"its columns are not {', '.join(COLUMNS)}")
            return [
                Succession(old, tuple(filter(None, new.split("|"))), how, version, origin)
                for old, new, how, version, origin in table
            ]
    except (OSError, csv.Error, ValueError) as error:
        raise StoreError(f"{source} is not a readable table of successors: {error}") from error


def lost_modules() -> Iterator[Succession]:
    """The modules that Python has lost, as rows of the table."""
    for module, (since, python, instead) in LOST_MODULES.items():
        use = f"Write it with `{instead}`: " if instead else ""
        how = f"{use}Python {python} and later have no module `{module}`."
        yield Succession(module, (), how, ".".join(map(str, since)), f"Python {python}: What's New")


class Successors:
    """The successors in one version (minor) that the history knows.

    ``bases`` are class → its base, as paths; ``known`` are paths that the version has, also those of modules that the
    history does not list.
    """

    def __init__(
        self,
        table: Iterable[Succession],
        history: ApiHistory,
        version: str,
        bases: Mapping[str, str],
        known: Collection[str] = (),
    ) -> None:
        self._history = history
        self._version = version
        self._bases = bases
        self._known = known
        until = version_key(version)
        table = list(table)
        # The versions in which a name took the place of others.
        self._came: dict[str, list[str]] = {}
        for row in table:
            for new in row.new:
                self._came.setdefault(new, []).append(row.version)
        rows = [row for row in table if version_key(row.version) <= until]
        # What took a place later: the new name → its rows, those first that were only renamed; and of these (how such a
        # name is written, the row).
        later = [row for row in table if version_key(row.version) > until and row.new]
        renamed = [row for row in later if _only_renames(row)]
        self._replaced_later: dict[str, list[Succession]] = {}
        for row in sorted((row for row in later if self._exists(row.old)), key=_only_renames, reverse=True):
            for new in row.new:
                if self._came_for(new, row):
                    self._replaced_later.setdefault(new, []).append(row)
        for new, taken in self._replaced_later.items():
            # Of what went before the name came, it did not take the place at once.
            taken.sort(key=lambda row, new=new: history.exists(new, row.version) is False)
        self._renamed_alike = [(_pattern(row.new[0]), row) for row in renamed if "*" in row.new[0]]
        self._rows = {row.old: row for row in rows if "*" not in row.old}
        # By what precedes the star, each with its place in the table.
        self._patterns: dict[str, list[tuple[int, re.Pattern[str], Succession]]] = {}
        for place, row in enumerate(rows):
            if "*" in row.old:
                found = place, _pattern(row.old), row
                self._patterns.setdefault(row.old.partition("*")[0], []).append(found)
        self._starts = KnownPrefixes(self._patterns)
        self._row_of: dict[str, Succession | None] = {}  # of what was asked for
        self._found: dict[str, list[Succession]] = {}

    def stated(self) -> Iterator[Succession]:
        """The table's rows about single names that this version lacks, whether or not the history knows them."""
        yield from (row for row in self._rows.values() if not self._exists(row.old))

    def dated(self, span: RemovedSpan) -> tuple[str, str]:
        """(last, gone) of a removed symbol: as the history has it, or where that has a gap, as the table says."""
        row = self._row(span.path)
        if row is None or not span.gone:
            return span.last, span.gone
        if not version_key(span.last) < version_key(row.version) < version_key(span.gone):
            return span.last, span.gone
        return self.before(row.version), row.version

    def came(self, span: RemovedSpan) -> tuple[str, str]:
        """(first, lacked) of what only newer versions have: as the history has it, or where that is in doubt, the
        version in which it took something's place.
        """
        if span.lacked:
            earliest, latest = version_key(span.lacked), version_key(span.first)
            came = [one for one in self._came.get(span.path, ()) if earliest < version_key(one) <= latest]
            if came:
                return min(came, key=version_key), ""
        return span.first, span.lacked

    def before(self, version: str) -> str:
        """The version before one; empty for the oldest. Raises StoreError for one that the history does not have."""
        versions = self._history.versions
        if version not in versions:
            raise StoreError(
                f"The table of successors names Blender {version}, which the history does not have: that knows "
                f"{', '.join(versions)}. Correct the version in {SUCCESSORS_FILE.name}, or add it to the history."
            )
        number = versions.index(version)
        return versions[number - 1] if number else ""

    def of(self, path: str) -> list[Succession]:
        """What takes the place of a missing path, best first, each row with one target or none.

        A name of later versions has the one that it was given in place of. Without a row of its own, a name has the
        same name in what took its owner's place, if that has it; or what took its place there, if that has lost it.
        Where nothing took its owner's place, nothing took its own.
        """
        if path not in self._found:
            self._found[path] = []  # against circles
            self._found[path] = list(self._of(path, 0))
        return self._found[path]

    def _of(self, path: str, step: int) -> Iterator[Succession]:
        row = self._row(path)
        if row is None:
            yield from self._earlier(path) or self._with_owner(path, step)
            return
        if not row.new:
            yield row
            return
        seen: set[str] = set()
        ends: list[Succession] = []
        for target in row.new:
            if self._exists(target):
                later = [Succession(path, (target,), row.how, row.version, row.source)]
            else:
                later = self._of(target, step + 1) if step < _STEPS else ()
            for entry in later:
                if not entry.new:
                    ends.append(entry)
                elif entry.new[0] not in seen:
                    seen.add(entry.new[0])
                    yield Succession(path, entry.new, entry.how or row.how, entry.version, entry.source)
        if ends and not seen:
            yield Succession(path, (), ends[0].how, ends[0].version, ends[0].source)

    def _earlier(self, path: str) -> list[Succession]:
        """What is here in place of a name of later versions; nothing where that is not known.

        Of several names that it took the place of, otherwise than by a new name: those that have its own owner.
        """
        if rows := self._replaced_later.get(path):
            owner = split_path(path)[0]
            others = [row for row in rows if split_path(row.old)[0] == owner]
            chosen = rows[:1] if _only_renames(rows[0]) else others or rows[:1]
            return [_turned(path, row.old, row) for row in chosen]
        for pattern, row in self._renamed_alike:
            match = pattern.fullmatch(path)
            old = _filled(row.old, match.groups()) if match else ""
            if old and "*" not in old and self._exists(old):
                return [_turned(path, old, row)]
        above, mark, name = split_path(path)
        for row in self._replaced_later.get(above, ()):
            # The name of the owner was another one's until it was given to this one.
            old = joined_path(row.old, mark, name)
            if _only_renames(row) and self._exists(above) and self._exists(old):
                names = (split_path(cls)[2] for cls in (above, row.old))
                how = "What Blender {} calls `{}` is `{}` here.".format(row.version, *names)
                return [Succession(path, (old,), how, row.version, row.source)]
        return []

    def _came_for(self, new: str, row: Succession) -> bool:
        """Whether what a name took the place of later does here what the name does. Not where the name holds that
        among others, by names; nor where both were there for a while, on two things that are both here.
        """
        if _only_renames(row):
            return True
        owner = split_path(new)[0]
        both = self._history.mask(row.old) & self._history.mask(new)
        elsewhere = owner not in TOP and owner != split_path(row.old)[0] and self._exists(owner)
        return not _HELD_BY_NAME.search(row.how) and not (both and elsewhere)

    def _with_owner(self, path: str, step: int) -> Iterator[Succession]:
        above, mark, name = split_path(path)
        if above in {"", "bpy.types", "bpy.ops"} or self._exists(above):
            return
        for row in self.of(above):
            if not row.new:
                yield Succession(path, (), row.how, row.version, row.source)
                return
            for owner in self._lineage(row.new[0]):
                target = joined_path(owner, mark, name)
                if self._exists(target):
                    yield Succession(path, (target,), "", row.version, row.source)
                    return
                if step < _STEPS and _only_renames(row) and self._history.exists(target, row.version):
                    # The new owner had it under the same name, and has lost it since.
                    yield from (replace(later, old=path) for later in self._of(target, step + 1))
                    return

    def _row(self, path: str) -> Succession | None:
        if path not in self._row_of:
            self._row_of[path] = self._rows.get(path) or self._row_by_pattern(path)
        return self._row_of[path]

    def _row_by_pattern(self, path: str) -> Succession | None:
        patterns = (entry for start in self._starts.of(path) for entry in self._patterns[start])
        for _, pattern, row in sorted(patterns, key=itemgetter(0)):
            if match := pattern.fullmatch(path):
                new = tuple(_filled(target, match.groups()) for target in row.new)
                return Succession(path, new, row.how, row.version, row.source)
        return None

    def _exists(self, path: str) -> bool:
        if self._history.exists(path, self._version):
            return True
        return path in self._known and not self._history.mask(path)

    def _lineage(self, path: str) -> Iterator[str]:
        for _ in range(_STEPS):
            yield path
            path = self._bases.get(path, "")
            if not path:
                return


def _turned(path: str, old: str, row: Succession) -> Succession:
    """What is here in place of a name of later versions, by the row that says what that took the place of."""
    return Succession(path, (old,), "" if _only_renames(row) else _OTHERWISE, row.version, row.source)


def _only_renames(row: Succession) -> bool:
    return len(row.new) == 1 and not row.how


def _pattern(path: str) -> re.Pattern[str]:
    """What finds the names that a path with stars stands for."""
    return re.compile(re.escape(path).replace(r"\*", r"([^.()\[\]:]*)"))


def _filled(target: str, parts: tuple[str, ...]) -> str:
    """A path with its stars filled: each by the part in its turn, or all by the only one."""
    if len(parts) == 1:
        return target.replace("*", parts[0])
    for part in parts:
        target = target.replace("*", part, 1)
    return target
