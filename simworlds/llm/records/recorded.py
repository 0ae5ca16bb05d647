"""Records requests to a model and its answers, and plays them back without a key or a network.

A record is made of rows (JSON objects). Before a call::

    {"type": "model.asked", "n": 7, "role": "coder", "stage": "motion", "model": "claude-opus-5-5",
     "digest": "…", "parts": ["…", …], "texts": {"…": "…"}}

and after it ``{"type": "model.answered", "n": 7, "turn": {…}}``. ``parts`` are digests of the system prompt, the tools
and each message in the form that ``canonical`` describes; ``texts`` are those that no earlier row has. Rows of other
types and further fields are ignored; a request without an answer was not answered. A record that a person writes is a
folder, see ``transcript``.

Playing back, a request gets the turn that was recorded for the same role and stage and the same request: by content, in
the order of the record. When nothing fits, the conversation has drifted; that ends it. A turn of a record is never
``live``, whatever the record says.
"""

from __future__ import annotations

import difflib
import threading
from collections import defaultdict
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from pydantic import BaseModel, ValidationError

from simworlds.llm.errors import Drifted, Stopped, UnreadableRecord, raise_for_stop
from simworlds.llm.messages import Text, ToolResult, Turn
from simworlds.llm.records.canonical import Form, alike, form_of, normal
from simworlds.llm.records.transcript import WrittenTurn, read_folder

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from simworlds.llm.messages import Ask, Model

_DIFF_LINES = 24
_DIFF_WIDTH = 200
_UNKNOWN = "(not in the record)"


class Recording:
    """A Model that passes requests to another one, and records them with its answers."""

    def __init__(
        self,
        model: Model,
        write: Callable[[dict[str, Any]], object],
        *,
        folders: Mapping[str, str] | None = None,
        first: int = 1,
    ) -> None:
        """``write`` gets each row before it has any effect. ``first`` is the number of the next call."""
        self._model = model
        self._write = write
        self._folders = dict(folders or {})
        self._next = first
        self._known: set[str] = set()
        self._lock = threading.Lock()

    def answer(self, ask: Ask, on_text: Callable[[str], object] | None = None) -> Turn:
        """The other's turn, see Model. What ``write`` raises ends the call."""
        form = form_of(ask, self._folders)
        with self._lock:
            number, self._next = self._next, self._next + 1
            self._write(self._asked(ask, form, number))
        try:
            turn = self._model.answer(ask, on_text)
        except Stopped as stopped:  # it was paid for
            self._answered(number, stopped.turn)
            raise
        self._answered(number, turn)
        return turn

    def _asked(self, ask: Ask, form: Form, number: int) -> dict[str, Any]:
        texts = {part.digest: part.text for part in form.parts if part.digest not in self._known}
        self._known.update(texts)
        return {
            "type": "model.asked",
            "n": number,
            "role": ask.role,
            "stage": ask.stage,
            "model": ask.model,
            "digest": form.digest,
            "parts": [part.digest for part in form.parts],
            "texts": texts,
        }

    def _answered(self, number: int, turn: Turn) -> None:
        with self._lock:
            self._write({"type": "model.answered", "n": number, "turn": asdict(turn)})


@dataclass(frozen=True, slots=True)
class RecordedTurn:
    """A turn in a journal, and the request that it answers."""

    name: str
    role: str
    stage: str
    digest: str
    parts: tuple[str, ...]
    texts: Mapping[str, str]
    turn: Turn


class Recorded:
    """A Model that plays a record back."""

    def __init__(
        self,
        record: Path | Iterable[Mapping[str, Any]],
        *,
        folders: Mapping[str, str] | None = None,
        then: Model | None = None,
        skip: Mapping[tuple[str, str], int] | None = None,
    ) -> None:
        """``record``: a hand-written folder, or rows.

        ``then`` is asked when the record has no turn left for the role and stage. ``skip``: so many turns of a role
        and stage were played before. Raises UnreadableRecord.
        """
        self._folders = dict(folders or {})
        self._then = then
        self._lanes: defaultdict[tuple[str, str], list[RecordedTurn | WrittenTurn]] = defaultdict(list)
        self._lock = threading.Lock()
        turns = read_folder(record) if isinstance(record, Path) else read_turns(record)
        for turn in turns:
            self._lanes[turn.role, turn.stage].append(turn)
        for lane, count in (skip or {}).items():
            del self._lanes[lane][:count]

    def left(self) -> tuple[str, ...]:
        """The names of the turns that were not played."""
        with self._lock:
            return tuple(turn.name for lane in self._lanes.values() for turn in lane)

    def answer(self, ask: Ask, on_text: Callable[[str], object] | None = None) -> Turn:
        """The recorded turn, see Model. Raises Drifted, and what the recorded model raised."""
        with self._lock:
            lane = self._lanes[ask.role, ask.stage]
            found = self._find(ask, lane)
            if found:
                lane.remove(found)
        if found is None:
            assert self._then
            return self._then.answer(ask, on_text)
        turn = replace(found.turn, live=False)
        if on_text and turn.text:
            on_text(turn.text)
        return raise_for_stop(turn)

    def _find(self, ask: Ask, lane: list[RecordedTurn | WrittenTurn]) -> RecordedTurn | WrittenTurn | None:
        """The turn for ``ask``; None: it is for ``then``. Raises Drifted."""
        form = form_of(ask, self._folders)
        if not lane and self._then:
            return None
        if not lane:
            where = f"The record has no further turn for the {_whose(ask)}."
            raise _drifted(where, ask, len(ask.messages), "", _said(ask))
        for turn in lane:
            if isinstance(turn, RecordedTurn) and turn.digest == form.digest:
                return turn
        first = lane[0]
        if isinstance(first, WrittenTurn):
            misfit = first.misfit(_said(ask))
            if misfit:
                where = f"The request of the {_whose(ask)} is not the one that {first.name} answers: {misfit}"
                raise _drifted(where, ask, len(ask.messages), misfit, _said(ask))
            return first
        _compare(first, form, ask)
        return first


def _compare(heard: RecordedTurn, form: Form, ask: Ask) -> None:
    """Raises Drifted where ``form`` is not, nearly enough, what was asked."""
    for place in range(max(len(heard.parts), len(form.parts))):
        part = form.parts[place] if place < len(form.parts) else None
        digest = heard.parts[place] if place < len(heard.parts) else None
        if part and part.digest == digest:
            continue
        # By the rules of now: the record may be of a version that had others.
        expected = normal(heard.texts.get(digest, _UNKNOWN)) if digest else ""
        found = part.text if part else ""
        if part and digest and alike(expected, found):
            continue
        name = part.name if part else f"message {place - 1}"
        where = f"The conversation is not the recorded one: the {_whose(ask)}, {heard.name}, {name}."
        raise _drifted(where, ask, max(0, place - 1), expected, found)


def _drifted(where: str, ask: Ask, message: int, expected: str, found: str) -> Drifted:
    lines = difflib.unified_diff(
        expected.splitlines(), found.splitlines(), "recorded", "now", lineterm="", n=1
    )
    rows = [line if len(line) <= _DIFF_WIDTH else f"{line[:_DIFF_WIDTH]}…" for line in lines]
    if len(rows) > _DIFF_LINES:
        rows = [*rows[:_DIFF_LINES], f"… and {len(rows) - _DIFF_LINES} more lines"]
    return Drifted(
        where,
        role=ask.role,
        stage=ask.stage,
        message=message,
        expected=expected,
        found=found,
        diff="\n".join(rows),
    )


def _whose(ask: Ask) -> str:
    return f"{ask.role} ({ask.stage})" if ask.stage else ask.role


def _said(ask: Ask) -> str:
    """The words of the user's last message, those of tools included."""
    last = next((message for message in reversed(ask.messages) if message.role == "user"), None)
    words: list[str] = []
    for said in last.content if last else ():
        inner = said.content if isinstance(said, ToolResult) else (said,)
        words += [block.text for block in inner if isinstance(block, Text)]
    return "\n".join(words)


class _Asked(BaseModel):
    type: Literal["model.asked"]
    n: int
    role: str
    stage: str
    digest: str
    parts: list[str]
    texts: dict[str, str]


class _Answered(BaseModel):
    type: Literal["model.answered"]
    n: int
    turn: Turn


def read_turns(rows: Iterable[Mapping[str, Any]]) -> list[RecordedTurn]:
    """The turns of a journal, in the order in which they were answered. Raises UnreadableRecord."""
    texts: dict[str, str] = {}
    asked: dict[int, _Asked] = {}
    turns: list[RecordedTurn] = []
    for number, row in enumerate(rows, 1):
        try:
            if row.get("type") == "model.asked":
                ask = _Asked.model_validate(row)
                texts.update(ask.texts)
                asked[ask.n] = ask
            elif row.get("type") == "model.answered":
                answered = _Answered.model_validate(row)
                ask = asked.pop(answered.n)
                turns.append(
                    RecordedTurn(
                        f"call {ask.n}",
                        ask.role,
                        ask.stage,
                        ask.digest,
                        tuple(ask.parts),
                        texts,
                        answered.turn,
                    )
                )
        except (ValidationError, KeyError) as error:
            why = "an answer to no question" if isinstance(error, KeyError) else str(error)
            raise UnreadableRecord(f"Row {number} is not part of a record: {why}") from error
    return turns
