"""The provenance of a result: commit, versions, and a digest of the code that made it."""

from __future__ import annotations

import ast
import os
import platform
import subprocess
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from bench.sweep.content_hash import digest_of
from bench.sweep.records import Provenance
from simworlds.files import sha256_of_file
from simworlds.installed import installed_version

if TYPE_CHECKING:
    from collections.abc import Iterator

_ROOT = Path(__file__).resolve().parent.parent.parent
_INSIDE, _FRAMES = "bench/audit/inside", "frames.py"
IN_BLENDER = "simworlds/sandbox/inside/*.py"
"""What opens, refuses and repairs files in each Blender of ours, for ``code_of``."""
_PACKAGES = (
    *("anthropic", "av", "bpy", "huggingface-hub", "numpy"),
    *("openai", "pillow", "pydantic", "ray", "safetensors"),
)


@cache
def code_of(module: str, *beside: str) -> str:
    """Digest of a module of ``bench`` with all of ``bench`` that it imports, and of further files (globs).

    What ``bench`` takes of ``simworlds`` starts programs and carries their answers, and does not count.
    """
    paths = {*_closure(module), *(path for pattern in beside for path in _ROOT.glob(pattern))}
    return digest_of({path.relative_to(_ROOT).as_posix(): sha256_of_file(path) for path in paths})


def code_of_audit() -> str:
    """Digest of the audit's code, with that in Blender."""
    inside = sorted(path.name for path in (_ROOT / _INSIDE).glob("*.py") if path.name != _FRAMES)
    return code_of("bench.audit.audit", *(f"{_INSIDE}/{name}" for name in inside), IN_BLENDER)


def code_of_frames() -> str:
    """Digest of the code that takes frames. What it shares with the audit matters only for unbaked physics."""
    return code_of(
        "bench.frames.clip_frames", f"{_INSIDE}/{_FRAMES}", "bench/frames/decode_video.py", IN_BLENDER
    )


def provenance(code: str, blender: str | None = None) -> Provenance:
    """The provenance of a step that runs now. ``code``: digest of its code; ``blender``: version that it uses."""
    commit, dirty = _commit()
    return Provenance(
        simworlds=installed_version("simworlds") or "from source",
        commit=commit,
        dirty=dirty,
        code=code,
        python=platform.python_version(),
        packages=_packages(),
        blender=blender,
        machine=f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
    )


def _closure(module: str) -> set[Path]:
    """The files of a module and of all modules of ``bench`` that it imports, directly or not."""
    files: set[Path] = set()
    waiting = [module]
    while waiting:
        path = _file_of(waiting.pop())
        if path is not None and path not in files:
            files.add(path)
            waiting += _imported(ast.parse(path.read_bytes()))
    return files


def _imported(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def _file_of(module: str) -> Path | None:
    top, *parts = module.split(".")
    if top != "bench" or not parts:
        return None
    path = _ROOT.joinpath(top, *parts).with_suffix(".py")
    return path if path.is_file() else None


@cache
def _packages() -> dict[str, str]:
    return {name: version for name in _PACKAGES if (version := installed_version(name))}


@cache
def _commit() -> tuple[str | None, bool | None]:
    """The commit of the checkout, and whether tracked files differ from it; None where there is no checkout."""
    if not (_ROOT / ".git").exists():
        return None, None
    commit = _git("rev-parse", "HEAD")
    changes = _git("status", "--porcelain", "--untracked-files=no")
    return commit or None, None if changes is None else bool(changes)


def _git(*words: str) -> str | None:
    try:
        done = subprocess.run(
            ["git", "-C", str(_ROOT), *words], capture_output=True, text=True, check=False, timeout=20
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip() if done.returncode == 0 else None
