"""Compares two Blenders' APIs: added, removed and changed symbols."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from kb_build.blender.call_texts import python_value
from kb_build.symbols.flag_names import READ_ONLY

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kb_build.blender.extract_reader import Extract
    from kb_build.symbols.records import EnumItem, Parameter, Symbol


@dataclass(frozen=True, slots=True)
class SymbolChange:
    """One difference of a symbol that both have.

    ``what`` is ``type``, ``default``, ``range``, ``unit``, ``base``, ``read-only``, ``deprecated``,
    ``enum items`` or ``parameters``; ``old`` and ``new`` are texts for people (enum items and parameters: what
    was removed, what was added).
    """

    path: str
    what: str
    old: str
    new: str


@dataclass(frozen=True, slots=True)
class DiffEntry:
    """A symbol that only one of the two has."""

    path: str
    kind: str
    owner: str


@dataclass(frozen=True, slots=True)
class Diff:
    """The differences between two full versions, each list sorted by path."""

    old: str
    new: str
    added: tuple[DiffEntry, ...]
    removed: tuple[DiffEntry, ...]
    changed: tuple[SymbolChange, ...]

    def under(self, prefix: str) -> Diff:
        """The part whose paths are ``prefix`` or go on from it (``bpy.types.Mesh``, ``bpy.ops``)."""
        return Diff(
            self.old,
            self.new,
            tuple(entry for entry in self.added if is_under(entry.path, prefix)),
            tuple(entry for entry in self.removed if is_under(entry.path, prefix)),
            tuple(change for change in self.changed if is_under(change.path, prefix)),
        )

    def to_json(self) -> dict[str, Any]:
        """The same as JSON-ready data."""
        return asdict(self)


def is_under(path: str, prefix: str) -> bool:
    """Whether a path is ``prefix`` or goes on from it."""
    rest = path.removeprefix(prefix)
    return path.startswith(prefix) and not (rest and f"_{rest[0]}".isidentifier())


def diff(old: Extract, new: Extract, *, interface: bool = False) -> Diff:
    """Compares two extracts. Panels, menus and other interface classes are left out unless ``interface``."""
    before, after = (_compared(extract.symbols, interface) for extract in (old, new))
    both = before.keys() & after.keys()
    return Diff(
        old.version,
        new.version,
        _entries(after[path] for path in sorted(after.keys() - before.keys())),
        _entries(before[path] for path in sorted(before.keys() - after.keys())),
        tuple(change for path in sorted(both) for change in _changes(before[path], after[path])),
    )


def _compared(symbols: Sequence[Symbol], interface: bool) -> dict[str, Symbol]:
    hidden = {symbol.path for symbol in symbols if symbol.is_of_interface and not interface}
    return {
        symbol.path: symbol
        for symbol in symbols
        if symbol.path not in hidden and symbol.owner not in hidden and not _is_repeated(symbol)
    }


def _is_repeated(symbol: Symbol) -> bool:
    return symbol.is_class_lookup or bool(symbol.same_as)


def _entries(symbols: Iterable[Symbol]) -> tuple[DiffEntry, ...]:
    return tuple(DiffEntry(symbol.path, symbol.kind, symbol.owner) for symbol in symbols)


def _changes(old: Symbol, new: Symbol) -> Iterator[SymbolChange]:
    before, after = _facts(old), _facts(new)
    for what in dict.fromkeys((*before, *after)):
        if before.get(what, "") != after.get(what, ""):
            yield SymbolChange(new.path, what, before.get(what, ""), after.get(what, ""))
    yield from _items_change(new.path, old.enum_items, new.enum_items)
    if old.kind == new.kind:
        yield from _parameters_change(new.path, old.parameters, new.parameters)


def _facts(symbol: Symbol) -> dict[str, str]:
    """The facts that are compared, as texts: a class's base, a member's type and value."""
    if symbol.kind in {"class", "module"}:
        return {"base": symbol.base}
    facts = {
        "type": _type(symbol),
        "unit": symbol.unit,
        "range": _range(symbol.hard_min, symbol.hard_max),
        "read-only": "yes" if READ_ONLY in symbol.flags else "",
        "deprecated": symbol.deprecation.note or "yes" if symbol.deprecation else "",
    }
    # A default of a run-time enumeration or of a constant is the machine's, not the API's.
    if symbol.default is not None and not symbol.enum_computed and symbol.kind != "data":
        facts["default"] = python_value(symbol.default)
    return facts


def _type(symbol: Symbol) -> str:
    length = "".join(f"[{n}]" for n in symbol.array)
    return (
        symbol.type + length + (f" of {symbol.target}" if symbol.target and symbol.kind != "operator" else "")
    )


def _range(low: float | None, high: float | None) -> str:
    if low is None and high is None:
        return ""
    return f"{'-inf' if low is None else low} … {'inf' if high is None else high}"


def _items_change(
    path: str, old: Sequence[EnumItem], new: Sequence[EnumItem], prefix: str = ""
) -> Iterator[SymbolChange]:
    if not old or not new:
        return
    before, after = [item.identifier for item in old], [item.identifier for item in new]
    gone = [name for name in before if name not in set(after)]
    come = [name for name in after if name not in set(before)]
    if gone or come:
        yield SymbolChange(path, f"{prefix}enum items", ", ".join(gone), ", ".join(come))


def _parameters_change(
    path: str, old: Sequence[Parameter], new: Sequence[Parameter]
) -> Iterator[SymbolChange]:
    before = {parameter.name: parameter for parameter in old}
    after = {parameter.name: parameter for parameter in new}
    gone = [name for name in before if name not in after]
    come = [name for name in after if name not in before]
    if gone or come:
        yield SymbolChange(path, "parameters", ", ".join(gone), ", ".join(come))
    for name in (name for name in after if name in before):
        previous, current = before[name], after[name]
        if previous.type != current.type:
            yield SymbolChange(path, f"{name}: type", previous.type, current.type)
        elif (previous.required, previous.default) != (
            current.required,
            current.default,
        ) and not previous.enum_items:
            yield SymbolChange(path, f"{name}: default", _default(previous), _default(current))
        yield from _items_change(path, previous.enum_items, current.enum_items, f"{name}: ")


def _default(parameter: Parameter) -> str:
    return "required" if parameter.required else python_value(parameter.default)


def format_diff(differences: Diff, *, limit: int | None = None) -> str:
    """The differences as Markdown: counts first, then by owner. ``limit`` cuts each part to so many lines."""
    counts = [
        f"# Blender {differences.old} → {differences.new}",
        "",
        f"- added: {_counted(entry.kind for entry in differences.added)}",
        f"- removed: {_counted(entry.kind for entry in differences.removed)}",
        f"- changed: {_counted(change.what.rpartition(': ')[2] for change in differences.changed)}",
    ]
    owners = {entry.path: entry.owner for entry in (*differences.added, *differences.removed)}
    removed = {entry.path: entry.kind for entry in differences.removed}
    added = {entry.path: entry.kind for entry in differences.added}
    changed: defaultdict[str, list[str]] = defaultdict(list)
    for change in differences.changed:
        changed[change.path].append(_change_text(change))
    parts = [
        _part("Removed", removed, owners, limit),
        _part("Added", added, owners, limit),
        _part("Changed", {path: "; ".join(texts) for path, texts in changed.items()}, {}, limit),
    ]
    return "\n".join([*counts, *(line for part in parts for line in part), ""])


def _counted(kinds: Iterable[str]) -> str:
    counts = Counter(kinds)
    listed = ", ".join(f"{kind} {count}" for kind, count in counts.most_common())
    return f"{counts.total()} ({listed})" if counts else "0"


def _change_text(change: SymbolChange) -> str:
    if change.what.endswith(("enum items", "parameters")):
        sides = (f"{sign}{names}" for sign, names in (("- ", change.old), ("+ ", change.new)) if names)
        return f"{change.what} {' '.join(sides)}"
    return f"{change.what} {change.old or 'none'} → {change.new or 'none'}"


def _part(
    title: str, entries: Mapping[str, str], owners: Mapping[str, str], limit: int | None
) -> Iterator[str]:
    """A heading, and the entries in the order of their paths below their owners."""
    if not entries:
        return
    yield from ("", f"## {title}", "")
    group = None
    owned = [(path, owners.get(path, path.rpartition(".")[0]), entries[path]) for path in sorted(entries)]
    # Where the whole owner came or went, its members follow from that.
    told = [row for row in owned if row[1] not in entries]
    for number, (path, owner, text) in enumerate(told):
        if limit is not None and number == limit:
            yield f"- … and {len(told) - limit} more"
            return
        if owner != group:
            group = owner
            yield f"- **{owner or 'top level'}**"
        yield f"  - `{path[len(owner) :].lstrip('.') if owner else path}` {text}"
