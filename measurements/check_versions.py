"""Measures drift: of what an older Blender's own scripts use and this one lacks, how much is reported.

``python -m measurements --only check_versions`` needs the base of an older Blender beside the measured one, and that
Blender's scripts. *Symbols*: the older base says which symbol a place stands for, and this Blender lacks it; it is
found if the check reports the line of one of its places. *Names, of any type*, without the type flow: an attribute of
the older base's that no symbol of this one is called, and that the package does not define itself. Places that this
Blender does not reach (``bpy.app.version``), or that are ready for a missing name, do not count; nor does what this
Blender finds there otherwise, or what the package itself registers. One cause is one finding: a member that went with
its class is found where the line is reported from which the script has the instance.
"""

from __future__ import annotations

import ast
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from bench.markdown_tables import Table
from kb_build.flow.values.types import Instance
from kb_build.usage.scripts import read_script
from kb_check.checker import Checker
from kb_check.migrate.place import version_of
from measurements.blender_scripts import scripts_folder
from measurements.check_blender import packages
from measurements.report import ReportPart, TargetFigure
from measurements.setting import say

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kb_build.flow.values.types import Resolution
    from kb_check.checker import Read
    from measurements.setting import Setting

OLDER = "4.2"
_HEADER = ("removed", "used", "reported", "share", "not reported, the first of them")
_SHOWN = 12
_JUDGED = frozenset({"attribute", "store", "name", "keyword", "value", "item", "text", "button"})

Place = tuple[str, int]


@dataclass(slots=True)
class Drift:
    """What is used and gone, and what of it is reported."""

    names: dict[str, list[Place]] = field(default_factory=lambda: defaultdict(list))
    places: dict[Place, set[str]] = field(default_factory=lambda: defaultdict(set))
    reported: set[Place] = field(default_factory=set[Place])
    with_class: dict[Place, set[str]] = field(default_factory=lambda: defaultdict(set))
    sources: dict[tuple[str, str], list[Place]] = field(default_factory=lambda: defaultdict(list))

    def is_found(self, place: Place) -> bool:
        """Whether a place is reported, or went with a class and the script is told so where it gets an instance."""
        return place in self.reported or any(
            not self.reported.isdisjoint(self.sources[place[0], cls]) for cls in self.with_class[place]
        )

    @property
    def names_found(self) -> set[str]:
        """The names that are reported at one place at least."""
        return {name for name, places in self.names.items() if not self.reported.isdisjoint(places)}

    def symbols(self) -> dict[str, list[Place]]:
        """Removed symbol → the places that stand for it."""
        found: dict[str, list[Place]] = defaultdict(list)
        for place, symbols in self.places.items():
            for symbol in symbols:
                found[symbol].append(place)
        return found

    @property
    def places_found(self) -> set[Place]:
        """The places of removed symbols that are reported."""
        return {place for place in self.places if self.is_found(place)}


def drift(older: Checker, newer: Checker, folder: Path) -> Drift:
    """Checks an older Blender's scripts, below ``folder``, for a newer one."""
    found = Drift()
    gone = _names(older) - _names(newer)
    for files in packages(folder):
        codes = {name: read_script(path) for name, path in files.items()}
        before, after = older.read_files(codes), newer.read_files(codes)
        own = {name for read in before.values() for name in _own_names(read.tree)}
        classes = {
            f"bpy.types.{node.name}"
            for read in before.values() for node in ast.walk(read.tree) if isinstance(node, ast.ClassDef)
        }  # fmt: skip
        registered = {
            name
            for reads in (before, after)
            for read in reads.values()
            for _, name in read.analysis.registered
        }
        operators = {path for read in before.values() for path in read.analysis.own_operators}
        package = newer.package(after.values())
        for name, read in after.items():
            path = files[name].relative_to(folder).as_posix()
            # A statement is reported as a whole: a call may begin lines above the keyword that is gone.
            for one in newer.check(read, package):
                if one.severity != "note":
                    found.reported.update(
                        (path, line) for line in range(one.span.line, one.span.end_line + 1)
                    )
            guarded = {(row.node.lineno, row.node.col_offset) for row in _rows(read) if row.guarded}
            for node in read.analysis.types:
                if not isinstance(node, ast.Attribute) or node.attr not in gone - own:
                    continue
                if (node.lineno, node.col_offset) not in guarded:
                    found.names[node.attr].append((path, node.end_lineno or node.lineno))
            reached = {node.lineno for node in read.analysis.types}
            there = {_position(row) for row in _rows(read) if row.symbols}
            for row in _rows(before[name]):
                if row.kind in _JUDGED and row.symbols and not row.guarded and row.node.lineno in reached:
                    paths = [_path(row, one) for one in row.symbols]
                    own_class = any(one.rpartition(".")[0] in classes for one in row.symbols)
                    if (
                        all(_is_gone(newer, one) for one in paths)
                        and not own_class
                        and row.value not in registered
                        and operators.isdisjoint(paths)
                        and _position(row) not in there
                    ):
                        found.places[path, row.node.end_lineno].update(paths)
                        found.with_class[path, row.node.end_lineno].update(
                            owner for one in paths if not newer.api.is_class(owner := one.rpartition(".")[0])
                        )
            for row in _rows(before[name]):
                kind = before[name].analysis.types.get(row.node)
                if row.symbols and isinstance(kind, Instance):
                    found.sources[path, kind.cls].append((path, row.node.lineno))
    return found


def measure(setting: Setting) -> ReportPart:
    """The drift from Blender 4.2 to the measured one."""
    base = setting.base.with_name(f"blender-{OLDER}.sqlite")
    if setting.quick or not base.is_file():
        why = (
            "left out by --quick"
            if setting.quick
            else f"there is no base of Blender {OLDER} beside the measured one"
        )
        return ReportPart("check_versions", skipped=(why,))
    if (folder := scripts_folder(base)) is None:
        return ReportPart("check_versions", skipped=(f"the scripts of Blender {OLDER} are not there",))
    say(f"check_versions: checking the scripts of Blender {OLDER}")
    with Checker(base) as older, Checker(setting.base) as newer:
        found = drift(older, newer, folder)
        minor = newer.names.version
    symbols = found.symbols()
    unseen = sorted(symbol for symbol, places in symbols.items() if not any(map(found.is_found, places)))
    missed = sorted(set(found.names) - found.names_found)
    open_places = [f"{path}:{line}" for path, line in sorted(set(found.places) - found.places_found)]
    rows = (
        ("symbols", *_row(len(symbols), unseen)),
        ("their places", *_row(len(found.places), open_places)),
        ("names, of any type", *_row(len(found.names), missed)),
    )
    share = 1 - len(unseen) / len(symbols) if symbols else 0.0
    note = f"symbols that Blender {OLDER}'s own scripts use and {minor} lacks"
    table = Table(f"What Blender {OLDER}'s scripts use and {minor} lacks", _HEADER, rows)
    figure = TargetFigure("check_drift", share, note)
    return ReportPart("check_versions", (figure,), (table,), (), {"symbols": unseen, "names": missed})


def _row(total: int, missed: list[str]) -> tuple[str, ...]:
    found = total - len(missed)
    return f"{total:,}", f"{found:,}", f"{found / total:.3f}" if total else "–", ", ".join(missed[:_SHOWN])


def _names(checker: Checker) -> set[str]:
    """The names of all properties, functions, operators and constants of a Blender."""
    kinds = "('property', 'function', 'operator', 'constant', 'class', 'module')"
    return {
        name
        for (name,) in checker.names.reader.rows(f"SELECT DISTINCT name FROM symbols WHERE kind IN {kinds}")
    }


def _own_names(tree: ast.AST) -> Iterator[str]:
    """The names that a script defines, or stores: what they mean is its own business."""
    for node in ast.walk(tree):
        if isinstance(node, (ast.FunctionDef, ast.ClassDef, ast.AsyncFunctionDef)):
            yield node.name
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "self":
            yield node.attr


def _rows(read: Read) -> Iterator[Any]:
    """The parts of a script that stand for something, where they have a place in it."""
    return (row for row in read.analysis.resolutions.values() if hasattr(row.node, "lineno"))


def _position(row: Resolution) -> tuple[str, int, int]:
    return row.kind, getattr(row.node, "lineno", 0), getattr(row.node, "end_col_offset", 0)


def _path(row: Resolution, symbol: str) -> str:
    return f"{symbol}:{row.value}" if row.kind == "value" else symbol


def _is_gone(checker: Checker, path: str) -> bool:
    """Whether a Blender lacks what the older one had; a member that only its class was renamed around is there."""
    reader, api = checker.names.reader, checker.api
    removed = reader.history.removed(path)
    if removed is None or version_of(removed[1]) < version_of(OLDER) or reader.history.still_works(path):
        return False
    function, bracket, parameter = path.removesuffix(")").partition("(")
    symbol = api.symbols.symbol(function)
    if bracket and symbol is not None and parameter in {"", *(one.name for one in symbol.parameters)}:
        return False
    owner, _, name = path.rpartition(".")
    heirs = [row.target for row in reader.history.successors(owner)]
    return not any(api.member(heir, name) for heir in heirs) and all(
        row.target.rpartition(".")[2] != name for row in reader.history.successors(path)
    )
