"""Reports of measurements: Markdown for people, JSON for later comparison."""

from __future__ import annotations

import json
import os
import platform
import sqlite3
import subprocess
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.markdown_tables import Table, format_table
from measurements.setting import REPO, brief
from measurements.targets import TARGETS, format_value
from simworlds.installed import installed_version

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

_PACKAGES = (
    "simworlds", "bpy", "mcp", "rank-bm25", "numpy", "rapidfuzz", "sphinx", "beautifulsoup4", "sqlite-utils",
)  # fmt: skip
_BUSY = "busy"
_REACHED = {True: "reached", False: "NOT reached", None: ""}

_LEAD = (
    "What `make bench` measured last: how good and how fast the answers are, what the servers, the live Blender, the "
    "verifier\nand the audit take, each beside its target and beside plain baselines."
)


@dataclass(frozen=True, slots=True)
class TargetFigure:
    """A measured value of the target ``key``, in its unit; ``note`` says how it was measured."""

    key: str
    value: float
    note: str = ""


@dataclass(frozen=True, slots=True)
class ReportPart:
    """The results of one part. ``skipped``: what could not be measured, and why."""

    name: str
    figures: tuple[TargetFigure, ...] = ()
    tables: tuple[Table, ...] = ()
    skipped: tuple[str, ...] = ()
    data: Mapping[str, Any] = field(default_factory=dict[str, Any])


def run_steps(name: str, steps: Mapping[str, Callable[[], ReportPart]]) -> ReportPart:
    """Measures a part step by step. A step that fails is skipped, with the reason."""
    parts = [_run_step(each, step) for each, step in steps.items()]
    return ReportPart(
        name,
        tuple(figure for part in parts for figure in part.figures),
        tuple(table for part in parts for table in part.tables),
        tuple(f"{part.name}: {reason}" for part in parts for reason in part.skipped),
        {part.name: part.data for part in parts},
    )


def _run_step(name: str, step: Callable[[], ReportPart]) -> ReportPart:
    try:
        return step()
    except Exception as error:  # a broken server, Blender or command may raise anything
        return ReportPart(name, skipped=(brief(error),))


def markdown(parts: Sequence[ReportPart], facts: Mapping[str, str]) -> str:
    """The whole report."""
    blocks = ["# SimWorlds, measured", _LEAD, _facts(facts)]
    figures = [figure for part in parts for figure in part.figures]
    if figures:
        blocks.append(format_table(targets_table(figures)))
        if _BUSY in facts.get("machine", ""):
            blocks.append("**The machine was busy at the start: times are longer than on an idle one.**")
    for part in parts:
        blocks += [format_table(each) for each in part.tables]
    skipped = [f"- {part.name}: {reason}" for part in parts for reason in part.skipped]
    if skipped:
        blocks.append("## Not measured\n\n" + "\n".join(skipped))
    return "\n\n".join(blocks) + "\n"


def targets_table(figures: Iterable[TargetFigure]) -> Table:
    """A table of figures with their targets and the peers' figures, in the order of the targets."""
    order = list(TARGETS)
    rows: list[tuple[str, ...]] = []
    for figure in sorted(figures, key=lambda figure: order.index(figure.key)):
        target = TARGETS[figure.key]
        verdict = _REACHED[target.reached(figure.value)]
        rows.append(
            (
                target.what,
                format_value(figure.value, target.unit),
                target.goal,
                verdict,
                target.peers,
                figure.note,
            )
        )
    counted = sum(row[3] != "" for row in rows)
    reached = sum(row[3] == _REACHED[True] for row in rows)
    note = (
        f"{reached} of {counted} targets reached. Peers as measured elsewhere, on 240 queries of which the dev set "
        "is a third (see measurements/targets.py); their machine had 2 cores."
    )
    header = ("what", "here", "target", "", "peers", "how")
    return Table("Targets", header, tuple(rows), note)


def _facts(facts: Mapping[str, str]) -> str:
    return "\n".join(f"- {name}: {value}" for name, value in facts.items())


# The machine and the versions


def machine_facts(base_meta: Mapping[str, str], base: Path) -> dict[str, str]:
    """The conditions of the figures: date, commit, machine, versions, base."""
    versions = [f"CPython {platform.python_version()}", f"SQLite {sqlite3.sqlite_version}"]
    versions += [f"{name} {_version(name)}" for name in _PACKAGES]
    blender = base_meta.get("blender") or base_meta.get("version", "unknown")
    pages = "with" if any(row.get("role") == "manual" for row in _sources(base_meta)) else "without"
    return {
        "date": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "commit": _commit(),
        "machine": f"{_processor()}, {os.cpu_count()} cores, {_memory()}{_busy()}",
        "system": platform.platform(terse=True),
        "versions": ", ".join(versions),
        "base": f"Blender {blender}, {pages} manual, {base.stat().st_size / 1e6:.1f} MB",
    }


def _sources(meta: Mapping[str, str]) -> list[dict[str, Any]]:
    return json.loads(meta.get("sources") or "[]")


def _version(name: str) -> str:
    return installed_version(name) or ("(from source)" if name == "simworlds" else "(absent)")


def _git(*arguments: str) -> str:
    try:
        done = subprocess.run(
            ["git", "-C", str(REPO), *arguments], capture_output=True, text=True, check=False, timeout=20
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


def _commit() -> str:
    commit = _git("rev-parse", "--short=12", "HEAD") or "unknown"
    return f"{commit} with changes" if _git("status", "--porcelain", "--untracked-files=no") else commit


def _processor() -> str:
    for line in _lines(Path("/proc/cpuinfo")):
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def _memory() -> str:
    for line in _lines(Path("/proc/meminfo")):
        if line.startswith("MemTotal:"):
            return f"{int(line.split()[1]) / 2**20:.0f} GiB"
    return "memory unknown"


def _busy() -> str:
    """The load of the machine, with a warning if it is busy: times are then unreliable."""
    if not hasattr(os, "getloadavg"):
        return ""
    load = os.getloadavg()[0]
    return f"; {_BUSY}: load {load:.1f}" if load > 0.7 * (os.cpu_count() or 1) else f"; load {load:.1f}"


def _lines(path: Path) -> Iterator[str]:
    try:
        yield from path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return


# Files


def as_json(parts: Sequence[ReportPart], facts: Mapping[str, str]) -> dict[str, Any]:
    """The report as data: every figure with its target, and the data of each part."""
    figures = [
        {
            "key": figure.key,
            "what": TARGETS[figure.key].what,
            "value": figure.value,
            "unit": TARGETS[figure.key].unit,
            "target": TARGETS[figure.key].goal,
            "reached": TARGETS[figure.key].reached(figure.value),
            "peers": TARGETS[figure.key].peers,
            "how": figure.note,
        }
        for part in parts
        for figure in part.figures
    ]
    skipped = [f"{part.name}: {reason}" for part in parts for reason in part.skipped]
    data = {part.name: dict(part.data) for part in parts}
    return {"facts": dict(facts), "figures": figures, "skipped": skipped, "parts": data}


def write(folder: Path, parts: Sequence[ReportPart], facts: Mapping[str, str]) -> str:
    """Writes ``bench.md`` and ``bench.json`` into ``folder``; returns the Markdown."""
    folder.mkdir(parents=True, exist_ok=True)
    text = markdown(parts, facts)
    (folder / "bench.md").write_text(text, encoding="utf-8")
    data = json.dumps(as_json(parts, facts), indent=2, ensure_ascii=False)
    (folder / "bench.json").write_text(data + "\n", encoding="utf-8")
    return text
