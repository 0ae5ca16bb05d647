"""Text is cut to fit, never lost."""

from __future__ import annotations

import random

import pytest

from kb_serve.answer.budget import AnswerBlock, clip, paginate, tokens

WORDS = (
    "the",
    "quality",
    "of",
    "cloth",
    "🎨",
    "größer",
    "naïve",
    "—",
    "`bpy.types.ClothSettings.quality`",
    "x",
)


def text_of(chance: random.Random, size: int) -> str:
    """Prose, long lines, blank lines, lists, and words without any blank."""
    pieces = [chance.choice([*WORDS, "\n", "\n\n", "- ", "  ", "y" * 400]) for _ in range(size)]
    return " ".join(pieces).strip() or "x"


def squeezed(text: str) -> str:
    return "".join(text.split())


def test_tokens_are_never_fewer_than_a_third_of_the_bytes() -> None:
    assert [tokens(text) for text in ("", "a", "abc", "abcd", "é" * 3, "🎨" * 3)] == [0, 1, 1, 2, 2, 4]
    assert tokens("\ud800" * 3) == 1


@pytest.mark.parametrize("budget", [0, 1, 2, 3, 5, 10, 50])
def test_a_clipped_text_fits_and_is_a_beginning(budget: int) -> None:
    chance = random.Random(budget)
    for size in (1, 2, 5, 40):
        for text in (
            text_of(chance, size),
            "z" * 50 * size,
            " " * 40 + "z" * 9,
            "🎨" * 30,
            "\n" * 200,
            "ü" * 90,
        ):
            shown = clip(text, budget)
            assert tokens(shown) <= max(budget, 2)
            assert shown == text or (shown.endswith("…") and text.startswith(shown.removesuffix(" …")))


def test_what_fits_is_not_clipped() -> None:
    assert clip("as it is", 3) == "as it is"


@pytest.mark.parametrize("seed", range(40))
def test_every_part_fits_and_nothing_is_lost(seed: int) -> None:
    chance = random.Random(seed)
    blocks = [
        AnswerBlock(text_of(chance, chance.randrange(1, 120)), f"block {n}")
        for n in range(chance.randrange(1, 12))
    ]
    budget = chance.randrange(10, 400)
    parts = paginate(blocks, budget)
    assert max(tokens(text) for text, _ in parts) <= budget
    assert squeezed("".join(text for text, _ in parts)) == squeezed("".join(block.text for block in blocks))
    assert parts[-1][1] == []


def test_remaining_blocks_are_named_in_order() -> None:
    blocks = [
        AnswerBlock("a " * 60, "first"),
        AnswerBlock("b " * 60, "second"),
        AnswerBlock("c " * 60, "third"),
    ]
    assert [left for _, left in paginate(blocks, 45)] == [["second", "third"], ["third"], []]


def test_blocks_that_fit_share_a_part() -> None:
    blocks = [AnswerBlock("one", "a"), AnswerBlock("two", "b"), AnswerBlock("three", "c")]
    assert paginate(blocks, 100) == [("one\n\ntwo\n\nthree", [])]


def test_a_block_is_not_begun_where_little_room_is_left() -> None:
    blocks = [AnswerBlock("x" * 80), AnswerBlock("y\n" * 30)]
    assert [text[:1] for text, _ in paginate(blocks, 32)] == ["x", "y"]


def test_nothing_is_one_empty_part() -> None:
    assert paginate([], 10) == [("", [])]
