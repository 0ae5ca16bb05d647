"""What stands around a question changes nothing about its answer."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.answer.question_frame import without_frame

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

QUESTION = "bake the cloth of a flag"


@pytest.mark.parametrize(
    "framed",
    [
        f"{QUESTION}. Thanks!",
        f"{QUESTION}. Please help me, I am stuck",
        f"{QUESTION} please",
        f"{QUESTION}, thanks in advance!!",
        f"Hello, I'm new to Blender scripting. {QUESTION}",
        f"Hi all! {QUESTION}",
        f"I need help with this: {QUESTION}",
        f"give me code to {QUESTION}",
        f"{QUESTION} (Blender 5.1)",
        f"I have tried everything. {QUESTION}. It does not work in 5.1.",
    ],
)
def test_the_same_is_asked(kb: KnowledgeBase, framed: str) -> None:
    assert without_frame(framed).rstrip(".") == QUESTION
    assert kb.query(framed).hits == kb.query(QUESTION).hits


@pytest.mark.parametrize(
    "framed",
    [
        f"{QUESTION}. How do I do this in Python?",
        f"Write a Blender Python script that {QUESTION}",
        f"write me a short script: {QUESTION}",
    ],
)
def test_that_a_script_is_wanted_is_not_lost(kb: KnowledgeBase, framed: str) -> None:
    assert without_frame(framed).replace("flag.", "flag") == f"{QUESTION} in Python"
    assert kb.query(framed).hits == kb.query(f"{QUESTION} in Python").hits


def test_an_abbreviation_is_no_code() -> None:
    assert without_frame("a force field, e.g. wind, on cloth") == "a force field, wind, on cloth"
    assert without_frame("soft bodies (i.e. jelly)") == "soft bodies ( jelly)"


@pytest.mark.parametrize(
    "text",
    [
        "help",
        "Thanks!",
        "What is new in 5.1?",
        "write the script in VS Code and reload it each time",
        "Blender as a python module: what does not work",
        "RuntimeError: Error: Object 'Cube' already in collection 'Scene Collection'",
        "from . import operators, ui",
        "frame.strokes.new(); stroke.points.add(10)",
        "ValueError: register_class(...): already registered as a subclass 'HairPanel'",
        "select vertices (all)",
        "RuntimeError: Error: Please select a file",
        "",
    ],
)
def test_what_asks_something_stays(text: str) -> None:
    assert without_frame(text) == text


def test_a_sentence_that_follows_is_no_member(kb: KnowledgeBase) -> None:
    for text in (
        "Add a camera. Then render the scene",
        "I have a cube. Please unwrap it",
        "a light.How bright is it",
    ):
        assert not any("has no" in note for note in kb.query(text).notes)
