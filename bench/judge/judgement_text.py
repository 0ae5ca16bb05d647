"""Formats judgements, their agreement and their cost as lines of text."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from bench.judge.agreement import Agreement, AgreementScores
    from bench.judge.estimate import QuestionEstimate
    from bench.judge.verdicts import JudgedItem, Judgement
    from simworlds.llm.spending import SpendingRow

_WIDTH = 110


def judgement_lines(
    judgements: Sequence[Judgement], agreement: Agreement | None, spent: SpendingRow
) -> Iterator[str]:
    """Each judgement, how far they agree, and what they cost now."""
    for judgement in judgements:
        yield from _judgement(judgement)
        yield ""
    if agreement:
        yield from _agreement(agreement)
        yield ""
    if not spent.calls:
        yield "Nothing was asked now: all answers were cached."
    else:
        cost = None if spent.unpriced else spent.cost
        yield (
            f"Asked now: {spent.calls} request{'s' if spent.calls > 1 else ''}, {_usd(cost)}, "
            f"{spent.usage.prompt:,} tokens in, {spent.usage.output:,} out"
        )


def _judgement(judgement: Judgement) -> Iterator[str]:
    label = f"{judgement.scene}: " if judgement.scene else ""
    again = f", repetition {judgement.repetition}" if judgement.repetition else ""
    judge = f"{judgement.provider}/{judgement.answered_by}"
    yield f"{label}{judge}, prompts {judgement.prompt_version}, items by {judgement.items_by}{again}"
    for name, items in judgement.dimensions.items():
        yield ""
        yield f"{name} {_number(judgement.scores[name])}"
        for item in items:
            yield from _item(item)
    yield ""
    yield (
        f"score {_number(judgement.score)}   {_usd(judgement.cost)}, plus {_usd(judgement.items_cost)} once for the "
        f"prompt; {judgement.usage.input:,} tokens in, {judgement.usage.output:,} out"
    )


def _item(item: JudgedItem) -> Iterator[str]:
    frames = f" [{', '.join(map(str, item.frames))}]" if item.frames else ""
    yield f"  {'✓' if item.holds else '✗'} {item.text}"
    yield click.wrap_text(f"{item.evidence}{frames}", _WIDTH, "      ", "      ")


def _agreement(agreement: Agreement) -> Iterator[str]:
    yield f"agreement of {agreement.judgements} judgements     κ  pairwise   score ± sd"
    for name, scores in (*agreement.dimensions.items(), ("all items", agreement.overall)):
        yield _scores_line(name, scores)
    split = {name: share for name, share in agreement.shares.items() if 0 < share < 1}
    if split:
        yield f"disagreement on {', '.join(f'{name} ({share:.2f})' for name, share in split.items())}"


def _scores_line(name: str, scores: AgreementScores) -> str:
    sd = "" if scores.sd is None else f" ± {scores.sd:.3f}"
    return (
        f"  {name:<22}{_number(scores.kappa):>11}{_number(scores.pairwise):>10}   {_number(scores.mean)}{sd}"
    )


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.3f}"


def _usd(value: float | None) -> str:
    return "price unknown" if value is None else f"${value:.4f}"


def question_lines(question: QuestionEstimate) -> Iterator[str]:
    """A question of a dry run."""
    times = (
        "cached, not asked"
        if not question.times
        else f"asked {question.times} time{'s' if question.times > 1 else ''}"
    )
    yield f"═══ {question.stage}: {times}, {question.pictures} pictures, about {question.tokens:,} tokens ═══"
    yield question.system
    yield "─── the user ───"
    yield from question.said
    yield ""


def sum_lines(questions: Sequence[QuestionEstimate], who: str) -> Iterator[str]:
    """What all questions together would cost at ``who``."""
    yield f"{who} would be asked:"
    for stage in dict.fromkeys(question.stage for question in questions):
        rows = [question for question in questions if question.stage == stage]
        times = sum(question.times for question in rows)
        size = sum(question.tokens * question.times for question in rows)
        pictures = sum(question.pictures * question.times for question in rows)
        yield (
            f"  {stage:<9}{times:>5} times, {size:>9,} tokens with {pictures} pictures in: {_bounds(rows)}"
        )
    yield "An invalid answer is asked for again, at most twice. Tokens are estimates and tend to be too high."


def _bounds(questions: Sequence[QuestionEstimate]) -> str:
    cost = _total((question.cost, question.times) for question in questions)
    most = _total((question.most, question.times) for question in questions)
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
