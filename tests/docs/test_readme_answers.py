"""What the README shows of answers is what is answered."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from places import REPO

from kb_serve.knowledge_base import KnowledgeBase

if TYPE_CHECKING:
    from pathlib import Path

_SHOWN = re.compile(
    r"^````console\n\$ simworlds docs --limit 1 '([^\n]+)'\n(.*?)^````$", re.MULTILINE | re.DOTALL
)
_OF_THE_MANUAL = re.compile(r"^manual: .*\n+|^\*\*In the manual\*\*.*(?:\n.+)*", re.MULTILINE)
SHOWN: list[tuple[str, str]] = _SHOWN.findall((REPO / "README.md").read_text(encoding="utf-8"))


def without_manual(answer: str) -> list[str]:
    """The lines that do not depend on which manual the base was built with."""
    return [line for line in _OF_THE_MANUAL.sub("", answer).splitlines() if line.strip()]


def test_the_readme_shows_answers() -> None:
    assert len(SHOWN) > 1


@pytest.mark.parametrize(("query", "answer"), SHOWN)
def test_an_answer_is_as_the_readme_shows_it(base: Path, query: str, answer: str) -> None:
    with KnowledgeBase(base) as kb:
        assert without_manual(kb.query(query, limit=1).text) == without_manual(answer)
