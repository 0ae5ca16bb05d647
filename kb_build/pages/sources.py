"""Finds the manual and the guides: by a given path, in a folder of sources, in the cache, on the official site."""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Literal

from kb_build.digests import Digests
from kb_build.errors import SourceError
from kb_build.pages.archives import unpack
from kb_build.pages.download import DownloadPatience, download
from simworlds.folder_files import FolderFiles, FolderLimits, FolderTooLarge, list_files, read_file
from simworlds.folder_lock import locked
from simworlds.releases import ROLES, Role, address, archive_suffixes, minor_of, source_names

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from kb_build.pages.archives import Progress

Form = Literal["rst", "html"]

_SUFFIXES: dict[Form, str] = {"rst": ".rst", "html": ".html"}
_DEPTH = 4
_HEAD = 400_000
_LIMITS = FolderLimits(file_bytes=8 << 20)


@dataclass(frozen=True, slots=True)
class DocumentationSource:
    """Pages to build from.

    ``path`` is the folder that the pages' slugs are relative to; ``version`` the documentation's own minor
    version, ``"unknown"`` where a given path does not tell; ``sha256`` the archive's, or over the folder's
    page names and contents; ``origin`` the path they came from; ``given`` whether the user named it;
    ``passed_over`` what of it is not read, such as links (empty: nothing).
    """

    role: Role
    path: Path
    form: Form
    version: str
    sha256: str
    origin: str
    given: bool
    passed_over: str = ""


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a source came from, and whether the user named it."""

    path: Path
    given: bool


@dataclass(frozen=True, slots=True)
class MissingSource:
    """A source that could not be found: what was tried, and what to do."""

    role: Role
    reason: str


def find_sources(  # noqa: PLR0913 - each names one place to look in
    version: str,
    *,
    cache: Path,
    manual: Path | None = None,
    guides: Path | None = None,
    corpora: Path | None = None,
    before: Mapping[str, Origin] | None = None,
    allow_download: bool = True,
    fresh: bool = False,
    base_url: str | None = None,
    patience: DownloadPatience | None = None,
    progress: Progress | None = None,
) -> tuple[list[DocumentationSource], list[MissingSource]]:
    """Finds the manual and the guides of a Blender version; returns the sources and what is missing.

    ``manual`` and ``guides`` are folders or archives named by the user, taken whatever their version;
    ``corpora`` is a folder with sources of several versions; ``before`` tells by role where the last build had
    them from; ``cache`` keeps downloads, unpacked archives and digests; with ``fresh``, what was downloaded is
    downloaded again, and counts where that fails; ``base_url`` replaces the official site; silent addresses cost
    what ``patience`` allows (ten seconds), both roles together. What another process is downloading into ``cache`` is
    waited for. Raises SourceError when a path that the user named cannot be used.
    """
    waits = patience or DownloadPatience()
    search = _Search(
        minor_of(version), cache, corpora, before or {}, allow_download, fresh, base_url, waits, progress
    )
    given = {"manual": manual, "guides": guides}
    results = [search.find(role, given[role]) for role in ROLES]
    search.digests.save()
    return [s for s in results if isinstance(s, DocumentationSource)], [
        s for s in results if isinstance(s, MissingSource)
    ]


@dataclass(slots=True)
class _Search:
    """The search for one version's sources."""

    version: str
    cache: Path
    corpora: Path | None
    before: Mapping[str, Origin]
    allow_download: bool
    fresh: bool
    base_url: str | None
    patience: DownloadPatience
    progress: Progress | None
    digests: Digests = field(init=False)

    def __post_init__(self) -> None:
        self.digests = Digests(self.cache / "digests.json")

    @property
    def downloads(self) -> Path:
        return self.cache / "downloads"

    def find(self, role: Role, given: Path | None) -> DocumentationSource | MissingSource:
        if given is not None:
            return self._open(role, given.expanduser().absolute(), given=True)
        faults: list[str] = []
        attempts = [self._among_corpora, self._among_downloads, self._as_before, self._from_site]
        if self.fresh:
            attempts.insert(1, attempts.pop())
        for attempt in attempts:
            if source := attempt(role, faults):
                return source
        name = "manual" if role == "manual" else "API guides"
        return MissingSource(
            role,
            f"no {name} of Blender {self.version}: {'; '.join(faults)}. "
            f"Give one with --{role} PATH (make kb {role.upper()}=PATH), or run again with a network",
        )

    def _among_corpora(self, role: Role, faults: list[str]) -> DocumentationSource | None:
        if self.corpora is None:
            faults.append("no folder of sources is named (SIMWORLDS_CORPORA)")
            return None
        return self._among(self.corpora, role, faults)

    def _among_downloads(self, role: Role, faults: list[str]) -> DocumentationSource | None:
        return self._among(self.downloads, role, faults)

    def _as_before(self, role: Role, faults: list[str]) -> DocumentationSource | None:
        """Looks where the last build found it: a build that names no source must not lose pages of the base."""
        origin = self.before.get(role)
        if self.corpora is not None or origin is None or not origin.path.exists():
            return None
        try:
            return self._open(role, origin.path, given=origin.given)
        except SourceError as error:
            faults.append(str(error))
            return None

    def _among(self, folder: Path, role: Role, faults: list[str]) -> DocumentationSource | None:
        """The first usable source of this version that lies in ``folder`` under one of the usual names."""
        for path in _candidates(folder, role, self.version):
            try:
                return self._open(role, path, given=False)
            except SourceError as error:
                faults.append(str(error))
        faults.append(f"{folder} has none" if folder.is_dir() else f"{folder} does not exist")
        return None

    def _from_site(self, role: Role, faults: list[str]) -> DocumentationSource | None:
        if not self.allow_download:
            faults.append("downloads are off")
            return None
        url = address(role, self.version, self.base_url)
        target = self.downloads / f"{source_names(role, self.version)[-1]}.zip"
        try:
            self.downloads.mkdir(parents=True, exist_ok=True)
            with locked(self.downloads, before_waiting=self._say_that_it_waits):
                if not self.fresh and (source := self._among_downloads(role, [])):
                    return source  # another process has downloaded it meanwhile
                download(url, target, patience=self.patience, progress=self.progress)
            return self._open(role, target, given=False)
        except SourceError as error:
            faults.append(str(error))
        except OSError as error:
            faults.append(f"{self.downloads} cannot be written to ({error.strerror or error})")
        return None

    def _say_that_it_waits(self) -> None:
        if self.progress:
            self.progress("waiting for another SimWorlds to end its download", 0, None)

    def _open(self, role: Role, path: Path, *, given: bool) -> DocumentationSource:
        """The source at ``path``. Raises SourceError if it has no pages of this role, or another version."""
        try:
            return self._read(role, path, given=given)
        except OSError as error:
            raise SourceError(f"{path} cannot be read: {error}") from error

    def _read(self, role: Role, path: Path, *, given: bool) -> DocumentationSource:
        if path.is_dir():
            top, digest = path, None
        elif path.is_file():
            digest = self.digests.of_file(path)
            top = self.cache / "unpacked" / f"{role}-{digest[:32]}"
            if not top.is_dir():
                unpack(path, top, wanted=_RELEVANT[role], progress=self.progress)
        else:
            raise SourceError(f"{path} does not exist; give a folder, a .zip or a .tar archive")
        try:
            files = list_files(top, _RELEVANT[role], _LIMITS)
        except FolderTooLarge as error:
            raise SourceError(str(error)) from error
        folder, form = _pages_folder(files, role, path)
        version = _version_of(folder, top, path)
        if not given and version not in {self.version, "unknown"}:
            raise SourceError(f"{path} holds Blender {version}")
        pages = files.beneath(folder)
        if files.passed_over() and folder.parts:  # elsewhere in a clone it is nobody's loss
            files = list_files(pages.folder, _RELEVANT[role], _LIMITS)
        return DocumentationSource(
            role=role,
            path=pages.folder,
            form=form,
            version=self.version if version == "unknown" and not given else version,
            sha256=digest or self.digests.of_files(pages),
            origin=str(path),
            given=given,
            passed_over=files.passed_over(),
        )


def _is_manual_file(path: PurePosixPath) -> bool:
    return path.suffix in {".rst", ".html", ".inv"}


def _is_guides_file(path: PurePosixPath) -> bool:
    """The API reference's other pages say what Blender itself says better, and they are 2,000."""
    return (
        path.suffix in {".rst", ".inv"}
        or (path.suffix == ".html" and path.name.startswith("info_"))
        or path.name == "index.html"
    )


_RELEVANT: dict[Role, Callable[[PurePosixPath], bool]] = {
    "manual": _is_manual_file,
    "guides": _is_guides_file,
}
_MARKS: dict[Role, tuple[str, ...]] = {"manual": ("index", "*"), "guides": ("info_*",)}


def _candidates(folder: Path, role: Role, version: str) -> Iterator[Path]:
    for name in source_names(role, version):
        for suffix in ("", *archive_suffixes()):
            path = folder / (name + suffix)
            if path.is_dir() if not suffix else path.is_file():
                yield path


def _pages_folder(files: FolderFiles, role: Role, origin: Path) -> tuple[PurePosixPath, Form]:
    """The folder among ``files`` that the pages' slugs are relative to, and their form; RST before HTML."""
    names: dict[PurePosixPath, list[PurePosixPath]] = {}
    for file in files.files:
        path = PurePosixPath(file.name)
        if len(path.parts) <= _DEPTH + 1 and not any(part.startswith("_") for part in path.parts[:-1]):
            names.setdefault(path.parent, []).append(path)
    folders = sorted(names, key=lambda folder: (len(folder.parts), folder))
    for mark in _MARKS[role]:
        for form, suffix in _SUFFIXES.items():
            for folder in folders:
                if any(path.match(mark + suffix) for path in names[folder]):
                    return folder, form
    wanted = "manual pages (.rst or .html)" if role == "manual" else "guides (info_*.rst or info_*.html)"
    passed_over = files.passed_over()
    raise SourceError(
        f"{origin} holds no {wanted}" + (f"; passed over: {passed_over}" if passed_over else "")
    )


_INVENTORY = re.compile(rb"^# (?:Version|Project):[^\n]*?(\d{1,2}\.\d{1,2})", re.MULTILINE)
_CONF = re.compile(rb"^(?:blender_version|version|release)\s*=\s*['\"](\d{1,2}\.\d{1,2})", re.MULTILINE)
_TITLE = re.compile(rb"<title>[^<]*Blender (\d{1,2}\.\d{1,2})")
_NAME = re.compile(r"(?:blender|manual|api|guides|python)\D*?(\d{1,2})[._](\d{1,2})(?!\d)", re.IGNORECASE)
_COMPACT_NAME = re.compile(r"manual_v(\d)(\d{1,2})0_")


def _version_of(folder: PurePosixPath, top: Path, origin: Path) -> str:
    """The documentation's minor version as its own files say, else as its names say, else "unknown"."""
    above, conf = (top, folder.parent / "conf.py") if folder.parts else (top.parent, PurePosixPath("conf.py"))
    for place, name, pattern in (
        (top, folder / "objects.inv", _INVENTORY),
        (top, folder / "conf.py", _CONF),
        (above, conf, _CONF),
        (top, folder / "index.html", _TITLE),
        (top, folder / "info_overview.html", _TITLE),
    ):
        with suppress(OSError):
            if match := pattern.search(read_file(place, name.as_posix(), most=_HEAD, cut=True)):
                return minor_of(match[1].decode())
    inside = reversed(folder.parts)
    outside = (origin.name, origin.parent.name)
    for name in (*inside, *outside):
        if match := _COMPACT_NAME.search(name) or _NAME.search(name):
            return minor_of(f"{match[1]}.{match[2]}")
    return "unknown"
