"""Files that travel between machines: as bytes, known by their content, unpacked only where they were meant to go."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from bench.sweep.content_hash import digest_of_bytes, digest_of_file, files_below
from simworlds.files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path


class Damaged(Exception):  # noqa: N818 - reads as the state it names
    """A parcel that is not what was sent."""


@dataclass(frozen=True, slots=True)
class Packed:
    """One file: where it belongs below a folder, its SHA-256, its content."""

    path: str
    sha256: str
    content: bytes


@dataclass(frozen=True, slots=True)
class Parcel:
    """Files of one folder. ``gone``: what was there and is to go."""

    files: tuple[Packed, ...] = ()
    gone: tuple[str, ...] = ()


def packed(folder: Path, files: Iterable[Path]) -> Parcel:
    """These files of a folder. Raises OSError."""
    found: list[Packed] = []
    for path in files:
        content = path.read_bytes()
        found.append(Packed(path.relative_to(folder).as_posix(), digest_of_bytes(content), content))
    return Parcel(tuple(found))


def packed_changes(folder: Path, before: Mapping[str, str]) -> Parcel:
    """What is other in a folder than it was ``before`` ({path: SHA-256}). Raises OSError."""
    files = {path.relative_to(folder).as_posix(): path for path in files_below(folder)}
    changed = [path for name, path in files.items() if before.get(name) != digest_of_file(path)]
    return Parcel(packed(folder, changed).files, tuple(sorted({*before} - {*files})))


def unpacked(parcel: Parcel, folder: Path, last: str = "") -> dict[str, str]:
    """Writes a parcel's files, the one called ``last`` after all others; {path: SHA-256}.

    Nothing is written if anything in it is damaged, or would lie elsewhere than below the folder. Raises Damaged,
    OSError.
    """
    targets = [(_target(folder, file.path), file) for file in parcel.files]
    going = [_target(folder, name) for name in parcel.gone]
    for file in parcel.files:
        if digest_of_bytes(file.content) != file.sha256:
            raise Damaged(f"{file.path} did not arrive as it was sent")
    for path, file in sorted(targets, key=lambda each: each[1].path == last):
        write_whole(path, file.content)
    for path in going:
        path.unlink(missing_ok=True)
    return {file.path: file.sha256 for file in parcel.files}


def _target(folder: Path, name: str) -> Path:
    relative = PurePosixPath(name)
    if not name or relative.is_absolute() or ".." in relative.parts or "\0" in name:
        raise Damaged(f"{name[:80]!r} leads out of its folder")
    path = folder / relative
    if not path.parent.resolve().is_relative_to(folder.resolve()):
        raise Damaged(f"{name[:80]!r} leads out of its folder")
    return path
