"""Dry run of a judgement: its questions, their estimated tokens, and what they can cost; no model is called.

Estimates of tokens tend to be too high (``simworlds.llm.tokens``). Since the length of an answer is unknown, the cost
is given without the answer, and with the longest possible answer.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import TYPE_CHECKING

from PIL import Image
from pydantic import BaseModel, ConfigDict

from bench.judge.answer_cache import Store
from bench.judge.dimensions import CHECKLISTS
from bench.judge.items import kept_items
from bench.judge.judge import checked, verdicts_key
from bench.judge.pictures import read_frames
from bench.judge.questions import enumeration, judging
from bench.judge.verdicts import Given
from simworlds.llm import tokens
from simworlds.llm.messages import Picture, Text, Usage

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from simworlds.llm.messages import Ask
    from simworlds.llm.prices import Prices

ASSUMED_ITEMS = 20
"""For a prompt whose items are not listed yet, beside the fixed ones."""
ASSUMED_FRAMES = 5
ASSUMED_SIZE = (1280, 720)
_ITEM_TOKENS = 30


class Question(BaseModel):
    """A question that would be asked ``times`` times now; 0 if the answer is cached.

    ``said``: the texts of the user's message, with pictures in brackets. Costs are US dollars per time, None if no
    price is known: ``cost`` without the answer, ``most`` with the longest one.
    """

    model_config = ConfigDict(frozen=True)

    stage: str
    times: int
    system: str
    said: tuple[str, ...]
    pictures: int
    tokens: int
    longest_answer: int
    cost: float | None
    most: float | None


@dataclass(frozen=True, slots=True)
class Asked:
    """A request for a judgement; ``scene`` is its label.

    A dry run without ``frames`` assumes five (for a still, one) of ASSUMED_SIZE.
    """

    prompt: str
    static: bool
    frames: Sequence[Path] = ()
    scene: str = ""


def estimate(  # noqa: PLR0913
    wanted: Asked, provider: str, model: str, *, prices: Prices, cache: Path | None, repeat: int = 1
) -> tuple[Question, Question]:
    """The question for the items and the one for the verdicts. Raises NotJudged."""
    prompt, static = checked(wanted.prompt), wanted.static
    store = Store(cache)
    items = kept_items(prompt, static=static, store=store)
    shown = read_frames(wanted.frames, static=static) if wanted.frames else None
    pictures = shown.pictures if shown else _assumed(static=static)
    texts = items.texts() if items else _fixed()
    missing = repeat
    if items and shown:
        keys = [
            verdicts_key(prompt, items, shown, provider, model, static=static, repetition=number)
            for number in range(repeat)
        ]
        missing = sum(store.kept("verdicts", key, Given) is None for key in keys)
    unknown = 0 if items else ASSUMED_ITEMS * _ITEM_TOKENS
    return (
        _question(enumeration(prompt, static=static), model, prices, 0 if items else 1),
        _question(judging(prompt, texts, pictures, static=static), model, prices, missing, unknown),
    )


def _question(ask: Ask, model: str, prices: Prices, times: int, more: int = 0) -> Question:
    price = prices.of(model)
    size = tokens.of_ask(ask) + more
    blocks = [block for message in ask.messages for block in message.content]
    said = [_told(block) for block in blocks if isinstance(block, (Text, Picture))]
    if more:
        said.append(f"[the items of the first answer: assumed to be {ASSUMED_ITEMS}, about {more} tokens]")
    return Question(
        stage=ask.stage,
        times=times,
        system="\n\n".join(ask.system),
        said=tuple(said),
        pictures=sum(isinstance(block, Picture) for block in blocks),
        tokens=size,
        longest_answer=ask.max_tokens,
        cost=prices.cost(model, Usage(input=size)),
        most=None if price is None else price.worst(size, ask.max_tokens),
    )


def _told(block: Text | Picture) -> str:
    if isinstance(block, Text):
        return block.text
    with Image.open(io.BytesIO(block.data)) as image:
        return f"[picture, {image.width} × {image.height}, about {tokens.of_picture(block)} tokens]"


def _fixed() -> dict[str, str]:
    return {
        f"{name}.{number}": text
        for name, listed in CHECKLISTS.items()
        for number, text in enumerate(listed, 1)
    }


def _assumed(*, static: bool) -> tuple[Picture, ...]:
    written = io.BytesIO()
    Image.new("RGB", ASSUMED_SIZE).save(written, "PNG")
    return (Picture(written.getvalue()),) * (1 if static else ASSUMED_FRAMES)
