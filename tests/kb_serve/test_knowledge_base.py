"""The face that callers see."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from asking import paths

from kb_build.pages.page import Page
from kb_build.symbols.records import Symbol
from kb_serve.errors import BadQuery, BaseMissing, KBServeError
from kb_serve.knowledge_base import KnowledgeBase

if TYPE_CHECKING:
    from pathlib import Path

    from kb_serve.reader import BaseReader


def test_one_query_in_two_lines(base: Path) -> None:
    with KnowledgeBase(base) as kb:
        assert kb.query("ClothSettings.quality").hits[0].id == "bpy.types.ClothSettings.quality"


def test_names_are_answered_without_what_only_a_search_needs(base: Path) -> None:
    code = (
        "import sys\nfrom pathlib import Path\nfrom kb_serve.knowledge_base import KnowledgeBase\n"
        f"answer = KnowledgeBase(Path({str(base)!r})).query('bpy.types.Scene.frame_end')\n"
        "assert answer.hits[0].id == 'bpy.types.Scene.frame_end'\n"
        "assert 'numpy' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_the_raw_record_of_a_symbol_is_the_whole_of_it(kb: KnowledgeBase, reader: BaseReader) -> None:
    for path in paths(reader, "operator", 30):
        symbol = kb.symbol(path)
        assert isinstance(symbol, Symbol)
        assert symbol == reader.symbol(path)
    assert kb.symbol("bpy.types.Nothing") is None


def test_the_raw_record_of_a_page_is_whole(kb: KnowledgeBase) -> None:
    page = kb.page("physics/cloth/settings/index")
    assert isinstance(page, Page)
    assert page.breadcrumbs
    assert all(section.text for section in page.sections[:1])
    assert kb.page("nowhere") is None


def test_meta_describes_the_base(kb: KnowledgeBase, base: Path) -> None:
    assert kb.meta["blender"].startswith(kb.meta["minor"])
    assert kb.meta["fingerprint"]
    assert kb.path == base


def test_further_arguments_are_named(kb: KnowledgeBase) -> None:
    with pytest.raises(TypeError):
        kb.query("cloth", 3)  # type: ignore[misc]


def test_every_refusal_is_of_one_family() -> None:
    assert issubclass(BadQuery, KBServeError)
    assert issubclass(BaseMissing, KBServeError)


def test_after_an_error_the_next_query_is_answered(kb: KnowledgeBase) -> None:
    for _ in range(3):
        with pytest.raises(BadQuery):
            kb.query("")
        assert kb.query("cloth").hits
