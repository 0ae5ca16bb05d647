"""Runs the extractor inside Blender and keeps its output for the next build of the same Blender."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from kb_build.digests import Digests
from kb_build.errors import ExtractError
from kb_build.fingerprint import extractor_digest, runtime_digest
from simworlds.files import remove_unfinished_files, staged_file
from simworlds.releases import minor_of
from simworlds.sandbox.errors import ProgramFailed
from simworlds.sandbox.program import Program
from simworlds.sandbox.runtime import run_program
from simworlds.settings import cache_folder, extracts_folder
from simworlds.terminal.progress import silent

if TYPE_CHECKING:
    from simworlds.sandbox.runtime import Runtime
    from simworlds.terminal.progress import Progress

_EXTRACTOR = Program(
    "kb_build.blender.inside.extract_api", {"kb_build.blender.inside": Path(__file__).parent / "inside"}
)
_SECONDS = 600.0


def extract_api(runtime: Runtime, *, home: Path, again: bool = False, progress: Progress = silent) -> Path:
    """Returns the file in ``home`` that describes this Blender's API (see extract_reader.read_extract).

    Starts Blender if there is no such file yet, or if ``again``. Raises ExtractError,
    naming the log with Blender's output.
    """
    digests = Digests(cache_folder(home) / "digests.json")
    identity = runtime_digest(runtime, digests)
    digests.save()
    folder = extracts_folder(home)
    name = f"blender-{runtime.version}-{identity[:12]}-{extractor_digest()[:12]}.jsonl"
    target = folder / name
    if target.is_file() and not again:
        return target
    progress(f"Asking Blender {runtime.version} for its API", 0, None)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        remove_unfinished_files(folder)
        with staged_file(target) as part:
            _run(runtime, part, folder / f"blender-{runtime.version}.log")
    except OSError as error:
        raise ExtractError(
            f"{target} cannot be written: {error}; make room there, or set SIMWORLDS_HOME"
        ) from error
    _remove_older(target, minor_of(runtime.version))
    return target


def _run(runtime: Runtime, part: Path, log: Path) -> None:
    try:
        run_program(runtime, _EXTRACTOR, [str(part)], timeout=_SECONDS, log=log)
    except ProgramFailed as error:
        raise ExtractError(str(error)) from error
    if not _is_whole(part):
        raise ExtractError(
            f"Blender {runtime.version} ended without an error, but its extract is not complete. "
            f"Its output is in {log}; run the build again"
        )


def _is_whole(extract: Path) -> bool:
    """Whether the last line is the one that the extractor writes last."""
    if not extract.is_file():
        return False
    with extract.open("rb") as file:
        file.seek(max(0, extract.stat().st_size - 200))
        return b'{"record":"end"' in file.read()


def _remove_older(target: Path, minor: str) -> None:
    """Removes the other extracts of the minor version."""
    for path in target.parent.glob(f"blender-{minor}.*.jsonl"):
        if path != target:
            path.unlink(missing_ok=True)
