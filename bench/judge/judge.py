"""Judges frames by a prompt: lists the prompt's items, once, then asks for a verdict on each item.

The judge sees only the prompt and the frames: no plan, no audit, no name of a file or a system. Answers are cached by
content, so that nothing is asked twice; another ``repetition`` asks again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.judge.answer_cache import Store, key_of
from bench.judge.ask import asked
from bench.judge.dimensions import dimensions
from bench.judge.errors import NotJudged
from bench.judge.items import Items, items_of, one_line
from bench.judge.pictures import Shown, read_frames
from bench.judge.questions import judging, prompt_version
from bench.judge.verdicts import Given, Item, Judgement, reader_of
from simworlds.llm.request import clean

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from bench.judge.providers import Provider

LONGEST_PROMPT = 4000


def judge(  # noqa: PLR0913
    prompt: str,
    frames: Sequence[Path],
    *,
    static: bool,
    provider: Provider,
    cache: Path | None,
    scene: str = "",
    repetition: int = 0,
    tell: Callable[[str], object] = lambda _: None,
) -> Judgement:
    """Judges a result by its frames: evenly spaced over a film, with the first and the last; for a still, one.

    ``cache`` is the folder of cached answers. ``scene`` labels the judgement; no model sees it. ``tell`` is called with
    progress. Raises NotJudged.
    """
    words = checked(prompt)
    shown = read_frames(frames, static=static)
    store = Store(cache)
    tell("Listing the prompt's items")
    items = items_of(words, static=static, provider=provider, store=store)
    key = verdicts_key(
        words, items, shown, provider.name, provider.model, static=static, repetition=repetition
    )

    def ask() -> Given:
        question = judging(words, items.texts(), shown.pictures, static=static)
        found = asked(provider, question, reader_of(items.texts(), len(shown.pictures)))
        return Given(by=found.by or provider.model, verdicts=found.value.verdicts, spent=found.spent)

    tell(f"Judging {len(items.items)} items by {len(frames)} frame{'s' if len(frames) > 1 else ''}")
    given = store.once("verdicts", key, Given, ask)
    return Judgement(
        scene=scene,
        provider=provider.name,
        model=provider.model,
        answered_by=given.by,
        prompt_version=prompt_version(),
        repetition=repetition,
        dimensions=_judged(items, given, static=static),
        usage=given.spent.usage,
        cost=given.spent.cost,
        items_by=items.by,
        items_usage=items.spent.usage,
        items_cost=items.spent.cost,
    )


def checked(prompt: str) -> str:
    """A prompt with its whitespace normalized. Raises NotJudged for an empty or too long one."""
    text = clean(" ".join(prompt.split()))
    if not text:
        raise NotJudged("prompt", "The prompt is empty.")
    if len(text) > LONGEST_PROMPT:
        raise NotJudged("prompt", f"The prompt has {len(text)} characters; the most is {LONGEST_PROMPT}.")
    return text


def verdicts_key(  # noqa: PLR0913
    prompt: str, items: Items, shown: Shown, provider: str, model: str, *, static: bool, repetition: int
) -> str:
    """The cache key of the verdicts: everything they depend on, and the repetition."""
    ingredients = {
        "prompt_version": prompt_version(),
        "provider": provider,
        "model": model,
        "prompt": prompt,
        "static": static,
        "items": items.texts(),
        "frames": shown.digests,
        "repetition": repetition,
    }
    return key_of(ingredients)


def _judged(items: Items, given: Given, *, static: bool) -> dict[str, tuple[Item, ...]]:
    said = {one.id: one for one in given.verdicts}
    return {
        dimension: tuple(
            Item(
                id=item.id,
                text=item.text,
                holds=said[item.id].holds,
                evidence=one_line(said[item.id].evidence),
                frames=tuple(sorted(set(said[item.id].frames))),
            )
            for item in items.items
            if item.dimension == dimension
        )
        for dimension in dimensions(static=static)
    }
