"""Verifies a base: it is complete, and every reference in it resolves."""

from __future__ import annotations

import json
import sqlite3
import zlib
from bisect import bisect_left
from collections import Counter, defaultdict
from contextlib import closing
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from kb_build.base_file import open_base, read_meta
from kb_build.errors import StoreError
from kb_build.index.analysis import key
from kb_build.live.values import compare_values, runtime_at_hand
from kb_build.pages.page import page_from_json
from kb_build.reference_list import WANTED, ReferenceResolution, read_reference, resolve
from kb_build.schema import FORM_PATH, POSTING_BYTES, UNITS, unpack
from kb_build.symbols.api_names import TYPES
from kb_build.symbols.records import symbol_from_json
from simworlds.how_to_get_bases import how_to_get_again
from simworlds.sandbox.errors import ProgramFailed

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from pathlib import Path

_SHOWN = 5


@dataclass(frozen=True, slots=True)
class BaseCheck:
    """The outcome of one check: how many rows it looked at, faults, and notes that are not faults."""

    name: str
    looked_at: int
    faults: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class BaseVerification:
    """The outcome of :func:`verify_base`."""

    path: Path
    blender: str
    checks: tuple[BaseCheck, ...]
    reference: ReferenceResolution | None = None

    @property
    def sound(self) -> bool:
        """Whether no check has a fault and enough of the reference resolves."""
        resolves = self.reference is None or self.reference.share >= WANTED
        return resolves and not any(check.faults for check in self.checks)

    def lines(self) -> Iterator[str]:
        """The outcome as lines of text; long lists are shortened."""
        yield f"{self.path} (Blender {self.blender})"
        for check in self.checks:
            yield f"  {'FAULT' if check.faults else 'ok':<6} {check.name}: {check.looked_at:,} checked"
            yield from (f"           {line}" for line in _shortened(check.faults, "wrong"))
            yield from (f"           {line}" for line in _shortened(check.notes, "worth knowing"))
        if self.reference is not None:
            reference = self.reference
            yield (
                f"  {'ok' if reference.share >= WANTED else 'FAULT':<6} reference: {reference.exact:,} of "
                f"{reference.total:,} identifiers resolve exactly ({reference.share:.2%}; wanted {WANTED:.1%})"
            )
            for reason, rows in reference.others.items():
                yield f"         {reason} ({len(rows):,})"
                yield from (f"           {row}" for row in rows)
        yield "Sound." if self.sound else f"Not sound. {how_to_get_again(self.path)}"

    def as_json(self) -> dict[str, Any]:
        """The outcome as JSON-ready data, complete."""
        reference = self.reference
        return {
            "path": str(self.path),
            "blender": self.blender,
            "sound": self.sound,
            "checks": [
                {
                    "name": check.name,
                    "looked_at": check.looked_at,
                    "faults": list(check.faults),
                    "notes": list(check.notes),
                }
                for check in self.checks
            ],
            "reference": None
            if reference is None
            else {
                "total": reference.total,
                "exact": reference.exact,
                "share": reference.share,
                "others": {reason: list(rows) for reason, rows in reference.others.items()},
            },
        }


def _shortened(rows: tuple[str, ...], what: str) -> Iterator[str]:
    yield from rows[:_SHOWN]
    if len(rows) > _SHOWN:
        yield f"… and {len(rows) - _SHOWN:,} more {what} (--json lists them)"


def verify_base(path: Path, reference: Path | None = None, *, live: bool = False) -> BaseVerification:
    """Runs every check on the base at ``path``; ``reference`` is a file for read_reference.

    ``live``: also compares the values of new things with those in the Blender that the base was built from.
    Raises StoreError when there is no base there that this SimWorlds understands, KBBuildError for a
    reference that cannot be read.
    """
    meta = read_meta(path)
    identifiers = read_reference(reference) if reference else None
    resolution: ReferenceResolution | None = None
    checks: list[BaseCheck] = []
    with closing(open_base(path)) as connection:
        checks.append(_guarded("file", _file, connection))
        if not checks[0].faults:
            try:
                base = _Base(connection, meta)
            except sqlite3.Error as error:
                raise StoreError(f"{path}: damaged ({error}). {how_to_get_again(path)}") from error
            checks += [_guarded(name, check, base) for name, check in _CHECKS]
            if live and not any(check.faults for check in checks):
                checks.append(_guarded("new values", lambda _: _new_values(path, meta), base))
            if identifiers is not None:
                resolution = resolve(identifiers, base.bases)
    return BaseVerification(path, meta.get("blender", "?"), tuple(checks), resolution)


def _guarded(name: str, check: Callable[[Any], BaseCheck], subject: object) -> BaseCheck:
    """Runs a check; one that fails on damaged data is a fault."""
    try:
        return check(subject)
    except (sqlite3.Error, zlib.error, ValueError, TypeError, KeyError) as error:
        return BaseCheck(name, 0, (f"could not be checked: {type(error).__name__}: {error}",))


class _Base:
    """The base under check, with the ids that all checks need."""

    def __init__(self, connection: sqlite3.Connection, meta: dict[str, str]) -> None:
        self.meta = meta
        self._connection = connection
        self.bases: dict[str, str] = dict(self.rows("SELECT path, base FROM symbols"))
        self.slugs = {slug for (slug,) in self.rows("SELECT slug FROM pages")}

    def rows(self, sql: str, *values: object) -> Iterator[Any]:
        """The rows of one query."""
        return self._connection.execute(sql, values)


def _new_values(path: Path, meta: dict[str, str]) -> BaseCheck:
    """New things in the running Blender have the values that the base tells."""
    runtime = runtime_at_hand(meta)
    if runtime is None:
        reason = (
            f"Blender {meta.get('blender')}, from which it was built, is not at hand: nothing was compared"
        )
        return BaseCheck("new values", 0, notes=(reason,))
    try:
        found = compare_values(path, runtime)
    except ProgramFailed as error:
        return BaseCheck("new values", 0, notes=(f"not compared: {error}",))
    return BaseCheck("new values", found.compared, found.wrong)


def _file(connection: sqlite3.Connection) -> BaseCheck:
    messages = [str(row[0]) for row in connection.execute("PRAGMA integrity_check")]
    pages = int(connection.execute("PRAGMA page_count").fetchone()[0])
    return BaseCheck("file", pages, tuple(message for message in messages if message != "ok"))


def _counts(base: _Base) -> BaseCheck:
    """The numbers of rows are those that the build recorded."""
    promised = json.loads(base.meta["counts"])
    counted = {
        "symbols": dict(base.rows("SELECT kind, count(*) FROM symbols GROUP BY kind")),
        "pages": dict(base.rows("SELECT source, count(*) FROM pages GROUP BY source")),
        "sections": next(base.rows("SELECT count(*) FROM sections"))[0],
        "links": dict(base.rows("SELECT kind, count(*) FROM links GROUP BY kind")),
    }
    faults = [
        f"{name}: {promised[name]} were written, {counted[name]} are there"
        for name in counted
        if counted[name] != promised[name]
    ]
    return BaseCheck("counts", len(counted), tuple(faults))


def _symbols(base: _Base) -> BaseCheck:
    """Owner, base, target and collection of every symbol exist, and its record can be read.

    Operators are exempt: Blender shows the classes of those that Python registered, and of no others.
    """
    known = base.bases
    faults: list[str] = []
    looked_at = 0
    for path, kind, owner, parent, target, collection, record in base.rows(
        "SELECT path, kind, owner, base, target, collection, record FROM symbols"
    ):
        looked_at += 1
        faults += [
            f"{path}: its {role} {name} is not in the base"
            for role, name in (
                ("owner", owner),
                ("base", parent),
                ("target", target and kind != "operator" and TYPES + target),
                ("collection", collection and TYPES + collection),
            )
            if name and name not in known
        ]
        if symbol_from_json(unpack(record)).path != path:
            faults.append(f"{path}: its record is another symbol's")
    return BaseCheck("symbols", looked_at, tuple(faults))


def _names(base: _Base) -> BaseCheck:
    """Every identifier and every page is found by its own spelling."""
    names = set(base.rows("SELECT key, id FROM names WHERE form = ?", FORM_PATH))
    ids = [*base.bases, *base.slugs]
    faults = [
        f"{identifier} is not found by its own name"
        for identifier in ids
        if (key(identifier), identifier) not in names
    ]
    return BaseCheck("names", len(ids), tuple(faults))


def _pages(base: _Base) -> BaseCheck:
    """Every page has sections, and the page above it exists."""
    sections = Counter(slug for (slug,) in base.rows("SELECT slug FROM sections"))
    faults = [f"{slug}: sections without a page" for slug in sections.keys() - base.slugs]
    for slug, parent, record in base.rows("SELECT slug, parent, record FROM pages"):
        page = page_from_json({"sections": [], **unpack(record)})
        if page.slug != slug:
            faults.append(f"{slug}: its record is another page's")
        if not sections[slug]:
            faults.append(f"{slug}: no sections")
        faults += [
            f"{slug}: the page {other} that it refers to is not there"
            for other in (parent, *page.children, *page.links)
            if other and other not in base.slugs
        ]
    return BaseCheck("pages", len(base.slugs), tuple(faults))


def _links(base: _Base) -> BaseCheck:
    """Both ends of every link exist. Blender's table also names pages that a manual no longer has."""
    anchors: dict[str, set[str]] = defaultdict(set)
    for slug, anchor in base.rows("SELECT slug, anchor FROM sections"):
        anchors[slug].add(anchor)
    manual = any("manual" in row for row in base.rows("SELECT DISTINCT source FROM pages"))
    faults: list[str] = []
    notes: Counter[str] = Counter()
    looked_at = 0
    for source, target, kind in base.rows("SELECT source, target, kind FROM links"):
        looked_at += 1
        if source not in base.bases:
            faults.append(f"{kind} link from {source}, which is not in the base")
        page, _, anchor = target.partition("#")
        if kind != "manual":
            if target not in base.bases:
                faults.append(f"{kind} link from {source} to {target}, which is not in the base")
        elif manual and page not in base.slugs:
            notes[f"Blender's table names the page {page}, which the manual lacks"] += 1
        elif manual and anchor and anchor not in anchors[page]:
            notes[
                "Blender's table names a place in a page that begins no section: the link leads to the page"
            ] += 1
    if not manual:
        notes["without a manual, links to it lead nowhere"] += 1
    return BaseCheck("links", looked_at, tuple(faults), _counted(notes))


def _counted(notes: Counter[str]) -> tuple[str, ...]:
    return tuple(f"{note} ({count:,} symbols)" if count > 1 else note for note, count in notes.most_common())


def _index(base: _Base) -> BaseCheck:
    """Every document is a symbol or page of the base, and the postings and phrases name documents."""
    faults: list[str] = []
    sizes: Counter[int] = Counter()
    for level, count, refs in base.rows("SELECT level, count, refs FROM levels"):
        sizes[level] = count
        named = refs.split("\n") if refs else []
        if len(named) != count:
            faults.append(f"level {level} of the index names {len(named)} documents, and says {count}")
        unknown = (ref for ref in named if ref not in base.bases and ref not in base.slugs)
        faults += [f"the index names {ref}, which is not in the base" for ref in unknown]
    documents = sum(sizes.values())
    targets = [
        target
        for (data,) in base.rows("SELECT targets FROM phrases")
        for target in memoryview(data).cast("i")
    ]
    faults += [f"a phrase asks for document {target}" for target in targets if not 0 <= target < documents]
    faults += _postings(
        base.rows("SELECT stem, units, data FROM postings"), sizes[UNITS], documents + len(targets)
    )
    if not documents:
        faults.append("the index is empty")
    return BaseCheck("index", sum(sizes.values()), tuple(faults))


def _postings(rows: Iterable[tuple[str, int, bytes]], units: int, end: int) -> Iterator[str]:
    """Of each stem: numbers below ``end`` as uint32, ascending, then as many weights as float16; those of units."""
    for stem, having, data in rows:
        count, cut = divmod(len(data), POSTING_BYTES)
        if cut:
            yield f"the postings of {stem!r} are cut off"
            continue
        numbers = memoryview(data)[: count * 4].cast("I").tolist()
        if any(number >= following for number, following in pairwise(numbers)) or (
            numbers and numbers[-1] >= end
        ):
            yield f"the postings of {stem!r} name documents out of order or of nothing"
        elif bisect_left(numbers, units) != having:
            yield f"the postings of {stem!r} are not of {having} units"


_CHECKS: tuple[tuple[str, Callable[[_Base], BaseCheck]], ...] = (
    ("counts", _counts),
    ("symbols", _symbols),
    ("names", _names),
    ("pages", _pages),
    ("links", _links),
    ("index", _index),
)
