"""Compares a base's defaults with new things in a running Blender, made by other code than the extractor's."""

from __future__ import annotations

import json
import random
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, NamedTuple

from kb_build.schema import open_read_only, unpack
from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flag_names import EMPTY, FILLED_ON
from kb_build.symbols.flags import empty_when_new, fillers
from kb_build.symbols.lines import literal
from kb_build.symbols.records import symbol_from_json
from simworlds.installed import installed_bpy
from simworlds.sandbox.program import Program
from simworlds.sandbox.runtime import Runtime, run_program

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kb_build.symbols.records import Default, Symbol

    _Symbols = Mapping[str, Symbol | str]

_PROGRAM = Program(
    "kb_build.live.inside.new_instances", {"kb_build.live.inside": Path(__file__).parent / "inside"}
)
_SECONDS = 120.0
_COMPARED = "compared"
_PRECISION = 1e-5
_NONE = {True: "None", False: "not None"}


@dataclass(frozen=True, slots=True)
class ComparedValues:
    """The outcome: how many (thing, property) pairs were compared; those whose RNA default differs; wrong ones."""

    compared: int
    differing: int
    wrong: tuple[str, ...]


def compare_values(
    base: Path, runtime: Runtime, *, sample: int | None = None, seed: int | None = None
) -> ComparedValues:
    """Makes new things in ``runtime`` and compares what they hold with what ``base`` says.

    ``sample`` pairs are drawn at random, all by default. Raises ProgramFailed when Blender does not finish,
    StoreError or NoBase when the base cannot be read.
    """
    with TemporaryDirectory(prefix="simworlds-") as folder:
        target = Path(folder) / "rows.json"
        run_program(runtime, _PROGRAM, [str(target)], timeout=_SECONDS, log=Path(folder) / "log")
        made: dict[str, Any] = json.loads(target.read_text(encoding="utf-8"))
    symbols = _properties(base)
    pairs = sorted(
        (
            *_values(symbols, made["rows"]),
            *_pointers(symbols, made["rows"]),
            *_collections(symbols, made["rows"]),
            *_fillers(symbols, made["filled"]),
        )
    )
    if sample is not None:
        pairs = random.Random(seed).sample(pairs, min(sample, len(pairs)))  # noqa: S311 - a sample
    wrong = tuple(pair.wrong for pair in pairs if pair.wrong)
    return ComparedValues(len(pairs), sum(pair.differs for pair in pairs), wrong)


class _Pair(NamedTuple):
    """One thing that was compared: what it is, whether RNA says something else, and what is wrong, if anything."""

    label: str
    cls: str
    name: str
    differs: bool
    wrong: str


def _held(
    symbols: _Symbols, rows: Iterable[Mapping[str, Any]], part: str, flag: str
) -> Iterator[tuple[str, str, Symbol, Any]]:
    """(what is new, its class, a property with a flag, what was seen of that) of each row."""
    for row in rows:
        for name, seen in row[part].items():
            symbol = _member(symbols, row["class"], name)
            if symbol is not None and flag in symbol.flags:
                yield row["label"], row["class"], symbol, seen


def _values(symbols: _Symbols, rows: Iterable[Mapping[str, Any]]) -> set[_Pair]:
    """The values of new things beside those that are told."""
    pairs: set[_Pair] = set()
    for label, cls, symbol, value in _held(symbols, rows, "values", _COMPARED):
        if value is None or label.startswith(f"{symbol.name}="):
            continue
        told = told_value(symbol, label)
        if told is None or (symbol.type == "enum" and value == ""):  # a number that stands for no item
            continue
        wrong = f"{cls}.{symbol.name} of a new {label}: {literal(value)}, told {literal(told)}"
        differs = not same_value(symbol.default, value)
        pairs.add(_Pair(label, cls, symbol.name, differs, "" if same_value(told, value) else wrong))
    return pairs


def _pointers(symbols: _Symbols, rows: Iterable[Mapping[str, Any]]) -> set[_Pair]:
    """Whether pointers of new things are None, beside what is told."""
    pairs: set[_Pair] = set()
    for label, cls, symbol, leads in _held(symbols, rows, "pointers", _COMPARED):
        told = told_empty(symbol, label)
        wrong = f"{cls}.{symbol.name} of a new {label}: {_NONE[not leads]}, told {_NONE[told]}"
        pairs.add(_Pair(label, cls, symbol.name, False, wrong if told is leads else ""))
    return pairs


def _collections(symbols: _Symbols, rows: Iterable[Mapping[str, Any]]) -> set[_Pair]:
    """Whether collections of new things have elements that are told to be empty."""
    pairs: set[_Pair] = set()
    for label, cls, symbol, has_elements in _held(symbols, rows, "collections", EMPTY):
        wrong = f"{cls}.{symbol.name} of a new {label}: has elements, told empty"
        pairs.add(_Pair(label, cls, symbol.name, False, wrong if has_elements else ""))
    return pairs


def _fillers(symbols: _Symbols, filled: Mapping[str, Sequence[str]]) -> set[_Pair]:
    """The calls that are told to fill pointers, beside what they filled."""
    pairs: set[_Pair] = set()
    for symbol in symbols.values():
        calls = [] if isinstance(symbol, str) else fillers(symbol)
        if isinstance(symbol, str) or len(calls) != 1 or calls[0] not in filled:
            continue
        name = symbol.path.removeprefix(TYPES)
        wrong = (
            ""
            if name in filled[calls[0]]
            else f"{name} is still None after {calls[0]}, which is told to make it"
        )
        pairs.add(_Pair(calls[0], name.partition(".")[0], symbol.name, False, wrong))
    return pairs


def runtime_at_hand(meta: Mapping[str, str]) -> Runtime | None:
    """The Blender that a base was built from, if it is still there: nothing is installed for a comparison."""
    built_from = json.loads(meta.get("runtime") or "{}")
    executable, version = Path(built_from.get("executable", "")), meta.get("blender", "")
    if version and installed_bpy() == version:
        return Runtime(Path(sys.executable), "environment", version)
    if built_from.get("kind") in {"executable", "managed"} and executable.is_file():
        return Runtime(executable, built_from["kind"], version)
    return None


def told_value(symbol: Symbol, label: str) -> Default:
    """What a base tells of a new thing: by its name, by the mode that names it, else the usual value."""
    for new in symbol.new_values:
        if label == new.when or (label in new.made and not new.when):
            return new.value
    return next((new.value for new in symbol.new_values if not new.when), symbol.default)


def told_empty(symbol: Symbol, label: str) -> bool:
    """Whether a base tells that a pointer of a new thing is None."""
    empty = empty_when_new(symbol)
    return empty is not None and (
        label in empty.made or not (empty.made or FILLED_ON + label in symbol.flags)
    )


def same_value(told: Default, value: Default) -> bool:
    """Whether two values are equal, floats as far as single precision goes."""
    if isinstance(told, list) and isinstance(value, list):
        return len(told) == len(value) and all(same_value(*pair) for pair in zip(told, value, strict=True))
    if isinstance(told, int | float) and isinstance(value, int | float):
        return abs(told - value) <= _PRECISION * max(abs(told), abs(value), _PRECISION)
    return told == value


def _properties(base: Path) -> dict[str, Symbol | str]:
    """The compared properties by path, and class → base class."""
    connection = open_read_only(base)
    try:
        rows: Iterable[tuple[str, str, str, bytes]] = connection.execute(
            "SELECT path, kind, base, record FROM symbols WHERE kind IN ('class', 'property')"
        )
        known: dict[str, Symbol | str] = {}
        for path, kind, above, record in rows:
            if kind == "class":
                known[path] = above
            elif path.startswith(TYPES):
                known[path] = symbol_from_json(unpack(record))
    finally:
        connection.close()
    return known


def _member(symbols: _Symbols, cls: str, name: str) -> Symbol | None:
    """The property of a class, or of the nearest class above it."""
    owner: Any = TYPES + cls
    while isinstance(owner, str) and owner in symbols:
        found = symbols.get(f"{owner}.{name}")
        if found is not None and not isinstance(found, str):
            return found
        owner = symbols[owner]
    return None
