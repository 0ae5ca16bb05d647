"""Fetches a ready base, from an address or a file, and takes nothing that is not exactly what it says it is.

What is checked, in this order: the SHA-256 of the file, where one was named; the archive (names, sizes, checksums);
the manifest; the SHA-256 of the base; its layout, statement by statement; and all that ``kb verify`` checks.
"""

from __future__ import annotations

import hashlib
import re
import sqlite3
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from kb_build.base_file import refuse_folder
from kb_build.errors import FetchedElsewhere, KBBuildError, ReadyBaseError, SourceError
from kb_build.pages.archives import ArchiveLimits, unpack
from kb_build.pages.download import ArchiveKind, DownloadPatience, download
from kb_build.ready.export import ready_name
from kb_build.ready.manifest import BASE, LARGEST_BASE, MANIFEST, MEMBERS, SUFFIX, Manifest, read_manifest
from kb_build.schema import DDL, INDEXES, NoBase, open_read_only
from kb_build.verify import verify_base
from simworlds.errors import remedy
from simworlds.files import scratch_folder, sha256_of_file
from simworlds.folder_lock import locked
from simworlds.loopback import is_loopback
from simworlds.releases import minor_of
from simworlds.sandbox.errors import Refusal
from simworlds.settings import base_path, cache_folder
from simworlds.terminal.progress import Progress, silent

if TYPE_CHECKING:
    from collections.abc import Generator
    from pathlib import PurePosixPath

_XZ = b"\xfd7zXZ\x00"
_LIMITS = ArchiveLimits(total_bytes=LARGEST_BASE + (1 << 20), members=16, ratio=100, free_bytes=1 << 20)
_SHA256 = re.compile(r"sha256=([0-9a-fA-F]{64})")
_PATIENCE_SECONDS = 20.0


def _is_xz(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(len(_XZ)) == _XZ


_KIND = ArchiveKind("ready base (.tar.xz)", _is_xz, 256 << 20)


@dataclass(frozen=True, slots=True)
class Fetched:
    """A ready base that was put in its place."""

    path: Path
    manifest: Manifest
    origin: str


def fetch_base(version: str, source: str, *, home: Path, progress: Progress = silent) -> Fetched:
    """Puts the ready base of ``version`` from ``source`` into ``home``, in place of the one that is there.

    ``source`` is a file or its address, or a folder or address with files named as ``ready_name`` says; it may end
    in ``#sha256=…``, which the file must then have. With an empty ``version``, a file is taken for whichever version
    it is of. Raises KBBuildError, FetchedElsewhere while another process downloads one; the base that was there
    before stays then.
    """
    minor = minor_of(version) if version else ""
    place, wanted = _split(source)
    if minor:
        refuse_folder(base_path(home, minor))
    try:
        with _archive(place, minor, wanted, home, progress) as archive:
            return _install(archive, wanted, minor, home, progress)
    except Refusal as error:
        raise FetchedElsewhere(
            "No base was fetched: another SimWorlds is fetching one here. Wait until it has ended"
        ) from error
    except SourceError as error:
        raise ReadyBaseError(f"No base was fetched: {error}") from error
    except OSError as error:
        raise ReadyBaseError(
            f"No base was fetched: {error}. {remedy(error)}, or set SIMWORLDS_HOME to another folder"
        ) from error


@contextmanager
def _archive(place: str, minor: str, wanted: str, home: Path, progress: Progress) -> Generator[Path]:
    """The ready base as a file; a download is removed afterwards. Raises Refusal while another process has one here."""
    if "://" not in place:
        yield _local_file(place, minor)
        return
    folder = cache_folder(home) / "bases"
    folder.mkdir(parents=True, exist_ok=True)
    with locked(folder):
        archive = _downloaded(_address(place, minor), wanted, folder, progress)
        try:
            yield archive
        finally:
            archive.unlink(missing_ok=True)


def _split(source: str) -> tuple[str, str]:
    """The place, and the SHA-256 that is named behind it."""
    if "#" not in source:
        return source, ""
    place, _, fragment = source.partition("#")
    match = _SHA256.fullmatch(fragment)
    if match is None:
        raise ReadyBaseError(
            f"{source[:300]!r} ends in something that is not a checksum; write it as #sha256= and 64 hexadecimal digits"
        )
    return place, match[1].lower()


def is_one_file(source: str) -> bool:
    """Whether a source names one ready base, rather than the place where bases of several versions lie."""
    place = source.partition("#")[0]
    return (place.partition("?")[0] if "://" in place else place).endswith(SUFFIX)


def _address(place: str, minor: str) -> str:
    return place if is_one_file(place) else f"{place.rstrip('/')}/{ready_name(minor)}"


def _local_file(place: str, minor: str) -> Path:
    path = Path(place).expanduser().absolute()
    path = path / ready_name(minor) if path.is_dir() else path
    if not path.is_file():
        raise ReadyBaseError(
            f"there is no file {path}; give a ready base that simworlds kb export has written"
        )
    return path


def _downloaded(url: str, wanted: str, folder: Path, progress: Progress) -> Path:
    try:
        parts = urlsplit(url)
    except ValueError as error:
        raise ReadyBaseError(
            f"{url[:300]!r} is not an address ({error}); give one that begins with https://"
        ) from error
    if parts.scheme not in {"https", "http"}:
        raise ReadyBaseError(
            f"{url[:300]!r} is not an address to fetch from; give one that begins with https://"
        )
    if parts.scheme == "http" and not wanted and not is_loopback(parts.hostname or ""):
        raise ReadyBaseError(
            f"{url} is not encrypted: whoever is on the way could change the base. Give an https:// address, or add "
            "#sha256= and the file's checksum"
        )
    target = folder / f"{hashlib.sha256(url.encode()).hexdigest()[:16]}{SUFFIX}"
    download(url, target, patience=DownloadPatience(_PATIENCE_SECONDS), progress=progress, kind=_KIND)
    return target


def _install(archive: Path, wanted: str, minor: str, home: Path, progress: Progress) -> Fetched:
    origin = str(archive)
    if wanted and (real := sha256_of_file(archive)) != wanted:
        raise ReadyBaseError(
            f"{origin} has the SHA-256 {real}, not {wanted}: it is another file, or was changed on the way"
        )
    if not _is_xz(archive):
        raise ReadyBaseError(
            f"{origin} is not a ready base (.tar.xz); give one that simworlds kb export has written"
        )
    with scratch_folder(home / "kb") as scratch:
        folder = scratch / "unpacked"
        unpack(archive, folder, wanted=_is_member, limits=_LIMITS, progress=progress)
        if missing := sorted(name for name in MEMBERS if not (folder / name).is_file()):
            raise ReadyBaseError(f"{origin} is not a ready base: it has no {', '.join(missing)}")
        manifest = read_manifest(folder / MANIFEST, origin)
        if minor and manifest.minor != minor:
            raise ReadyBaseError(
                f"{origin} is of Blender {manifest.blender}, not {minor}; fetch {manifest.minor}"
            )
        progress("checking the base", 0, None)
        _check(folder / BASE, manifest, origin)
        target = base_path(home, manifest.minor)
        (folder / BASE).chmod(0o644)
        (folder / BASE).replace(target)
    return Fetched(target, manifest, origin)


def _is_member(path: PurePosixPath) -> bool:
    if str(path) not in MEMBERS:
        raise SourceError(f"it holds {str(path)[:120]!r}, which no ready base does; do not use this file")
    return True


def _check(base: Path, manifest: Manifest, origin: str) -> None:
    """Raises ReadyBaseError unless the base is the one of the manifest, laid out as ours are, and sound."""
    size, digest = base.stat().st_size, sha256_of_file(base)
    if (size, digest) != (manifest.size, manifest.sha256):
        raise ReadyBaseError(
            f"{origin}: its base has {size:,} bytes and the SHA-256 {digest}, not {manifest.size:,} and "
            f"{manifest.sha256} as its manifest says; get the file again"
        )
    try:
        if (foreign := _foreign_statements(base)) is not None:
            raise ReadyBaseError(
                f"{origin}: its base is not laid out as a knowledge base ({foreign}); do not use it"
            )
        verification = verify_base(base)
    except ReadyBaseError:
        raise
    except (KBBuildError, NoBase, sqlite3.Error) as error:
        raise ReadyBaseError(f"{origin}: its base cannot be read ({error}); get another file") from error
    if verification.blender != manifest.blender:
        raise ReadyBaseError(
            f"{origin}: its base is of Blender {verification.blender[:40]}, and its manifest says {manifest.blender}"
        )
    if not verification.sound:
        fault = next(fault for check in verification.checks for fault in check.faults)
        raise ReadyBaseError(f"{origin}: its base is not sound ({fault[:300]}); get another file")


def _foreign_statements(base: Path) -> str | None:
    """What differs between the layout of a file and a base's: a view or a trigger would run when it is read."""
    with closing(sqlite3.connect(":memory:")) as model, closing(open_read_only(base)) as connection:
        connection.execute("PRAGMA trusted_schema=OFF")
        model.executescript(DDL + INDEXES)
        expected, found = _statements(model), _statements(connection)
    for name in sorted(expected.keys() | found.keys()):
        if expected.get(name) != found.get(name):
            return f"{name[:80]!r} {'is missing' if name not in found else 'is not one of its tables or indexes'}"
    return None


def _statements(connection: sqlite3.Connection) -> dict[str, str]:
    rows = connection.execute("SELECT name, type || ' ' || coalesce(sql, '') FROM sqlite_schema")
    # ANALYZE writes a table of its own; indexes that SQLite makes have no statement.
    return {name: statement for name, statement in rows if name not in {"sqlite_stat1", "sqlite_stat4"}}
