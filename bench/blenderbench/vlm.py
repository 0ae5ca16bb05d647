"""The judge of edits: four marks from 0 to 5, by a model that sees goal and result (paper, "BlenderBench Setup").

The criteria are the peer's four: task completion, visual quality, spatial accuracy, detail accuracy. The instruction is
this project's own, and all four are asked for at once: marks are comparable among systems that are judged here by the
same model, not with figures that others publish.
"""

from __future__ import annotations

import hashlib
import io
import json
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PIL import Image
from pydantic import BaseModel, ConfigDict, Field

from bench.judge.answer_cache import AnswerCache, key_of
from bench.judge.ask import ask_judge
from bench.judge.usage import AnswerCost
from simworlds.llm.canonical import form_of
from simworlds.llm.messages import Ask, Picture, Text, Tool, user
from simworlds.llm.structured import fits
from simworlds.mcp_transport.schemas import schema_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bench.judge.providers import JudgeProvider

CRITERIA = ("task_completion", "visual_quality", "spatial_accuracy", "detail_accuracy")
BEST = 5
_STAGE = "marks"
_MAX_TOKENS = 8_000
_LARGEST = 1568  # pixels; models see no more of a picture
_PROMPT = Path(__file__).parent / "prompts" / "marks.md"
_VERSION_DIGITS = 12


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Mark(_Part):
    """One mark."""

    evidence: str = Field(description="What is seen that decides it, and where; one or two sentences.")
    mark: int = Field(description="A whole number from 0 to 5.")


class Marks(_Part):
    """The four marks."""

    task_completion: Mark
    visual_quality: Mark
    spatial_accuracy: Mark
    detail_accuracy: Mark

    @property
    def score(self) -> float:
        """Their mean."""
        return sum(getattr(self, name).mark for name in CRITERIA) / len(CRITERIA)


class Judged(_Part):
    """Marks, who was asked for them and who answered, by which wording, and what that used up, once."""

    provider: str
    model: str
    answered_by: str
    prompt_version: str
    marks: Marks
    spent: AnswerCost


def judge_edit(
    instruction: str,
    goal: Image.Image,
    result: Image.Image,
    provider: JudgeProvider,
    cache_folder: Path | None,
) -> Judged:
    """The marks of an edit. Raises NotJudged: nothing was judged, and the reason; never a low mark."""
    plain = [_plain(picture) for picture in (goal, result)]
    ingredients = {
        "instruction": instruction,
        "pictures": [_digest(picture) for picture in plain],
        "provider": provider.name,
        "model": provider.model,
        "prompt": prompt_version(),
    }

    def ask() -> Judged:
        found = ask_judge(provider, _ask(instruction, [_encoded(picture) for picture in plain]), _reader)
        return Judged(
            provider=provider.name,
            model=provider.model,
            answered_by=found.by or provider.model,
            prompt_version=prompt_version(),
            marks=found.value,
            spent=found.spent,
        )

    return AnswerCache(cache_folder).load_or_make("edits", key_of(ingredients), Judged, ask)


@cache
def prompt_version() -> str:
    """Another one whenever the question is worded otherwise."""
    blank = Picture(b"")
    return form_of(_ask("An example.", (blank, blank))).digest[:_VERSION_DIGITS]


def _ask(instruction: str, shown: Sequence[Picture]) -> Ask:
    """The model's name is the provider's to fill in."""
    goal, result = shown
    said = (
        Text(f"The request, as a JSON string:\n\n{json.dumps(instruction, ensure_ascii=False)}"),
        Text("The goal:"),
        goal,
        Text("The result:"),
        result,
    )
    tool = Tool(_STAGE, f"Gives the answer. {Marks.__doc__}", schema_of(Marks))
    prompt = _PROMPT.read_text(encoding="utf-8").strip()
    return Ask("judge", _STAGE, "", (prompt,), (user(*said),), (tool,), _MAX_TOKENS)


def _reader(data: Any) -> tuple[Marks | None, list[str]]:
    """Marks within the scale. The schema has no bounds, which not all providers take."""
    marks, faults = fits(Marks)(data)
    if marks is None:
        return None, [str(fault) for fault in faults]
    given = {name: getattr(marks, name).mark for name in CRITERIA}
    wrong = [
        f"{name}.mark: {mark} is not from 0 to {BEST}."
        for name, mark in given.items()
        if not 0 <= mark <= BEST
    ]
    return (None, wrong) if wrong else (marks, [])


def _plain(picture: Image.Image) -> Image.Image:
    """Pixels and nothing else, at a size that models see: no path and no name of a system comes along."""
    plain = Image.frombytes("RGB", picture.size, picture.tobytes())
    plain.thumbnail((_LARGEST, _LARGEST), Image.Resampling.LANCZOS)
    return plain


def _digest(picture: Image.Image) -> str:
    """Of what is shown; encoders differ in how they pack it."""
    return hashlib.sha256(f"{picture.width} {picture.height}\n".encode() + picture.tobytes()).hexdigest()


def _encoded(picture: Image.Image) -> Picture:
    written = io.BytesIO()
    picture.save(written, "PNG")
    return Picture(written.getvalue())
