"""Packs a base into one file that others can fetch: without this machine's paths, the same bytes each time."""

from __future__ import annotations

import io
import json
import lzma
import shutil
import sqlite3
import tarfile
from contextlib import closing
from dataclasses import dataclass
from typing import IO, TYPE_CHECKING, Any

from kb_build.base_file import open_base, read_meta
from kb_build.errors import StoreError
from kb_build.ready.manifest import BASE, LICENCES, MANIFEST, NOTICE, SUFFIX, Manifest, notice
from kb_build.schema import SCHEMA_VERSION
from simworlds.files import scratch_folder, sha256_of_file, staged_file
from simworlds.how_to_get_bases import how_to_get_again
from simworlds.terminal.progress import Progress, silent

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path


@dataclass(frozen=True, slots=True)
class Exported:
    """The file that was written: its size and SHA-256, and what is in it."""

    path: Path
    size: int
    sha256: str
    manifest: Manifest


def ready_name(minor: str) -> str:
    """The name under which a version's ready base is looked for: ``"blender-5.1.tar.xz"``."""
    return f"blender-{minor}{SUFFIX}"


def export_base(base: Path, output: Path, *, progress: Progress = silent) -> Exported:
    """Writes the ready base of ``base`` to ``output``. Raises StoreError; then nothing is left there."""
    open_base(base).close()  # refuses what is no base before anything is written
    try:
        with scratch_folder(output.parent) as scratch, staged_file(output) as part:
            draft = scratch / BASE
            _copy_without_paths(base, draft)
            manifest = _manifest(draft)
            with part.open("wb") as raw, lzma.open(raw, "wb", preset=6) as packed:
                _pack(packed, manifest, draft, progress)
            size, digest = part.stat().st_size, sha256_of_file(part)
    except (OSError, sqlite3.Error) as error:
        raise StoreError(
            f"{output} cannot be written: {error}. Make room, or name another file with --output"
        ) from error
    except (LookupError, TypeError, ValueError, AttributeError) as error:
        fault = f"its facts: {type(error).__name__}: {' '.join(str(error).split())[:200]}"
        raise StoreError(f"{base}: damaged ({fault}). {how_to_get_again(base)}") from error
    return Exported(output, size, digest, manifest)


def _copy_without_paths(base: Path, draft: Path) -> None:
    """A copy of the base in which no folder of this machine is named."""
    shutil.copyfile(base, draft)
    with closing(sqlite3.connect(draft, isolation_level=None)) as connection:
        for name, value in _public_meta(read_meta(base)).items():
            connection.execute("UPDATE meta SET value = ? WHERE name = ?", (value, name))
        connection.execute("VACUUM")


def _public_meta(meta: Mapping[str, str]) -> dict[str, str]:
    """The rows of meta that name folders, without them."""
    sources: list[dict[str, Any]] = json.loads(meta.get("sources", "[]"))
    for source in sources:
        origin = str(source.get("origin", "")).replace("\\", "/")
        source["origin"] = origin if "://" in origin else origin.rpartition("/")[2]
        source["given"] = False  # there is no such path to read again elsewhere
    runtime: dict[str, Any] = json.loads(meta.get("runtime", "{}"))
    # The reasons tell of the folders and archives in which nothing was found.
    missing = [
        {
            "role": row["role"],
            "reason": f"this base was made without; build it anew with --{row['role']} PATH",
        }
        for row in json.loads(meta.get("missing", "[]"))
    ]
    rows = {
        "sources": sources,
        "runtime": {"kind": runtime.get("kind", "")},
        "missing": missing,
        "faults": [_public_fault(fault) for fault in json.loads(meta.get("faults", "[]"))],
    }
    return {name: json.dumps(value, ensure_ascii=False) for name, value in rows.items()}


def _public_fault(fault: str) -> str:
    """The step that failed and the kind of its error, without the traceback and the message."""
    step, _, told = fault.partition(":")
    last = told.strip().rpartition("\n")[2]
    return f"{step}: {last.partition(':')[0]}"


def _manifest(draft: Path) -> Manifest:
    meta = read_meta(draft)
    return Manifest(
        blender=meta.get("blender", ""),
        schema_version=SCHEMA_VERSION,
        size=draft.stat().st_size,
        sha256=sha256_of_file(draft),
        built_at=meta.get("built_at", ""),
        simworlds=meta.get("simworlds", ""),
        licences=LICENCES,
    )


def _pack(packed: IO[bytes], manifest: Manifest, draft: Path, progress: Progress) -> None:
    described = manifest.model_dump_json(indent=2).encode() + b"\n"
    with tarfile.open(fileobj=packed, mode="w|", format=tarfile.USTAR_FORMAT) as archive:
        for name, content in ((MANIFEST, described), (NOTICE, notice(manifest).encode())):
            archive.addfile(_member(name, len(content)), io.BytesIO(content))
        with draft.open("rb") as file:
            archive.addfile(_member(BASE, manifest.size), _Watched(file, manifest.size, progress))


def _member(name: str, size: int) -> tarfile.TarInfo:
    member = tarfile.TarInfo(name)  # of nobody, and of no time: the same base gives the same bytes
    member.size, member.mode = size, 0o644
    return member


class _Watched(io.RawIOBase):
    """A file that tells how much of it was read."""

    def __init__(self, file: IO[bytes], size: int, progress: Progress) -> None:
        self._file, self._size, self._progress = file, size, progress

    def read(self, size: int = -1, /) -> bytes:
        data = self._file.read(size)
        self._progress("packing the base", self._file.tell(), self._size)
        return data
