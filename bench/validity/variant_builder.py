"""Makes variants of a scene and audits them: a copy in a folder of its own, one Blender that edits, one that audits.

Both are confined as for any untrusted file. The scene itself is only read; the folder has links to its caches, through
which nothing can be written or deleted. Each Blender is started when it is first needed, and again after a crash.
"""

from __future__ import annotations

import shutil
import tempfile
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from bench.audit.actors import find_actors
from bench.audit.audit import audit, audit_of, audit_scene, read_scene
from bench.audit.untrusted_blend import AUDITOR, BlenderOptions, Crashed, UntrustedBlend
from simworlds.sandbox.program import Program

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

    from bench.audit.actors import ActorResolution
    from bench.audit.audit import Audit
    from bench.audit.facts import Scene
    from bench.scenes.spec import Spec

_Result = TypeVar("_Result")
_VALIDITY = Path(__file__).parent
_PROGRAM = Program(
    "bench.validity.inside.variant_builder",
    {
        **AUDITOR.packages,
        "bench.validity.inside": _VALIDITY / "inside",
        **{
            f"bench.validity.{name}.inside": _VALIDITY / name / "inside"
            for name in ("counterfeits", "invariance", "mutations")
        },
    },
)


@dataclass(frozen=True, slots=True)
class SceneReading:
    """A file without relations: its facts, actors, and the audit of their predicates."""

    scene: Scene
    found: dict[str, ActorResolution]
    audit: Audit


class VariantBuilder:
    """A context manager; the variants are deleted at its end."""

    def __init__(self, spec: Spec, blend: Path, means: BlenderOptions | None = None) -> None:
        self.spec, self.blend = spec, blend.resolve()
        means = means or BlenderOptions()
        self._means = replace(means, read=(*means.read, self.blend.parent))

    def __enter__(self) -> VariantBuilder:
        self._stack = ExitStack()
        folder = tempfile.TemporaryDirectory(prefix="simworlds-validate-", ignore_cleanup_errors=True)
        self.folder = Path(self._stack.enter_context(folder)).resolve()
        self.folder.chmod(0o755)  # it is read by a Blender that runs as another user where this one is root
        self.original = self.folder / self.blend.name
        shutil.copy2(self.blend, self.original)
        for path in self.blend.parent.iterdir():
            if path.is_dir():
                (self.folder / path.name).symlink_to(path)
        self._auditor = _ReusedBlender(lambda path: UntrustedBlend(path, self._means))
        self._worker = _ReusedBlender(lambda path: UntrustedBlend(path, self._means, _PROGRAM, self.folder))
        self._stack.callback(self._auditor.close)
        self._stack.callback(self._worker.close)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.close()

    # Variants

    def make(self, name: str, job: str, **arguments: Any) -> tuple[Path, Any]:
        """Runs a job of ``inside/variant_builder.py`` on the original scene, and saves the result as ``name``.

        Returns the file and the job's answer. Raises NotScored where it refuses or crashes, CannotStart.
        """
        path = self.folder / f"{name}.blend"

        def work(blender: UntrustedBlend) -> Any:
            answer = blender.ask(job, doing=f"running {job}", **arguments)
            blender.ask("save", doing="saving", path=str(path))
            return answer

        return path, self._worker.run(self.original, work)

    def render(self, path: Path, *, cycles: bool, seed: int = 0) -> None:
        """Renders start, middle and end of a variant, beside it: its name with -0, -1, -2.png.

        By Workbench, or by Cycles with ``seed``.
        """
        blender = self._worker.opened(path)
        blender.ask("render", doing="rendering", path=str(path.with_suffix("")), cycles=cycles, seed=seed)

    def difference(self, first: Path, second: Path) -> float:
        """The mean absolute difference of two variants' pictures: red, green and blue from 0 to 1."""
        one, other = (str(path.with_suffix("")) for path in (first, second))
        blender = self._worker.opened(self.original)
        return float(blender.ask("compare", doing="comparing", first=one, second=other))

    # Audits

    @cached_property
    def reading(self) -> SceneReading:
        """The original scene."""
        return self.read(self.original)

    @cached_property
    def audited(self) -> Audit:
        """The audit of the original scene in its own folder, in a new Blender."""
        return audit(self.blend, self.spec, self._means)

    def read(self, path: Path) -> SceneReading:
        """Reads a variant without relations. Raises NotScored, CannotStart."""
        scene = self._auditor.run(path, lambda file: read_scene(file, play=True))
        found = find_actors(self.spec, scene)
        return SceneReading(scene, found, audit_scene(self.spec, scene, found))

    def audit(self, path: Path) -> Audit:
        """Audits a variant in the Blender that has read the others. Raises NotScored, CannotStart."""
        return self._auditor.run(path, lambda file: audit_of(file, read_scene(file, play=True), self.spec))

    def audit_alone(self, path: Path) -> Audit:
        """Audits a variant in a new Blender."""
        return audit(path, self.spec, self._means)


class _ReusedBlender:
    """A Blender that is reused for one file after another."""

    def __init__(self, start: Callable[[Path], UntrustedBlend]) -> None:
        self._start, self._stack = start, ExitStack()
        self._file: UntrustedBlend | None = None

    def run(self, path: Path, work: Callable[[UntrustedBlend], _Result]) -> _Result:
        """Works on the file. Where a Blender crashes that had another file before, a new one works on it once more: the
        simulations that it held may have hurt it. Raises NotScored.
        """
        is_new = self._file is None
        try:
            return work(self.opened(path))
        except Crashed:
            if is_new:
                raise
            self.close()
            return work(self.opened(path))

    def opened(self, path: Path) -> UntrustedBlend:
        """Opens the file in the running Blender, or in a new one after a crash. Raises NotScored."""
        if self._file is not None:
            try:
                self._file.reopen(path)
            except Crashed:
                self.close()
        if self._file is None:
            self._file = self._stack.enter_context(self._start(path))
        return self._file

    def close(self) -> None:
        """Ends the Blender, if there is one."""
        self._file = None
        self._stack.close()
