"""Poly Haven's public API: what it has, and its files, with their licence, into a folder of the user's library.

It is asked only by a server that was started with --online, and under a name of its own, as its terms want. Its
answers are read by models with bounds; files come from its own hosts, have the size and the MD5 that it tells, and go
on where a transfer broke off.
"""

from __future__ import annotations

import hashlib
import math
import re
import shutil
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Annotated, Any, Literal
from urllib.parse import urlsplit

import httpx2
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from agents.blender.assets.licence import NOTE_FILE, LicenceNote
from simworlds.files import write_whole
from simworlds.sandbox.errors import Refusal
from simworlds.schemas.faults import first_fault

if TYPE_CHECKING:
    import threading

Kind = Literal["hdris", "textures", "models"]
Resolution = Literal["1k", "2k", "4k", "8k"]
Told = Callable[[float, float | None, str], None]
CREDIT = "Powered by Poly Haven"
FOLDER = "poly_haven"  # in the library
_UNFINISHED = ".fetching"  # in the library; hidden, so no part of it
_API = "https://api.polyhaven.com"
_ORIGINS = frozenset({"https://dl.polyhaven.org"})
_PAGES = "https://polyhaven.com/a"
_AGENT = "SimWorlds asset library"
_SECONDS = 20.0  # without an answer
_LARGEST_ANSWER = 64 << 20
_LARGEST_FILE = 2 << 30
_LARGEST_ASSET = 6 << 30
_MOST_FILES = 200
_ATTEMPTS = 4
_CHUNK = 1 << 18
_ID = r"^[A-Za-z0-9_\-]{1,100}$"
_PLACE = re.compile(r"[\w .()+-]{1,120}")
# Maps that are connected, by the names of the file list: the word that our own file gets.
_MAPS = {
    "Diffuse": "diffuse",
    "diffuse": "diffuse",
    "col1": "diffuse",
    "col_01": "diffuse",
    "coll1": "diffuse",
    "nor_gl": "normal",
    "Rough": "roughness",
    "Metal": "metallic",
    "Displacement": "displacement",
    "AO": "ao",
    "Opacity": "opacity",
    "Mask": "opacity",
    "emission": "emission",
    "emissive": "emission",
}
_LIST_SECONDS = 3600.0  # how long a list of assets counts
_FORMATS = ("jpg", "png", "exr")
Words = list[Annotated[str, Field(max_length=300)]]


class _Answer(BaseModel):
    """The base of what the API says; what is not used is left out."""

    model_config = ConfigDict(extra="ignore", frozen=True)


class OnlineAsset(_Answer):
    """An asset as the list has it; ``type``: 0 HDRI, 1 texture, 2 model."""

    name: str = Field(max_length=300)
    type: int = Field(ge=0, le=2)
    description: str | None = Field(default=None, max_length=20_000)
    authors: dict[str, Any] = Field(default_factory=dict[str, Any], max_length=100)
    categories: Words = Field(default_factory=list[str], max_length=500)
    tags: Words = Field(default_factory=list[str], max_length=500)


class _File(_Answer):
    url: str = Field(max_length=2000)
    md5: str = Field(pattern=r"^[0-9a-f]{32}$")
    size: int = Field(ge=1, le=_LARGEST_FILE)


class _FileWithIncludes(_File):
    include: dict[str, _File] = Field(default_factory=dict[str, _File], max_length=_MOST_FILES)


_Listing = TypeAdapter(dict[Annotated[str, Field(pattern=_ID)], OnlineAsset])
_KINDS: tuple[Kind, ...] = ("hdris", "textures", "models")


@dataclass(frozen=True, slots=True)
class FetchedAsset:
    """What was fetched: ``files`` relative to ``folder``, ``main`` the one to use (for textures, the colour)."""

    folder: Path
    main: str
    files: tuple[str, ...]
    bytes: int
    note: LicenceNote


class PolyHaven:
    """The API at ``api``; files may come from ``origins`` (scheme and host) only."""

    def __init__(
        self,
        api: str = _API,
        origins: frozenset[str] = _ORIGINS,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """``clock`` gives seconds."""
        self._api = api
        self._origins = origins
        self._clock = clock
        self._lists: dict[Kind, tuple[float, dict[str, OnlineAsset]]] = {}  # with the time when it was read

    def search(self, words: str, kind: Kind) -> list[tuple[str, OnlineAsset]]:
        """(id, asset) of those that have every word in their name, tags or categories. Raises Refusal."""
        wanted = words.lower().split()
        found: list[tuple[int, str, OnlineAsset]] = []
        for name, asset in self._list(kind).items():
            title = f"{name} {asset.name}".lower()
            rest = " ".join((*asset.tags, *asset.categories)).lower()
            scores = [3 * (word in title) + (word in rest) for word in wanted]
            if all(scores):
                found.append((-sum(scores), name, asset))
        return [(name, asset) for _, name, asset in sorted(found, key=lambda entry: entry[:2])]

    def fetch(  # noqa: PLR0913 - what a caller may want of a transfer
        self,
        name: str,
        resolution: Resolution,
        library: Path,
        *,
        told: Told | None = None,
        cancelled: threading.Event | None = None,
        timeout: float = 600.0,
    ) -> FetchedAsset:
        """Fetches an asset into ``library``, whole or not at all, with a note on its licence. Raises Refusal."""
        asset = self._info(name)
        kind = _KINDS[asset.type]
        files = self._files(name, kind, resolution)
        total = sum(file.size for file in files.values())
        if total > _LARGEST_ASSET:
            raise Refusal(
                f"{name} has {total / 1e9:.1f} GB in {resolution}, too much; take a lower resolution."
            )
        note = LicenceNote(
            source="Poly Haven",
            page=f"{_PAGES}/{name}",
            license="CC0",
            author=", ".join(str(author)[:100] for author in asset.authors)[:900],
            name=asset.name,
            tags=[*dict.fromkeys((*asset.tags, *asset.categories))][:50],
            md5={place: file.md5 for place, file in files.items()},
        )
        folder = library / FOLDER / kind / f"{name}_{resolution}"
        unfinished = library / _UNFINISHED / folder.name
        transfer = _Transfer(self._origins, told, cancelled, time.monotonic() + timeout, total)
        try:
            if not _is_whole(folder, files):
                with self._client() as client:
                    for place, file in files.items():
                        transfer.bring(client, file, unfinished / place)
                write_whole(unfinished / NOTE_FILE, note.model_dump_json(indent=1))
                if folder.exists():
                    shutil.rmtree(folder)
                folder.parent.mkdir(parents=True, exist_ok=True)
                unfinished.rename(folder)
        except OSError as error:
            raise Refusal(f"{library} cannot be written to: {error.strerror or error}.") from error
        return FetchedAsset(folder, next(iter(files)), tuple(files), total, note)

    # What the API says

    def _list(self, kind: Kind) -> dict[str, OnlineAsset]:
        """The assets of a kind by id. A server may run for days, in which new ones appear."""
        read_at, assets = self._lists.get(kind, (-math.inf, {}))
        if self._clock() - read_at >= _LIST_SECONDS:
            assets = self._read(f"/assets?type={kind}", _Listing)
            self._lists[kind] = (self._clock(), assets)
        return assets

    def _info(self, name: str) -> OnlineAsset:
        if not re.fullmatch(_ID, name):
            raise Refusal(f"{name[:100]!r} is not an id of Poly Haven; search for one.")
        return self._read(f"/info/{name}", TypeAdapter(OnlineAsset))

    def _files(self, name: str, kind: Kind, resolution: Resolution) -> dict[str, _File]:
        """{place in the asset's folder: file}, the main one first. Raises Refusal."""
        tree = self._read(f"/files/{name}", TypeAdapter(dict[str, Any]))
        try:
            if kind == "hdris":
                entry = _File.model_validate(_at(tree, name, "hdri", resolution, "hdr"))
                return {f"{name}_{resolution}.hdr": entry}
            if kind == "models":
                main = _FileWithIncludes.model_validate(_at(tree, name, "gltf", resolution, "gltf"))
                included = {_safe(place, name): file for place, file in main.include.items()}
                return {f"{name}_{resolution}.gltf": main, **included}
            return _maps(tree, name, resolution)
        except ValidationError as error:
            raise self._malformed(error) from error

    def _read(self, path: str, kind: TypeAdapter[Any]) -> Any:
        """An answer of the API. Raises Refusal."""
        try:
            with self._client() as client, client.stream("GET", f"{self._api}{path}") as response:
                if response.status_code == 404:
                    raise Refusal(f"Poly Haven has no {path.rpartition('/')[2][:100]!r}; search for one.")
                if response.status_code != 200:
                    raise Refusal(f"Poly Haven answered {response.status_code}. Try again later.")
                data = bytearray()
                for chunk in response.iter_bytes(_CHUNK):
                    data += chunk
                    if len(data) > _LARGEST_ANSWER:
                        raise Refusal(
                            "Poly Haven's answer is too long to be one of its lists; it was not read."
                        )
            return kind.validate_json(bytes(data))
        except httpx2.HTTPError as error:
            raise Refusal(
                f"Poly Haven cannot be reached: {str(error)[:200] or type(error).__name__}."
            ) from error
        except ValidationError as error:
            raise self._malformed(error) from error

    def _malformed(self, error: ValidationError) -> Refusal:
        fault = first_fault(error, whole="the whole")
        return Refusal(f"Poly Haven's answer is not what it should be ({fault}).")

    def _client(self) -> httpx2.Client:
        headers = {"User-Agent": _AGENT, "Accept-Encoding": "identity"}
        return httpx2.Client(headers=headers, timeout=_SECONDS, follow_redirects=False)


def _at(tree: dict[str, Any], name: str, *path: str) -> Any:
    """What is at a place of the file list. Raises Refusal, which tells the resolutions there are."""
    here: Any = tree
    for depth, key in enumerate(path):
        if not isinstance(here, dict) or key not in here:
            has = ", ".join(sorted(map(str, here))[:10]) if isinstance(here, dict) and depth else "nothing"
            raise Refusal(f"{name} has no {' '.join(path)}; it has {has}.")
        here = here[key]
    return here


def _maps(tree: dict[str, Any], name: str, resolution: Resolution) -> dict[str, _File]:
    """The maps of a texture, one of each kind, colour first."""
    found: dict[str, _File] = {}
    words: set[str] = set()
    several = {"ao", "roughness", "metallic"}
    for key, word in (*_MAPS.items(), ("arm", "arm")):
        here = tree.get(key)
        by_format = here.get(resolution) if isinstance(here, dict) else None
        if word in words or not isinstance(by_format, dict) or (word == "arm" and words & several == several):
            continue
        ending = next((ending for ending in _FORMATS if ending in by_format), None)
        if ending is not None:
            words.add(word)
            found[f"{name}_{word}_{resolution}.{ending}"] = _File.model_validate(by_format[ending])
    if not found:
        raise Refusal(f"{name} has no maps in {resolution}; take another resolution.")
    return found


def _safe(place: str, name: str) -> str:
    """A place that a file list names, if it stays in the asset's folder. Raises Refusal."""
    parts = PurePosixPath(place).parts
    if not parts or len(parts) > 4 or not all(_PLACE.fullmatch(part) and part.strip(". ") for part in parts):
        raise Refusal(
            f"The file list of {name} names {place[:120]!r}, which may not be written; nothing was fetched."
        )
    return "/".join(parts)


@dataclass(slots=True)
class _Transfer:
    """Files of one asset, one after the other."""

    origins: frozenset[str]
    told: Told | None
    cancelled: threading.Event | None
    deadline: float
    total: int
    done: int = 0

    def bring(self, client: httpx2.Client, file: _File, target: Path) -> None:
        """Fetches a file unless it is there. What has come stays beside it until it is whole. Raises Refusal."""
        if target.is_file() and _md5(target) == file.md5:
            self.done += file.size
            return
        address = urlsplit(file.url)
        if f"{address.scheme}://{address.netloc}" not in self.origins:
            raise Refusal(f"Poly Haven names a file at {file.url[:100]!r}, which is not where its files are.")
        target.parent.mkdir(parents=True, exist_ok=True)
        part = target.with_name(f".{file.md5}.part")
        for left in reversed(range(_ATTEMPTS)):
            before = part.stat().st_size if part.exists() else 0
            try:
                self._receive(client, file, part, target.name)
                break
            except httpx2.HTTPError as error:
                after = part.stat().st_size if part.exists() else 0
                if not left or after <= before:
                    raise Refusal(
                        f"{target.name} broke off after {after:,} of {file.size:,} bytes "
                        f"({str(error)[:100] or type(error).__name__}). Call again to go on from there."
                    ) from error
        if _md5(part) != file.md5:
            part.unlink()
            raise Refusal(
                f"{target.name} is not the file that Poly Haven lists (its MD5 differs); it was removed."
            )
        part.replace(target)
        self.done += file.size

    def _receive(self, client: httpx2.Client, file: _File, part: Path, name: str) -> None:
        offset = part.stat().st_size if part.exists() else 0
        if offset > file.size:
            part.unlink()
            offset = 0
        if offset == file.size:
            return
        headers = {"Range": f"bytes={offset}-"} if offset else {}
        with client.stream("GET", file.url, headers=headers) as response:
            if response.status_code not in {200, 206}:
                raise Refusal(f"Poly Haven answered {response.status_code} for {name}. Try again later.")
            if response.status_code == 200 or not _goes_on(response, offset):
                offset = 0
            with part.open("ab" if offset else "wb") as output:
                for chunk in response.iter_raw():  # as it comes: what a chunk waits for would be lost
                    offset += len(chunk)
                    if offset > file.size:
                        output.truncate(0)
                        raise Refusal(f"{name} is longer than the {file.size:,} bytes that Poly Haven lists.")
                    output.write(chunk)
                    self._check(name, offset)
        if offset < file.size:
            raise httpx2.ReadError("the connection ended early")

    def _check(self, name: str, offset: int) -> None:
        if self.told is not None:
            self.told(self.done + offset, self.total, f"fetching {name}")
        if self.cancelled is not None and self.cancelled.is_set():
            raise Refusal(f"Fetching {name} was cancelled; call again to go on from there.")
        if time.monotonic() > self.deadline:
            raise Refusal(f"Fetching {name} took too long; call again to go on from there.")


def _goes_on(response: httpx2.Response, offset: int) -> bool:
    return response.headers.get("Content-Range", "").startswith(f"bytes {offset}-")


def _is_whole(folder: Path, files: dict[str, _File]) -> bool:
    """Whether an asset was fetched before, and is still as it is listed."""
    return (folder / NOTE_FILE).is_file() and all(
        (folder / place).is_file() and _md5(folder / place) == file.md5 for place, file in files.items()
    )


def _md5(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, lambda: hashlib.md5(usedforsecurity=False)).hexdigest()
