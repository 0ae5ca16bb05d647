"""Checks all scripts of Blender itself, which are right as a rule, and has Blender judge what is found there.

``python -m measurements --only check_blender`` checks every script that the base's Blender brings, and those of each
other version from 4.2 on whose base lies beside it. A finding is true if ``broken_in_blender.toml`` has a row for it
and Blender, when it runs the row's code, says what the row says; a comparison that never holds also if
Blender's own enumeration lacks the value, and a name that nothing binds if the module that Blender loads lacks it.
Every other error is counted as false. Warnings of other rules, and notes, are counted alone.

This project's own scripts that run inside Blender, in the folders called ``inside``, are checked too. They run in every
version, which the tests prove: whatever is found there is false.
"""

from __future__ import annotations

import gc
import json
import re
import subprocess
import sys
import time
import tomllib
from collections import Counter, defaultdict
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from bench.markdown_tables import Table
from kb_build.base_file import read_meta
from kb_build.flow.state.source_files import module_name
from kb_build.usage.scripts import read_script
from kb_check.checker import Checker
from measurements.blender_scripts import scripts_folder
from measurements.report import ReportPart, TargetFigure
from measurements.setting import REPO, say
from simworlds.releases import version_key

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kb_check.findings import Finding
    from measurements.setting import Setting

BROKEN = Path(__file__).with_name("broken_in_blender.toml")
OLDEST = (4, 2)  # older Blenders bring hundreds of add-ons that nobody kept up
_HEADER = (
    "Blender",
    "files",
    "lines",
    "errors",
    "proven",
    "false",
    "never true",
    "proven",
    "other warnings",
    "notes",
)
_PARTS = (
    "simworlds",
    "kb_build",
    "kb_check",
    "agents",
    "bench",
)  # of the project that have packages in Blender
_MARK = "ANSWERS:"
_UNBOUND = re.compile(r"(?:called )?`(\w+)`(?: is bound in .*)?: NameError")
_ON_PATH = ("modules", "startup", "addons_core", "addons")  # folders of scripts that Python imports from
_SECONDS = 120
# Runs in Blender: each text of code, from the state that Blender starts in, and what it ends in.
_RUN = """
import json, sys
import bpy
answers = []
for code in json.loads({codes!r}):
    bpy.ops.wm.read_factory_settings()
    try:
        exec(code, {{"bpy": bpy}})
        answers.append("")
    except Exception as error:
        answers.append(f"{{type(error).__name__}}: {{error}}")
print({mark!r} + json.dumps(answers))
"""


@dataclass(frozen=True, slots=True)
class Broken:
    """What a script of Blender's gets wrong, and the code that proves it."""

    scripts: tuple[str, ...]
    symbol: str
    code: str
    says: str
    why: str


def broken_rows() -> list[Broken]:
    """The rows of ``broken_in_blender.toml``."""
    rows = tomllib.loads(BROKEN.read_text(encoding="utf-8"))["broken"]
    return [
        Broken(tuple(row["scripts"]), row["symbol"], row["code"], row["says"], row["why"]) for row in rows
    ]


def packages(folder: Path) -> Iterator[dict[str, Path]]:
    """The scripts below Blender's folder of scripts, grouped as they belong together: module path → file.

    An add-on is a package; so is each folder right below the others (``startup/bl_ui``).
    """
    groups: defaultdict[Path, dict[str, Path]] = defaultdict(dict)
    for path in sorted(folder.rglob("*.py")):
        parts = path.relative_to(folder).parts
        if "__pycache__" not in parts and len(parts) > 1:
            root = folder / parts[0]
            groups[root / parts[1] if len(parts) > 2 else root][path.relative_to(root).as_posix()] = path
    yield from groups.values()


def check_all(checker: Checker, folder: Path) -> Iterator[tuple[str, list[Finding], int]]:
    """(path below the folder, findings, number of lines) of every script below Blender's folder of scripts."""
    for files in packages(folder):
        codes = {name: read_script(path) for name, path in files.items()}
        reads = checker.read_files(codes)
        package = checker.package(reads.values())
        for name, read in reads.items():
            path = files[name].relative_to(folder).as_posix()
            yield path, checker.check(read, package), codes[name].count("\n")


def inside_packages(repo: Path = REPO) -> Iterator[dict[str, Path]]:
    """This project's packages that run inside Blender: path in the repository → file."""
    for part in _PARTS:
        for folder in sorted((repo / part).rglob("inside")):
            yield {path.relative_to(repo).as_posix(): path for path in sorted(folder.rglob("*.py"))}


def check_inside(checker: Checker, repo: Path = REPO) -> tuple[list[str], int]:
    """The errors, and comparisons that never hold, in these packages, and the number of their files."""
    wrong: list[str] = []
    count = 0
    for files in inside_packages(repo):
        reads = checker.read_files({name: path.read_text(encoding="utf-8") for name, path in files.items()})
        package = checker.package(reads.values())
        count += len(files)
        for name, read in reads.items():
            wrong += [
                f"{name}:{one.span.line}: {one.rule}: {one.message}"
                for one in checker.check(read, package)
                if one.severity == "error" or one.rule == "never-true"
            ]
    return wrong, count


def ask_blender(executable: str, codes: Iterable[str]) -> dict[str, str]:
    """What Blender says to pieces of code, the error that each ends in ("" for none); {} if it cannot be run."""
    wanted = list(dict.fromkeys(codes))
    program = _RUN.format(codes=json.dumps(wanted), mark=_MARK)
    is_python = Path(executable).name.startswith("python")
    options = ["-c"] if is_python else ["--background", "--factory-startup", "--python-expr"]
    try:
        done = subprocess.run(
            [executable, *options, program], capture_output=True, text=True, timeout=_SECONDS, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return {}
    line = next((line for line in done.stdout.splitlines() if line.startswith(_MARK)), "")
    return dict(zip(wanted, json.loads(line.removeprefix(_MARK)), strict=True)) if line else {}


def proof_of(path: str, finding: Finding, rows: list[Broken]) -> tuple[str, str]:
    """The code that proves a finding, and what it must say; empty for none."""
    if unbound := _UNBOUND.search(finding.message):
        code = f"eval({unbound[1]!r}, {_names_in(path)})"
        return code, f"NameError: name {unbound[1]!r} is not defined"
    for row in rows:
        if finding.symbol == row.symbol and path in row.scripts:
            return row.code, row.says
    if finding.rule == "never-true":
        owner, _, value = finding.symbol.rpartition(":")
        cls, _, name = owner.rpartition(".")
        code = f"{cls}.bl_rna.properties[{name!r}].enum_items[{value!r}]"
        return code, f"KeyError: 'bpy_prop_collection[key]: key \"{value}\" not found'"
    return "", ""


def _names_in(path: str) -> str:
    """Code that gives the names of a script's module, once it was loaded."""
    parts = module_name(path)[0].split(".")
    roots = [place for place, part in enumerate(parts) if part in _ON_PATH]
    if roots:
        return f"vars(__import__('importlib').import_module({'.'.join(parts[roots[-1] + 1 :])!r}))"
    file = f"bpy.utils.system_resource('SCRIPTS') + {f'/{path}'!r}"
    return f"__import__('runpy').run_path({file})"


def measure(setting: Setting) -> ReportPart:
    """Checks the base's Blender, and unless ``quick`` each other one in the same home."""
    bases = [setting.base]
    if not setting.quick:
        others = (
            path for path in sorted(setting.base.parent.glob("blender-*.sqlite")) if path != setting.base
        )
        bases += [path for path in others if version_key(path.stem) >= OLDEST]
    rows: list[tuple[str, ...]] = []
    skipped: list[str] = []
    false: list[str] = []
    own: list[str] = []
    seconds, lines, own_files = 0.0, 0, 0
    for base in bases:
        meta = read_meta(base)
        runtime: Mapping[str, str] = json.loads(meta["runtime"])
        if (folder := scripts_folder(base)) is None:
            skipped.append(f"Blender {meta['minor']}: its scripts are not there")
            continue
        say(f"check_blender: checking the scripts of Blender {meta['blender']}")
        gc.disable()  # as the command does
        began = time.process_time()
        with Checker(base) as checker:
            results = list(check_all(checker, folder))
            gc.enable()
            if base == setting.base:
                seconds, lines = time.process_time() - began, sum(count for _, _, count in results)
                own, own_files = check_inside(checker)
        executable = runtime.get("executable") or sys.executable
        row, wrong = _judged(results, executable if Path(executable).exists() else sys.executable)
        rows.append((meta["minor"], *row))
        false += [f"{meta['minor']}: {text}" for text in wrong]
    figures = (
        TargetFigure("check_false", len(false), "errors and comparisons not proven, all versions"),
        TargetFigure("check_inside", len(own), f"{own_files} files"),
        TargetFigure("check_all", seconds, f"{lines:,} lines, one process"),
        TargetFigure("check_speed", 1e6 * seconds / max(1, lines), "the same, a thousand lines"),
    )
    table = Table("Findings in Blender's own scripts", _HEADER, tuple(rows))
    return ReportPart(
        "check_blender", figures if rows else (), (table,), tuple(skipped), {"false": false, "inside": own}
    )


def _judged(
    results: list[tuple[str, list[Finding], int]], executable: str
) -> tuple[tuple[str, ...], list[str]]:
    """A row of the table, and the findings that are not proven."""
    known = broken_rows()
    found = [
        (path, finding, *proof_of(path, finding, known))
        for path, findings, _ in results
        for finding in findings
    ]
    answers = ask_blender(executable, (code for _, _, code, _ in found if code))
    counts: Counter[str] = Counter()
    false: list[str] = []
    for path, finding, code, says in found:
        kind = "never" if finding.rule == "never-true" else finding.severity
        counts[kind] += 1
        if kind in {"never", "error"}:
            if code and answers.get(code) == says:
                counts[f"{kind} proven"] += 1
            else:
                told = f" ({answers.get(code)})" if code else ""
                false.append(f"{path}:{finding.span.line}: {finding.rule}: {finding.message}{told}")
    lines = sum(count for _, _, count in results)
    numbers = (
        len(results), lines, counts["error"], counts["error proven"], counts["error"] - counts["error proven"],
        counts["never"], counts["never proven"], counts["warning"], counts["note"],
    )  # fmt: skip
    return tuple(f"{number:,}" for number in numbers), false
