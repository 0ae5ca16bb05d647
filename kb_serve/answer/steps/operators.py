"""The operators that run what a topic's steps have made and set."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_build.symbol_lines import literal, operator_areas, operator_needs, refused_nothing
from kb_serve.answer.panel_lines import panel_lines
from kb_serve.reader import TYPES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.records import Symbol
    from kb_serve.answer.steps.topic_names import TopicNames
    from kb_serve.reader import BaseReader

POINT_CACHE = f"{TYPES}PointCache"  # what operators bake
_MOST = 4
_ARGUMENTS = 3  # of an operator's call
_USED_ELSEWHERE = 3  # weight of an operator that has not the topic's module
_PATH = "data_path"
_BAKE = "bake"  # what runs what has been set, wherever it is
_MAKE_OR_REMOVE = frozenset(
    {
        "add",
        "new",
        "create",
        "insert",
        "remove",
        "delete",
        "free",
        "clear",
        "preset",
        "copy",
        "paste",
        "select",
        "move",
        "reset",
        "toggle",
        "hide",
    }
)


def runs(names: TopicNames, reader: BaseReader, *, is_cached: bool, is_made: bool) -> Iterator[str]:
    """The topic's operators that neither make nor remove anything; before them what bakes the cache, if it has one.

    Where a thing that is called as the topic ``is_made``, those are left out that do something else: an armature
    modifier needs none of an armature's operators.
    """
    weights = reader.weights(list(names.operators))
    operators = [
        path
        for path in names.operators
        if _runs(path)
        and not _wants_a_path(reader.symbol(path))
        and weights.get(path, 0) >= (1 if path.split(".")[2] in names.keys else _USED_ELSEWHERE)
        and not (is_made and _is_beside(path, names, reader))
    ]
    if is_cached:
        operators = [*_bakes(reader), *operators]
    for path in operators[:_MOST]:
        yield _line(path, reader)


def _is_beside(path: str, names: TopicNames, reader: BaseReader) -> bool:
    """Whether neither an operator nor its module is called as the topic is, or it waits for a window."""
    _, _, module, name = path.split(".")
    if names.has_title(name) or names.title.removesuffix("s") in key(name) or _BAKE in name.split("_"):
        return False
    if key(module) != names.title:
        return True
    symbol = reader.symbol(path)
    return symbol is not None and (bool(operator_areas(symbol)) or _never_ran(symbol))


def _never_ran(operator: Symbol) -> bool:
    """Whether an operator's poll said no wherever it was tried, without a window."""
    return not (operator_needs(operator) or refused_nothing(operator))


def asked(operator: Symbol, reader: BaseReader) -> str:
    """What must be before an operator runs, and does what is wanted; empty for nothing."""
    return "; ".join(_asked(operator, reader))


def _asked(operator: Symbol, reader: BaseReader) -> Iterator[str]:
    if needs := operator_needs(operator):
        yield f"takes {needs}"
    elif _never_ran(operator):
        yield "not seen to run without a window"
    yield from panel_lines(operator, reader)


def _runs(path: str) -> bool:
    return _MAKE_OR_REMOVE.isdisjoint(path.rpartition(".")[2].split("_"))


def _wants_a_path(operator: Symbol | None) -> bool:
    """Whether an operator works on what a path in a string names, and on nothing where none is given."""
    parameters = operator.parameters if operator else ()
    return any(parameter.name == _PATH and not parameter.default for parameter in parameters)


def _bakes(reader: BaseReader) -> Iterator[str]:
    """The heaviest operator of the page that explains the cache."""
    for target in reader.manual_links(POINT_CACHE):
        paths = reader.symbols_of_page(target.partition("#")[0])
        entries = (reader.entry(path) for path in paths if _runs(path))
        operators = [entry for entry in entries if entry and entry.kind == "operator"]
        yield from (entry.path for entry in reader.heaviest(operators)[:1])


def _line(path: str, reader: BaseReader) -> str:
    """An operator's call with its first arguments, and what it does."""
    symbol = reader.symbol(path)
    given = [p for p in symbol.parameters if p.default is not None] if symbol else []
    arguments = [f"{p.name}={literal(p.default)}" for p in given[:_ARGUMENTS]]
    left = len(symbol.parameters) - len(arguments) if symbol else 0
    entry = reader.entry(path)
    said = entry.line.partition(" — ")[2] if entry else ""
    more = f" and {left} more" if left else ""
    needed = asked(symbol, reader) if symbol else ""
    return (
        f"`{path}({', '.join(arguments)})`{more}"
        + (f" — {said}" if said else "")
        + (f" ({needed})" if needed else "")
    )
