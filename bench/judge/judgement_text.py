"""Formats judgements, their agreement and their cost as lines of text."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from bench.judge.agreement import Agreed, Agreement
    from bench.judge.estimate import Question
    from bench.judge.verdicts import Item, Judgement
    from simworlds.llm.spending import SpendingRow

_WIDTH = 110


def judgement_lines(
    judged: Sequence[Judgement], agreed: Agreement | None, spent: SpendingRow
) -> Iterator[str]:
    """Each judgement, how far they agree, and what they cost now."""
    for one in judged:
        yield from _judgement(one)
        yield ""
    if agreed:
        yield from _agreement(agreed)
        yield ""
    if not spent.calls:
        yield "Nothing was asked now: all answers were cached."
    else:
        cost = None if spent.unpriced else spent.cost
        yield (
            f"Asked now: {spent.calls} request{'s' if spent.calls > 1 else ''}, {_usd(cost)}, "
            f"{spent.usage.prompt:,} tokens in, {spent.usage.output:,} out"
        )


def _judgement(one: Judgement) -> Iterator[str]:
    label = f"{one.scene}: " if one.scene else ""
    again = f", repetition {one.repetition}" if one.repetition else ""
    yield f"{label}{one.provider}/{one.answered_by}, prompts {one.prompt_version}, items by {one.items_by}{again}"
    for name, items in one.dimensions.items():
        yield ""
        yield f"{name} {_number(one.scores[name])}"
        for item in items:
            yield from _item(item)
    yield ""
    yield (
        f"score {_number(one.score)}   {_usd(one.cost)}, plus {_usd(one.items_cost)} once for the prompt; "
        f"{one.usage.input:,} tokens in, {one.usage.output:,} out"
    )


def _item(item: Item) -> Iterator[str]:
    frames = f" [{', '.join(map(str, item.frames))}]" if item.frames else ""
    yield f"  {'✓' if item.holds else '✗'} {item.text}"
    yield click.wrap_text(f"{item.evidence}{frames}", _WIDTH, "      ", "      ")


def _agreement(agreed: Agreement) -> Iterator[str]:
    yield f"agreement of {agreed.judgements} judgements     κ  pairwise   score ± sd"
    for name, one in (*agreed.dimensions.items(), ("all items", agreed.overall)):
        yield _agreed(name, one)
    split = {name: share for name, share in agreed.shares.items() if 0 < share < 1}
    if split:
        yield f"disagreement on {', '.join(f'{name} ({share:.2f})' for name, share in split.items())}"


def _agreed(name: str, one: Agreed) -> str:
    sd = "" if one.sd is None else f" ± {one.sd:.3f}"
    return f"  {name:<22}{_number(one.kappa):>11}{_number(one.pairwise):>10}   {_number(one.mean)}{sd}"


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.3f}"


def _usd(value: float | None) -> str:
    return "price unknown" if value is None else f"${value:.4f}"


def question_lines(one: Question) -> Iterator[str]:
    """A question of a dry run."""
    times = "cached, not asked" if not one.times else f"asked {one.times} time{'s' if one.times > 1 else ''}"
    yield f"═══ {one.stage}: {times}, {one.pictures} pictures, about {one.tokens:,} tokens ═══"
    yield one.system
    yield "─── the user ───"
    yield from one.said
    yield ""


def sum_lines(questions: Sequence[Question], who: str) -> Iterator[str]:
    """What all questions together would cost at ``who``."""
    yield f"{who} would be asked:"
    for stage in dict.fromkeys(one.stage for one in questions):
        rows = [one for one in questions if one.stage == stage]
        size = sum(one.tokens * one.times for one in rows)
        pictures = sum(one.pictures * one.times for one in rows)
        yield (
            f"  {stage:<9}{sum(one.times for one in rows):>5} times, {size:>9,} tokens with {pictures} pictures in: "
            f"{_bounds(rows)}"
        )
    yield "An invalid answer is asked for again, at most twice. Tokens are estimates and tend to be too high."


def _bounds(questions: Sequence[Question]) -> str:
    cost = _total((one.cost, one.times) for one in questions)
    most = _total((one.most, one.times) for one in questions)
    if cost is None or most is None:
        return "the model's price is unknown; give it with --price"
    return f"{_usd(cost)} without the answers, {_usd(most)} with the longest possible ones"


def _total(costs: Iterable[tuple[float | None, int]]) -> float | None:
    total = 0.0
    for cost, times in costs:
        if cost is None:
            return None
        total += cost * times
    return total
