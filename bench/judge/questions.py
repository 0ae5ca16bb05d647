"""The judge's two questions as requests to a model, and their version, which follows from their wording.

The texts are the Markdown files in ``prompts``. The shape of an answer is the schema of the one tool that the model
gets: all fields are required and without bounds, as all providers' structured outputs demand; bounds are checked
afterwards, and an answer that breaks them goes back. The classes' docstrings and fields are part of the wording.
"""

from __future__ import annotations

import hashlib
import json
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict, Field

from bench.judge.dimensions import fixed_items
from simworlds.llm.messages import Ask, Picture, Text, Tool, user
from simworlds.llm.records.canonical import form_of
from simworlds.schemas.json_schema import schema_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from simworlds.llm.messages import Block

FOLDER = Path(__file__).with_name("prompts")
ITEMS, VERDICTS = "items", "verdicts"
"""The names of the two questions, by which cost is counted."""
MAX_TOKENS = 16_000
_VERSION_DIGITS = 12
_KINDS = {True: "a still", False: "a film"}


class _Shape(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Named(_Shape):
    """A thing, a relation or an action that the request names."""

    words: str = Field(description="The words of the request that say so, copied letter for letter.")
    text: str = Field(description="The statement to check, complete by itself.")


class Enumeration(_Shape):
    """What can be checked of the request, in three lists."""

    objects: tuple[Named, ...] = Field(description="One item for each thing that a camera can see.")
    relations: tuple[Named, ...] = Field(description="One item for each pair of things and how they stand.")
    actions: tuple[Named, ...] = Field(description="One item for each happening; none for a still.")


class Verdict(_Shape):
    """What the frames say of one item."""

    id: str = Field(description="The item's id.")
    evidence: str = Field(description="What is seen, and where in the picture; one or two sentences.")
    frames: tuple[int, ...] = Field(description="The numbers of the frames that show it.")
    holds: bool


class Verdicts(_Shape):
    """One verdict for each item, in the given order."""

    verdicts: tuple[Verdict, ...]


def enumeration(prompt: str, *, static: bool) -> Ask:
    """Asks which items a prompt gives. The answer is an Enumeration."""
    words = f"The words ask for {_KINDS[static]}. As a JSON string, they are:\n\n{_json(prompt)}"
    return _ask(ITEMS, "enumerate.md", (Text(words),), Enumeration)


def judging(prompt: str, items: Mapping[str, str], pictures: Sequence[Picture], *, static: bool) -> Ask:
    """Asks for a verdict on each item (id → text), by the pictures. The answer is Verdicts."""
    listed = ",\n".join(_json({"id": name, "text": text}) for name, text in items.items())
    blocks: list[Block] = [
        Text(
            f"The request, for {_KINDS[static]}, as a JSON string:\n\n{_json(prompt)}\n\n{_describe_frames(pictures)}"
        )
    ]
    for number, picture in enumerate(pictures, 1):
        blocks += [Text(_label(number, len(pictures))), picture]
    blocks.append(Text(f"The {len(items)} items, as JSON:\n\n[{listed}]"))
    return _ask(VERDICTS, "verdicts.md", blocks, Verdicts)


@cache
def prompt_version() -> str:
    """The version of the prompts, which changes with any wording: a digest of both questions about an example.

    The items are the fixed ones, which are wording too.
    """
    blank = (Picture(b""),)
    asked = [
        ask
        for static in (True, False)
        for ask in (
            enumeration("An example.", static=static),
            judging("An example.", fixed_items(), blank if static else blank * 2, static=static),
        )
    ]
    return hashlib.sha256("".join(form_of(ask).digest for ask in asked).encode()).hexdigest()[
        :_VERSION_DIGITS
    ]


def _ask(stage: str, file: str, said: Sequence[Block], shape: type[BaseModel]) -> Ask:
    """A question without the model's name, which the provider fills in."""
    tool = Tool(stage, f"Gives the answer. {shape.__doc__}", schema_of(shape))
    return Ask("judge", stage, "", (_read(file),), (user(*said),), (tool,), MAX_TOKENS)


def _describe_frames(pictures: Sequence[Picture]) -> str:
    count = len(pictures)
    return "The still:" if count == 1 else f"{count} frames of the film, from its first to its last:"


def _label(number: int, count: int) -> str:
    if count == 1:
        return "Frame 1:"
    return f"Frame {number} of {count}, at {round(100 * (number - 1) / (count - 1))} % of the film:"


def _json(value: object) -> str:
    return json.dumps(value, ensure_ascii=False)


@cache
def _read(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8").strip()
