"""What was asked and answered, kept by content: a file for each answer, written whole or not at all.

An entry carries the digest of what it holds; one that does not fit it (half written, changed, of another shape) is as
good as none, and is written anew. Who wants an answer that another process is just asking for waits for it.
"""

from __future__ import annotations

import hashlib
import json
import logging
from contextlib import contextmanager
from typing import TYPE_CHECKING, TypeVar

from pydantic import BaseModel, ValidationError

from bench.judge.errors import NotJudged
from simworlds.files import write_whole

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Mapping
    from pathlib import Path

M = TypeVar("M", bound=BaseModel)
_LOG = logging.getLogger(__name__)


def key_of(ingredients: Mapping[str, object]) -> str:
    """The SHA-256 of what an answer depends on."""
    return hashlib.sha256(json.dumps(ingredients, sort_keys=True).encode()).hexdigest()


class Store:
    """A folder of answers. Without one, nothing is kept."""

    def __init__(self, folder: Path | None) -> None:
        self._folder = None if folder is None else folder.expanduser().absolute()

    def kept(self, kind: str, key: str, shape: type[M]) -> M | None:
        """What is kept under a key, if it is sound."""
        if self._folder is None:
            return None
        try:
            entry = json.loads(self._path(kind, key).read_bytes())
            written = json.dumps(entry["value"], sort_keys=True)
            return shape.model_validate_json(written) if entry["sha256"] == _sha256(written) else None
        except (OSError, ValueError, KeyError, TypeError, RecursionError, ValidationError):
            return None

    def once(self, kind: str, key: str, shape: type[M], make: Callable[[], M]) -> M:
        """What is kept under a key, or else what ``make`` gives, which is then kept.

        Raises NotJudged, before anything is made, where nothing can be kept.
        """
        if self._folder is None:
            return make()
        with self._alone(key):
            found = self.kept(kind, key, shape)
            if found is None:
                found = make()
                self._write(self._path(kind, key), found)
            return found

    def _path(self, kind: str, key: str) -> Path:
        assert self._folder is not None
        return self._folder / kind / f"{key}.json"

    @contextmanager
    def _alone(self, key: str) -> Generator[None]:
        """Holds the keys that begin as this one does, for one thread of one process."""
        import fcntl  # noqa: PLC0415 - not on Windows

        assert self._folder is not None
        try:
            (self._folder / "locks").mkdir(parents=True, exist_ok=True)
            file = (self._folder / "locks" / key[:2]).open("w")
        except OSError as error:
            raise NotJudged("cache", f"{self._folder} cannot keep answers: {error.strerror}.") from error
        with file:
            fcntl.flock(file, fcntl.LOCK_EX)
            yield

    def _write(self, path: Path, value: BaseModel) -> None:
        """An answer that cannot be kept is an answer all the same: it was paid for."""
        plain = value.model_dump(mode="json")
        written = json.dumps(plain, sort_keys=True)
        text = json.dumps({"sha256": _sha256(written), "value": plain}, indent=1, ensure_ascii=False)
        try:
            write_whole(path, text)
        except OSError as error:
            _LOG.warning("%s cannot be written, so this will be asked again: %s", path, error.strerror)


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
