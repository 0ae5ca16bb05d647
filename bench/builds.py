"""How long builds take: from nothing with all pages, without pages, and when nothing has changed.

Every build is a process of ``simworlds kb build`` in a home folder that was empty before.
"""

from __future__ import annotations

import subprocess
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.report import Figure, Part, Table
from bench.setting import BLENDER, REPO, corpora, environment, percentile, say, simworlds
from kb_build.errors import KBBuildError
from kb_build.pages.html import read_html
from kb_build.settings import base_path
from kb_build.sources import find_sources

if TYPE_CHECKING:
    from bench.setting import Setting

HTML = "manual-4.4-html"
_HTML_VERSION = "4.4"
_JOBS = 2
_LONGEST = 1_800


class BuildFailed(Exception):  # noqa: N818 - reads as the state it names
    """A build ended with an error; the message is its last words."""


def run_build(home: Path, *arguments: str) -> float:
    """Builds in ``home`` and returns the seconds. Raises BuildFailed."""
    command = [*simworlds(), "kb", "build", BLENDER, "--offline", *arguments]
    began = time.perf_counter()
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
    took = time.perf_counter() - began
    if done.returncode != 0:
        said = (done.stderr or done.stdout).strip().splitlines()
        raise BuildFailed(f"exit code {done.returncode}: {said[-1] if said else 'it said nothing'}")
    return took


def measure(setting: Setting) -> Part:
    """Builds in temporary folders; with ``quick`` neither the whole one nor the manual's HTML form."""
    figures: list[Figure] = []
    rows: list[tuple[str, ...]] = []
    skipped: list[str] = []
    with tempfile.TemporaryDirectory(prefix="simworlds-bench-") as folder:
        steps = (
            [(_api, "build without pages")]
            if setting.quick
            else [(_api, "build without pages"), (_whole, "build")]
        )
        for step, name in steps:
            try:
                step(Path(folder), figures, rows)
            except BuildFailed as error:
                skipped.append(f"{name}: {error}")
        if not setting.quick:
            try:
                _html(Path(folder), figures, rows)
            except (KBBuildError, FileNotFoundError) as error:
                skipped.append(f"manual from HTML: {error}")
    if not any(figure.key == "size" for figure in figures):
        figures.append(Figure("size", setting.base.stat().st_size / 1e6, "the base that is measured"))
    tables = (Table("Builds", ("what", "seconds", "gives"), tuple(rows)),) if rows else ()
    data: dict[str, Any] = {
        "builds": [dict(zip(("what", "seconds", "gives"), row, strict=True)) for row in rows]
    }
    return Part("builds", tuple(figures), tables, tuple(skipped), data)


def _again(home: Path, *arguments: str) -> float:
    return percentile([run_build(home, *arguments) for _ in range(3)], 0.5)


def _api(folder: Path, figures: list[Figure], rows: list[tuple[str, ...]]) -> None:
    say(f"builds: {BLENDER} without pages")
    home = folder / "api"
    took = run_build(home, "--no-pages")
    figures.append(Figure("build_api", took, "empty home"))
    rows.append(("without pages, empty home", f"{took:.1f}", _size(home)))
    again = _again(home, "--no-pages")
    rows.append(("without pages, nothing changed", f"{again:.2f}", "the same base"))


def _whole(folder: Path, figures: list[Figure], rows: list[tuple[str, ...]]) -> None:
    if corpora() is None:
        raise BuildFailed("no documentation sources here; set SIMWORLDS_CORPORA to a folder that has them")
    say(f"builds: {BLENDER} with manual and guides")
    home = folder / "whole"
    took = run_build(home, "--require", "manual,guides")
    figures.append(Figure("build", took, "empty home"))
    figures.append(Figure("size", base_path(home, BLENDER).stat().st_size / 1e6, "just built"))
    rows.append(("with manual and guides, empty home", f"{took:.1f}", _size(home)))
    again = _again(home)
    figures.append(Figure("build_again", again, "median of 3"))
    rows.append(("with manual and guides, nothing changed", f"{again:.2f}", "the same base"))
    anew = run_build(home, "--force")
    rows.append(("with manual and guides, forced", f"{anew:.1f}", _size(home)))


def _size(home: Path) -> str:
    return f"{base_path(home, BLENDER).stat().st_size / 1e6:.1f} MB"


def _html(folder: Path, figures: list[Figure], rows: list[tuple[str, ...]]) -> None:
    sources = corpora()
    archive = next(iter(sorted(sources.glob(f"{HTML}*"))), None) if sources else None
    if archive is None:
        raise FileNotFoundError(f"no {HTML}.tar.xz among the documentation sources")
    say(f"builds: unpacking {archive.name}")
    began = time.perf_counter()
    found, _ = find_sources(_HTML_VERSION, cache=folder / "cache", manual=archive, allow_download=False)
    unpacked = time.perf_counter()
    html = next(source for source in found if source.role == "manual")
    size = sum(path.stat().st_size for path in html.path.rglob("*") if path.is_file()) / 1e6
    say("builds: reading the manual's HTML form")
    between = time.perf_counter()
    pages = read_html(html.path, source="manual", version=_HTML_VERSION, jobs=_JOBS)
    took = time.perf_counter() - between
    figures.append(Figure("html", took, f"{size:,.0f} MB, {_JOBS} processes"))
    rows.append((f"{archive.name}: unpacking", f"{unpacked - began:.1f}", f"{size:,.0f} MB"))
    rows.append((f"{archive.name}: reading", f"{took:.1f}", f"{len(pages):,} pages"))
