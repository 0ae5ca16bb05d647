"""Measures what a base tells of new things: defaults, enumerations whose items depend on the instance, sockets.

Defaults are compared with a running Blender, in which other code than the extractor's makes the things.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.markdown_tables import Table
from kb_build.base_file import read_meta
from kb_build.live.values import compare_values, runtime_at_hand
from kb_build.schema import open_read_only, unpack
from kb_build.symbols.flag_names import COMPARED, NAME_WHEN_SHOWN
from kb_build.symbols.flags import empty_when_new, fillers
from kb_build.symbols.records import symbol_from_json
from measurements.report import ReportPart, TargetFigure, run_steps
from measurements.setting import say

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_build.symbols.records import Symbol
    from measurements.setting import Setting


def measure(setting: Setting) -> ReportPart:
    """Counts what the base tells, and compares it with the live Blender."""
    connection = open_read_only(setting.base)
    try:
        rows = connection.execute(
            "SELECT record FROM symbols WHERE kind IN ('property', 'socket')"
        ).fetchall()
        former = int(connection.execute("SELECT count(*) FROM still_works").fetchone()[0])
    finally:
        connection.close()
    symbols = [symbol_from_json(unpack(record)) for (record,) in rows]
    return run_steps(
        "defaults",
        {
            "told": lambda: ReportPart(
                "told", tables=(_defaults(symbols), _enums(symbols), _sockets(symbols, former))
            ),
            "live": lambda: _live(setting),
        },
    )


def _table(title: str, counts: dict[str, int], note: str) -> Table:
    return Table(
        title, ("what", "how many"), tuple((name, f"{count:,}") for name, count in counts.items()), note
    )


def _defaults(symbols: Sequence[Symbol]) -> Table:
    pointers = [symbol for symbol in symbols if symbol.type == "pointer" and COMPARED in symbol.flags]
    compared = [symbol for symbol in symbols if symbol.type != "pointer" and COMPARED in symbol.flags]
    differing = [symbol for symbol in compared if any(not new.when for new in symbol.new_values)]
    counts = {
        "properties of which new ones were read": len(compared),
        "a new one differs from RNA's default": len(differing),
        "… by what was made, or how": sum(
            sum(not new.when for new in symbol.new_values) > 1 for symbol in differing
        ),
        "… by a mode that it is in": sum(any(new.when for new in symbol.new_values) for symbol in compared),
        "pointers of which new ones were read": len(pointers),
        "… None on a new one": sum(empty_when_new(symbol) is not None for symbol in pointers),
        "… and filled by a call that was tried": sum(bool(fillers(symbol)) for symbol in pointers),
    }
    return _table(
        "Defaults of new things", counts, "RNA's own defaults are what the official reference prints."
    )


def _enums(symbols: Sequence[Symbol]) -> Table:
    asked = [symbol for symbol in symbols if any(item.where for item in symbol.enum_items)]
    items = [item for symbol in asked for item in symbol.enum_items if item.where]
    counts = {
        "enumerations whose items depend on the instance": len(asked),
        "items taken in some contexts only": sum(item.is_taken for item in items),
        "… whose context is a mode": sum(bool(item.where and item.where.is_by_setting) for item in items),
        "items that RNA lists and no instance took": sum(not item.is_taken for item in items),
    }
    return _table("Enums by context", counts, "Every instance was asked in each of its modes.")


def _sockets(symbols: Sequence[Symbol], former: int) -> Table:
    sockets = [symbol for symbol in symbols if symbol.kind == "socket"]
    counts = {
        "sockets": len(sockets),
        "reached by name in every mode": sum('["' in "".join(symbol.subscripts[:1]) for symbol in sockets),
        "by name only while shown, else by place": sum(NAME_WHEN_SHOWN in symbol.flags for symbol in sockets),
        "whose identifier is not their name": sum(symbol.identifier != symbol.label for symbol in sockets),
        "former names that Blender still takes": former,
    }
    return _table("Sockets", counts, "Every subscript was tried on the node.")


def _live(setting: Setting) -> ReportPart:
    meta = read_meta(setting.base)
    runtime = runtime_at_hand(meta)
    if runtime is None:
        return ReportPart("live", skipped=(f"Blender {meta.get('blender')} is not at hand",))
    say("defaults: new things in the live Blender")
    found = compare_values(setting.base, runtime)
    note = f"{found.compared:,} properties of new things in Blender {runtime.version}, made by other code; "
    note += f"RNA's default is another for {found.differing:,}"
    figures = (TargetFigure("defaults_wrong", len(found.wrong), note),)
    return ReportPart("live", figures, data={"wrong": list(found.wrong)})
