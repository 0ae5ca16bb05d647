"""Checks packages that others wrote and published, and has Blender judge what is found there.

``python -m measurements --only check_packages`` fetches the packages of ``packages_on_pypi.toml`` once, by their
digests, and checks each for the Blenders that it says it is for. An error is right if a row of that file stands for it
and Blender, when it runs the row's code, says what the row says. Every other error counts as false. Warnings and notes
are counted alone.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tomllib
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.markdown_tables import Table
from kb_build.base_file import read_meta
from measurements.builds import simworlds_command
from measurements.check_blender import Broken, ask_blender
from measurements.report import ReportPart, TargetFigure
from measurements.setting import environment, say
from simworlds.settings import base_path, cache_folder

if TYPE_CHECKING:
    from collections.abc import Sequence

    from measurements.setting import Setting

LISTED = Path(__file__).with_name("packages_on_pypi.toml")
_HEADER = ("package", "version", "Blender", "files", "errors", "right", "false", "warnings", "notes")
_SECONDS = 900
# Of packages with compiled parts, the files for one machine: their Python is the same for all.
_FOR_ANY_MACHINE = ("--python-version", "3.11", "--platform", "manylinux2014_x86_64", "--platform", "any")


@dataclass(frozen=True, slots=True)
class Package:
    """A published package and the Blenders that it is for."""

    name: str
    version: str
    sha256: str
    blenders: tuple[str, ...]


def listed() -> tuple[list[Package], list[Broken]]:
    """The packages, and what each gets wrong: paths of scripts begin with the package's name."""
    data = tomllib.loads(LISTED.read_text(encoding="utf-8"))
    packages = [
        Package(row["name"], row["version"], row["sha256"], tuple(row["blenders"])) for row in data["package"]
    ]
    broken = [
        Broken(tuple(row["scripts"]), row["symbol"], row["code"], row["says"], row["why"])
        for row in data["broken"]
    ]
    return packages, broken


def fetch(package: Package, folder: Path) -> Path | None:
    """The unpacked files of a package, fetched if they are not there; None without a network."""
    unpacked = folder / f"{package.name}-{package.version}"
    if unpacked.is_dir():
        return unpacked
    folder.mkdir(parents=True, exist_ok=True)
    wanted = folder / "wanted.txt"
    wanted.write_text(f"{package.name}=={package.version} --hash=sha256:{package.sha256}\n", encoding="utf-8")
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--only-binary=:all:"]
    done = subprocess.run(
        [*command, *_FOR_ANY_MACHINE, "--require-hashes", "--dest", str(folder), "-r", str(wanted)],
        check=False,
        capture_output=True,
        timeout=_SECONDS,
    )
    archive = next(folder.glob(f"{package.name}-{package.version}-*.whl"), None)
    if done.returncode != 0 or archive is None:
        return None
    half = unpacked.with_suffix(".half")
    with zipfile.ZipFile(archive) as files:
        files.extractall(half, [name for name in files.namelist() if name.endswith(".py")])
    archive.unlink()
    return half.rename(unpacked)


def check(folder: Path, blender: str, home: Path) -> dict[str, Any]:
    """What ``simworlds check --json`` says of a folder, with the paths of findings below it."""
    command = [
        *simworlds_command(),
        "check",
        "--json",
        "--no-gitignore",
        "--no-cache",
        "--blender",
        blender,
        ".",
    ]
    done = subprocess.run(
        command,
        cwd=folder,
        env=environment(home),
        capture_output=True,
        text=True,
        timeout=_SECONDS,
        check=False,
    )
    return json.loads(done.stdout)


def right_and_false(
    found: Sequence[dict[str, Any]], rows: Sequence[Broken], executable: str
) -> tuple[int, list[str]]:
    """The number of errors that Blender proves, and the others, each in a line."""
    rows_of = [
        next((row for row in rows if error["symbol"] == row.symbol and error["path"] in row.scripts), None)
        for error in found
    ]
    answers = ask_blender(executable, [row.code for row in rows_of if row])
    false = [
        f"{error['path']}:{error['line']}: {error['rule']}: {error['message']}"
        for error, row in zip(found, rows_of, strict=True)
        if row is None or answers.get(row.code, "").strip() != row.says
    ]
    return len(found) - len(false), false


def measure(setting: Setting) -> ReportPart:
    """Checks each package for each of its Blenders whose base is there."""
    packages, rows = listed()
    folder = cache_folder(setting.home) / "packages"
    table: list[tuple[str, ...]] = []
    skipped: list[str] = []
    false: list[str] = []
    right = files = 0
    for package in packages:
        say(f"check_packages: {package.name} {package.version}")
        unpacked = fetch(package, folder)
        if unpacked is None:
            skipped.append(f"{package.name} {package.version}: it could not be fetched")
            continue
        for blender in package.blenders:
            base = base_path(setting.home, blender)
            if not base.is_file():
                skipped.append(f"{package.name}: no base of Blender {blender}")
                continue
            told = check(unpacked, blender, setting.home)
            executable = json.loads(read_meta(base)["runtime"]).get("executable") or sys.executable
            errors = [one for one in told["findings"] if one["severity"] == "error"]
            proven, wrong = right_and_false(errors, rows, executable)
            counts = (told["files"], len(errors), proven, len(wrong), told["warnings"], told["notes"])
            table.append((package.name, package.version, blender, *(f"{count:,}" for count in counts)))
            false += [f"{blender}: {line}" for line in wrong]
            right, files = right + proven, files + told["files"]
    figures = (TargetFigure("packages_false", len(false), f"{right} right, {files:,} files"),)
    tables = (Table("Findings in packages of others", _HEADER, tuple(table)),)
    return ReportPart("check_packages", figures if table else (), tables, tuple(skipped), {"false": false})
