"""Unpacks untrusted archives safely.

Only regular files are written, each below the target folder, as ordinary bytes with ordinary permissions.
Links, devices and everything else that is not a file or a folder are passed over; a name that leads out of
the folder condemns the whole archive.
"""

from __future__ import annotations

import bz2
import gzip
import io
import lzma
import stat
import tarfile
import unicodedata
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import IO

from kb_build.errors import SourceError
from simworlds.errors import NO_ROOM
from simworlds.files import staged_folder

Progress = Callable[[str, int, int | None], None]
"""Called with what is being done, how many bytes are done, and of how many (None: not known)."""

Wanted = Callable[[PurePosixPath], bool]

_CHUNK = 1 << 20
_OPENERS: tuple[tuple[bytes, Callable[[io.BufferedReader], io.BufferedIOBase]], ...] = (
    (b"\x1f\x8b", lambda file: gzip.GzipFile(fileobj=file)),
    (b"BZh", bz2.BZ2File),
    (b"\xfd7zXZ\x00", lzma.LZMAFile),
)
_ZSTD = b"\x28\xb5\x2f\xfd"
_DAMAGE = (
    tarfile.TarError,
    zipfile.BadZipFile,
    zlib.error,
    lzma.LZMAError,
    gzip.BadGzipFile,
    EOFError,
    ValueError,
    NotImplementedError,  # a compression that zipfile does not know
    RuntimeError,  # an encrypted member; RecursionError from chained headers
    MemoryError,
)


@dataclass(frozen=True, slots=True)
class ArchiveLimits:
    """Limits on what an archive may unpack to.

    ``total_bytes`` bounds everything that is unpacked or read past; ``ratio`` bounds it again as a multiple
    of the archive's own size, once ``free_bytes`` are exceeded. The manual's HTML packs 215 to 1.
    """

    total_bytes: int = 3 << 30
    members: int = 100_000
    ratio: int = 1_000
    free_bytes: int = 256 << 20

    def bytes_for(self, archive_size: int) -> int:
        """How many bytes may come out of an archive of ``archive_size`` bytes."""
        return min(self.total_bytes, max(self.free_bytes, self.ratio * archive_size))


def unpack(
    archive: Path,
    target: Path,
    *,
    wanted: Wanted | None = None,
    limits: ArchiveLimits | None = None,
    progress: Progress | None = None,
) -> int:
    """Unpack a .zip or .tar (plain, .gz, .bz2, .xz) into the new folder ``target``; returns how many files.

    ``wanted`` picks members by their path in the archive. ``target`` appears only when all is unpacked.
    Raises SourceError for an archive that is damaged, hostile, too large or of an unknown kind, and for a
    full disk.
    """
    try:
        size = archive.stat().st_size
        with staged_folder(target) as folder, archive.open("rb") as file:
            job = _Job(archive, folder, wanted, limits or ArchiveLimits(), size, file, progress)
            return job.run()
    except _DAMAGE as error:
        raise SourceError(
            f"{archive} is damaged or not an archive ({_brief(error)}); get it again, or give another one"
        ) from error
    except OSError as error:
        raise _disk_error(error, archive, target) from error


def safe_path(name: str, archive: Path) -> PurePosixPath:
    """The name of a member of ``archive`` as a path that stays where it is put; SourceError if it would not.

    Refused: absolute paths, ``..``, drive letters and other colons, control and invisible characters, names
    that become one of these when a file system normalises them, and names longer than file systems take.
    """
    for form in (name, unicodedata.normalize("NFKC", name)):
        slashed = form.replace("\\", "/")
        if slashed.startswith("/") or ":" in slashed or ".." in slashed.split("/"):
            raise _refused(archive, name, "leads out of its folder")
    if not name.isprintable() and any(unicodedata.category(sign) in {"Cc", "Cf", "Cs"} for sign in name):
        raise _refused(archive, name, "has invisible characters")
    path = PurePosixPath(name.replace("\\", "/"))
    too_long = len(name.encode()) > 1024 or any(len(part.encode()) > 255 for part in path.parts)
    if too_long or len(path.parts) > 40:
        raise _refused(archive, name, "has too long a path")
    return path


def _refused(archive: Path, name: str, fault: str) -> SourceError:
    return SourceError(f"{archive}: its member {name[:120]!r} {fault}; do not use this archive")


@dataclass(slots=True)
class _Job:
    """One archive on its way into one folder."""

    archive: Path
    folder: Path
    wanted: Wanted | None
    limits: ArchiveLimits
    size: int
    file: io.BufferedReader
    progress: Progress | None
    written: int = 0
    files: int = 0

    def run(self) -> int:
        magic = self.file.read(8)
        self.file.seek(0)
        if magic.startswith(_ZSTD):
            raise SourceError(f"{self.archive} is packed with Zstandard; repack it as .tar.xz or .zip")
        if magic.startswith((b"PK\x03\x04", b"PK\x05\x06")):
            self._unpack_zip()
        else:
            opener = next((opener for start, opener in _OPENERS if magic.startswith(start)), None)
            self._unpack_tar(opener(self.file) if opener else self.file)
        return self.files

    def _unpack_zip(self) -> None:
        with zipfile.ZipFile(self.file) as archive:
            for count, info in enumerate(archive.infolist(), start=1):
                self._count(count)
                path = safe_path(info.filename, self.archive)
                mode = info.external_attr >> 16
                is_file = not info.is_dir() and stat.S_IFMT(mode) in {0, stat.S_IFREG}
                if is_file and self._is_wanted(path):
                    self._check_total(self.written + info.file_size)
                    with archive.open(info) as source:
                        self._write(path, source)

    def _unpack_tar(self, stream: io.BufferedIOBase) -> None:
        guarded = _Guarded(stream, self._check_total)
        with tarfile.open(fileobj=guarded, mode="r:") as archive:
            for count, info in enumerate(archive, start=1):
                self._count(count)
                path = safe_path(info.name, self.archive)
                self._check_total(guarded.tell() + info.size)
                if info.isreg() and self._is_wanted(path):
                    source = archive.extractfile(info)
                    assert source is not None  # regular members have content
                    self._write(path, source)
        if guarded.last_block != bytes(tarfile.BLOCKSIZE):  # tarfile takes a missing end for an end
            raise tarfile.ReadError("it ends in the middle")
        while guarded.read(_CHUNK):  # compressed streams keep their checksum at the end
            pass

    def _is_wanted(self, path: PurePosixPath) -> bool:
        return bool(path.parts) and (self.wanted is None or self.wanted(path))

    def _count(self, members: int) -> None:
        if members > self.limits.members:
            raise SourceError(
                f"{self.archive} has more than {self.limits.members:,} members; no documentation source has. "
                "Unpack it yourself and give the folder"
            )

    def _check_total(self, total: int) -> None:
        allowed = self.limits.bytes_for(self.size)
        if total > allowed:
            raise SourceError(
                f"{self.archive} ({self.size:,} bytes) unpacks to more than {allowed:,} bytes, as bombs do. "
                "If you trust it, unpack it yourself and give the folder"
            )

    def _write(self, path: PurePosixPath, source: IO[bytes]) -> None:
        place = self.folder / path
        place.parent.mkdir(parents=True, exist_ok=True)
        with place.open("wb") as file:
            while chunk := source.read(_CHUNK):
                self.written += len(chunk)
                self._check_total(self.written)
                file.write(chunk)
        self.files += 1
        if self.progress:
            self.progress(f"unpacking {self.archive.name}", min(self.file.tell(), self.size), self.size)


class _Guarded(io.RawIOBase):
    """A decompressed tar stream, read forwards only, with limits on each step and on the total.

    tarfile reads an extended header in one piece, however long it claims to be; the bound on one step keeps
    that from filling the memory.
    """

    def __init__(self, stream: io.BufferedIOBase, check_total: Callable[[int], None]) -> None:
        self._stream = stream
        self._check_total = check_total
        self._position = 0
        self.last_block = b""

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def tell(self) -> int:
        return self._position

    def read(self, size: int = -1, /) -> bytes:
        if not 0 <= size <= _CHUNK:
            raise tarfile.ReadError("a header of impossible length")
        data = self._stream.read(size)
        self._position += len(data)
        self._check_total(self._position)
        if size == tarfile.BLOCKSIZE:
            self.last_block = data
        return data

    def seek(self, position: int, whence: int = 0, /) -> int:
        if whence != 0 or position < self._position:
            raise tarfile.ReadError("members out of order")
        self._check_total(position)
        while self._position < position:
            if not self.read(min(_CHUNK, position - self._position)):
                raise tarfile.ReadError("unexpected end of data")
        return self._position


def _brief(error: BaseException) -> str:
    return f"{type(error).__name__}: {str(error)[:200]}" if str(error) else type(error).__name__


def _disk_error(error: OSError, archive: Path, target: Path) -> SourceError:
    if error.errno in NO_ROOM:
        return SourceError(
            f"the disk is full: {archive} cannot be unpacked into {target.parent} ({error.strerror}); "
            "make room, or move the cache with SIMWORLDS_HOME"
        )
    return SourceError(f"{archive} cannot be unpacked into {target.parent}: {error}")
