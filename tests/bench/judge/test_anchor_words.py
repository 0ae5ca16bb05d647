"""Which words an item may stand on: fixed for the shipped prompts, whatever retrieval makes of words."""

from __future__ import annotations

from pathlib import Path

import pytest

from bench.judge.anchor_words import content_stems
from bench.judge.items import items_reader
from bench.scenes.spec import specs

STEMS = dict(
    line.split(": ") for line in Path(__file__).with_name("prompt_stems.txt").read_text().splitlines()
)


@pytest.mark.parametrize("spec", specs(), ids=lambda spec: spec.id)
def test_shipped_prompts_keep_their_stems(spec):
    assert " ".join(content_stems(spec.prompt)) == STEMS[spec.id]


def test_there_are_stems_for_the_shipped_prompts_only():
    assert STEMS.keys() == {spec.id for spec in specs()}


@pytest.mark.parametrize(
    ("words", "text", "is_accepted"),
    [
        ("two parrots", "both parrots sit", True),
        ("leaning parrots", "a parrot leans", True),
        ("two parrots", "two birds", True),  # the number is a content word
        ("the blender", "a blender on the counter", True),
        ("the crate", "the box", False),
        ("on the", "it is on the crate", False),  # function words alone
    ],
)
def test_an_item_shares_a_content_word_with_its_quotation(words, text, is_accepted):
    prompt = f"Here are {words}, at noon."
    accepted, faults = items_reader(prompt, static=True)(
        {"objects": [{"words": words, "text": text}], "relations": [], "actions": []}
    )
    assert (accepted is not None) == is_accepted, faults
