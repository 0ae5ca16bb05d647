"""A folder of assets, catalogued: what it has is read once by each Blender, confined, and kept by the contents."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from agents.blender.assets.licence import LONGEST, NOTE_FILE, LicenceNote
from agents.blender.assets.map_names import IMAGES, map_of, texture_sets
from agents.blender.assets.replies import MarkedAsset, ReadAssets
from agents.blender.second_blender import second_blender
from agents.blender.sheets.contact_sheet import to_png
from simworlds.files import write_whole
from simworlds.folder_files import FolderFile, FolderLimits, FolderTooLarge, list_files, read_file
from simworlds.sandbox.errors import BlenderError, Lost, Refusal
from simworlds.settings import cache_folder, home_folder

if TYPE_CHECKING:
    from agents.blender.assets.poly_haven import PolyHaven
    from agents.blender.supervisor import Supervisor
    from simworlds.sandbox.blender_process import BlenderProcess
    from simworlds.sandbox.hostile_ground import HostileGround
    from simworlds.sandbox.pictures.picture_decoder import PictureDecoder

Kind = Literal["object", "collection", "material", "world", "node_group", "textures", "hdri"]
Told = Callable[[float, float | None, str], None]
_VERSION = 1  # of what is kept of a file
_HDRIS = frozenset({".hdr", ".exr"})
_LIMITS = FolderLimits(files=20_000, entries=200_000, depth=12, file_bytes=4 << 30, total_bytes=1 << 40)
_FILE_SECONDS = 120.0
_QUIET_SECONDS = 2.0
_SIDE = 128  # pixels of a preview
_CHUNK = 1 << 20
_MOST_INDEX = 64 << 20  # bytes


def open_library(root: Path, online: PolyHaven | None = None) -> AssetLibrary:
    """The library in a folder; what is read of it is kept in the user's folder. Nothing is read yet."""
    return AssetLibrary(root, cache_folder(home_folder()) / "assets", online)


@dataclass(frozen=True, slots=True)
class LibraryAsset:
    """Something of the library. ``file`` is relative to its folder; ``maps`` of a texture set: {map: file}.

    ``size``: of an image, in pixels; ``preview``: the path of a PNG, None without one.
    """

    id: str
    kind: Kind
    name: str
    file: str
    tags: tuple[str, ...] = ()
    description: str = ""
    author: str = ""
    license: str = ""
    maps: dict[str, str] = field(default_factory=dict[str, str])
    size: tuple[int, int] | None = None
    preview: Path | None = None


class _Kept(BaseModel):
    """What is kept of a file of some contents; pictures are named by their own digests."""

    model_config = ConfigDict(extra="forbid")

    read: ReadAssets
    pictures: dict[str, str] = Field(default_factory=dict[str, str])


class AssetLibrary:
    """The assets of ``root``; what was read is kept in the folder ``cache``. For one thread at a time.

    ``online``: where more of them can be fetched from.
    """

    def __init__(self, root: Path, cache: Path, online: PolyHaven | None = None) -> None:
        self.root = root
        self.online = online
        self._cache = cache
        self._assets: list[LibraryAsset] | None = None
        self._seen: tuple[FolderFile, ...] = ()
        self._ended: dict[
            str, _Kept
        ] = {}  # what has ended a Blender, which may have been a matter of the day
        self.faults: list[str] = []

    def assets(self, blender: Supervisor, told: Told | None = None) -> list[LibraryAsset]:
        """All assets, by id; files that are new or changed are read first. Raises Refusal."""
        try:
            files = list_files(self.root, _is_wanted, _LIMITS).files
        except (OSError, FolderTooLarge) as error:
            raise Refusal(f"The asset library {self.root} cannot be read: {error}.") from error
        if self._assets is None or tuple(files) != self._seen:
            self._assets = self._catalogue(files, blender, told)
            self._seen = tuple(files)
        return self._assets

    def _catalogue(
        self, files: list[FolderFile], blender: Supervisor, told: Told | None
    ) -> list[LibraryAsset]:
        self.faults = []
        by_name = {file.name: file for file in files}
        sets = texture_sets(by_name)
        shown = {place: maps.get("base_color") or next(iter(maps.values())) for place, maps in sets.items()}
        maps = {name for entry in sets.values() for name in entry.values()}
        lights = [name for name in by_name if _ending(name) in _HDRIS and name not in maps]
        blends = [name for name in by_name if _ending(name) == ".blend"]
        kept = self._read_all([by_name[name] for name in (*blends, *shown.values(), *lights)], blender, told)
        assets: list[LibraryAsset] = []
        for name in blends:
            if (entry := kept.get(name)) is not None:
                assets += [self._of_blend(name, marked, entry) for marked in entry.read.assets]
        for place, entry_maps in sets.items():
            if (entry := kept.get(shown[place])) is not None:
                plain = LibraryAsset(f"{place}/textures", "textures", PurePosixPath(place).name, shown[place])
                assets.append(replace(self._of_image(plain, entry), maps=entry_maps))
        for name in lights:
            if (entry := kept.get(name)) is not None:
                assets.append(
                    self._of_image(LibraryAsset(name, "hdri", PurePosixPath(name).stem, name), entry)
                )
        return sorted(assets, key=lambda asset: asset.id)

    def _of_blend(self, file: str, marked: MarkedAsset, kept: _Kept) -> LibraryAsset:
        return LibraryAsset(
            f"{file}/{marked.kind}/{marked.name}",
            marked.kind,
            marked.name,
            file,
            tuple(marked.tags),
            marked.description,
            marked.author,
            marked.license,
            preview=self._picture(kept, marked.picture),
        )

    def _of_image(self, asset: LibraryAsset, kept: _Kept) -> LibraryAsset:
        """The same with what is known of its image, and of the folder that it lies in."""
        known = replace(asset, size=kept.read.size, preview=self._picture(kept, kept.read.picture))
        with suppress(OSError, ValueError):
            place = PurePosixPath(asset.file).with_name(NOTE_FILE).as_posix()
            note = LicenceNote.model_validate_json(read_file(self.root, place, most=LONGEST))
            return replace(known, tags=tuple(note.tags), author=note.author, license=note.license)
        return known

    def _picture(self, kept: _Kept, name: str) -> Path | None:
        digest = kept.pictures.get(name)
        return self._cache / f"{digest}.png" if digest is not None else None

    # What is read once

    def _read_all(self, files: list[FolderFile], blender: Supervisor, told: Told | None) -> dict[str, _Kept]:
        """What each file has. Those that cannot be read are among ``faults``."""
        digests, found = self._digests(), dict[str, _Kept]()
        began = time.monotonic()
        with ExitStack() as stack:
            second: tuple[BlenderProcess, HostileGround] | None = None
            for number, file in enumerate(files):
                if told is not None and time.monotonic() - began > _QUIET_SECONDS:
                    told(number, len(files), f"cataloguing {file.name}")
                try:
                    digest = digests.setdefault(_stamp(self.root, file), "") or self._digest(file)
                    digests[_stamp(self.root, file)] = digest
                    key = f"{digest}-{blender.launch.runtime.version}"
                    entry = self._ended.get(key) or self._load(key)
                    if entry is None:
                        if second is None or not second[0].alive:
                            second = stack.enter_context(second_blender(blender.launch, self.root))
                        entry = self._read(file, key, *second, blender.pictures)
                except (OSError, BlenderError) as error:
                    self.faults.append(f"{file.name}: {str(error)[:300]}")
                    continue
                if entry.read.fault:
                    self.faults.append(f"{file.name}: {entry.read.fault}")
                else:
                    found[file.name] = entry
        self._store_digests(digests)
        return found

    def _read(
        self,
        file: FolderFile,
        key: str,
        process: BlenderProcess,
        ground: HostileGround,
        decoder: PictureDecoder,
    ) -> _Kept:
        """Lets the second Blender read a file, and keeps what it says; of a file that ends it, in this library only."""
        folder = "pictures"
        request: dict[str, Any] = {
            "path": str(self.root / file.name),
            "folder": ground.for_blender(folder),
        }
        try:
            reply = process.call("read_assets", request, ReadAssets.model_validate, timeout=_FILE_SECONDS)
        except Lost as error:
            fault = f"it ends the Blender that reads it: {str(error)[:200]}"
            return self._ended.setdefault(
                key, _Kept(read=ReadAssets(assets=[], size=None, picture="", fault=fault))
            )
        read = reply.value
        pictures: dict[str, str] = {}
        for name in {read.picture, *(asset.picture for asset in read.assets)} - {""}:
            with suppress(Refusal), ground.open(f"{folder}/{name}", at_most=_CHUNK) as opened:
                png = to_png(decoder.decode(opened, name, longest=_SIDE).image)
                pictures[name] = hashlib.sha256(png).hexdigest()
                write_whole(self._cache / f"{pictures[name]}.png", png, durable=False)
        ground.remove(folder)
        kept = _Kept(read=read, pictures=pictures)
        write_whole(self._cache / f"{key}.json", kept.model_dump_json(), durable=False)
        return kept

    def _digest(self, file: FolderFile) -> str:
        digest = hashlib.sha256(f"{_VERSION}".encode())
        with (self.root / file.name).open("rb") as opened:
            while data := opened.read(_CHUNK):
                digest.update(data)
        return digest.hexdigest()

    def _load(self, key: str) -> _Kept | None:
        with suppress(OSError, ValidationError):
            return _Kept.model_validate_json((self._cache / f"{key}.json").read_bytes())
        return None

    @property
    def _index(self) -> Path:
        return self._cache / "files.json"

    def _digests(self) -> dict[str, str]:
        """{stamp of a file: digest of its contents}, so that an unchanged file is not read to know it."""
        with suppress(OSError, ValueError):
            if self._index.stat().st_size <= _MOST_INDEX:
                known = json.loads(self._index.read_bytes())
                return {str(stamp): str(digest) for stamp, digest in known.items()}
        return {}

    def _store_digests(self, digests: dict[str, str]) -> None:
        known = {stamp: digest for stamp, digest in digests.items() if digest}
        with suppress(OSError):
            write_whole(self._index, json.dumps(known), durable=False)


def _stamp(root: Path, file: FolderFile) -> str:
    return f"{root / file.name}:{file.size}:{file.changed}:{file.inode}"


def _ending(name: str) -> str:
    return PurePosixPath(name).suffix.lower()


def _is_wanted(path: PurePosixPath) -> bool:
    ending = path.suffix.lower()
    if path.name == NOTE_FILE:
        return True
    return ending in _HDRIS or ending == ".blend" or (ending in IMAGES and bool(map_of(path.stem)[0]))


def find_assets(assets: list[LibraryAsset], query: str, kind: Kind | None) -> list[LibraryAsset]:
    """Those that have every word of a query in their name, tags, description or path; the best first."""
    words = query.lower().split()
    scored: list[tuple[int, str, LibraryAsset]] = []
    for asset in assets:
        if kind is not None and asset.kind != kind:
            continue
        name, tags = asset.name.lower(), " ".join(asset.tags).lower()
        rest = f"{asset.id} {asset.description} {asset.kind}".lower()
        scores = [4 * (word in name) + 2 * (word in tags) + (word in rest) for word in words]
        if all(scores):
            scored.append((-sum(scores), asset.id, asset))
    return [asset for _, _, asset in sorted(scored, key=lambda entry: entry[:2])]
