"""The public API of a knowledge base: ``KnowledgeBase.open("5.1").query("cloth self collision")``."""

from __future__ import annotations

import re
from importlib import import_module
from threading import Lock
from typing import TYPE_CHECKING, Self

from kb_serve.answer.composer import AnswerComposer
from kb_serve.locate import find_base
from kb_serve.query_limits import LIMIT, MAX_TOKENS
from kb_serve.reader import BaseReader

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path
    from types import TracebackType

    from kb_build.pages.page import Page
    from kb_build.symbols.records import Symbol
    from kb_serve.answer.docs_answer import DocsAnswer


# Look-ups and rows of a query. The labelled queries take up to 11,000, and the first one loads 20,000 names more.
_MOST_WORK = 150_000
# What code has that words have not.
_CODE = re.compile(
    r"[\w\])] *(?:[-+*/%@|&^]|//|\*\*)?=[^=]|[!=]= ?[\"']|\w\([^)]|^[ \t]*(?:for|class|def|with|if) .*:",
    re.MULTILINE,
)


class KnowledgeBase:
    """One Blender version's knowledge base, read-only. Safe to share between threads."""

    def __init__(self, path: Path) -> None:
        """Opens a base file. Raises BaseMissing or BaseUnreadable, which say what to do."""
        self._reader = BaseReader(path)
        self._composer = AnswerComposer(self._reader, _notes_on_code)
        self._lock = Lock()

    @classmethod
    def open(cls, version: str | None = None, *, home: Path | None = None) -> Self:
        """Opens the base of a Blender version (``"5.1"``, ``"5.1.2"``), by default the newest that was built.

        ``home`` is the folder of the bases: by default what SIMWORLDS_HOME names, else the user's data folder.
        Raises BaseMissing if it was not built.
        """
        return cls(find_base(version, home))

    def query(
        self,
        text: str,
        *,
        limit: int = LIMIT,
        max_tokens: int = MAX_TOKENS,
        part: int = 1,
        command: str = "",
    ) -> DocsAnswer:
        """Answers a query in any form: a name, an expression, an error message, a question, a topic.

        ``limit`` bounds the hits, ``max_tokens`` the text; what does not fit is in the further parts, counted
        from 1. ``command`` is what asks, if it is typed in a shell: the answer then says how to type the next call.
        Raises BadQuery for an empty query, one that takes too much work, or a wrong limit or part.
        """
        with self._lock, self._reader.bounded(_MOST_WORK):
            return self._composer.answer(text, limit, max_tokens, part, command)

    def symbol(self, path: str) -> Symbol | None:
        """The raw record of an identifier, as the base spells it."""
        with self._lock:
            return self._reader.symbol(path)

    def page(self, slug: str) -> Page | None:
        """The whole raw record of a page."""
        with self._lock:
            return self._reader.manual.page(slug)

    @property
    def meta(self) -> dict[str, str]:
        """Facts about the base: Blender's version and build, fingerprint, sources, what is missing."""
        with self._lock:
            return self._reader.meta

    @property
    def reader(self) -> BaseReader:
        """What reads the base, for parts that work beside it; not for several threads at once."""
        return self._reader

    @property
    def path(self) -> Path:
        """The base's file."""
        return self._reader.path

    def close(self) -> None:
        """Closes the file."""
        with self._lock:
            self._reader.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _notes_on_code(reader: BaseReader, query: str) -> Sequence[str]:
    """What is wrong in the code of a query. Said by the checker, which is built on this part: it stands here by name,
    and is loaded with the first code.
    """
    if _CODE.search(query) is None:
        return ()
    return import_module("kb_check.in_queries").notes_on_code(reader, query)
