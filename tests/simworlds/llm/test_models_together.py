"""The pieces as a run uses them: counted, recorded, cut to a budget, killed anywhere and taken up again."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from asks import LOOK, MESSAGES, RUN, ask, png
from fake_messages_api import Reply
from pydantic import BaseModel

from simworlds.llm.context import ContextLimits, fit
from simworlds.llm.messages import Kept, Picture, Text, ToolResult, user
from simworlds.llm.records.recorded import Recorded, Recording
from simworlds.llm.spending import Metered, Spending
from simworlds.llm.structured import ask_for, fits

if TYPE_CHECKING:
    from simworlds.llm.messages import Message, Model

LIMITS = ContextLimits(budget=2500, pictures=4, newest=2, long=300)


class Verdict(BaseModel):
    good: bool


def answers(params: dict[str, Any]) -> Reply:
    """Six calls, each after some thought; a verdict for those who have no tools."""
    if not params.get("tools"):
        return Reply('I see it.\n```json\n{"good": true}\n```', input_tokens=None)
    steps = json.dumps(params["messages"]).split("step(")[1:]
    number = 1 + max((int(step.split(")")[0]) for step in steps), default=-1)
    if number == 6:
        return Reply("Done.", input_tokens=None)
    content = (
        {"type": "thinking", "thinking": f"What comes after {number}?"},
        {"type": "tool_use", "id": f"t{number}", "name": RUN.name, "input": {"code": f"step({number})"}},
        {"type": "tool_use", "id": f"l{number}", "name": LOOK.name, "input": {"name": "Table"}},
    )
    return Reply(content=content, stop_reason="tool_use", input_tokens=None)


def run(model: Model) -> list[str]:
    """A small loop of a coder's and a reviewer's; what was said, thinking left out."""
    messages: tuple[Message, ...] = (user("Build it."),)
    said: list[str] = []
    for _ in range(10):
        messages = fit(messages, LIMITS, pinned=("The plan: a table.",))
        turn = model.answer(ask(*messages))
        said += [repr(block) for block in turn.content if not isinstance(block, Kept)]
        if not turn.calls:
            break
        results = [ToolResult(call.id, (Text("word " * 60), Picture(png(28, 28)))) for call in turn.calls]
        messages = (*messages, turn.message(), user(*results))
    verdict = ask_for(model, ask(*messages[:1], role="reviewer", tools=()), fits(Verdict))
    return [*said, repr(verdict.value)]


def test_a_run_that_was_killed_anywhere_ends_the_same_and_pays_nothing_twice(api, claude):
    api.answer = answers
    rows: list[dict[str, Any]] = []
    spending = Spending(max_cost=1.0)
    whole = run(Recording(Metered(claude, spending), rows.append))
    calls = len(api.received(MESSAGES))
    assert (calls, len(rows), whole[-1]) == (8, 16, "Verdict(good=True)")
    assert {(row.role, row.calls) for row in spending.rows()} == {("coder", 7), ("reviewer", 1)}
    for killed in range(len(rows) + 1):
        api.requests.clear()
        kept = [json.loads(json.dumps(row)) for row in rows[:killed]]
        more: list[dict[str, Any]] = []
        live = Recording(Metered(claude, Spending(max_cost=1.0)), more.append, first=killed)
        assert run(Recorded(kept, then=live)) == whole
        answered = killed // 2
        assert len(api.received(MESSAGES)) == calls - answered == len(more) // 2
    api.requests.clear()
    assert run(Recorded(rows)) == whole
    assert api.requests == []
