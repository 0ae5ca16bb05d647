"""Files that Blender is to import, with those that they refer to, at a place that it can read and not change."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from simworlds.sandbox.errors import NotThere, Refusal
from simworlds.sandbox.hostile_ground import HostileGround, copy_to

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator
    from pathlib import Path

    from agents.blender.files.readable_files import ReadableFile
    from agents.blender.files.run_folder import RunFolder

_LARGEST = 8 << 30  # bytes of a file
_MOST_BYTES = 8 << 30  # that are copied for one import
_MOST_FILES = 2000


def check_there(file: ReadableFile, name: str) -> int:
    """The bytes of a regular file that is not empty. Raises Refusal."""
    try:
        with HostileGround(file.root).open(file.relative, at_most=_LARGEST) as opened:
            size = opened.seek(0, 2)
    except NotThere as error:
        raise Refusal(f"There is no {name[:300]}.") from error
    except Refusal as error:
        raise Refusal(
            f"{name[:300]} cannot be opened: it is a link, not a regular file, or too large."
        ) from error
    if not size:
        raise Refusal(f"{name[:300]} is empty.")
    return size


@contextmanager
def lent_for_import(file: ReadableFile, folder: RunFolder) -> Generator[dict[str, str]]:
    """For Blender: the ``path`` at which it can read a file, and the folder that it may refer to. Raises Refusal.

    From folders that Blender may read, and from its own workspace, nothing is copied. Of the run's root itself, only
    the file and those that are named after it.
    """
    if file.root != folder.root:
        yield {"path": str(file.path), "root": str(file.root)}
        return
    if folder.workspace.holds(file.path):
        yield {"path": str(file.path), "root": folder.workspace.for_blender()}
        return
    if owner := folder.owner_of(file.relative):
        raise Refusal(
            f"{file.relative.split('/')[0]}/ is reserved for {owner}; files cannot be imported from it."
        )
    with folder.lending() as lent:
        copied = 0
        for number, source in enumerate(_companions(file, folder)):
            if number >= _MOST_FILES:
                raise Refusal(
                    f"{file.path.parent} has more than {_MOST_FILES} files; import from a smaller folder."
                )
            relative = source.relative_to(folder.root).as_posix()
            with HostileGround(folder.root).open(relative, at_most=_LARGEST) as opened:
                copied += opened.seek(0, 2)
                opened.seek(0)
                if copied > _MOST_BYTES:
                    raise Refusal(f"{file.path.parent} has more than {_MOST_BYTES >> 30} GiB of files.")
                copy_to(opened, lent / source.relative_to(file.path.parent), durable=False)
        yield {"path": str(lent / file.path.name), "root": str(lent)}


def _companions(file: ReadableFile, folder: RunFolder) -> Iterator[Path]:
    """The file, and the regular files that it may refer to."""
    path = file.path
    if path.parent == folder.root:
        yield from (other for other in path.parent.glob("*") if other.stem == path.stem and _is_plain(other))
        return
    yield from (other for other in path.parent.rglob("*") if _is_plain(other))


def _is_plain(path: Path) -> bool:
    return path.is_file() and not path.is_symlink()
