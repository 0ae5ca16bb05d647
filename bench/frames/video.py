"""Frames of an untrusted video or picture file.

Decoders are large programs that parse untrusted data. They run in their own process (``decode_video.py``), sandboxed
like Blender: no network, no child process, read access to the file only, write access to one folder, limits of memory
and time.
"""

from __future__ import annotations

import json
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from bench.audit.untrusted_blend import NotScored
from simworlds.processes import CommandFailed, CommandTimedOut, run_group
from simworlds.sandbox.confinement.confined_command import best_sandbox, own_python
from simworlds.sandbox.confinement.resource_limits import GIB, ResourceLimits
from simworlds.sandbox.runtime import clean_environment

if TYPE_CHECKING:
    from collections.abc import Sequence

PICTURES = (".png", ".jpg", ".jpeg", ".webp")
VIDEOS = (".mp4", ".webm", ".mkv", ".mov", ".avi", ".gif")
SECONDS = 120.0
_SCRIPT = Path(__file__).with_name("decode_video.py")
_LIMITS = ResourceLimits(memory=2 * GIB, file_size=GIB // 4)
_LARGEST = 256 << 20  # bytes of a picture


def pictures(source: Path, shares: Sequence[float]) -> list[bytes]:
    """The frames (PNG) at ``shares`` (0 to 1) of a video, or a picture file as a frame. Raises NotScored."""
    path = source.expanduser().resolve()
    if not path.is_file():
        raise NotScored(f"there is no file {source.name}")
    if path.suffix.lower() not in PICTURES and find_spec("av") is None:
        raise NotScored(
            "reading a video needs the package av: install it with pip install 'simworlds[video]'"
        )
    with tempfile.TemporaryDirectory(prefix="simworlds-frames-", ignore_cleanup_errors=True) as place:
        folder = Path(place).resolve()
        _decode(path, shares, folder)
        return [_read(folder / f"{number}.png") for number in range(len(shares))]


def _decode(path: Path, shares: Sequence[float], folder: Path) -> None:
    words = [sys.executable, "-I", str(_SCRIPT), str(path), str(folder), json.dumps(list(shares))]
    readable = [_SCRIPT, path, *map(Path, own_python())]
    command = best_sandbox(limits=_LIMITS).command(words, read=readable, write=[folder])
    try:
        run_group(
            command, environment=clean_environment(folder), timeout=SECONDS, log=folder / "log", folder=folder
        )
    except CommandTimedOut:
        raise NotScored(
            f"{path.name} was still being decoded after the time limit of {SECONDS:g} s"
        ) from None
    except CommandFailed as error:
        reason = error.tail.splitlines()[-1][:200] if error.tail else str(error)
        raise NotScored(f"{path.name} cannot be decoded: {reason}") from error


def _read(path: Path) -> bytes:
    """What the process wrote, if it is a plain file."""
    try:
        if path.is_symlink() or not path.is_file() or path.stat().st_size > _LARGEST:
            raise NotScored("a decoded frame is not a picture")
        return path.read_bytes()
    except OSError as error:
        raise NotScored(f"a decoded frame cannot be read: {error.strerror or error}") from error
