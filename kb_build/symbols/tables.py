"""The rows that a base has of its symbols, and of the names of symbols and pages."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from functools import reduce
from itertools import groupby
from operator import attrgetter, itemgetter, or_
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, short_path, terms, topic_key
from kb_build.index.creation import creation_calls
from kb_build.index.empty_ways import EmptyWays
from kb_build.schema import FORM_LABEL, FORM_NAME, FORM_PATH, FORM_SHORT, FORM_TOPIC, Mark, pack
from kb_build.symbols.flags import empty_when_new, fillers, has_unseen_default, is_locked
from kb_build.symbols.lines import leaves_out_values, member_line, switches
from kb_build.symbols.records import to_json
from kb_build.usage.examples import SymbolUsage

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence

    from kb_build.pages.page import Page
    from kb_build.panels.panel_labels import PanelLabel
    from kb_build.symbols.records import SettingCondition, Symbol
    from kb_build.usage.examples import Uses

    Row = tuple[object, ...]

_TWO_ACTIONS = re.compile(r"(?P<first>\w+ing) (?:&|and) (?P<second>\w+ing)(?: (?P<rest>\w+))?")


@dataclass(frozen=True, slots=True)
class SymbolTables:
    """Rows of the tables symbols, names, enum_items, operator_arguments, creation and setting_conditions, as schema.DDL
    has them, where scripts use symbols, and where panels show properties.
    """

    symbols: Sequence[Row]
    names: Sequence[Row]
    enum_items: Sequence[Row]
    operator_arguments: Sequence[Row]
    creation: Sequence[Row]
    conditions: Sequence[SettingCondition] = ()
    uses: Mapping[str, Uses] = field(default_factory=dict[str, "Uses"])
    panels: Mapping[str, Sequence[PanelLabel]] = field(default_factory=dict[str, "Sequence[PanelLabel]"])


def symbol_tables(
    symbols: Sequence[Symbol], pages: Sequence[Page], used: Callable[[], SymbolUsage] = SymbolUsage
) -> SymbolTables:
    """The rows of all symbols, and of the names of ``pages``.

    ``used`` gives the uses of the symbols in scripts. It is called last: it may wait for them.
    """
    names = {row for symbol in symbols for row in symbol_names(symbol)}
    # In the order of their keys: SQLite then fills page after page, and splits none.
    names.update(row for page in pages for row in page_names(page))
    titles = {name for name, form, _ in names if form == FORM_TOPIC}
    names = sorted(names.union(action_names(pages, titles)))
    items = sorted((row for symbol in symbols for row in enum_rows(symbol)), key=itemgetter(0, 1, 2))
    # Only classes are looked at again, once it is known how they are reached.
    records = [pack(to_json(symbol)) if symbol.kind != "class" else b"" for symbol in symbols]
    usage = used()
    calls = creation_calls(symbols, usage.reached, usage.names)
    on = _switches(usage.conditions)
    ways = EmptyWays(symbols, usage.reached)
    placed = [_with_way(symbol, usage.reached, ways) for symbol in symbols]
    return SymbolTables(
        symbols=[
            (
                number, symbol.path, symbol.kind, symbol.owner, symbol.name, symbol.type, symbol.target,
                symbol.collection, symbol.base, symbol.group, symbol.label, int(marks_of(symbol)),
                member_line(symbol, on.get(symbol.path, "")),
                symbol.reached, symbol.lacks, choices_of(symbol), record or pack(to_json(symbol)),
            )
            for number, (symbol, record) in enumerate(zip(placed, records, strict=True))
        ],
        names=names,
        enum_items=items,
        operator_arguments=sorted(
            (parameter.name, number)
            for number, symbol in enumerate(symbols) if symbol.kind == "operator"
            for parameter in symbol.parameters
        ),
        creation=[(path, *creation) for path, creation in calls.items()],
        conditions=usage.conditions,
        uses=usage.uses,
        panels=usage.panels,
    )  # fmt: skip


def marks_of(symbol: Symbol) -> Mark:
    """What is known of a symbol without its record."""
    empty = empty_when_new(symbol)
    known = {
        Mark.READ_ONLY: is_locked(symbol),
        Mark.DEPRECATED: symbol.deprecation is not None,
        Mark.UNSEEN: has_unseen_default(symbol),
        Mark.GIVEN: empty is not None and not empty.made and not fillers(symbol),
    }
    return reduce(or_, (mark for mark, holds in known.items() if holds), Mark(0))


def choices_of(symbol: Symbol) -> str:
    """The stems of the words of a symbol's arguments and values; empty where its line tells them all."""
    if not leaves_out_values(symbol):
        return ""
    items = (symbol.enum_items, *(parameter.enum_items for parameter in symbol.parameters))
    names = [name for each in items for item in each for name in (item.name, item.identifier)]
    names += (name for parameter in symbol.parameters for name in (parameter.name, parameter.label))
    return " ".join(sorted({stem for name in names for stem in terms(name)}))


def symbol_names(symbol: Symbol) -> Iterator[tuple[str, int, str]]:
    """(key, form, path) for every spelling under which a symbol is asked for."""
    short = short_path(symbol.path)
    yield key(symbol.path), FORM_PATH, symbol.path
    yield key(short), FORM_SHORT, symbol.path
    if symbol.kind == "operator":
        yield key(symbol.target), FORM_SHORT, symbol.path
        yield key(f"bpy.types.{symbol.target}"), FORM_SHORT, symbol.path
    if symbol.is_of_interface or symbol.is_class_lookup:
        return
    yield key(symbol.name), FORM_NAME, symbol.path
    if symbol.kind == "socket":
        # Not its own name, which hundreds of sockets share.
        others = (name for name in symbol.socket_keys if name != symbol.name)
        yield from ((key(f"{symbol.side}{name}"), FORM_SHORT, symbol.path) for name in others)
    if symbol.kind == "class" and symbol.owner == "bpy.types":
        yield key(f"types.{symbol.name}"), FORM_SHORT, symbol.path
    if symbol.label and symbol.kind != "socket":
        yield key(symbol.label), FORM_LABEL, symbol.path


def page_names(page: Page) -> Iterator[tuple[str, int, str]]:
    """(key, form, slug) for a page: its slug, the slug's last part, its title."""
    yield key(page.slug), FORM_PATH, page.slug
    yield key(page.slug.removesuffix("/index")), FORM_SHORT, page.slug
    yield key(page.slug.removesuffix("/index").rpartition("/")[2]), FORM_NAME, page.slug
    yield key(page.title), FORM_LABEL, page.slug
    yield topic_key(page.title), FORM_TOPIC, page.slug


def action_names(pages: Iterable[Page], titles: Container[str]) -> Iterator[tuple[str, int, str]]:
    """The topics of pages on two actions: ``Importing & Exporting Files`` is asked for by either word.

    Not by one that is a page's own title; ``titles`` are the keys of these.
    """
    for page in pages:
        both = _TWO_ACTIONS.fullmatch(page.title)
        for action in (both["first"], both["second"]) if both else ():
            named = {topic_key(action), topic_key(f"{action} {both['rest'] or ''}")} if both else set[str]()
            yield from ((name, FORM_TOPIC, page.slug) for name in sorted(named) if name not in titles)


def enum_rows(symbol: Symbol) -> Iterator[tuple[str, str, str, str]]:
    """(key, owner, identifier, name) of a symbol's own enum items, of what it returns, and of its parameters'."""
    if symbol.kind == "enum":
        return
    for item in (*symbol.enum_items, *(item for returned in symbol.returns for item in returned.enum_items)):
        yield key(item.identifier), symbol.path, item.identifier, item.name
    for parameter in symbol.parameters:
        for item in parameter.enum_items:
            yield key(item.identifier), f"{symbol.path}({parameter.name})", item.identifier, item.name


def _with_way(symbol: Symbol, reached: Mapping[str, str], ways: EmptyWays) -> Symbol:
    """A class with the expression that leads to an instance, and what that way lacks."""
    path = reached.get(symbol.path)
    return replace(symbol, reached=path, lacks=ways.last_empty(symbol.name)) if path else symbol


def _switches(conditions: Iterable[SettingCondition]) -> dict[str, str]:
    """Property → the settings of its own class of which panels want one on, else grey it out: ``use_a or use_b``."""
    found: dict[str, str] = {}
    for path, rows in groupby(conditions, key=attrgetter("path")):
        cls = path.rpartition(".")[0]
        for gates in switches(rows):
            if all(gate.rpartition(".")[0] == cls for gate in gates):
                found.setdefault(path, " or ".join(gate.rpartition(".")[2] for gate in gates))
    return found
