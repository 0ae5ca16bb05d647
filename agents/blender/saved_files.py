"""Saved files: a .blend in the run's folder, and beside it the folder of what cannot be packed into it."""

from __future__ import annotations

import re
import shutil
import stat
import tempfile
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from simworlds.sandbox.blender_process import BlenderProcess
from simworlds.sandbox.errors import BlenderError, Refusal, ToolBroke
from simworlds.sandbox.untrusted_files import copy_file, open_beneath
from simworlds.sandbox.usage import sweep

if TYPE_CHECKING:
    from collections.abc import Generator, Iterable

    from agents.blender.run_folder import RunFolder
    from simworlds.sandbox.launch import Launch

WRITTEN = ".saved.blend"  # in the workspace, while it is taken out
_STAGED = ".saving-"  # in the run's folder
_LENT = ".loading"  # in the workspace: what is to be opened
_MAGIC = (b"BLENDER", b"\x28\xb5\x2f\xfd", b"\x1f\x8b")  # plain, zstd (since 3.0), gzip (before)
_BLEND = re.compile(r"\.blend\d*$", re.IGNORECASE)
_LISTED = 12


class _Told(BaseModel):
    """What Blender tells: data from outside, checked for its shape."""

    model_config = ConfigDict(frozen=True)


class Cache(_Told):
    """A physics cache: frames that it is for, that it has, and how many that a bake would fill are missing."""

    label: str
    baked: bool
    outdated: bool
    range: list[int] = Field(min_length=2, max_length=2)
    where: Literal["memory", "disk"]
    frames: int
    missing: int


class External(_Told):
    """A file that is used and not packed."""

    what: str
    path: str
    missing: bool


class Seen(_Told):
    """An open file."""

    objects: int
    caches: list[Cache]


class Written(Seen):
    """A file that was written; ``files`` are (path in the workspace, path in the folder beside the .blend)."""

    bytes: int
    packed: list[str]
    rescued: list[str]
    files: list[tuple[str, str]]
    external: list[External]


class Loaded(Seen):
    """A file that was opened as the run's own; ``scripts``: it has some, which were not run."""

    version: str
    scripts: bool
    external: list[External]


_Model = TypeVar("_Model", bound=BaseModel)


def checked(model: type[_Model], value: Any) -> _Model:
    """A reply as data. Raises ToolBroke if it is something else."""
    try:
        return model.model_validate(value)
    except ValidationError as error:
        raise ToolBroke("Blender's answer is not of the form that it should be", str(error)[:4000]) from error


def beside(blend: Path) -> Path:
    """The folder of a .blend's caches, called as Blender calls it."""
    return blend.with_name(f"blendcache_{blend.stem}")


# Saving


@contextmanager
def staging(folder: RunFolder) -> Generator[Path]:
    """A folder of the run in which a saved file is put together, out of executed code's reach. Raises Refusal."""
    try:
        for left in folder.root.glob(f"{_STAGED}*"):
            shutil.rmtree(left, ignore_errors=True)
        place = Path(tempfile.mkdtemp(prefix=_STAGED, dir=folder.root))
    except OSError as error:
        raise Refusal(f"{folder.root} cannot be written to: {error.strerror or error}.") from error
    try:
        yield place
    finally:
        shutil.rmtree(place, ignore_errors=True)


def take_all(folder: RunFolder, files: Iterable[tuple[str, str]], target: Path) -> tuple[int, int]:
    """Copies (path in the workspace, path below ``target``); returns how many and how many bytes. Raises Refusal."""
    count = total = 0
    for source, below in files:
        parts = PurePosixPath(below).parts
        if not parts or ".." in parts or below.startswith("/") or "\0" in source + below:
            raise Refusal(f"{below[:120]!r} cannot be a file of a cache.")
        with folder.open_made(source) as made:
            copied = target.joinpath(*parts)
            try:
                copied.parent.mkdir(parents=True, exist_ok=True)
                with copied.open("wb") as copy:
                    copy_file(made, copy)
                total += copied.stat().st_size
            except OSError as error:
                raise Refusal(f"a copy of {source} cannot be written: {error.strerror or error}") from error
        count += 1
    return count, total


def put_in_place(staged: Path, target: Path) -> None:
    """Moves a .blend and its caches to where they belong, or leaves whole what is there. Raises Refusal."""
    before = staged.with_name("before")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        if beside(target).exists():
            beside(target).rename(before)
        if beside(staged).exists():
            beside(staged).rename(beside(target))
        staged.replace(target)
    except OSError as error:
        if before.exists():
            shutil.rmtree(beside(target), ignore_errors=True)
            before.rename(beside(target))
        raise Refusal(f"{target} cannot be written: {error.strerror or error}.") from error


def look_afresh(launch: Launch, blend: Path, *, timeout: float) -> Seen:
    """What another Blender finds that has nothing but this .blend and the folder beside it.

    Raises Refusal if it does not open there.
    """
    with tempfile.TemporaryDirectory(prefix="simworlds-look-", ignore_cleanup_errors=True) as place:
        room = Path(place).resolve()
        read = [one for one in (blend, beside(blend)) if one.exists()]
        fresh = replace(
            launch, workspace=room / "workspace", private=room / "private", read=(*launch.read, *read)
        )
        for made in (fresh.workspace, fresh.private):
            made.mkdir()
        try:
            process = BlenderProcess(fresh)
            try:
                return checked(Seen, process.call("inspect", {"path": str(blend)}, timeout=timeout).value)
            finally:
                process.kill()
        except BlenderError as error:
            raise Refusal(f"the copy does not open in another Blender: {error}") from error


def faults(scene: Seen, copy: Seen | None) -> list[str]:
    """In words, which caches that pass for baked are not whole, in the scene or in a copy of it."""
    there = {cache.label: cache for cache in copy.caches} if copy is not None else {}
    told: list[str] = []
    for cache in scene.caches:
        if not cache.baked:
            continue
        found = there.get(cache.label)
        if cache.missing:
            told.append(
                f"the cache of {cache.label} passes for baked, but {cache.missing} of its frames are missing: "
                "bake it again"
            )
        elif copy is not None and (found is None or not found.baked or found.frames < cache.frames):
            told.append(
                f"the cache of {cache.label} has {cache.frames} frames here, "
                f"but {found.frames if found else 0} in the copy"
            )
    return told


# Loading


@dataclass(frozen=True, slots=True)
class Found:
    """A .blend that may be opened: below ``root``, one of the folders that it may come from."""

    root: Path
    relative: str

    @property
    def path(self) -> Path:
        """Where it lies."""
        return self.root / self.relative


def find(asked: str, folder: RunFolder, read: tuple[Path, ...]) -> Found:
    """The file that a caller names, relative to the run's folder or absolute. Raises Refusal if it is no .blend."""
    if "\0" in asked or len(asked) > 4096:
        raise Refusal(f"{asked[:120]!r} is no path.")
    name = asked if _BLEND.search(asked) else f"{asked}.blend"
    path = folder.root / name
    if ".." in Path(name).parts:
        raise Refusal(f"{asked[:120]!r} is no plain path: leave out '..'.")
    for root in (folder.root, *read):
        for spelled in {root, root.resolve()}:
            if path.is_relative_to(spelled) and path != spelled:
                found = Found(root, path.relative_to(spelled).as_posix())
                _check(found, name, folder)
                return found
    allowed = ", ".join(str(root) for root in (folder.root, *read))
    raise Refusal(f"{asked[:300]} may not be opened; what can be lies below {allowed}.")


def _check(found: Found, name: str, folder: RunFolder) -> None:
    if found.path.parent == folder.checkpoints:
        raise Refusal(f"{name} is a checkpoint; go back to it with checkpoint={found.path.stem.lstrip('0')}.")
    if not found.path.exists() and not found.path.is_symlink():
        raise Refusal(f"There is no {name}. {saved_files(folder)}")
    try:
        with open_beneath(found.root, found.relative) as file:
            head = file.read(7)
    except Refusal as error:
        raise Refusal(f"{name} cannot be opened: it is a link, or no plain file.") from error
    if not head:
        raise Refusal(f"{name} is empty.")
    if not head.startswith(_MAGIC):
        raise Refusal(f"{name} is no .blend file.")


def saved_files(folder: RunFolder) -> str:
    """In words, what was saved in the run's folder."""
    names = sorted(
        path.relative_to(folder.root).as_posix()
        for path in folder.root.rglob("*.blend")
        if path.parent not in (folder.workspace, folder.checkpoints)
        and not any(part.startswith(".") for part in path.relative_to(folder.root).parts)
        and folder.workspace not in path.parents
    )
    if not names:
        return "Nothing has been saved in this run."
    more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
    return f"Saved in this run: {', '.join(names[:_LISTED])}{more}."


@contextmanager
def lent(found: Found, folder: RunFolder) -> Generator[tuple[Path, bool]]:
    """(where Blender can read the file, whether that is a copy made for it). No call may run meanwhile but the load."""
    readable = found.root != folder.root or found.path.is_relative_to(folder.workspace)
    if readable:
        yield found.path, False
        return
    room = folder.workspace / _LENT
    try:
        clear(room)
        room.mkdir()
        copy = room / found.path.name
        with open_beneath(found.root, found.relative) as source, copy.open("wb") as target:
            copy_file(source, target)
        if beside(found.path).is_dir() and not beside(found.path).is_symlink():
            shutil.copytree(beside(found.path), beside(copy), symlinks=True)
    except (OSError, shutil.Error) as error:
        clear(room)
        raise Refusal(f"{found.path} cannot be copied into the workspace: {error}.") from error
    try:
        yield copy, True
    finally:
        clear(room)


def clear(place: Path) -> None:
    """Removes a file, link or folder of the workspace, whatever code has made of it."""
    with suppress(OSError):
        if stat.S_ISDIR(place.lstat().st_mode):
            sweep(place)
            place.rmdir()
        else:
            place.unlink()
