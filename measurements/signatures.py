"""Measures signatures: how many arguments and results of functions and operators have types, words and values."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.markdown_tables import Table
from kb_build.schema import open_read_only, unpack
from kb_build.symbols.records import symbol_from_json
from measurements.report import ReportPart

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from kb_build.symbols.records import Symbol
    from measurements.setting import Setting

_HEADER = (
    "module",
    "calls",
    "arguments",
    "type",
    "words",
    "default or required",
    "values",
    "results",
    "type ",
)
_NOTE = (
    "Calls are functions and operators. Arguments: how many have a type, a description or label, a known default "
    "(or none, because the caller must give them), and listed values. Results: how many have a type."
)
_DEEPER = ("bpy", "bmesh")


@dataclass(slots=True)
class SignatureCoverage:
    """Counts over the calls of one module. ``fixed`` arguments have a known default, or must be given."""

    calls: int = 0
    arguments: int = 0
    typed: int = 0
    described: int = 0
    fixed: int = 0
    valued: int = 0
    results: int = 0
    typed_results: int = 0

    def add(self, symbol: Symbol) -> None:
        """Counts one function or operator."""
        self.calls += 1
        written = symbol.signature
        for parameter in symbol.parameters:
            self.arguments += 1
            self.typed += bool(parameter.type)
            self.described += bool(parameter.description or parameter.label)
            known = parameter.required or parameter.default is not None or f"{parameter.name}=" in written
            self.fixed += known
            self.valued += bool(parameter.enum_items)
        self.results += len(symbol.returns)
        self.typed_results += sum(bool(result.type) for result in symbol.returns)


def module_of(path: str) -> str:
    """``bmesh.ops.bevel`` → ``bmesh.ops``, ``mathutils.Vector.lerp`` → ``mathutils``."""
    parts = path.split(".")
    return ".".join(parts[: 2 if parts[0] in _DEEPER and len(parts) > 2 else 1])


def calls_of(base: Path) -> Iterator[Symbol]:
    """Every function and operator of a base."""
    with closing(open_read_only(base)) as connection:
        for (record,) in connection.execute(
            "SELECT record FROM symbols WHERE kind IN ('function', 'operator') ORDER BY path"
        ):
            yield symbol_from_json(unpack(record))


def coverage(symbols: Iterable[Symbol]) -> dict[str, SignatureCoverage]:
    """The counts by module. The two functions that every class repeats are left out."""
    found: dict[str, SignatureCoverage] = {}
    for symbol in symbols:
        if not symbol.name.startswith("bl_rna_get_subclass"):
            found.setdefault(module_of(symbol.path), SignatureCoverage()).add(symbol)
    return found


def _share(part: int, whole: int) -> str:
    return f"{part / whole:.0%}" if whole else ""


def _row(module: str, counts: SignatureCoverage) -> tuple[str, ...]:
    n = counts.arguments
    shares = (_share(part, n) for part in (counts.typed, counts.described, counts.fixed))
    results = (str(counts.results), _share(counts.typed_results, counts.results))
    return (module, str(counts.calls), str(n), *shares, str(counts.valued), *results)


def measure(setting: Setting) -> ReportPart:
    """The table of all modules."""
    found = coverage(calls_of(setting.base))
    rows = tuple(_row(module, found[module]) for module in sorted(found))
    return ReportPart("signatures", tables=(Table("Signatures", _HEADER, rows, _NOTE),))
