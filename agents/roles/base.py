"""What all roles have in common: a conversation with the model, with or without tools."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeVar

from pydantic import BaseModel

from agents.roles.names import format_role
from simworlds.llm import tokens
from simworlds.llm.context import ContextLimits, fit
from simworlds.llm.errors import CutShort, Declined, Misfit
from simworlds.llm.messages import Ask, Text, ToolResult, user
from simworlds.llm.structured import ask_for, complaint, fits, form_of, read

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from agents.plan.part import Stage
    from simworlds.llm.messages import Block, Message, Model, Tool, ToolUse, Turn
    from simworlds.llm.structured import AnswerReader

M = TypeVar("M", bound=BaseModel)

MAX_CALLS = 80  # of one attempt
_SAME_CALLS = (
    3  # the same call with the same outcome, one after the other: from here on the model is told so …
)
_CIRCLES = 6  # … and from here on it is not asked any more
_CUTS = 3
_TRIES = 4  # for an answer that must fit a schema

How = Literal["done", "circles", "too many calls", "refused", "cut short"]


class ToolSet(Protocol):
    """The tools that a role may call."""

    @property
    def offered(self) -> tuple[Tool, ...]:
        """What the model is told of them."""
        ...

    def use(self, call: ToolUse) -> ToolResult:
        """Calls one; an unknown one is a result that says so."""
        ...


@dataclass(frozen=True, slots=True)
class RoleContext:
    """What a role works with.

    ``name`` is the model's, unless ``names`` has another for a role; ``tools`` makes the tools for a role and stage;
    ``saying`` gets (role, words) as they come; ``safe`` is called before everything that costs, and raises what ends
    the run there. ``verifier``, ``staged``: whether the run has a verifier, and stages.
    """

    model: Model
    name: str
    tools: Callable[[str, Stage], ToolSet]
    saying: Callable[[str, str], object]
    safe: Callable[[], object]
    names: Mapping[str, str] = field(default_factory=dict[str, str])
    limits: ContextLimits = field(default_factory=ContextLimits)
    max_tokens: int = 32_000
    verifier: bool = True
    staged: bool = True

    def answer(self, ask: Ask, on_text: Callable[[str], object] | None = None) -> Turn:
        """The model's turn, see Model; each is a safe point."""
        self.safe()
        return self.model.answer(ask, on_text)


@dataclass(frozen=True, slots=True)
class WorkResult:
    """How a stretch of work with tools ended; ``said`` are the model's last words."""

    how: How
    said: str
    calls: int
    turn: Turn | None = None


class Conversation:
    """A conversation of one role, kept within the context's limits.

    What is ``pinned`` in a request is in it, whatever had to go.
    """

    def __init__(
        self, context: RoleContext, role: str, system: tuple[str, ...], tools: ToolSet | None = None
    ) -> None:
        self._context = context
        self._role = role
        self._system = system
        self._tools = tools
        self._offered = tools.offered if tools else ()
        self._frame = tokens.of_frame(system, self._offered)
        self._messages: tuple[Message, ...] = ()

    @property
    def said(self) -> str:
        """What the model said last."""
        last = next((one for one in reversed(self._messages) if one.role == "assistant"), None)
        return "\n".join(block.text for block in last.content if isinstance(block, Text)) if last else ""

    def data(
        self,
        stage: str,
        shape: type[M],
        *said: Block | str,
        reader: AnswerReader[M] | None = None,
        pinned: Sequence[str] = (),
    ) -> M:
        """Asks for JSON of a shape that ``reader`` takes. What did not fit is not kept. Raises Misfit, ModelError."""
        self._hear(said, pinned)
        return self._read_on(stage, shape, reader or fits(shape), self._messages)

    def work(self, stage: str, *said: Block | str, pinned: Sequence[str] = ()) -> WorkResult:
        """Lets the model work with its tools until it says something without calling any. Raises ModelError."""
        assert self._tools is not None
        self._hear(said, pinned)
        calls = cuts = 0
        repeats = _Repeats()
        while True:
            try:
                turn = self._context.answer(self._ask(stage, self._messages), self._say)
            except Declined as refused:
                return WorkResult("refused", str(refused), calls, refused.turn)
            except CutShort as cut:
                cuts += 1
                if cuts == _CUTS:
                    return WorkResult("cut short", str(cut), calls, cut.turn)
                self._cut(cut)
                continue
            self._messages = (*self._messages, turn.message())
            if not turn.calls:
                return WorkResult("done", turn.text, calls, turn)
            results = [self._used(call, repeats) for call in turn.calls]
            calls += len(results)
            self._hear(results, pinned)
            if repeats.most >= _CIRCLES or calls >= MAX_CALLS:
                return WorkResult(
                    "circles" if calls < MAX_CALLS else "too many calls", turn.text, calls, turn
                )

    def work_then_data(
        self,
        stage: str,
        shape: type[M],
        *said: Block | str,
        reader: AnswerReader[M],
        pinned: Sequence[str] = (),
    ) -> M:
        """As ``work``; the last words are to be JSON of a shape that ``reader`` takes. Raises Misfit, ModelError."""
        worked = self.work(stage, *said, pinned=pinned)
        if worked.how != "done" or worked.turn is None:
            if worked.how == "refused":
                raise Declined(worked.said, _sure(worked.turn))
            self._hear(("That is enough. Give your answer now, as the JSON that is asked for.",), pinned)
            return self._read_on(stage, shape, reader, self._messages)
        try:
            return read(worked.said, reader)
        except Misfit as misfit:
            whole, self._messages = self._messages, self._messages[:-1]
            return self._read_on(stage, shape, reader, (*whole, complaint(worked.turn, misfit)))

    def _read_on(
        self, stage: str, shape: type[M], reader: AnswerReader[M], messages: tuple[Message, ...]
    ) -> M:
        ask, form = self._ask(stage, messages), form_of(shape)
        try:
            found = ask_for(self._context, ask, reader, tries=_TRIES, on_text=self._say, form=form)
        except Misfit as misfit:
            role = format_role(self._role)
            told = f"The {role} ({ask.model}) gave no answer of the requested form, {_TRIES} times. The last:"
            raise Misfit([told, *misfit.problems], misfit.text) from misfit
        self._messages = (*self._messages, replace(found.turn, content=_words(found.turn)).message())
        return found.value

    def _hear(self, said: Sequence[Block | str], pinned: Sequence[str]) -> None:
        message = user(*said)
        last = self._messages[-1] if self._messages else None
        if last is not None and last.role == "user":  # two of one side's in a row are one
            self._messages = (*self._messages[:-1], replace(last, content=(*last.content, *message.content)))
        else:
            self._messages = (*self._messages, message)
        self._messages = fit(self._messages, self._context.limits, pinned=pinned, frame=self._frame)

    def _ask(self, stage: str, messages: tuple[Message, ...]) -> Ask:
        context = self._context
        name = context.names.get(self._role, context.name)
        return Ask(self._role, stage, name, self._system, messages, self._offered, context.max_tokens)

    def _say(self, words: str) -> None:
        self._context.saying(self._role, words)

    def _cut(self, cut: CutShort) -> None:
        """The call that was cut off is gone; the model is to go on in smaller steps."""
        words = _words(cut.turn)
        if words:
            self._messages = (*self._messages, replace(cut.turn, content=words).message())
        self._hear(
            ("Your answer was cut off. Go on in smaller steps: shorter code, one call at a time.",), ()
        )

    def _used(self, call: ToolUse, repeats: _Repeats) -> ToolResult:
        assert self._tools is not None
        self._context.safe()
        result = self._tools.use(call) if not call.fault else _unreadable(call)
        times = repeats.count(call, result)
        if times < _SAME_CALLS:
            return result
        told = Text(
            f"This very call has now been made {times} times in a row, and always with this outcome. Do something "
            "else, or end with a report of what is in the way."
        )
        return replace(result, content=(*result.content, told))


class _Repeats:
    """Counts calls that are made over and over with the same outcome."""

    def __init__(self) -> None:
        self._last = ""
        self.most = 0

    def count(self, call: ToolUse, result: ToolResult) -> int:
        """How often in a row, this one included."""
        made = json.dumps([call.name, call.input, result.failed], sort_keys=True)
        self.most = self.most + 1 if made == self._last else 1
        self._last = made
        return self.most


def _words(turn: Turn) -> tuple[Block, ...]:
    """The turn without calls, which nobody answers."""
    return tuple(block for block in turn.content if block.type != "tool_use")


def _unreadable(call: ToolUse) -> ToolResult:
    text = f"{call.name or 'The tool'} was not called. {call.fault} Send the whole call again."
    return ToolResult(call.id, (Text(text),), failed=True)


def _sure(turn: Turn | None) -> Turn:
    assert turn is not None
    return turn


def plan_json(value: Any) -> str:
    """A part of a plan as a model reads it: without what is left at its default."""
    return json.dumps(value.model_dump(mode="json", exclude_defaults=True), ensure_ascii=False)
