"""Runs scripts in real Blenders, as they were and as they are now, and compares the scenes that they leave."""

from __future__ import annotations

import json
import shutil
import tempfile
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simworlds.errors import UserError
from simworlds.releases import minor_of
from simworlds.sandbox.errors import ProgramFailed, RuntimeMissing
from simworlds.sandbox.program import Program
from simworlds.sandbox.runtime import find_runtime, run_program

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from simworlds.sandbox.runtime import Runtime

_PROGRAM = Program(
    "kb_check.migrate.inside.run_script", {"kb_check.migrate.inside": Path(__file__).parent / "inside"}
)
_SECONDS = 300.0
_MOST_BYTES = 64 << 20
_MOST_DIFFERENCES = 40


@dataclass(frozen=True, slots=True)
class Ending:
    """How a script ended in a Blender. ``error`` is empty where it ran through; ``scene`` what it left."""

    version: str
    error: str = ""
    scene: Mapping[str, Any] = field(default_factory=dict[str, Any])


@dataclass(frozen=True, slots=True)
class Trial:
    """A script in two Blenders. ``before`` is None where there is no such Blender here."""

    name: str
    before: Ending | None
    after: Ending
    differences: tuple[str, ...] = ()

    @property
    def verdict(self) -> str:
        """One sentence."""
        if self.after.error:
            return f"Ends in Blender {self.after.version} with an error: {self.after.error}"
        if self.before is None:
            return f"Runs in Blender {self.after.version}."
        if self.before.error:
            return (
                f"Runs in Blender {self.after.version}; before, it ended in {self.before.version} with an error: "
                f"{self.before.error}"
            )
        versions = f"{self.before.version} and {self.after.version}"
        if self.differences:
            return f"Runs in both, but the scenes of {versions} differ."
        return f"Runs in both; the scenes of {versions} are alike."


def runtime_at_hand(version: str, home: Path) -> Runtime | None:
    """A Blender of a version that is here: this environment's, one that was fetched before, or an installed one.

    Nothing is downloaded.
    """
    version = minor_of(version)
    with suppress(RuntimeMissing):
        return find_runtime(version, home=home, install=False)
    program = shutil.which("blender")
    with suppress(RuntimeMissing):
        return find_runtime(version, home=home, blender_exe=Path(program)) if program else None
    return None


def run_in(runtime: Runtime, path: Path) -> Ending:
    """Runs a script, or registers the add-on in a folder, in a fresh Blender without a window."""
    with tempfile.TemporaryDirectory(prefix="simworlds-") as folder:
        out, log = Path(folder) / "facts.json", Path(folder) / "blender.log"
        try:
            run_program(runtime, _PROGRAM, [str(path.absolute()), str(out)], timeout=_SECONDS, log=log)
        except ProgramFailed as error:
            return Ending(runtime.version, " ".join(str(error).split())[:400])
        return _read(out, runtime.version)


def compare(before: Ending, after: Ending) -> tuple[str, ...]:
    """What differs between two scenes, one line each."""
    found = list(_differences(before.scene, after.scene, ""))
    more = len(found) - _MOST_DIFFERENCES
    return (*found[:_MOST_DIFFERENCES], *([f"… and {more} more"] if more > 0 else []))


def try_out(name: str, old: Path, new: Path, source: Runtime | None, target: Runtime) -> Trial:
    """Runs ``old`` in ``source`` (where there is one) and ``new`` in ``target``, and compares."""
    before = run_in(source, old) if source is not None else None
    after = run_in(target, new)
    if before is None or before.error or after.error:
        return Trial(name, before, after)
    return Trial(name, before, after, compare(before, after))


def _read(out: Path, version: str) -> Ending:
    """The facts that a run wrote: the script may have written there, too."""
    try:
        if out.stat().st_size > _MOST_BYTES:
            raise UserError("its facts are too large")
        facts = json.loads(out.read_text(encoding="utf-8"))
        error, scene = facts["error"], facts["scene"]
        if error is None:
            return Ending(version, "", scene if isinstance(scene, dict) else {})
        text = f"{error['kind']}: {error['message']} ({error['file']}:{error['line']})"
    except (OSError, ValueError, KeyError, TypeError, RecursionError, UserError) as error:
        return Ending(version, f"it left no account of itself ({error})")
    return Ending(version, " ".join(text.split())[:400])


def _differences(old: Any, new: Any, path: str) -> Iterator[str]:
    if isinstance(old, dict) and isinstance(new, dict):
        for key in dict.fromkeys([*old, *new]):
            where = f"{path}.{key}" if path else str(key)
            if key not in new:
                yield f"{where}: gone"
            elif key not in old:
                yield f"{where}: new"
            else:
                yield from _differences(old[key], new[key], where)
    elif not _alike(old, new):
        yield f"{path}: {_short(old)} → {_short(new)}"


def _alike(old: Any, new: Any) -> bool:
    if isinstance(old, list) and isinstance(new, list):
        return len(old) == len(new) and all(map(_alike, old, new))
    if isinstance(old, float) and isinstance(new, float):
        return abs(old - new) <= 1e-3 * max(1.0, abs(old))
    return bool(old == new)


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 80 else f"{text[:80]}…"
