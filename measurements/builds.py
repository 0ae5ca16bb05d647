"""Measures builds: with all pages, without pages, and when nothing has changed.

Every build is a process of ``simworlds kb build`` in an empty home folder.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.markdown_tables import Table
from bench.sweep.command import simworlds_command
from kb_build.pages.readers.html import read_html
from kb_build.pages.sources import find_sources
from measurements.report import ReportPart, TargetFigure
from measurements.setting import BLENDER, REPO, corpora, environment, say
from simworlds.errors import UserError
from simworlds.settings import base_path

if TYPE_CHECKING:
    from measurements.setting import Setting

HTML = "manual-4.4-html"
_HTML_VERSION = "4.4"
_JOBS = 2
_LONGEST = 1_800
_HEADER = ("what", "seconds", "CPU seconds", "gives")


class BuildFailed(Exception):  # noqa: N818 - reads as the state it names
    """A build failed or gave a wrong result; the message says how."""


@dataclass(frozen=True, slots=True)
class BuildTime:
    """Wall time and CPU time of all processes, in seconds."""

    wall: float
    cpu: float


def run_build(home: Path, *arguments: str) -> BuildTime:
    """Builds in ``home``. Raises BuildFailed."""
    command = [*simworlds_command(), "kb", "build", BLENDER, "--offline", *arguments]
    began, used = time.perf_counter(), _children_cpu()
    try:
        done = subprocess.run(
            command,
            env=environment(home),
            cwd=REPO,
            capture_output=True,
            text=True,
            check=False,
            timeout=_LONGEST,
        )
    except (OSError, subprocess.SubprocessError) as error:
        raise BuildFailed(f"{' '.join(command[-5:])}: {error}") from error
    took = BuildTime(time.perf_counter() - began, _children_cpu() - used)
    if done.returncode != 0:
        lines = (done.stderr or done.stdout).strip().splitlines()
        raise BuildFailed(f"exit code {done.returncode}: {lines[-1] if lines else 'it printed nothing'}")
    return took


def _children_cpu() -> float:
    times = os.times()
    return times.children_user + times.children_system


def measure(setting: Setting) -> ReportPart:
    """Builds in temporary folders; ``quick`` skips the full build and the manual from HTML."""
    figures: list[TargetFigure] = []
    rows: list[tuple[str, ...]] = []
    skipped: list[str] = []
    with tempfile.TemporaryDirectory(prefix="simworlds-bench-") as folder:
        steps = [(_api, "build without pages"), (_whole, "build with pages")]
        for step, name in steps[:1] if setting.quick else steps:
            try:
                step(Path(folder), figures, rows)
            except BuildFailed as error:
                skipped.append(f"{name}: {error}")
        if not setting.quick:
            try:
                _html(Path(folder), figures, rows)
            except (UserError, FileNotFoundError) as error:
                skipped.append(f"manual from HTML: {error}")
    if not any(figure.key == "size" for figure in figures):
        figures.append(TargetFigure("size", setting.base.stat().st_size / 1e6, "the measured base"))
    tables = (Table("Builds", _HEADER, tuple(rows)),) if rows else ()
    data: dict[str, Any] = {"builds": [dict(zip(_HEADER, row, strict=True)) for row in rows]}
    return ReportPart("builds", tuple(figures), tables, tuple(skipped), data)


def _again(home: Path, *arguments: str) -> BuildTime:
    """The median of three builds without changes."""
    base = base_path(home, BLENDER)
    before = base.stat()
    took = sorted((run_build(home, *arguments) for _ in range(3)), key=lambda time: time.wall)[1]
    after = base.stat()
    if (before.st_ino, before.st_mtime_ns) != (after.st_ino, after.st_mtime_ns):
        raise BuildFailed(
            "the base was built again although nothing had changed, unless SimWorlds itself did"
        )
    return took


def _row(what: str, took: BuildTime, gives: str) -> tuple[str, ...]:
    return what, f"{took.wall:.2f}", f"{took.cpu:.2f}", gives


def _api(folder: Path, figures: list[TargetFigure], rows: list[tuple[str, ...]]) -> None:
    say(f"builds: {BLENDER} without pages")
    home = folder / "api"
    took = run_build(home, "--no-pages")
    figures.append(TargetFigure("build_api", took.wall, "empty home"))
    rows.append(_row("without pages, empty home", took, _size(home)))
    rows.append(_row("without pages, nothing changed", _again(home, "--no-pages"), "the same base"))


def _whole(folder: Path, figures: list[TargetFigure], rows: list[tuple[str, ...]]) -> None:
    if corpora() is None:
        raise BuildFailed("there are no documentation sources; set SIMWORLDS_CORPORA to their folder")
    say(f"builds: {BLENDER} with manual and guides")
    home = folder / "whole"
    took = run_build(home, "--require", "manual,guides")
    alone = _sphinx(folder)
    figures.append(TargetFigure("build", took.wall, "empty home"))
    figures.append(TargetFigure("build_times", took.wall / alone.wall, f"Sphinx here {alone.wall:.1f} s"))
    figures.append(TargetFigure("size", base_path(home, BLENDER).stat().st_size / 1e6, "just built"))
    rows.append(_row("with manual and guides, empty home", took, _size(home)))
    again = _again(home)
    figures.append(TargetFigure("build_again", again.wall, "median of 3"))
    rows.append(_row("with manual and guides, nothing changed", again, "the same base"))
    rows.append(_row("with manual and guides, forced", run_build(home, "--force"), _size(home)))
    rows.append(_row("Sphinx alone, writing nothing", alone, "the manual's pages read"))


def _sphinx(folder: Path) -> BuildTime:
    """What Sphinx itself takes to read the manual's pages. Raises BuildFailed."""
    found, _ = find_sources(BLENDER, cache=folder / "cache", corpora=corpora(), allow_download=False)
    manual = next((source.path for source in found if source.role == "manual"), None)
    if manual is None:
        raise BuildFailed("there is no manual among the documentation sources")
    say("builds: the manual by Sphinx alone")
    # No configuration, no warnings, and a builder that writes nothing.
    command = [sys.executable, "-m", "sphinx", "-C", "-Q", "-b", "dummy", "-j", str(_JOBS)]
    began, used = time.perf_counter(), _children_cpu()
    try:
        subprocess.run([*command, manual, folder / "sphinx"], check=True, timeout=_LONGEST)
    except (OSError, subprocess.SubprocessError) as error:
        raise BuildFailed(f"Sphinx alone: {error}") from error
    return BuildTime(time.perf_counter() - began, _children_cpu() - used)


def _size(home: Path) -> str:
    return f"{base_path(home, BLENDER).stat().st_size / 1e6:.1f} MB"


def _html(folder: Path, figures: list[TargetFigure], rows: list[tuple[str, ...]]) -> None:
    sources = corpora()
    archive = next(iter(sorted(sources.glob(f"{HTML}*"))), None) if sources else None
    if archive is None:
        raise FileNotFoundError(f"no {HTML}.tar.xz among the documentation sources")
    say(f"builds: unpacking {archive.name}")
    began, used = time.perf_counter(), time.process_time()
    found_sources, _ = find_sources(
        _HTML_VERSION, cache=folder / "cache", manual=archive, allow_download=False
    )
    unpacked = BuildTime(time.perf_counter() - began, time.process_time() - used)
    html = next(source for source in found_sources if source.role == "manual")
    size = sum(path.stat().st_size for path in html.path.rglob("*") if path.is_file()) / 1e6
    say("builds: reading the manual's HTML form")
    between, used = time.perf_counter(), time.process_time() + _children_cpu()
    pages = read_html(html.path, source="manual", version=_HTML_VERSION, jobs=_JOBS)
    took = BuildTime(time.perf_counter() - between, time.process_time() + _children_cpu() - used)
    figures.append(TargetFigure("html", took.wall, f"{size:,.0f} MB, {_JOBS} processes"))
    rows.append(_row(f"{archive.name}: unpacking", unpacked, f"{size:,.0f} MB"))
    rows.append(_row(f"{archive.name}: reading", took, f"{len(pages):,} pages"))
