"""Judges frames by a prompt: lists the prompt's items, once, then asks for a verdict on each item.

The judge sees only the prompt and the frames: no plan, no audit, no name of a file or a system. Answers are cached by
content, so that nothing is asked twice; another ``repetition`` asks again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.judge.answer_cache import AnswerCache, key_of
from bench.judge.ask import ask_judge
from bench.judge.dimensions import dimensions
from bench.judge.errors import NotJudged
from bench.judge.items import PromptItems, items_of, one_line
from bench.judge.pictures import JudgedFrames, read_frames
from bench.judge.questions import judging, prompt_version
from bench.judge.verdicts import CachedVerdicts, JudgedItem, Judgement, verdicts_reader
from simworlds.llm.apis.claude_request import clean

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from bench.judge.providers import JudgeIdentity, JudgeProvider

LONGEST_PROMPT = 4000


def judge(  # noqa: PLR0913
    prompt: str,
    frames: Sequence[Path],
    *,
    static: bool,
    provider: JudgeProvider,
    cache: Path | None,
    scene: str = "",
    repetition: int = 0,
    tell: Callable[[str], object] = lambda _: None,
) -> Judgement:
    """Judges a result by its frames: evenly spaced over a film, with the first and the last; for a still, one.

    ``cache`` is the folder of cached answers. ``scene`` labels the judgement; no model sees it. ``tell`` is called with
    progress. Raises NotJudged.
    """
    text = checked_prompt(prompt)
    pictures = read_frames(frames, static=static)
    answers = AnswerCache(cache)
    tell("Listing the prompt's items")
    items = items_of(text, static=static, provider=provider, answers=answers)
    key = verdicts_key(text, items, pictures, provider.identity, static=static, repetition=repetition)

    def ask() -> CachedVerdicts:
        question = judging(text, items.texts(), pictures.pictures, static=static)
        answer = ask_judge(provider, question, verdicts_reader(items.texts(), len(pictures.pictures)))
        return CachedVerdicts(
            by=answer.by or provider.model, verdicts=answer.value.verdicts, spent=answer.spent
        )

    tell(f"Judging {len(items.items)} items by {len(frames)} frame{'s' if len(frames) > 1 else ''}")
    verdicts = answers.load_or_make("verdicts", key, CachedVerdicts, ask)
    return Judgement(
        scene=scene,
        provider=provider.name,
        model=provider.model,
        answered_by=verdicts.by,
        prompt_version=prompt_version(),
        repetition=repetition,
        dimensions=_judged(items, verdicts, static=static),
        usage=verdicts.spent.usage,
        cost=verdicts.spent.cost,
        items_by=items.by,
        items_usage=items.spent.usage,
        items_cost=items.spent.cost,
    )


def checked_prompt(prompt: str) -> str:
    """A prompt with its whitespace normalized. Raises NotJudged for an empty or too long one."""
    text = clean(" ".join(prompt.split()))
    if not text:
        raise NotJudged("prompt", "The prompt is empty.")
    if len(text) > LONGEST_PROMPT:
        raise NotJudged("prompt", f"The prompt has {len(text)} characters; the most is {LONGEST_PROMPT}.")
    return text


def verdicts_key(  # noqa: PLR0913
    prompt: str,
    items: PromptItems,
    frames: JudgedFrames,
    who: JudgeIdentity,
    *,
    static: bool,
    repetition: int,
) -> str:
    """The cache key of the verdicts: everything they depend on, and the repetition."""
    ingredients = {
        "prompt_version": prompt_version(),
        "judge": who,
        "prompt": prompt,
        "static": static,
        "items": items.texts(),
        "frames": frames.digests,
        "repetition": repetition,
    }
    return key_of(ingredients)


def _judged(
    items: PromptItems, verdicts: CachedVerdicts, *, static: bool
) -> dict[str, tuple[JudgedItem, ...]]:
    verdict_of = {verdict.id: verdict for verdict in verdicts.verdicts}
    return {
        dimension: tuple(
            JudgedItem(
                id=item.id,
                text=item.text,
                holds=verdict_of[item.id].holds,
                evidence=one_line(verdict_of[item.id].evidence),
                frames=tuple(sorted(set(verdict_of[item.id].frames))),
            )
            for item in items.items
            if item.dimension == dimension
        )
        for dimension in dimensions(static=static)
    }
