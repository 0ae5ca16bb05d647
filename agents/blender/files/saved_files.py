"""Saved .blend files of a run, each with a folder beside it for the caches that cannot be packed."""

from __future__ import annotations

import re
import shutil
import tempfile
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Literal

from pydantic import Field, model_validator

from agents.blender.files.readable_files import find_readable
from agents.blender.second_blender import second_blender
from simworlds.counting import format_list
from simworlds.formats.blend_file import HEAD, begins_blend
from simworlds.sandbox.errors import BlenderError, NotThere, Refusal
from simworlds.sandbox.hostile_ground import DEEPEST, HostileGround, copy_folder, copy_to
from simworlds.sandbox.replies import Claim, Count, Name, Place

if TYPE_CHECKING:
    from collections.abc import Generator, Iterable

    from agents.blender.files.readable_files import ReadableFile
    from agents.blender.files.run_folder import RunFolder
    from simworlds.sandbox.launch import Launch

COPY_NAME = ".saved.blend"  # in the workspace, until it is taken out
_MOST_FILES = 500_000
_MOST_NAMED = 20_000
_STAGED = ".saving-"  # in the run's folder
_BLEND = re.compile(r"\.blend\d*$", re.IGNORECASE)
_LISTED = 12
_LARGEST = 1 << 40  # bytes of a .blend


class CacheReport(Claim):
    """A physics cache: the frames it is for, how many it has, and how many of a bake's frames are missing."""

    label: Name
    baked: bool
    outdated: bool
    range: list[int] = Field(min_length=2, max_length=2)
    where: Literal["memory", "disk"]
    frames: Count
    missing: Count


class ExternalFile(Claim):
    """A file that is used and not packed; ``missing``: Blender cannot read it."""

    what: Name
    path: Place
    missing: bool


class FileContents(Claim):
    """What an open file has."""

    objects: Count
    caches: list[CacheReport] = Field(max_length=_MOST_NAMED)


class SavedCopy(FileContents):
    """A file that was written; ``files`` are (path in the workspace, path in the folder beside the .blend).

    The ``loose`` ones are of simulations that are not baked: Blender may have dropped them since. ``unused``:
    data-blocks that are not in it, because nothing uses them.
    """

    bytes: Count
    packed: list[Name] = Field(max_length=_MOST_NAMED)
    rescued: list[Name] = Field(max_length=_MOST_NAMED)
    files: list[tuple[Place, Place]] = Field(max_length=_MOST_FILES)
    loose: list[tuple[Place, Place]] = Field(max_length=_MOST_FILES)
    external: list[ExternalFile] = Field(max_length=_MOST_NAMED)
    unused: list[Name] = Field(max_length=_MOST_NAMED)

    @model_validator(mode="after")
    def _each_once(self) -> SavedCopy:
        every = [source for source, _ in (*self.files, *self.loose)]
        if len({*every}) < len(every):
            raise ValueError("a file is to be copied more than once")
        return self


class LoadedFile(FileContents):
    """A file that was opened as the run's own; ``scripts``: it has scripts, which were not run."""

    version: Name
    scripts: bool
    external: list[ExternalFile] = Field(max_length=_MOST_NAMED)


def caches_folder(blend: Path) -> Path:
    """The folder of a .blend's caches, named as Blender names it."""
    return blend.with_name(f"blendcache_{blend.stem}")


# Saving


@contextmanager
def staging(folder: RunFolder) -> Generator[Path]:
    """A folder in which a saved file is put together, out of executed code's reach. Raises Refusal."""
    try:
        for leftover in folder.root.glob(f"{_STAGED}*"):
            shutil.rmtree(leftover, ignore_errors=True)
        staged = Path(tempfile.mkdtemp(prefix=_STAGED, dir=folder.root))
        staged.chmod(0o755)  # a Blender that may read the folder around the run's goes through here
    except OSError as error:
        raise Refusal(f"{folder.root} cannot be written to: {error.strerror or error}.") from error
    try:
        yield staged
    finally:
        shutil.rmtree(staged, ignore_errors=True)


def copy_from_workspace(
    folder: RunFolder, files: Iterable[tuple[str, str]], target: Path, *, may_be_gone: bool = False
) -> tuple[int, int]:
    """Copies (path in the workspace, path below ``target``); returns how many files and bytes. Raises Refusal."""
    count = total = 0
    for source, below in files:
        parts = PurePosixPath(below).parts
        if not parts or ".." in parts or len(parts) > DEEPEST or below.startswith("/") or "\0" in below:
            raise Refusal(f"{below[:120]!r} is not a valid path for a cache file.")
        try:
            with folder.workspace.open(source) as file:
                total += copy_to(file, target.joinpath(*parts), durable=False)
        except NotThere:
            if may_be_gone:
                continue
            raise
        count += 1
    return count, total


def put_in_place(staged: Path, target: Path) -> None:
    """Moves a .blend and its caches to their place; on failure the old ones stay. Raises Refusal."""
    before, has_moved = staged.with_name("before"), False
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        if caches_folder(target).exists():
            caches_folder(target).rename(before)
        if caches_folder(staged).exists():
            caches_folder(staged).rename(caches_folder(target))
            has_moved = True
        staged.replace(target)
    except OSError as error:
        if has_moved:
            shutil.rmtree(caches_folder(target), ignore_errors=True)
        if before.exists():
            before.rename(caches_folder(target))
        raise Refusal(f"{target} cannot be written: {error.strerror or error}.") from error


def move_saved(made: Path, target: Path) -> None:
    """Moves a saved .blend with its caches; where the file is, all is. May be called again after it was cut off.

    The caches of the file that was there before go, whether or not the new one has any. Raises OSError.
    """
    target.parent.mkdir(exist_ok=True)
    # Where this is, the caches beside the target may be the new ones.
    begun = made.with_name(f"{made.name}.begun")
    if caches_folder(made).is_dir():
        begun.touch()
        shutil.rmtree(caches_folder(target), ignore_errors=True)
        caches_folder(made).replace(caches_folder(target))
    elif not begun.exists():
        shutil.rmtree(caches_folder(target), ignore_errors=True)
    made.replace(target)
    begun.unlink(missing_ok=True)


def open_elsewhere(launch: Launch, blend: Path, *, timeout: float) -> FileContents:
    """Opens a .blend in a second Blender, which has nothing but the file and its caches. Raises Refusal."""
    try:
        with second_blender(launch, blend, caches_folder(blend)) as (process, _):
            request = {"path": str(blend)}
            return process.call("inspect", request, FileContents.model_validate, timeout=timeout).value
    except BlenderError as error:
        raise Refusal(f"the copy does not open in a second Blender: {error}") from error


def cache_faults(scene: FileContents, copy: FileContents | None) -> list[str]:
    """Sentences on caches that are marked as baked but incomplete, in the scene or in a copy of it."""
    copied = {cache.label: cache for cache in copy.caches} if copy is not None else {}
    faults: list[str] = []
    for cache in scene.caches:
        if not cache.baked:
            continue
        other = copied.get(cache.label)
        if cache.missing:
            faults.append(
                f"the cache of {cache.label} is marked as baked, but {cache.missing} of its frames are missing: "
                "bake it again"
            )
        elif copy is not None and (other is None or not other.baked or other.frames < cache.frames):
            faults.append(
                f"the cache of {cache.label} has {cache.frames} frames here, "
                f"but {other.frames if other else 0} in the copy"
            )
    return faults


# Loading


def find_blend_file(name: str, folder: RunFolder, read: tuple[Path, ...]) -> ReadableFile:
    """The file of that name, relative to the run's folder or absolute. Raises Refusal if it is not a .blend."""
    spelled = name if is_blend_name(name) else f"{name}.blend"
    blend_file = find_readable(spelled, folder, read)
    _check(blend_file, spelled, folder)
    return blend_file


def is_blend_name(name: str) -> bool:
    """Whether a file's name is that of a .blend or of a backup of one."""
    return _BLEND.search(name) is not None


def _check(blend_file: ReadableFile, name: str, folder: RunFolder) -> None:
    path = blend_file.path
    if path.parent == folder.checkpoints:
        raise Refusal(f"{name} is a checkpoint; go back to it with checkpoint={path.stem.lstrip('0')}.")
    try:
        with HostileGround(blend_file.root).open(blend_file.relative, at_most=_LARGEST) as file:
            head = file.read(HEAD)
    except NotThere as error:
        raise Refusal(f"There is no {name}. {describe_saved_files(folder)}") from error
    except Refusal as error:
        raise Refusal(f"{name} cannot be opened: it is a link or not a regular file.") from error
    if not head:
        raise Refusal(f"{name} is empty.")
    if not begins_blend(head):
        raise Refusal(f"{name} is not a .blend file.")


def describe_saved_files(folder: RunFolder) -> str:
    """A sentence that lists what was saved in the run's folder."""
    names = sorted(path.relative_to(folder.root).as_posix() for path in folder.saved)
    if not names:
        return "Nothing has been saved in this run."
    return f"Saved in this run: {format_list(names, _LISTED)}."


@contextmanager
def lent_to_blender(blend_file: ReadableFile, folder: RunFolder) -> Generator[str]:
    """A path at which Blender can read the file, and its caches beside it, but not change them. Raises Refusal.

    A file of the run is copied to where Blender may read; what lies in its workspace is its own anyway.
    """
    if blend_file.root != folder.root or folder.workspace.holds(blend_file.path):
        yield str(blend_file.path)
        return
    with folder.lending() as lent:
        copy = lent / blend_file.path.name
        with HostileGround(blend_file.root).open(blend_file.relative, at_most=_LARGEST) as source:
            copy_to(source, copy, durable=False)
        caches = caches_folder(blend_file.path)
        if caches.is_dir() and not caches.is_symlink():
            copy_folder(caches, caches_folder(copy))
        yield str(copy)
