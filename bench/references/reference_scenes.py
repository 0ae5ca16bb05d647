"""Reference scenes: for every spec a scene that meets it, built by its script in ``inside`` and baked.

They prove that the specs can be satisfied; the other properties of the benchmark are proven on them. A scene that was
built is kept until its script, the modules that it imports, or Blender change.
"""

from __future__ import annotations

import ast
import hashlib
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

from simworlds.files import staged_folder
from simworlds.sandbox.errors import ProgramFailed
from simworlds.sandbox.launch import find_blender
from simworlds.sandbox.program import SHARED, Program
from simworlds.sandbox.runtime import run_program
from simworlds.settings import home_folder

if TYPE_CHECKING:
    from collections.abc import Iterator

    from simworlds.sandbox.runtime import Runtime

INSIDE = Path(__file__).parent / "inside"
_SCENES = INSIDE / "scenes"
_MAKER = Program("bench.references.inside.make", {**SHARED, "bench.references.inside": INSIDE})
_SECONDS = 900.0


class CannotBuild(Exception):  # noqa: N818 - reads as the state it names
    """A reference scene that could not be built; the message says which, and where Blender's output is."""


def references_folder() -> Path:
    """Where reference scenes are kept."""
    return home_folder() / "references"


def has_reference(scene: str) -> bool:
    """Whether there is a script for the scene."""
    return script_of(scene).is_file()


def script_of(scene: str) -> Path:
    """The script of a scene."""
    return _SCENES / f"{scene}.py"


def build(scene: str, folder: Path | None = None, runtime: Runtime | None = None) -> Path:
    """The baked .blend of a scene, below ``folder``; it is built if missing. Its caches lie beside it.

    Raises CannotBuild, and CannotStart where no Blender works.
    """
    if not has_reference(scene):
        raise CannotBuild(f"There is no script for {scene} in {_SCENES}.")
    runtime = runtime or find_blender()
    place = (folder or references_folder()) / f"{scene}-{_key(scene, runtime)}"
    blend = place / f"{scene}.blend"
    if blend.is_file():
        return blend
    try:
        _build(scene, blend, runtime)
    except OSError as error:
        raise CannotBuild(f"{scene} cannot be written to {place}: {error.strerror or error}") from error
    return blend


def _build(scene: str, blend: Path, runtime: Runtime) -> None:
    """Builds into a folder beside, which is then renamed: a reference is complete or missing."""
    place, parent = blend.parent, blend.parent.parent
    shutil.rmtree(place, ignore_errors=True)
    with staged_folder(place) as folder:
        log = folder / "blender.log"
        try:
            run_program(runtime, _MAKER, [scene, str(folder / blend.name)], timeout=_SECONDS, log=log)
        except ProgramFailed as error:
            kept = parent / f"{scene}.log"
            shutil.copy(log, kept)
            raise CannotBuild(f"{scene} could not be built: {error} (kept as {kept})") from error
        if not (folder / blend.name).is_file():
            raise CannotBuild(f"{scene} was not saved")
    for old in parent.glob(f"{scene}-*"):
        if old != place:
            shutil.rmtree(old, ignore_errors=True)


def _key(scene: str, runtime: Runtime) -> str:
    """A digest of what a scene depends on: its script, the modules that it imports, Blender's version."""
    digest = hashlib.sha256(runtime.version.encode())
    for path in sorted({*_used(INSIDE / "make.py"), *_used(script_of(scene))}):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _used(script: Path) -> Iterator[Path]:
    """A script, and the modules of ``inside`` that it imports, directly or not."""
    waiting, seen = [script], {script}
    while waiting:
        path = waiting.pop()
        yield path
        for node in ast.walk(ast.parse(path.read_bytes())):
            if not isinstance(node, ast.ImportFrom) or not node.level:
                continue
            names = [node.module] if node.module else [alias.name for alias in node.names]
            imported = {INSIDE / f"{name}.py" for name in names} - seen
            seen |= imported
            waiting += [module for module in imported if module.is_file()]
