"""Runs the extractor inside Blender and keeps its output for the next build of the same Blender."""

from __future__ import annotations

import errno
import json
import os
import re
import shutil
from collections import Counter, defaultdict
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from kb_build.blender.docstrings_ahead import docstrings_ahead
from kb_build.digests import Digests
from kb_build.errors import ExtractError
from kb_build.fingerprint import extractor_digest, runtime_digest
from kb_build.versions.history import ApiHistory
from simworlds.errors import remedy
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
# Of glibc; elsewhere it means nothing. Hundreds of trials run in copies of Blender's process: few large pages are
# copied sooner than many, and memory that is given back is wanted again at once.
_MEMORY = {
    "GLIBC_TUNABLES": "glibc.malloc.hugetlb=1:glibc.malloc.mmap_threshold=1073741824:"
    "glibc.malloc.trim_threshold=4294967296"
}
_SECONDS = 600.0
_CRASHES = 4
_LEAST_FREE = 64 << 10  # bytes: an extract is written in pieces of about so many
_NODE = re.compile(r'bpy\.types\.(\w*Node\w*)(?:\.(inputs|outputs)\["(.*)"\])?')
_MAKING = re.compile(rb'\{"record":"making","maker":"(\w+)"\}')


def extract_api(runtime: Runtime, *, home: Path, again: bool = False, progress: Progress = silent) -> Path:
    """Returns the file in ``home`` that describes this Blender's API (see extract_reader.read_extract).

    Starts Blender if there is no such file yet, if the Blender that it was made with has moved since, or if ``again``.
    Raises ExtractError, naming the log with Blender's output.
    """
    digests = Digests(cache_folder(home) / "digests.json")
    identity = runtime_digest(runtime, digests)
    digests.save()
    folder = extracts_folder(home)
    name = f"blender-{runtime.version}-{identity[:12]}-{extractor_digest()[:12]}.jsonl"
    target = folder / name
    if target.is_file() and not again and not _has_moved(target):
        return target
    progress(f"Asking Blender {runtime.version} for its API", 0, None)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        remove_unfinished_files(folder)
        with staged_file(target) as part:
            _run(runtime, part, folder / f"blender-{runtime.version}.log")
    except OSError as error:
        raise ExtractError(
            f"{target} cannot be written: {error.strerror or error}. {remedy(error)}, or set SIMWORLDS_HOME to "
            "another folder"
        ) from error
    _remove_older(target, minor_of(runtime.version))
    return target


def _has_moved(extract: Path) -> bool:
    """Whether the scripts of the Blender that an extract was made with, which a build reads, are no longer there."""
    with extract.open("rb") as file:
        try:
            scripts = json.loads(file.readline()).get("scripts", "")
        except ValueError:
            return True
    return bool(scripts) and not Path(scripts).is_dir()


def former_nodes(history: ApiHistory) -> dict[str, dict[str, list[str]]]:
    """Every node class of any version: side → names that its sockets have had."""
    found: dict[str, dict[str, list[str]]] = {}
    for path in history.masks:
        if match := _NODE.fullmatch(path):
            sides = found.setdefault(match[1], defaultdict(list))
            if match[2]:
                sides[match[2]].append(match[3])
    return found


def _run(runtime: Runtime, part: Path, log: Path) -> None:
    """Extracts; a maker of new things in which Blender crashes twice is left out of the next attempt.

    Some crash in one run of many: what they make would be lost for nothing.
    """
    former, crashes, skipped = former_nodes(ApiHistory.load()), Counter[str](), list[str]()
    with TemporaryDirectory(prefix="simworlds-") as folder:
        given = Path(folder) / "given.json"
        while True:
            given.write_text(json.dumps({"former": former, "skipped": skipped}), encoding="utf-8")
            try:
                with docstrings_ahead(part):
                    run_program(
                        runtime,
                        _EXTRACTOR,
                        [str(given), str(part)],
                        timeout=_SECONDS,
                        log=log,
                        variables=_MEMORY,
                    )
                break
            except ProgramFailed as error:
                if shutil.disk_usage(part.parent).free < _LEAST_FREE:
                    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(part.parent)) from error
                crashed = _maker_at_work(part)
                if not crashed or crashed in skipped or len(skipped) == _CRASHES:
                    raise ExtractError(str(error)) from error
                crashes[crashed] += 1
                if crashes[crashed] > 1:
                    skipped.append(crashed)
    if not _is_whole(part):
        raise ExtractError(
            f"Blender {runtime.version} ended without an error, but its extract is not complete. "
            f"Its output is in {log}; run the build again"
        )


def _maker_at_work(extract: Path) -> str:
    """The maker of new things that was the last to start; empty for none."""
    makers = _MAKING.findall(extract.read_bytes()) if extract.is_file() else []
    return makers[-1].decode() if makers else ""


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
