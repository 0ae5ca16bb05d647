"""Measures the latency of answers in process.

Every pass opens the base anew, warms it with queries of each kind that are in no set, and then sends every dev query
once, so that no answer is cached. The whole answer counts, text included. Beside it stands what FTS5 takes to rank the
same queries over the same words, without an answer.
"""

from __future__ import annotations

import time
from contextlib import closing
from typing import TYPE_CHECKING

from bench.markdown_tables import Table
from kb_serve.knowledge_base import KnowledgeBase
from measurements.baselines import Baselines, read_units
from measurements.report import ReportPart, TargetFigure
from measurements.retrieval import NAMED, Query, read_queries
from measurements.setting import percentile, say

if TYPE_CHECKING:
    from collections.abc import Sequence

    from measurements.setting import Setting

WARMING = (
    "bpy.types.Scene.frame_end",
    "bpy.ops.mesh.primitive_cube_add(size=2)",
    "bpy.context.scene.render.resolution_x",
    "AttributeError: 'Scene' object has no attribute 'foo'",
    "sculpting",
    "where are the render settings of a scene",
    "SUBSURF",
    "subdivison surfce",
)
PASSES = 5
EXACT = frozenset({"exact", "member"})


def measure(setting: Setting) -> ReportPart:
    """Measures percentiles over the first set of queries."""
    queries = read_queries(setting.queries[0])
    fresh: dict[str, list[float]] = {}
    again: dict[str, list[float]] = {}
    opening: list[float] = []
    passes = 1 if setting.quick else PASSES
    for number in range(passes):
        say(f"latency: pass {number + 1} of {passes}")
        began = time.perf_counter()
        with KnowledgeBase(setting.base) as knowledge:
            knowledge.query(WARMING[0])
            opening.append((time.perf_counter() - began) * 1e3)
            for text in WARMING:
                knowledge.query(text)
            _ask(knowledge, queries, fresh)
            _ask(knowledge, queries, again)
    plain = _fts5(setting, [query for query in queries if _group(query) == "ranked"])
    groups = {name: (fresh[name], again[name]) for name in ("exact", "expression", "ranked") if name in fresh}
    rows = [
        (
            name,
            str(len(times) // passes),
            *(f"{percentile(times, share):.2f}" for share in (0.5, 0.95, 1.0)),
            f"{percentile(repeated, 0.5):.3f}",
        )
        for name, (times, repeated) in groups.items()
    ]
    note = (
        "Milliseconds. First answers of a warm base; “again”: the same query once more. exact: full names and "
        f"members; ranked: neither these nor expressions. Opening a base and its first answer: "
        f"{percentile(opening, 0.5):.0f} ms. FTS5 ranks those that are ranked in {plain:.2f} ms (p50)."
    )
    header = ("queries", "n", "p50", "p95", "slowest", "again p50")
    figures = [
        TargetFigure(f"{name}_p{round(100 * share)}", percentile(groups[name][0], share), f"{passes} passes")
        for name, share in (("exact", 0.5), ("ranked", 0.5), ("ranked", 0.95))
        if name in groups
    ]
    if "ranked" in groups:
        times = percentile(groups["ranked"][0], 0.5) / plain
        figures.append(TargetFigure("ranked_times", times, f"FTS5 here {plain:.2f} ms, its ranking alone"))
    data = {name: {"fresh_ms": times, "again_ms": repeated} for name, (times, repeated) in groups.items()}
    return ReportPart(
        "latency", tuple(figures), (Table("Latency in process", header, tuple(rows), note),), (), data
    )


def _fts5(setting: Setting, queries: Sequence[Query]) -> float:
    """The p50 of FTS5's ranking in milliseconds."""
    say("latency: FTS5 over the same words")
    took: list[float] = []
    with closing(Baselines(read_units(setting.base))) as flat:
        for query in queries:
            began = time.perf_counter()
            flat.fts5(query.query)
            took.append((time.perf_counter() - began) * 1e3)
    return percentile(took, 0.5)


def _ask(knowledge: KnowledgeBase, queries: Sequence[Query], times: dict[str, list[float]]) -> None:
    for query in queries:
        began = time.perf_counter()
        knowledge.query(query.query)
        took = (time.perf_counter() - began) * 1e3
        times.setdefault(_group(query), []).append(took)


def _group(query: Query) -> str:
    if query.kind in EXACT:
        return "exact"
    return "expression" if query.kind in NAMED else "ranked"
