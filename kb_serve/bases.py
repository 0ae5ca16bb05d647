"""The open knowledge bases, by version; a base is opened again when its file is replaced."""

from __future__ import annotations

import contextlib
import time
from dataclasses import dataclass
from functools import cached_property
from threading import RLock
from typing import TYPE_CHECKING

from kb_serve.errors import BaseUnreadable
from kb_serve.in_use import blender_in_use
from kb_serve.locate import find_base
from simworlds.releases import minor_of
from simworlds.settings import built_bases

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from kb_serve.knowledge_base import KnowledgeBase

_CHECK_SECONDS = 1.0

_Stamp = tuple[int, int, int]


@dataclass(slots=True)
class _Opened:
    base: KnowledgeBase
    stamp: _Stamp
    checked: float


class Bases:
    """The bases in a home folder, by version. Safe to share between threads.

    A base that ``pick`` returns stays open until a later call finds its file replaced: use it at once.
    """

    def __init__(
        self,
        home: Path,
        *,
        default: str | None = None,
        blender_exe: Path | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """``default`` is the version to use where a caller names none; ``clock`` gives seconds."""
        self.home = home
        self.default = default
        self._blender_exe = blender_exe
        self._clock = clock
        self._opened: dict[Path, _Opened] = {}
        self._built: tuple[float, dict[str, Path]] = (0.0, {})
        self._lock = RLock()

    def pick(self, version: str | None = None) -> KnowledgeBase:
        """The base of a version. Without one: of the default, of the Blender in use, or the newest.

        Raises BaseMissing, with a list of those built, and BaseUnreadable.
        """
        with self._lock:
            return self._open(self.file(version))

    def built(self) -> dict[str, Path]:
        """Minor version → file, oldest Blender first; read from disk at most once a second."""
        with self._lock:
            read_at, built = self._built
            if not built or self._clock() - read_at >= _CHECK_SECONDS:
                built = built_bases(self.home)
                self._built = (self._clock(), built)
            return built

    def wanted_but_missing(self) -> str | None:
        """The default version if it has no base, ``""`` where no version has one, None where nothing is missing."""
        built = self.built()
        if self.default is not None:
            return None if minor_of(self.default) in built else self.default
        return None if built else ""

    @cached_property
    def in_use(self) -> str | None:
        """The full version of the Blender in use."""
        return blender_in_use(self._blender_exe)

    def close(self) -> None:
        """Closes all files."""
        with self._lock:
            for opened in self._opened.values():
                opened.base.close()
            self._opened.clear()

    def file(self, version: str | None = None) -> Path:
        """The file of that base, chosen as ``pick`` does. Raises BaseMissing."""
        version = version or self.default
        built = self.built()
        if version is None and len(built) > 1 and self.in_use is not None:
            in_use = minor_of(self.in_use)
            version = in_use if in_use in built else None
        path = built.get(version) if version is not None else next(reversed(built.values()), None)
        return path or find_base(version, self.home)

    def _open(self, path: Path) -> KnowledgeBase:
        opened = self._opened.get(path)
        now = self._clock()
        if opened is not None and now - opened.checked < _CHECK_SECONDS:
            return opened.base
        stamp = _stamp(path)
        if opened is not None:
            opened.checked = now
            if stamp in (None, opened.stamp):
                return opened.base
        from kb_serve.knowledge_base import KnowledgeBase  # noqa: PLC0415 - loaded while the client connects

        with contextlib.suppress(BaseUnreadable) if opened is not None else contextlib.nullcontext():
            base = KnowledgeBase(path)
            # The stamp is older than the open file: a replacement in between is noticed next time.
            self._opened[path] = _Opened(base, stamp or (0, 0, 0), now)
            if opened is not None:
                opened.base.close()
        return self._opened[path].base


def _stamp(path: Path) -> _Stamp | None:
    try:
        stat = path.stat()
    except OSError:
        return None
    return stat.st_ino, stat.st_mtime_ns, stat.st_size
