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
from simworlds.llm.messages import Ask, Picture, Text, Tool, user
from simworlds.llm.records.canonical import form_of
from simworlds.llm.structured import fits
from simworlds.schemas.json_schema import schema_of

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


class EditJudgement(_Part):
    """The marks of an edit: with the model that was asked and the one that answered, the prompt's version, the cost."""

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
) -> EditJudgement:
    """Judges an edit. Raises NotJudged with the reason where that fails, rather than a low mark."""
    plain = [_plain(picture) for picture in (goal, result)]
    ingredients = {
        "instruction": instruction,
        "pictures": [_digest(picture) for picture in plain],
        "judge": provider.identity,
        "prompt": prompt_version(),
    }

    def ask() -> EditJudgement:
        answer = ask_judge(provider, _ask(instruction, [_encoded(picture) for picture in plain]), _reader)
        return EditJudgement(
            provider=provider.name,
            model=provider.model,
            answered_by=answer.by or provider.model,
            prompt_version=prompt_version(),
            marks=answer.value,
            spent=answer.spent,
        )

    return AnswerCache(cache_folder).load_or_make("edits", key_of(ingredients), EditJudgement, ask)


@cache
def prompt_version() -> str:
    """A digest of the question: it changes with the wording."""
    blank = Picture(b"")
    return form_of(_ask("An example.", (blank, blank))).digest[:_VERSION_DIGITS]


def _ask(instruction: str, pictures: Sequence[Picture]) -> Ask:
    """The question. The provider fills in the model's name."""
    goal, result = pictures
    content = (
        Text(f"The request, as a JSON string:\n\n{json.dumps(instruction, ensure_ascii=False)}"),
        Text("The goal:"),
        goal,
        Text("The result:"),
        result,
    )
    tool = Tool(_STAGE, f"Gives the answer. {Marks.__doc__}", schema_of(Marks))
    prompt = _PROMPT.read_text(encoding="utf-8").strip()
    return Ask("judge", _STAGE, "", (prompt,), (user(*content),), (tool,), _MAX_TOKENS)


def _reader(data: Any) -> tuple[Marks | None, list[str]]:
    """Checks the marks' bounds, which the schema omits because some providers reject them."""
    marks, faults = fits(Marks)(data)
    if marks is None:
        return None, [str(fault) for fault in faults]
    by_name = {name: getattr(marks, name).mark for name in CRITERIA}
    out_of_range = [
        f"{name}.mark: {mark} is not from 0 to {BEST}."
        for name, mark in by_name.items()
        if not 0 <= mark <= BEST
    ]
    return (None, out_of_range) if out_of_range else (marks, [])


def _plain(picture: Image.Image) -> Image.Image:
    """Only the pixels, at a size that models see: without metadata, which might name a system."""
    plain = Image.frombytes("RGB", picture.size, picture.tobytes())
    plain.thumbnail((_LARGEST, _LARGEST), Image.Resampling.LANCZOS)
    return plain


def _digest(picture: Image.Image) -> str:
    """A digest of the pixels: encoders pack them differently."""
    return hashlib.sha256(f"{picture.width} {picture.height}\n".encode() + picture.tobytes()).hexdigest()


def _encoded(picture: Image.Image) -> Picture:
    written = io.BytesIO()
    picture.save(written, "PNG")
    return Picture(written.getvalue())
