"""Reference scenes: for every spec a scene that meets it, built by its script in ``inside`` and baked.

They show that what the specs ask for can be had, and are what the other properties of the benchmark are proven on. A
scene that was built is kept until its script, the library, or Blender changes.
"""

from __future__ import annotations

import ast
import hashlib
import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

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
    """A reference scene that could not be built; the message says which, and where Blender's output lies."""


def references_folder() -> Path:
    """Where reference scenes are kept."""
    return home_folder() / "references"


def has_reference(scene: str) -> bool:
    """Whether there is a script for that scene."""
    return script_of(scene).is_file()


def script_of(scene: str) -> Path:
    """The script of a scene."""
    return _SCENES / f"{scene}.py"


def build(scene: str, folder: Path | None = None, runtime: Runtime | None = None) -> Path:
    """The baked .blend of a scene, below ``folder``; built unless it is there already. Its caches lie beside it.

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
        raise CannotBuild(f"{scene} cannot be kept in {place}: {error.strerror or error}") from error
    return blend


def _build(scene: str, blend: Path, runtime: Runtime) -> None:
    """Builds into a folder beside, which is then renamed: what lies there is whole."""
    parent = blend.parent.parent
    parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=parent, prefix=f".{scene}-", ignore_cleanup_errors=True) as made:
        log = Path(made) / "blender.log"
        try:
            run_program(runtime, _MAKER, [scene, str(Path(made, blend.name))], timeout=_SECONDS, log=log)
        except ProgramFailed as error:
            kept = parent / f"{scene}.log"
            shutil.copy(log, kept)
            raise CannotBuild(f"{scene} could not be built: {error} (kept as {kept})") from error
        if not Path(made, blend.name).is_file():
            raise CannotBuild(f"{scene} was not saved")
        shutil.rmtree(blend.parent, ignore_errors=True)
        Path(made).rename(blend.parent)
    for old in parent.glob(f"{scene}-*"):
        if old != blend.parent:
            shutil.rmtree(old, ignore_errors=True)


def _key(scene: str, runtime: Runtime) -> str:
    """What a scene is made of: its script, what that imports, and Blender."""
    made = hashlib.sha256(runtime.version.encode())
    for path in sorted({*_used(INSIDE / "make.py"), *_used(script_of(scene))}):
        made.update(path.read_bytes())
    return made.hexdigest()[:16]


def _used(script: Path) -> Iterator[Path]:
    """A script, and the modules beside it that it imports, by way of others too."""
    waiting, seen = [script], {script}
    while waiting:
        path = waiting.pop()
        yield path
        for node in ast.walk(ast.parse(path.read_bytes())):
            if not isinstance(node, ast.ImportFrom) or not node.level:
                continue
            names = [node.module] if node.module else [alias.name for alias in node.names]
            found = {INSIDE / f"{name}.py" for name in names} - seen
            seen |= found
            waiting += [one for one in found if one.is_file()]
