"""Phrases written by themselves come into what ships, and go again where they do not find what they are for."""

from __future__ import annotations

import json
from contextlib import nullcontext
from typing import TYPE_CHECKING

import pytest

from measurements import ship_phrases

if TYPE_CHECKING:
    from pathlib import Path

QUALITY = "bpy.types.ClothSettings.quality"
MASS = "bpy.types.ClothSettings.mass"


@pytest.fixture
def corpora(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for folder in ("words", "summaries", "queries"):
        (tmp_path / folder).mkdir()
    (tmp_path / "words" / "query_expansions.txt").write_text(f"# Phrases.\n{QUALITY}: fabric shakes\n")
    page = ["physics/cloth", "0", "claude", "What cloth is.", ["flag in the wind"]]
    (tmp_path / "summaries" / "5.1.a-l.page-2.jsonl").write_text(json.dumps(page) + "\n")
    (tmp_path / "queries" / "dev.jsonl").write_text(json.dumps({"query": "How heavy is my textile?"}) + "\n")
    monkeypatch.setattr(ship_phrases, "_CORPORA", tmp_path)
    (tmp_path / "words" / "plain_questions.txt").write_text("# More.\n")
    names = ("query_expansions.txt", "plain_questions.txt")
    monkeypatch.setattr(ship_phrases, "_SYMBOLS", tuple(tmp_path / "words" / name for name in names))
    monkeypatch.setattr(ship_phrases, "_PAGES", tmp_path / "summaries")
    return tmp_path


def test_only_what_says_something_new_is_added(corpora: Path) -> None:
    written = corpora / "written.txt"
    written.write_text(
        f"{MASS}: heavy textile; wool drapes down\n"
        f"{QUALITY}: shaking fabrics; finer solver steps\n"
        "physics/cloth: wind and flags; tablecloth falls\n"
        "bpy.types.ClothSettings.pin_stiffness: -\n"
    )
    ship_phrases.add(str(written))
    assert (
        corpora / "words" / "query_expansions.txt"
    ).read_text() == f"# Phrases.\n{QUALITY}: fabric shakes\n"
    assert (corpora / "words" / "plain_questions.txt").read_text() == (
        f"# More.\n{MASS}: wool drapes down\n{QUALITY}: finer solver steps\n"
    )
    (page,) = (corpora / "summaries" / "5.1.a-l.page-2.jsonl").read_text().splitlines()
    assert json.loads(page)[4] == ["flag in the wind", "tablecloth falls"]


def test_what_does_not_find_its_symbol_goes_again(
    corpora: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    written = corpora / "written.txt"
    written.write_text(f"{QUALITY}: finer solver steps; something else entirely\n")
    ship_phrases.add(str(written))
    monkeypatch.setattr(ship_phrases, "finds", lambda _base, phrase, _ref: phrase.startswith("finer"))
    monkeypatch.setattr(ship_phrases, "KnowledgeBase", lambda _path: nullcontext())
    ship_phrases.keep("no.sqlite", str(written))
    table = (corpora / "words" / "plain_questions.txt").read_text()
    assert table == f"# More.\n{QUALITY}: finer solver steps\n"
    assert capsys.readouterr().out.startswith("1 of 2 phrases")
