"""Builds the wheel and the sdist from the tracked files alone, twice and apart: both must give the same bytes."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import click

_EPOCH = 1_577_836_800  # the first second of 2020, where there is no commit to take the time from


def epoch(repo: Path) -> int:
    """The time that built files carry: SOURCE_DATE_EPOCH, else that of the last commit."""
    if named := os.environ.get("SOURCE_DATE_EPOCH"):
        return int(named)
    done = _git(repo, "log", "-1", "--format=%ct")
    return int(done) if done.strip().isdigit() else _EPOCH


def build_twice(repo: Path, output: Path) -> tuple[Path, Path]:
    """The wheel and the sdist, in ``output``. Raises ClickException if two builds differ, or one fails."""
    with tempfile.TemporaryDirectory(prefix="simworlds-build-") as scratch:
        first = _build(repo, Path(scratch) / "first", hash_seed="1", zone="UTC")
        second = _build(repo, Path(scratch) / "a" / "second", hash_seed="2", zone="Asia/Kathmandu")
        differing = [
            name for name in sorted(first.keys() | second.keys()) if first.get(name) != second.get(name)
        ]
        if differing:
            raise click.ClickException(f"Two builds of the same files differ in {', '.join(differing)}.")
    output.mkdir(parents=True, exist_ok=True)
    for name, content in first.items():
        (output / name).write_bytes(content)
    wheel, sdist = (
        next(output / name for name in first if name.endswith(end)) for end in (".whl", ".tar.gz")
    )
    return wheel, sdist


def _build(repo: Path, folder: Path, *, hash_seed: str, zone: str) -> dict[str, bytes]:
    """File name → content, built from a copy of the tracked files in ``folder``."""
    source, target = folder / "source", folder / "built"
    for name in _git(repo, "ls-files", "-z").split("\0"):
        if name and (repo / name).is_file():
            place = source / name
            place.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(repo / name, place)  # with today's date: it must not matter
    environment = {
        **os.environ,
        "SOURCE_DATE_EPOCH": str(epoch(repo)),
        "PYTHONHASHSEED": hash_seed,
        "TZ": zone,
    }
    done = subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "--directory", str(target)],
        cwd=source,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise click.ClickException(f"hatchling failed:\n{done.stderr.strip()}")
    return {path.name: path.read_bytes() for path in target.iterdir()}


def _git(repo: Path, *words: str) -> str:
    done = subprocess.run(["git", *words], cwd=repo, capture_output=True, text=True, check=False)
    if done.returncode:
        raise click.ClickException(f"git {words[0]} failed; make dist needs a clone: {done.stderr.strip()}")
    return done.stdout
