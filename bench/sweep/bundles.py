"""Bundles of files that are sent between machines: bytes with their digests, unpacked only below one folder."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from bench.sweep.content_hash import digest_of_bytes, files_below
from simworlds.files import sha256_of_file, write_whole

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path


class DamagedBundle(Exception):  # noqa: N818 - reads as the state it names
    """A bundle that differs from what was sent."""


@dataclass(frozen=True, slots=True)
class BundledFile:
    """One file: where it belongs below a folder, its SHA-256, its content."""

    path: str
    sha256: str
    content: bytes


@dataclass(frozen=True, slots=True)
class Bundle:
    """Files of one folder. ``gone``: paths to delete."""

    files: tuple[BundledFile, ...] = ()
    gone: tuple[str, ...] = ()


def bundle_files(folder: Path, files: Iterable[Path]) -> Bundle:
    """Bundles files of a folder. Raises OSError."""
    bundled: list[BundledFile] = []
    for path in files:
        content = path.read_bytes()
        bundled.append(BundledFile(path.relative_to(folder).as_posix(), digest_of_bytes(content), content))
    return Bundle(tuple(bundled))


def bundle_changes(folder: Path, before: Mapping[str, str]) -> Bundle:
    """Bundles what has changed in a folder since ``before`` ({path: SHA-256}). Raises OSError."""
    files = {path.relative_to(folder).as_posix(): path for path in files_below(folder)}
    changed = [path for name, path in files.items() if before.get(name) != sha256_of_file(path)]
    return Bundle(bundle_files(folder, changed).files, tuple(sorted({*before} - {*files})))


def unpack_bundle(bundle: Bundle, folder: Path, last: str = "") -> dict[str, str]:
    """Writes the files of a bundle, the one called ``last`` after all others; returns {path: SHA-256}.

    Nothing is written if a file is damaged or would lie outside of the folder. Raises DamagedBundle,
    OSError.
    """
    targets = [(_target(folder, file.path), file) for file in bundle.files]
    going = [_target(folder, name) for name in bundle.gone]
    for file in bundle.files:
        if digest_of_bytes(file.content) != file.sha256:
            raise DamagedBundle(f"{file.path} did not arrive as it was sent")
    for path, file in sorted(targets, key=lambda each: each[1].path == last):
        write_whole(path, file.content)
    for path in going:
        path.unlink(missing_ok=True)
    return {file.path: file.sha256 for file in bundle.files}


def _target(folder: Path, name: str) -> Path:
    relative = PurePosixPath(name)
    if not name or relative.is_absolute() or ".." in relative.parts or "\0" in name:
        raise DamagedBundle(f"{name[:80]!r} is outside of its folder")
    path = folder / relative
    if not path.parent.resolve().is_relative_to(folder.resolve()):
        raise DamagedBundle(f"{name[:80]!r} is outside of its folder")
    return path
