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

from bench.judge.answer_cache import AnswerCache
from bench.judge.dimensions import fixed_items
from bench.judge.items import cached_items
from bench.judge.judge import checked_prompt, verdicts_key
from bench.judge.pictures import read_frames
from bench.judge.questions import enumeration, judging
from bench.judge.verdicts import CachedVerdicts
from simworlds.llm import tokens
from simworlds.llm.messages import Picture, Text, Usage

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from bench.judge.providers import JudgeIdentity
    from simworlds.llm.messages import Ask
    from simworlds.llm.prices import Prices

ASSUMED_ITEMS = 20
"""For a prompt whose items are not listed yet, beside the fixed ones."""
ASSUMED_FRAMES = 5
ASSUMED_SIZE = (1280, 720)
_ITEM_TOKENS = 30


class QuestionEstimate(BaseModel):
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
class JudgeRequest:
    """A request for a judgement; ``scene`` is its label.

    A dry run without ``frames`` assumes five (for a still, one) of ASSUMED_SIZE.
    """

    prompt: str
    static: bool
    frames: Sequence[Path] = ()
    scene: str = ""


def estimate(
    request: JudgeRequest, judge: JudgeIdentity, *, prices: Prices, cache: Path | None, repeat: int = 1
) -> tuple[QuestionEstimate, QuestionEstimate]:
    """The question for the items and the one for the verdicts. Raises NotJudged."""
    prompt, static = checked_prompt(request.prompt), request.static
    answers = AnswerCache(cache)
    items = cached_items(prompt, static=static, answers=answers)
    frames = read_frames(request.frames, static=static) if request.frames else None
    pictures = frames.pictures if frames else _assumed_pictures(static=static)
    texts = items.texts() if items else fixed_items()
    missing = repeat
    if items and frames:
        keys = [
            verdicts_key(prompt, items, frames, judge, static=static, repetition=number)
            for number in range(repeat)
        ]
        missing = sum(answers.load("verdicts", key, CachedVerdicts) is None for key in keys)
    unknown = 0 if items else ASSUMED_ITEMS * _ITEM_TOKENS
    return (
        _question(enumeration(prompt, static=static), judge.model, prices, 0 if items else 1),
        _question(judging(prompt, texts, pictures, static=static), judge.model, prices, missing, unknown),
    )


def _question(ask: Ask, model: str, prices: Prices, times: int, assumed_tokens: int = 0) -> QuestionEstimate:
    price = prices.of(model)
    size = tokens.of_ask(ask) + assumed_tokens
    blocks = [block for message in ask.messages for block in message.content]
    said = [_describe_block(block) for block in blocks if isinstance(block, (Text, Picture))]
    if assumed_tokens:
        said.append(
            f"[the items of the first answer: assumed to be {ASSUMED_ITEMS}, about {assumed_tokens} tokens]"
        )
    return QuestionEstimate(
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


def _describe_block(block: Text | Picture) -> str:
    if isinstance(block, Text):
        return block.text
    with Image.open(io.BytesIO(block.data)) as image:
        return f"[picture, {image.width} × {image.height}, about {tokens.of_picture(block)} tokens]"


def _assumed_pictures(*, static: bool) -> tuple[Picture, ...]:
    png = io.BytesIO()
    Image.new("RGB", ASSUMED_SIZE).save(png, "PNG")
    return (Picture(png.getvalue()),) * (1 if static else ASSUMED_FRAMES)
