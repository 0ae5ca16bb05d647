"""Targets of the measurements, with the figures of peers.

Peers' figures were measured on one machine (2 cores, no GPU) with 240 labelled queries, of which
``corpora/queries/dev.jsonl`` is a third; *FTS5* is SQLite's, one flat index of 25,000 documents with the name
weighted threefold, *rank-bm25* is BM25Okapi over the same documents, *official* is Blender Lab's MCP server.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Unit = Literal["share", "ms", "s", "MB", "bytes", "tokens", "count", "times"]


@dataclass(frozen=True, slots=True)
class Target:
    """One figure: what it is, its bound (None: only reported), and the peers' figures.

    ``at_least``: ``bound`` is a minimum, else a maximum. MB are 10⁶ bytes.
    """

    key: str
    what: str
    unit: Unit
    bound: float | None = None
    at_least: bool = False
    peers: str = ""

    def reached(self, value: float) -> bool | None:
        """Whether a value is within the bound; None without a bound."""
        if self.bound is None:
            return None
        return value >= self.bound if self.at_least else value <= self.bound

    @property
    def goal(self) -> str:
        """The bound as text, ``≤ 10 ms``."""
        if self.bound is None:
            return ""
        return f"{'≥' if self.at_least else '≤'} {_number(self.bound, self.unit)}"


def format_value(value: float, unit: Unit) -> str:
    """Formats a measured value with sensible precision."""
    if unit == "share":
        return f"{value:.3f}"
    if unit == "count":
        return f"{value:,.0f}"
    if unit == "times":
        return f"{value:.2f} ×"
    if unit in {"tokens", "bytes"}:
        return f"{value:,.0f} {unit}"
    if value < 10:
        return f"{value:.2f} {unit}"
    return f"{value:.1f} {unit}" if value < 100 else f"{value:,.0f} {unit}"


def _number(bound: float, unit: Unit) -> str:
    if unit == "share":
        return f"{bound:.2f}"
    if unit == "times":
        return f"{bound:g} ×"
    return f"{bound:,g}" if unit == "count" else f"{bound:,g} {unit}"


_ROWS = (
    Target(
        "hit1", "all kinds but task: hit@1", "share", 0.85, True, "FTS5 0.33 · rank-bm25 0.34 · official 0.11"
    ),
    Target(
        "hit5", "all kinds but task: hit@5", "share", 0.97, True, "FTS5 0.55 · rank-bm25 0.54 · official 0.13"
    ),
    Target("hit1_check", "… of the second set: hit@1", "share", 0.78, True),
    Target("hit5_check", "… of the second set: hit@5", "share", 0.94, True),
    Target("hit1_blind", "… of the third set, not looked at: hit@1", "share", 0.75, True),
    Target("hit5_blind", "… of the third set, not looked at: hit@5", "share", 0.92, True),
    Target("hit1_fourth", "… of the fourth set: hit@1", "share", None, True),
    Target("hit5_fourth", "… of the fourth set: hit@5", "share", None, True),
    Target("hit1_fourth_kept", "… of its half that was not looked at: hit@1", "share", 0.75, True),
    Target("hit5_fourth_kept", "… of its half that was not looked at: hit@5", "share", 0.92, True),
    Target("task5", "task: hit@5", "share", 0.60, True, "FTS5 0.24 · MiniLM embeddings 0.56"),
    Target("paraphrased5", "what hit@5 loses where the same is asked in other words", "share", 0.05),
    Target("told_names", "plain questions: a name told that the code needs", "share", None, True),
    Target("told_names_kept", "… of those that were not looked at", "share", None, True),
    Target("told_names_third", "… of 240 by somebody else, not looked at", "share", 0.92, True),
    Target("told_all_compound", "several names asked for at once: all of them told", "share", None, True),
    Target("told_all_compound_kept", "… of those that were not looked at", "share", 0.65, True),
    Target("invented_first", "names that no Blender has: the meant one comes first", "share", None, True),
    Target("invented_five", "… or among five, or named above them", "share", None, True),
    Target("invented_kept_first", "… of those that were not looked at: first", "share", 0.60, True),
    Target("invented_kept_five", "… among five, or named above them", "share", 0.85, True),
    Target("held_first", "asked of a thing what its holder does: the right one first", "share", None, True),
    Target("held_five", "… or among five, or named above them", "share", None, True),
    Target("held_kept_first", "… of those that were not looked at: first", "share", 0.70, True),
    Target("held_kept_five", "… among five, or named above them", "share", 0.85, True),
    Target("names1", "exact, member, expression: hit@1", "share", 0.97, True),
    Target("members", "class members found first by full path", "share", None, True, "official 0 of 400"),
    Target("history_dated", "removed symbols of scripts: dated rightly in the base", "share", 0.95, True),
    Target(
        "history_first", "… right successor first in the base, none where there is none", "share", 0.85, True
    ),
    Target("history_answered", "… answered with date and right successor first", "share", 0.85, True),
    Target("old_gone", "code of other versions: removed names said to be gone", "share", 0.98, True),
    Target("old_version", "… in the right version", "share", 0.95, True),
    Target("old_first", "… what takes their place comes first", "share", 0.80, True),
    Target("old_five", "… or among the first five", "share", 0.92, True),
    Target("old_nothing", "… told that nothing does, without a stand-in", "share", 0.90, True),
    Target("old_never", "names that no version had: told so", "share", 0.90, True),
    Target("old_works", "names that work: left alone", "share", 1.0, True),
    Target("recipes_run", "recipes that do their task, in all Blenders of the machine", "share", 1.0, True),
    Target("answered_tasks", "how-to questions: all that the code needs in 40 lines", "share", 0.85, True),
    Target("answered_tasks_kept", "… of those not looked at", "share", 0.8, True),
    Target("longest", "longest answer (estimated high)", "tokens", 1500, False, "official 121 KB"),
    Target("defaults_wrong", "defaults of new things told wrongly", "count", 0),
    Target("passages", "symbols with a passage of the manual", "count", 2_000, True),
    Target("passages_right", "passages about their symbol", "share", 0.97, True),
    Target("exact_p50", "in process, by exact name: p50", "ms", 0.5),
    Target(
        "ranked_p50", "in process, ranked: p50", "ms", 1, False, "FTS5 1.2 · rank-bm25 11 · official 860 ms"
    ),
    Target("ranked_p95", "in process, ranked: p95", "ms", 10, False, "official 12.5 s (first broad query)"),
    Target("ranked_times", "… beside FTS5's ranking alone", "times", 0.83, False, "FTS5 1 ×"),
    Target("mcp_p50", "MCP over stdio, one call: p50", "ms", 4, False, "echo tool 1.0 ms"),
    Target("mcp_times", "… beside an echo tool's", "times", 3),
    Target("start", "server start to first answer", "s", 0.8, False, "echo tool 0.45 s · others past 10 s"),
    Target("docs", "simworlds docs X, cold process", "s", 0.6),
    Target("memory", "server's resident memory, at most", "MB", 130),
    Target("load_errors", "64 HTTP clients: errors", "count", 0),
    Target("load_wrong", "64 HTTP clients: wrong answers", "count", 0),
    Target("soak_errors", "half an hour of mixed load: errors", "count", 0),
    Target("soak_growth", "… resident memory, last third by the second", "times", 1.05),
    Target("soak_orphans", "… processes left over", "count", 0),
    Target("build", "build with manual and guides", "s", 18, False, "Sphinx alone 34 s"),
    Target(
        "build_times",
        "… beside Sphinx alone, which only reads the manual",
        "times",
        0.53,
        False,
        "Sphinx 1 ×",
    ),
    Target("build_api", "build without pages", "s", 8),
    Target("build_again", "build when nothing has changed", "s", 1),
    Target("html", "manual from HTML (789 MB): reading", "s", 30),
    Target("size", "base file", "MB", 75),
    Target(
        "used_symbols",
        "of the 1,000 symbols most used in Blender's scripts: with an example",
        "share",
        0.80,
        True,
    ),
    Target("expressions1", "expressions of Blender's scripts, asked alone: right first", "share", 0.85, True),
    Target("expressions5", "… or among five", "share", 0.92, True),
    Target("nameless5", "… with a variable whose name tells nothing, among five", "share", None, True),
    Target("bound5", "… behind the line that binds such a variable", "share", None, True),
    Target("denied1", "statements of Blender's scripts, asked alone: wrongly denied", "share", 0.01),
    Target("denied3", "… three in a row", "share", 0.01),
    Target("steps_done", "steps of topics that Blender does in a new scene", "share", 0.99, True),
    Target("flow_speed", "types flow through 1,000 lines", "ms", 150),
    Target("check_false", "Blender's own scripts: findings that Blender does not prove", "count", 0),
    Target("packages_false", "packages of others: errors that Blender does not prove", "count", 0),
    Target("check_inside", "own scripts that run inside Blender: findings", "count", 0),
    Target("check_all", "checking all of them", "s", 25),
    Target("check_speed", "checking 1,000 of their lines", "ms", 150),
    Target(
        "check_found",
        "scripts from memory, not looked at: errors that Blender raises, found",
        "share",
        0.88,
        True,
    ),
    Target("check_right", "… findings that are right", "share", 0.97, True),
    Target("check_found_seen", "… of those that were looked at: found", "share", 0.88, True),
    Target("check_right_seen", "… of those that were looked at: right", "share", 0.97, True),
    Target("check_fixes", "… sure fixes after which the statement runs", "share", 0.95, True),
    Target("planted", "mistakes planted in Blender's own scripts: found", "share", 0.92, True),
    Target("check_drift", "names in an older Blender's scripts that are gone: found", "share", 0.95, True),
    Target(
        "migrate_predicted",
        "an older Blender's add-ons: whether they run in a newer one, predicted",
        "share",
        0.95,
        True,
    ),
    Target("migrate_broken", "… that run there, and do not after migrating", "count", 0),
    Target("listed_serve", "simworlds serve: what a client is sent of its tools", "bytes", 3_000),
    Target("listed_build", "simworlds mcp: what a client is sent of its tools", "bytes", 18_000),
    Target("told_build", "… of which models are told", "tokens", 5_000, False, "blender-mcp 6,900"),
    Target("worker_start", "Blender's start to its first reply", "s", 2),
    Target("mcp_start", "simworlds mcp: start to first blender_execute", "s", 2),
    Target("preflight", "pre-flight of 100 lines, beside execution: p50", "ms", 30),
    Target("execute_p50", 'blender_execute("1+1") over MCP: p50', "ms", 8, False, "echo tool 1.0 ms"),
    Target("state", "scene state of 500 objects", "ms", 300),
    Target("preview", "preview of 50 objects, 4 × 384²", "s", 3),
    Target("restart", "restart after SIGKILL, 100 objects", "s", 4),
    Target("verify", "verifying 500 objects, 1,000,000 triangles: C, G, V, W", "s", 5),
    Target("verify_growth", "cost an object, 2,000 against 50 objects", "times", 1.5),
    Target("verify_motion", "verifying 12 actors over 250 baked frames: T", "s", 10),
    Target("verify_loose", "simworlds verify, 200 untagged primitives, in all", "s", 10),
    Target("mutations", "random breaches of valid scenes found by their rule", "share", 0.98, True),
    Target("false_alarms", "findings in valid scenes", "count", 0),
    Target("audit", "audit of one scene with caches, within 2 GB, at most", "s", 6),
    Target("audit_all", "the same of all scenes on 2 cores", "s", 300),
)
TARGETS = {target.key: target for target in _ROWS}
assert len(TARGETS) == len(_ROWS), "a figure is listed twice"
