"""A cache of answers, keyed by the content of the question: one file per answer, written atomically.

An entry has the digest of its value; an entry that does not match (damaged, edited, of another shape) is ignored and
replaced. If another process is asking the same question, callers wait for its answer.
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
from simworlds.operating_system import SYSTEM

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Mapping
    from pathlib import Path

M = TypeVar("M", bound=BaseModel)
_LOG = logging.getLogger(__name__)


def key_of(ingredients: Mapping[str, object]) -> str:
    """The SHA-256 of everything that an answer depends on."""
    return hashlib.sha256(json.dumps(ingredients, sort_keys=True).encode()).hexdigest()


class AnswerCache:
    """A folder of answers. Without a folder, nothing is kept."""

    def __init__(self, folder: Path | None) -> None:
        self._folder = None if folder is None else folder.expanduser().absolute()

    def load(self, kind: str, key: str, shape: type[M]) -> M | None:
        """The valid answer for a key, or None."""
        if self._folder is None:
            return None
        try:
            entry = json.loads(self._path(kind, key).read_bytes())
            written = json.dumps(entry["value"], sort_keys=True)
            return shape.model_validate_json(written) if entry["sha256"] == _sha256(written) else None
        except (OSError, ValueError, KeyError, TypeError, RecursionError, ValidationError):
            return None

    def load_or_make(self, kind: str, key: str, shape: type[M], make: Callable[[], M]) -> M:
        """The answer for a key; if there is none, calls ``make`` and keeps its result.

        Raises NotJudged, before calling ``make``, if the folder cannot be written.
        """
        if self._folder is None:
            return make()
        with self._locked(key):
            answer = self.load(kind, key, shape)
            if answer is None:
                answer = make()
                self._write(self._path(kind, key), answer)
            return answer

    def _path(self, kind: str, key: str) -> Path:
        assert self._folder is not None
        return self._folder / kind / f"{key}.json"

    @contextmanager
    def _locked(self, key: str) -> Generator[None]:
        """Locks the keys with the same first two letters for one thread of one process."""
        assert self._folder is not None
        try:
            (self._folder / "locks").mkdir(parents=True, exist_ok=True)
            file = (self._folder / "locks" / key[:2]).open("w")
        except OSError as error:
            raise NotJudged(
                "cache", f"Cannot keep answers in {self._folder}: {error.strerror}. Choose another --cache."
            ) from error
        with file:
            SYSTEM.lock(file, wait=True)
            yield

    def _write(self, path: Path, value: BaseModel) -> None:
        """Writes an answer; if that fails, it only warns, since the answer is paid for and valid."""
        plain = value.model_dump(mode="json")
        written = json.dumps(plain, sort_keys=True)
        text = json.dumps({"sha256": _sha256(written), "value": plain}, indent=1, ensure_ascii=False)
        try:
            write_whole(path, text)
        except OSError as error:
            _LOG.warning("Cannot write %s, so this question will be asked again: %s", path, error.strerror)


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
