"""Read-only look-ups in one knowledge base file."""

from __future__ import annotations

import json
import sqlite3
import zlib
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar, cast

from kb_build.schema import FORM_NAME, Mark, NoBase, open_read_only, unpack
from kb_build.symbols.api_names import COLLECTION, TYPES
from kb_build.symbols.object_data import data_class
from kb_build.symbols.records import Page, SettingCondition, Symbol, page_from_json, symbol_from_json
from kb_serve.errors import BadQuery, BaseMissing, BaseUnreadable
from kb_serve.kept_rows import KeptRows
from simworlds.how_to_get_bases import how_to_get_again, how_to_get_at

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Generator, Iterable, Iterator, Sequence
    from pathlib import Path

    from kb_build.symbols.records import Otherwise

_Record = TypeVar("_Record")
_Value = TypeVar("_Value")
_Shared = TypeVar("_Shared")

EXTEND = "__extend__"  # the identifier of the socket at which a node gets more
# As numbers: a test of a flag takes a microsecond, and answers make many.
_READ_ONLY, _DEPRECATED, _UNSEEN, _GIVEN = (
    int(mark) for mark in (Mark.READ_ONLY, Mark.DEPRECATED, Mark.UNSEEN, Mark.GIVEN)
)
PROPERTIES = "bpy.props."  # whose functions scripts import by name
UNLIMITED = float("inf")


class SymbolEntry(NamedTuple):
    """The part of a symbol that resolving needs; the whole record is read only for answers.

    ``line`` describes it in the list of its owner's members. ``reached`` and ``lacks`` are a class's, as in its record;
    ``choices``: the stems of what its arguments and values are called, where the line does not tell them all.
    """

    path: str
    kind: str
    owner: str
    name: str
    type: str
    target: str
    collection: str
    base: str
    group: str
    label: str
    marks: int
    line: str
    reached: str
    lacks: str
    choices: str

    @property
    def head(self) -> str:
        """The line without the description: name, type, default, values, and whether it can be set."""
        return self.line.partition(" — ")[0]

    @property
    def is_read_only(self) -> bool:
        """Whether it cannot be assigned."""
        return bool(self.marks & _READ_ONLY)

    @property
    def is_deprecated(self) -> bool:
        """Whether Blender calls it deprecated."""
        return bool(self.marks & _DEPRECATED)

    @property
    def is_unseen(self) -> bool:
        """Whether its default is RNA's alone: no new instance was compared."""
        return bool(self.marks & _UNSEEN)

    @property
    def is_given(self) -> bool:
        """Whether it is a pointer that is None on all new things, and that an assignment alone fills."""
        return bool(self.marks & _GIVEN)


class PageEntry(NamedTuple):
    """A page without its text; ``parent`` is a slug."""

    slug: str
    source: str
    version: str
    title: str
    parent: str
    url: str
    summary: str
    summary_method: str


@dataclass(frozen=True, slots=True)
class Successor:
    """What takes the place of a removed symbol, since which version, and where that is written down.

    ``target`` is a path of this version; it is empty where nothing does, and ``how`` says why. Otherwise ``how`` is
    what else changes.
    """

    target: str
    how: str
    version: str
    source: str


class Creation(NamedTuple):
    """How an instance is made: the call, the function or operator that is called, and the type that it names."""

    call: str
    maker: str
    choice: str


@dataclass(frozen=True, slots=True)
class Use:
    """Lines of one of Blender's own scripts that use a symbol; ``line`` is the first one's number."""

    file: str
    line: int
    code: str


_ENTRY = "path, kind, owner, name, type, target, collection, base, grp, label, marks, line, reached, lacks, choices"
_PAGE = "slug, source, version, title, parent, url, summary, summary_method"


def open_file(path: Path) -> sqlite3.Connection:
    """Opens a base read-only and checks its format. Raises BaseMissing or BaseUnreadable."""
    try:
        return open_read_only(path, threads=True)
    except FileNotFoundError:
        raise BaseMissing(f"{path}: there is no knowledge base here. {how_to_get_at(path)}") from None
    except NoBase as error:
        raise BaseUnreadable(f"{path}: {error}. {how_to_get_again(path)}") from error


class BaseReader:
    """Look-ups in one base. Frequent ones are cached: the file never changes while it is open."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._connection = open_file(path)
        self._opened = ExitStack()
        self.close_with(self._connection.close)
        self._work_left = UNLIMITED
        # A symbol's or page's row, or None; the pages right below one, in the manual's order; the targets of a symbol's
        # links to the manual, and the URL of the first that is a page; (form, id) of everything spelled like a key (see
        # analysis.key), preferred forms first.
        # An entry takes nearly a kilobyte, and a class has fifty members.
        self.entry = KeptRows(self._entries, None, 700)
        self.page_entry = KeptRows(self._page_entries, None, 500)
        self.page_children = KeptRows(self._page_children, (), 100)
        self.manual_links = KeptRows(self._manual_links, (), 500)
        self.manual_url = KeptRows(self._manual_urls, "", 500)
        self.by_key = KeptRows(self._by_key, (), 100)
        # What scripts write for a page's labels: (section, line) → the names in Markdown; line -1 is the heading.
        self.label_names = KeptRows(self._label_names, {}, 100)
        # The members of a class or module by name; the classes right below one; the symbols whose last part is a name.
        self.members = lru_cache(maxsize=32)(self._members)
        self.subclasses = lru_cache(maxsize=16)(self._subclasses)
        # The whole record of an identifier, and a page with its sections, or None. They are looked at several times
        # while they are answered with.
        self.symbol = lru_cache(maxsize=32)(self._symbol)
        self.page = lru_cache(maxsize=8)(self._page)
        # A thousand symbols share a name, and resolving asks for the same few again and again.
        self.by_name = lru_cache(maxsize=8)(self._by_name)
        self._shared: dict[object, object] = {}

    def shared(self, make: Callable[[BaseReader], _Shared]) -> _Shared:
        """What is made of the base once, for all that read it with this reader."""
        if make not in self._shared:
            self._shared[make] = make(self)
        return cast("_Shared", self._shared[make])

    def close(self) -> None:
        """Closes the file, and what was opened beside it."""
        self._opened.close()

    def close_with(self, close: Callable[[], object]) -> None:
        """Closes something else when the file is closed."""
        self._opened.callback(close)

    def rows(self, sql: str, *values: object) -> list[Any]:
        """Runs one SQL query. Raises BaseUnreadable for a damaged file, and BadQuery (see ``bounded``)."""
        try:
            rows = self._connection.execute(sql, values).fetchall()
        except UnicodeEncodeError:
            return []  # a lone surrogate is in no base
        except sqlite3.DatabaseError as error:
            raise self.damaged(error) from error
        self._work_left -= 1 + len(rows)
        if self._work_left < 0:
            raise BadQuery(
                "This query takes too much work. Ask one thing at a time: a name, an expression or a message."
            )
        return rows

    @contextmanager
    def bounded(self, most: float) -> Generator[None]:
        """Lets look-ups raise BadQuery once there were ``most`` of them and of the rows that they found, together.

        Within another bound it counts for itself.
        """
        before, self._work_left = self._work_left, most
        try:
            yield
        finally:
            self._work_left = before

    def rows_of(self, sql: str, keys: Collection[object], order: str = "") -> list[Any]:
        """The rows with any of the keys, by the columns ``order`` if given; ``sql`` ends with the keys' column."""
        if not keys:
            return []
        ordered = f" ORDER BY {order}" if order else ""
        # Filled up to a power of two: a statement of another length is prepared anew, which costs as much as it finds.
        values = [*keys]
        values += values[-1:] * ((1 << (len(values) - 1).bit_length()) - len(values))
        return self.rows(f"{sql} IN ({','.join('?' * len(values))}){ordered}", *values)

    def damaged(self, why: object) -> BaseUnreadable:
        """The error to raise for a file with wrong content."""
        return BaseUnreadable(f"{self.path}: damaged ({why}). {how_to_get_again(self.path)}")

    def _record(self, make: Callable[[dict[str, Any]], _Record], data: bytes) -> _Record:
        try:
            return make(unpack(data))
        except (zlib.error, ValueError, TypeError, KeyError, AttributeError) as error:
            raise self.damaged(error) from error

    @cached_property
    def meta(self) -> dict[str, str]:
        """Facts about the base: version, build, fingerprint, sources, missing sources, …"""
        return dict(self.rows("SELECT name, value FROM meta"))

    @cached_property
    def missing_sources(self) -> list[str]:
        """What the documentation that the base was built without is to it: its manual."""
        return [row["role"] for row in json.loads(self.meta.get("missing", "[]"))]

    def _entries(self, paths: Sequence[str]) -> dict[str, SymbolEntry | None]:
        rows = self.rows_of(f"SELECT {_ENTRY} FROM symbols WHERE path", paths)
        return {row[0]: SymbolEntry._make(row) for row in rows}

    def _page_entries(self, slugs: Sequence[str]) -> dict[str, PageEntry | None]:
        rows = self.rows_of(f"SELECT {_PAGE} FROM pages WHERE slug", slugs)
        return {row[0]: PageEntry._make(row) for row in rows}

    @cached_property
    def slugs(self) -> frozenset[str]:
        """The slugs of all pages."""
        return frozenset(slug for (slug,) in self.rows("SELECT slug FROM pages"))

    def takes_more_sockets(self, node: str, side: str) -> bool:
        """Whether a class of nodes gets sockets on a side by its items or its group's interface."""
        return any(name.startswith(f'{side}["{EXTEND}') for name in self.members(node))

    def is_page(self, identifier: str) -> bool:
        """Whether an id is a page's slug, and not a symbol's path."""
        return identifier in self.slugs

    def _page_children(self, slugs: Sequence[str]) -> dict[str, tuple[PageEntry, ...]]:
        rows = self.rows_of(f"SELECT parent, {_PAGE} FROM pages WHERE parent", slugs, "parent, position")
        return _grouped((row[0], PageEntry._make(row[1:])) for row in rows)

    def _manual_links(self, sources: Sequence[str]) -> dict[str, tuple[str, ...]]:
        sql = "SELECT source, target FROM links WHERE kind = 'manual' AND source"
        return _grouped(self.rows_of(sql, sources, "place"))

    def _manual_urls(self, sources: Sequence[str]) -> dict[str, str]:
        sql = """SELECT links.source, url || substr(target, instr(target || '#', '#')) FROM links
            JOIN pages ON slug = substr(target, 1, instr(target || '#', '#') - 1)
            WHERE kind = 'manual' AND links.source"""
        return dict(self.rows_of(sql, sources, "place DESC"))

    def _label_names(self, slugs: Sequence[str]) -> dict[str, dict[tuple[int, int], str]]:
        rows = self.rows_of("SELECT slug, section, line, names FROM label_names WHERE slug", slugs)
        names: dict[str, dict[tuple[int, int], str]] = {}
        for slug, section, line, text in rows:
            names.setdefault(slug, {})[section, line] = text
        return names

    def _by_key(self, keys: Sequence[str]) -> dict[str, tuple[tuple[int, str], ...]]:
        rows = self.rows_of("SELECT key, form, id FROM names WHERE key", keys, "key, form, id")
        return _grouped((key, (form, identifier)) for key, form, identifier in rows)

    def _members(self, owner: str) -> dict[str, SymbolEntry]:
        rows = self.rows(f"SELECT {_ENTRY} FROM symbols WHERE owner = ? ORDER BY id", owner)
        return {
            row[3] if row[1] != "socket" else row[0][len(owner) + 1 :]: SymbolEntry._make(row) for row in rows
        }

    def _subclasses(self, path: str) -> tuple[SymbolEntry, ...]:
        rows = self.rows(f"SELECT {_ENTRY} FROM symbols WHERE base = ? AND base != '' ORDER BY path", path)
        return tuple(SymbolEntry._make(row) for row in rows)

    def descendants(self, path: str) -> Iterator[SymbolEntry]:
        """Every class below a class, nearest first."""
        for child in self.subclasses(path):
            yield child
            yield from self.descendants(child.path)

    def labels_below(self, path: str) -> dict[str, str]:
        """The labels of a class and of every class below it."""
        sql = """WITH RECURSIVE below(path) AS (VALUES (?) UNION SELECT symbols.path FROM symbols
            JOIN below ON base = below.path AND base != '') SELECT path, label FROM symbols WHERE path IN below"""
        return dict(self.rows(sql, path))

    def lineage(self, path: str) -> Iterator[SymbolEntry]:
        """A class and its bases up to bpy_struct."""
        entry = self.entry(path)
        while entry is not None:
            yield entry
            entry = self.entry(entry.base) if entry.base else None

    def member(self, owners: Iterable[str], name: str) -> SymbolEntry | None:
        """The first that one of the owners has of a name; of a socket ``inputs["Factor"]``."""
        paths = {f"{owner}.{name}": owner for owner in owners}
        self.entry.load(paths)
        entries = ((self.entry(path), owner) for path, owner in paths.items())
        return next((entry for entry, owner in entries if entry and entry.owner == owner), None)

    def member_names(self, owner: str) -> list[str]:
        """The names of what a class's instances have, inherited members included, or of a module's: a collection's are
        its own and those of all collections, as it is no structure.
        """
        owners = [ancestor.path for ancestor in self.lineage(owner)] or [owner]
        if self.is_of_collection(owner):
            owners = [owner, *(ancestor.path for ancestor in self.lineage(COLLECTION))]
        return list(dict.fromkeys(name for path in owners for name in self._own_names(path)))

    def _own_names(self, owner: str) -> list[str]:
        """The names alone: a module has thousands, and what else is known of them takes megabytes."""
        name = "CASE kind WHEN 'socket' THEN substr(path, length(owner) + 2) ELSE name END"
        return [row[0] for row in self.rows(f"SELECT {name} FROM symbols WHERE owner = ? ORDER BY id", owner)]

    def content_lines(self, module: str) -> list[str]:
        """The lines of what a module has, its own machinery last. Not kept, as ``bpy.types`` has thousands."""
        sql = """SELECT line FROM symbols WHERE owner = ? AND grp != 'ui' ORDER BY substr(name, 1, 1) = '_', id"""
        return [row[0] for row in self.rows(sql, module)]

    def members_called(self, owner: str, stem: str) -> list[str]:
        """The names of a class's own members that are ``stem``, or begin with it and go on behind a ``_``."""
        sql = "SELECT name FROM symbols WHERE owner = ? AND (name = ? OR substr(name, 1, ?) = ?) ORDER BY id"
        return [row[0] for row in self.rows(sql, owner, stem, len(stem) + 1, f"{stem}_")]

    def member_of(self, cls: str, name: str) -> SymbolEntry | None:
        """A class's own or inherited member."""
        return self.member((ancestor.path for ancestor in self.lineage(cls)), name)

    def descends(self, cls: str, ancestor: str) -> bool:
        """Whether a class is ``ancestor`` or derives from it."""
        return any(entry.path == ancestor for entry in self.lineage(cls))

    @cached_property
    def object_data(self) -> dict[str, str]:
        """The class of an object's data by the object's type, for the types that have data."""
        types = self.symbol(f"{TYPES}Object.type")
        kinds = [item.identifier for item in types.enum_items] if types else []
        found = {kind: data_class(kind, lambda name: self.entry(TYPES + name) is not None) for kind in kinds}
        return {kind: TYPES + name for kind, name in found.items() if name}

    @cached_property
    def _types_of_data(self) -> dict[str, str]:
        return {cls: kind for kind, cls in self.object_data.items()}

    def object_type(self, cls: str) -> str:
        """The type of an object whose data is of a class; empty for none."""
        kinds = (self._types_of_data.get(entry.path, "") for entry in self.lineage(cls))
        return next(filter(None, kinds), "")

    def is_object_data(self, cls: str) -> bool:
        """Whether objects have instances of a class as data."""
        return self.object_type(cls) != ""

    def _symbol(self, path: str) -> Symbol | None:
        rows = self.rows("SELECT record FROM symbols WHERE path = ?", path)
        return self._record(symbol_from_json, rows[0][0]) if rows else None

    def _by_name(self, name: str) -> tuple[SymbolEntry, ...]:
        """Every symbol whose last part is exactly ``name``."""
        rows = self.rows(f"SELECT {_ENTRY} FROM symbols WHERE name = ? ORDER BY id", name)
        return tuple(SymbolEntry._make(row) for row in rows)

    def pointing_at(self, cls: str) -> list[SymbolEntry]:
        """The pointer properties whose value is a class, given by its name."""
        sql = f"""SELECT {_ENTRY} FROM symbols
            WHERE target = ? AND target != '' AND kind = 'property' AND type = 'pointer' ORDER BY path"""
        return [SymbolEntry._make(row) for row in self.rows(sql, cls)]

    @cached_property
    def labelled_classes(self) -> dict[str, list[str]]:
        """Label of several words, in small letters → the paths of RNA's classes that have it."""
        sql = "SELECT path, label FROM symbols WHERE owner = 'bpy.types' AND kind = 'class' AND label LIKE '% %'"
        found: dict[str, list[str]] = {}
        for path, label in self.rows(f"{sql} ORDER BY path"):
            found.setdefault(label.lower(), []).append(path)
        return found

    def pointers(self) -> list[SymbolEntry]:
        """All that point to a class."""
        sql = f"SELECT {_ENTRY} FROM symbols WHERE type = 'pointer' AND target != '' ORDER BY path"
        return [SymbolEntry._make(row) for row in self.rows(sql)]

    def collections_with(self, cls: str) -> list[SymbolEntry]:
        """The properties that are collections of a class, given by its name."""
        sql = f"""SELECT {_ENTRY} FROM symbols
            WHERE target = ? AND target != '' AND kind = 'property' AND type = 'collection' ORDER BY path"""
        return [SymbolEntry._make(row) for row in self.rows(sql, cls)]

    def is_of_collection(self, cls: str) -> bool:
        """Whether a class is that of collections, whose instances are no structures."""
        return cls.startswith(TYPES) and bool(self.collections_of(cls.removeprefix(TYPES)))

    def collections_of(self, cls: str) -> list[str]:
        """Paths of the properties whose collections are of a class of their own, given by its name."""
        sql = "SELECT path FROM symbols WHERE collection = ? AND collection != '' AND kind = 'property' ORDER BY id"
        return [row[0] for row in self.rows(sql, cls)]

    def enum_owners(self, key: str) -> list[tuple[str, str, str]]:
        """(owner, identifier, name) for every enumeration that has the item."""
        return self.rows("SELECT owner, identifier, name FROM enum_items WHERE key = ?", key)

    @cached_property
    def history_versions(self) -> list[str]:
        """All minor versions that the history knows, oldest first."""
        return json.loads(self.meta.get("history_versions", "[]"))

    @cached_property
    def unknown_modules(self) -> frozenset[str]:
        """The modules of other Blenders that the build lacks which this base was made from."""
        return frozenset(json.loads(self.meta.get("unknown_modules", "[]")))

    @cached_property
    def addon_names(self) -> dict[str, str]:
        """What add-ons register that Blender brings and that are not on from the start: path → add-on."""
        found: dict[str, list[str]] = json.loads(self.meta.get("addon_names", "{}"))
        return {path: addon for addon, paths in found.items() for path in paths}

    def removed(self, path: str) -> tuple[str, str, str] | None:
        """(first, last, gone) of a symbol that this version lacks: the versions that have it, the first without it.

        ``gone`` is empty for what only newer versions have.
        """
        rows = self.rows("SELECT first, last, gone FROM removed WHERE path = ?", path)
        return rows[0] if rows else None

    def removed_named(self, name: str) -> list[str]:
        """Paths of the symbols of other versions whose last part is exactly ``name``."""
        return [row[0] for row in self.rows("SELECT path FROM removed WHERE name = ? ORDER BY path", name)]

    def still_works(self, path: str) -> str:
        """The symbol that one gets by a former name that this Blender still takes; "" where it does not."""
        rows = self.rows("SELECT taken_as FROM still_works WHERE path = ?", path)
        return rows[0][0] if rows else ""

    def removed_by_key(self, key: str) -> list[str]:
        """Paths of symbols of other versions that are spelled like ``key``."""
        return [
            row[0] for row in self.rows("SELECT path FROM removed_names WHERE key = ? ORDER BY path", key)
        ]

    def successors(self, path: str) -> list[Successor]:
        """What takes the place of a symbol that this version lacks, best first; empty where no source says it."""
        sql = "SELECT target, how, version, source FROM successors WHERE path = ? ORDER BY position"
        return [Successor(*row) for row in self.rows(sql, path)]

    def replaced_by(self, path: str) -> list[str]:
        """Paths of the symbols that other versions had in place of one that this version has."""
        return [
            row[0] for row in self.rows("SELECT path FROM successors WHERE target = ? ORDER BY path", path)
        ]

    def successors_of_classes(self) -> list[tuple[str, str]]:
        """(removed class, class in its place), the best first for each."""
        sql = """SELECT path, target FROM successors WHERE path GLOB 'bpy.types.*' AND path NOT GLOB 'bpy.types.*[.(:]*'
            AND target != '' ORDER BY path, position"""
        return self.rows(sql)

    def similar_names(self, path: str) -> list[tuple[str, float]]:
        """The symbols that resemble one without known successor, with scores, best first."""
        return self.rows("SELECT target, score FROM similar_names WHERE path = ? ORDER BY score DESC", path)

    def since(self, path: str) -> str:
        """The version that introduced a symbol; empty where that is not known, and for those older than the history."""
        version, lacked = self.arrival(path)
        return "" if lacked else version

    def arrival(self, path: str) -> tuple[str, str]:
        """(the first version known to have a symbol, the last one known to lack it unless it is the one just before);
        both empty for those older than the history.
        """
        rows: list[tuple[str, str]] = self.rows("SELECT version, lacked FROM since WHERE path = ?", path)
        return rows[0] if rows else ("", "")

    def gone_in(self, version: str) -> list[str]:
        """Paths of the symbols that a version was the first to lack."""
        return [row[0] for row in self.rows("SELECT path FROM removed WHERE gone = ? ORDER BY path", version)]

    def new_in(self, version: str) -> list[str]:
        """Paths of the symbols that a version was the first to have."""
        sql = "SELECT path FROM since WHERE version = ? AND lacked = '' ORDER BY path"
        return [row[0] for row in self.rows(sql, version)]

    def uses(self, path: str) -> list[Use]:
        """The clearest uses of a symbol in Blender's own scripts and the guides, best first."""
        sql = "SELECT file, line, code FROM uses WHERE path = ? ORDER BY rank"
        return [Use(*row) for row in self.rows(sql, path)]

    def use_counts(self, paths: Collection[str]) -> dict[str, int]:
        """How often Blender's own scripts use each of some symbols; those that they do not use are left out."""
        return dict(self.rows_of("SELECT path, uses FROM use_counts WHERE path", paths))

    def conditions_of(self, path: str) -> list[SettingCondition]:
        """What other settings a property or operator depends on, by clause."""
        sql = "SELECT path, clause, gate, test, otherwise FROM setting_conditions WHERE path = ? ORDER BY clause"
        return [SettingCondition(*row) for row in self.rows(sql, path)]

    def depending_on(self, gate: str, test: str, *otherwise: Otherwise) -> list[str]:
        """The properties that are ``otherwise`` unless ``gate`` is ``test``, by path."""
        sql = f"""SELECT path FROM setting_conditions AS own
            WHERE gate = ? AND test = ? AND otherwise IN ({",".join("?" * len(otherwise))}) AND NOT EXISTS (
            SELECT 1 FROM setting_conditions WHERE path = own.path AND clause = own.clause AND gate != own.gate
            ) ORDER BY path"""
        return [row[0] for row in self.rows(sql, gate, test, *otherwise)]

    def passage(self, path: str) -> tuple[str, int, int] | None:
        """(slug, number of the section, line of its text) of the place in the manual that is about a symbol."""
        rows = self.rows("SELECT slug, section, line FROM passages WHERE path = ?", path)
        return rows[0] if rows else None

    def passage_text(self, path: str) -> tuple[str, str, str]:
        """(slug, headings, text) of that place; all empty where there is none."""
        rows: list[tuple[str, str, str]] = self.rows(
            "SELECT slug, headings, text FROM passages WHERE path = ?", path
        )
        return rows[0] if rows else ("", "", "")

    def weights(self, paths: Collection[str]) -> dict[str, float]:
        """How much symbols count among their like; those that count nothing are left out."""
        return dict(self.rows_of("SELECT path, weight FROM weights WHERE path", paths))

    def heaviest(self, entries: Iterable[SymbolEntry], least: float = 0.0) -> list[SymbolEntry]:
        """Entries of at least some weight, by weight; those of equal weight keep their order."""
        found = list(entries)
        weights = self.weights([entry.path for entry in found])
        heavy = [entry for entry in found if weights.get(entry.path, 0.0) >= least]
        return sorted(heavy, key=lambda entry: -weights.get(entry.path, 0.0))

    def member_weights(self, owners: Collection[str]) -> dict[str, list[float]]:
        """The weights of the members of classes, by class."""
        sql = """SELECT owner, weight FROM symbols JOIN weights ON weights.path = symbols.path
            WHERE kind IN ('property', 'function') AND owner"""
        weights: dict[str, list[float]] = {}
        for owner, weight in self.rows_of(sql, owners):
            weights.setdefault(owner, []).append(weight)
        return weights

    def creations(self, paths: Collection[str]) -> dict[str, Creation]:
        """Class → how an instance is made, for those that have a call."""
        rows = self.rows_of("SELECT path, call, maker, choice FROM creation WHERE path", paths)
        return {row[0]: Creation(*row[1:]) for row in rows}

    def calls_of(self, maker: str) -> list[tuple[str, str]]:
        """(call, its choice) of all that a function makes."""
        return self.rows("SELECT call, choice FROM creation WHERE maker = ? ORDER BY path", maker)

    def made_by_call(self, call: str) -> str:
        """The class of which a call makes an instance; empty for none."""
        return next((row[0] for row in self.rows("SELECT path FROM creation WHERE call = ?", call)), "")

    def made_as(self, name: str) -> list[str]:
        """The classes of whose calls one gives a new instance this name."""
        return [row[0] for row in self.rows("SELECT path FROM creation WHERE instr(call, ?)", f'"{name}"')]

    def made_by_choice(self, choice: str) -> list[tuple[str, str]]:
        """(class, what makes it) of the classes of which a call makes an instance with this choice."""
        return self.rows("SELECT path, maker FROM creation WHERE choice = ? ORDER BY path", choice)

    def class_made(self, function: str, result: str, choice: str) -> str:
        """The class of which a function makes an instance with a choice, or else another one that gives the same
        ``result``, a class, as bones take the constraints of objects; empty for none.
        """
        makers = self.made_by_choice(choice)
        own = next((cls for cls, maker in makers if maker == function), "")
        return own or next((cls for cls, _ in makers if result and self.descends(cls, result)), "")

    def operators_taking(self, argument: str) -> list[str]:
        """Paths of the operators with an argument of that name."""
        sql = "SELECT path FROM operator_arguments JOIN symbols ON id = operator WHERE argument = ? ORDER BY path"
        return [row[0] for row in self.rows(sql, argument)]

    def is_written(self, name: str) -> bool:
        """Whether a name stands in a call's text, or in what Blender's own scripts write: as an argument, say."""
        sql = """SELECT EXISTS (SELECT 1 FROM symbols WHERE kind IN ('function', 'operator') AND instr(line, ?))
            OR EXISTS (SELECT 1 FROM uses WHERE instr(code, ?))"""
        return bool(self.rows(sql, name, name)[0][0])

    @cached_property
    def operator_arguments(self) -> frozenset[str]:
        """The names of all operators' arguments."""
        return frozenset(row[0] for row in self.rows("SELECT DISTINCT argument FROM operator_arguments"))

    def functions_named(self, prefix: str) -> list[str]:
        """Paths of the functions of data classes whose names begin with a key."""
        sql = """SELECT DISTINCT path FROM names JOIN symbols ON symbols.path = names.id
            WHERE form = ? AND key >= ? AND key < ? AND kind = 'function' AND owner LIKE 'bpy.types.%'"""
        return [row[0] for row in self.rows(sql, FORM_NAME, prefix, prefix + "\uffff")] if prefix else []

    def symbols_of_page(self, slug: str) -> list[str]:
        """The symbols that a page explains, by Blender's own table."""
        return [row[0] for row in self.rows("SELECT symbol FROM explained WHERE slug = ?", slug)]

    @cached_property
    def deprecated_properties(self) -> frozenset[str]:
        """The paths of the properties that Blender calls deprecated: dozens, about which every answer asks."""
        sql = "SELECT path FROM symbols WHERE kind = 'property' AND marks & ?"
        return frozenset(path for (path,) in self.rows(sql, _DEPRECATED))

    @cached_property
    def data_classes(self) -> list[tuple[str, str]]:
        """(path, name) of every data class."""
        return self.rows("SELECT path, name FROM symbols WHERE kind = 'class' AND grp = 'data'")

    def operators_of(self, module: str) -> list[str]:
        """Paths of the operators in a module of ``bpy.ops``, named by its key."""
        sql = "SELECT path FROM symbols WHERE kind = 'operator' AND owner = ? ORDER BY path"
        return [row[0] for row in self.rows(sql, f"bpy.ops.{module}")]

    def _page(self, slug: str) -> Page | None:
        rows = self.rows("SELECT record FROM pages WHERE slug = ?", slug)
        return self._record(page_from_json, rows[0][0]) if rows else None


def _grouped(rows: Iterable[tuple[str, _Value]]) -> dict[str, tuple[_Value, ...]]:
    """Key → its values, in the order of the rows."""
    groups: dict[str, list[_Value]] = {}
    for own, value in rows:
        groups.setdefault(own, []).append(value)
    return {own: tuple(values) for own, values in groups.items()}
