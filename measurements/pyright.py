"""Compares the checker with pyright, the plain baseline: with fake-bpy-module's stubs, and with those of SimWorlds.

``python -m measurements --only pyright`` has each of them check, in pyright's basic mode, the script templates that the
base's Blender brings and this project's own scripts that run inside Blender, where errors are false unless
``broken_in_blender.toml`` proves the line wrong, and scripts with planted mistakes (:mod:`measurements.planted`),
which are found when the copy has an error at the mistake's line that the script has not. Seconds are CPU time, of the
processes that were started too.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tempfile
import time
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.markdown_tables import Table
from kb_build.usage.scripts import read_script
from kb_check.checker import Checker
from kb_check.command.files import find_files
from kb_check.command.project import check_group
from kb_check.command.run import load
from kb_check.stubs.package import write_folder
from measurements.blender_scripts import scripts_folder, why_none
from measurements.check_blender import broken_rows, proof_of
from measurements.planted import MISTAKES, plant
from measurements.report import ReportPart
from measurements.setting import REPO, say

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from measurements.planted import Planted
    from measurements.setting import Setting

_PEER = "fake-bpy-module-5.1"
_BATCH = 200  # scripts that one pyright reads
_SECONDS = 1_800
_HEADER = (
    "", "templates: files", "errors", "proven", "own scripts: files", "errors", "proven", "planted", "found", "share",
    "CPU s",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Error:
    """What is said to be wrong at some lines."""

    first: int
    last: int
    text: str


Errors = dict[str, list[Error]]  # by the file's path below the folder that was checked


@dataclass(slots=True)
class Row:
    """What one of them made of everything. ``sets`` is (files, errors, proven) of each set of right scripts."""

    sets: list[tuple[int, int, int]] = field(default_factory=list[tuple[int, int, int]])
    planted: int = 0
    found: int = 0
    seconds: float = 0.0


class OwnCheck:
    """``simworlds check``, in this process."""

    def __init__(self, base: Path) -> None:
        self._base = base

    def errors(self, folder: Path) -> Errors:
        """The errors in the files below a folder."""
        found: Errors = {}
        with Checker(self._base) as checker:
            for group in load(find_files([folder], gitignore=False).groups, []):
                for file, findings in zip(group, check_group(checker, group), strict=True):
                    found[Path(file.name).relative_to(folder).as_posix()] = [
                        Error(each.span.line, each.span.end_line, f"{each.rule}: {each.message}")
                        for each in findings
                        if each.severity == "error"
                    ]
        return found


class Pyright:
    """pyright in basic mode; ``stubs`` is a folder of stubs, without it the environment's packages bring them."""

    def __init__(self, stubs: Path | None = None) -> None:
        self._stubs = stubs

    def errors(self, folder: Path) -> Errors:
        """The errors in the files below a folder."""
        config: dict[str, Any] = {"typeCheckingMode": "basic", "venvPath": str(REPO), "venv": ".venv"}
        if self._stubs is not None:
            config["stubPath"] = str(self._stubs)
        (folder / "pyrightconfig.json").write_text(json.dumps(config), encoding="utf-8")
        done = subprocess.run(
            [sys.executable, "-m", "pyright", "--outputjson", "--project", str(folder)],
            capture_output=True, text=True, cwd=folder, timeout=_SECONDS, check=False,
        )  # fmt: skip
        found: defaultdict[str, list[Error]] = defaultdict(list)
        for row in json.loads(done.stdout)["generalDiagnostics"]:
            if row["severity"] == "error":
                path = Path(row["file"]).relative_to(folder.resolve()).as_posix()
                lines = row["range"]["start"]["line"] + 1, row["range"]["end"]["line"] + 1
                found[path].append(Error(*lines, f"{row.get('rule', '')}: {row['message']}"))
        return dict(found)


def lay_out(folder: Path, scripts: Iterable[tuple[str, str]]) -> None:
    """Writes scripts, given by (path, text), below a folder."""
    for name, code in scripts:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(code, encoding="utf-8", newline="")


def own_scripts() -> Iterable[tuple[str, str]]:
    """This project's scripts that run inside Blender."""
    for part in ("simworlds", "kb_build", "kb_check", "agents", "bench"):
        for path in sorted((REPO / part).rglob("inside/**/*.py")):
            yield path.relative_to(REPO).as_posix(), read_script(path)


def proven_lines(base: Path, scripts: Path) -> set[tuple[str, int]]:
    """(path below Blender's folder of scripts, line) of what is proven to be wrong in the templates."""
    rows, found = broken_rows(), set[tuple[str, int]]()
    with Checker(base) as checker:
        for path in sorted((scripts / "templates_py").glob("*.py")):
            name = path.relative_to(scripts).as_posix()
            found.update(
                (name, each.span.line)
                for each in checker.check(read_script(path))
                if proof_of(name, each, rows)[0]
            )
    return found


def judge(
    peer: OwnCheck | Pyright, sets: Sequence[Path], proven: set[tuple[str, int]], planted: Sequence[Planted],
    originals: dict[str, str],
) -> Row:  # fmt: skip
    """Has one of them check the sets of right scripts, and those with mistakes."""
    row, began = Row(), _cpu()
    for folder in sets:
        files = sum(1 for _ in folder.rglob("*.py"))
        errors = [(name, each) for name, held in peer.errors(folder).items() for each in held]
        right = sum(any((name, line) in proven for line in range(e.first, e.last + 1)) for name, e in errors)
        row.sets.append((files, len(errors), right))
    for start in range(0, len(planted), _BATCH):
        with tempfile.TemporaryDirectory(prefix="simworlds-") as name:
            row.found += _found(peer, Path(name), planted[start : start + _BATCH], originals)
    row.planted, row.seconds = len(planted), _cpu() - began
    return row


def _found(
    peer: OwnCheck | Pyright, folder: Path, batch: Sequence[Planted], originals: dict[str, str]
) -> int:
    """How many mistakes of a batch are found. Each script stands in a folder of its own: none imports another."""
    scripts = sorted({mistake.script for mistake in batch})
    lay_out(folder, ((f"s{number}/script.py", originals[name]) for number, name in enumerate(scripts)))
    lay_out(folder, ((f"m{number}/script.py", mistake.code) for number, mistake in enumerate(batch)))
    errors = peer.errors(folder)
    before = {
        name: Counter(each.text for each in errors.get(f"s{number}/script.py", ()))
        for number, name in enumerate(scripts)
    }
    count = 0
    for number, mistake in enumerate(batch):
        here = Counter(
            each.text
            for each in errors.get(f"m{number}/script.py", ())
            if each.first <= mistake.line <= each.last
        )
        count += any(times > before[mistake.script][text] for text, times in here.items())
    return count


def _cpu() -> float:
    """CPU seconds of this process, and of those that it started and that have ended."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def measure(setting: Setting) -> ReportPart:
    """Compares them; ``quick`` leaves it out."""
    if setting.quick:
        return ReportPart("pyright", skipped=("left out by --quick",))
    if (scripts := scripts_folder(setting.base)) is None:
        return ReportPart("pyright", skipped=(why_none(setting.base),))
    rows: list[tuple[str, ...]] = []
    planted = list(plant(setting.base, scripts, MISTAKES))
    originals = {mistake.script: read_script(scripts / mistake.script) for mistake in planted}
    proven = proven_lines(setting.base, scripts)
    with tempfile.TemporaryDirectory(prefix="simworlds-") as name:
        top = Path(name)
        templates, own, stubs = top / "templates", top / "own", top / "stubs"
        paths = sorted((scripts / "templates_py").glob("*.py"))
        lay_out(templates, ((path.relative_to(scripts).as_posix(), read_script(path)) for path in paths))
        lay_out(own, own_scripts())
        write_folder(setting.base, stubs)
        peers = {
            "simworlds check": OwnCheck(setting.base),
            "pyright, stubs of SimWorlds": Pyright(stubs),
            f"pyright, {_PEER}": Pyright(),
        }
        for title, peer in peers.items():
            say(f"pyright: {title}")
            row = judge(peer, (templates, own), proven, planted, originals)
            numbers = [number for each in row.sets for number in each]
            share = row.found / max(1, row.planted)
            rows.append(
                (title, *map(str, (*numbers, row.planted, row.found)), f"{share:.3f}", f"{row.seconds:.0f}")
            )
    return ReportPart("pyright", (), (Table("Beside pyright in basic mode", _HEADER, tuple(rows)),))
