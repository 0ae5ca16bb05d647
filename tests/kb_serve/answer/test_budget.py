"""Text is cut into parts that no budget changes, and shown as far as it fits; nothing is lost."""

from __future__ import annotations

import random

import pytest

from kb_serve.answer.budget import PART_TOKENS, AnswerBlock, clip, cut, names_of, shown, tokens

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


def blocks_of(chance: random.Random) -> list[AnswerBlock]:
    return [
        AnswerBlock(text_of(chance, chance.randrange(1, 120)), f"block {n}")
        for n in range(chance.randrange(1, 12))
    ]


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
            part = clip(text, budget)
            assert tokens(part) <= max(budget, 2)
            assert part == text or (part.endswith("…") and text.startswith(part.removesuffix(" …")))


def test_what_fits_is_not_clipped() -> None:
    assert clip("as it is", 3) == "as it is"


@pytest.mark.parametrize("seed", range(40))
def test_every_part_is_short_and_nothing_is_lost(seed: int) -> None:
    blocks = blocks_of(random.Random(seed))
    parts = cut(blocks)
    assert max(tokens(part.text) for part in parts) <= PART_TOKENS
    whole = "".join(part.glue + part.text for part in parts).removeprefix("\n\n")
    assert whole == "\n\n".join(block.text for block in blocks)
    assert names_of(parts) == [block.name for block in blocks]


@pytest.mark.parametrize("seed", range(40))
def test_going_on_where_an_answer_ended_shows_everything_once_for_any_budget(seed: int) -> None:
    chance = random.Random(seed)
    blocks = blocks_of(chance)
    parts, number, told = cut(blocks), 0, ""
    while number < len(parts):
        budget = chance.randrange(PART_TOKENS, 400)
        text, after = shown(parts, number, budget)
        assert tokens(text) <= budget
        assert after > number
        told, number = told + text, after
    assert squeezed(told) == squeezed("".join(block.text for block in blocks))


@pytest.mark.parametrize("seed", range(10))
def test_a_part_begins_at_the_same_word_for_every_budget(seed: int) -> None:
    chance = random.Random(seed)
    parts = cut(blocks_of(chance))
    first = chance.randrange(len(parts))
    small, large = (shown(parts, first, budget)[0] for budget in (PART_TOKENS, 1_000))
    assert large.startswith(small)


def test_blocks_that_fit_are_shown_together() -> None:
    parts = cut([AnswerBlock("one", "a"), AnswerBlock("two", "b"), AnswerBlock("three", "c")])
    assert shown(parts, 0, 100) == ("one\n\ntwo\n\nthree", 3)
    assert shown(parts, 1, 1) == ("two", 2)


def test_nothing_is_one_empty_part() -> None:
    assert shown(cut([]), 0, 10) == ("", 1)
