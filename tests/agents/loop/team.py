"""A team for tests: answers for all roles as a server of the Messages API, from what a test says is special.

What is answered depends on the request alone, not on what was asked before: a run that is killed and taken up again
hears the same.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import count
from typing import Any, TypeVar

import crates
from fake_messages_api import Reply

Params = dict[str, Any]
Said = str | Reply | Mapping[str, Any] | Callable[[Params], Reply]
"""Words, a whole reply, JSON, or what makes a reply of a request."""

ROLES = {
    "# You are the planner": "planner",
    "# You are the coder": "coder",
    "# You are the reviewer": "reviewer",
    "# You are the final reviewer": "final_reviewer",
}
DONE = "The stage is built."
ADVANCE = None  # a stage that nothing keeps open is closed without a decision
RETRY = {
    "transition": "retry",
    "reason": "Something is wrong.",
    "instructions": "Mend what the verifier finds.",
}
REPLAN = {"transition": "replan", "reason": "This plan leads nowhere."}
ABORT = {"transition": "abort", "reason": "This cannot be built."}
FINE = {"judgements": [], "blocking": False, "summary": "It looks right."}
BLOCKING = {"judgements": [], "blocking": True, "summary": "The crate looks like a sphere."}
FILM = {"transition": "film", "reason": "It is as planned."}
ACCEPT = {"verdict": "accept", "summary": "As asked."}
NEEDS_FIX = {"verdict": "needs_fix", "summary": "Too low.", "instructions": "Put the sun higher."}

Turn = TypeVar("Turn")
_numbers = count(1)


def reply(said: str | Reply | Mapping[str, Any]) -> Reply:
    """Words, or data as JSON."""
    if isinstance(said, Reply):
        return said
    return Reply(said if isinstance(said, str) else json.dumps(said))


def call(name: str, /, **given: Any) -> Reply:
    """A turn that calls a tool."""
    return Reply(content=(use(name, **given),), stop_reason="tool_use")


def calls(*uses: dict[str, Any]) -> Reply:
    """A turn that calls several."""
    return Reply(content=uses, stop_reason="tool_use")


def use(name: str, /, **given: Any) -> dict[str, Any]:
    return {"type": "tool_use", "id": f"toolu_{next(_numbers):06}", "name": name, "input": given}


def run(code: str, **more: Any) -> Reply:
    """A turn that runs code in Blender."""
    return call("blender_execute", code=code, **more)


@dataclass
class Team:
    """What each role says.

    ``code`` is what the coder runs in a stage's first turn; ``coder`` has all of its turns in a stage instead, by their
    place in the conversation (the last is said again and again), as ``reviewer`` has the reviewer's. ``tactics`` are
    the planner's tactical plans by their place in the stage, ``decisions`` its decisions by attempt: where there is
    one, the reviewer blocks, unless the test says what it does.
    """

    plan: Said = field(default_factory=crates.standing)
    code: Mapping[str, str] = field(default_factory=lambda: dict(crates.CODE))
    coder: Mapping[str, Sequence[Said]] = field(default_factory=dict)
    reviewer: Mapping[str, Sequence[Said]] = field(default_factory=dict)
    tactics: Mapping[str, Sequence[Said]] = field(default_factory=dict)
    decisions: Mapping[str, Sequence[Said | None]] = field(default_factory=dict)
    film: Said = field(default_factory=lambda: dict(FILM))
    final: Sequence[Said] = (ACCEPT,)
    first: Callable[[str, str, Params], Said | None] = lambda role, stage, params: None

    def __call__(self, params: Params) -> Reply:
        """The answer to a request."""
        role, stage = whose(params)
        said = self.first(role, stage, params)
        if said is None:
            said = getattr(self, f"_{role}")(stage, params)
        return said(params) if callable(said) else reply(said)

    def _planner(self, stage: str, params: Params) -> Said:
        told = _task(params)
        if told.startswith("Before the film"):
            return self.film
        if not stage:
            return self.plan
        if told.startswith("Attempt"):
            attempt = int(told.split()[1])
            return _nth(self.decisions.get(stage, (RETRY,)), attempt - 1) or RETRY
        before = [text for text in texts(params) if text.startswith(f"The stage {stage} begins.")]
        plain = {"stage": stage, "goal": f"Build {stage}."}
        return _nth(self.tactics.get(stage, (plain,)), len(before) - 1)

    def _coder(self, stage: str, params: Params) -> Said:
        turns = self.coder.get(stage)
        if turns is None:
            turns = (run(self.code[stage]), DONE) if stage in self.code else (DONE,)
        return _nth(turns, turn_of(params))

    def _reviewer(self, stage: str, params: Params) -> Said:
        decisions = self.decisions.get(stage, (ADVANCE,))
        reviews = tuple(FINE if one is ADVANCE else BLOCKING for one in decisions)
        return _nth(self.reviewer.get(stage, reviews), turn_of(params))

    def _final_reviewer(self, stage: str, params: Params) -> Said:
        return _nth(self.final, turn_of(params))


def whose(params: Params) -> tuple[str, str]:
    """(role, stage) of a request."""
    system = [block["text"] for block in params["system"]]
    role = next(role for title, role in ROLES.items() if system[0].startswith(title + "\n"))
    if role == "planner":
        found = re.search(r"[Tt]he stage (\w+)", _task(params)[:80])
        return role, found[1] if found else ""
    if role == "final_reviewer":
        return role, "render"
    stages = (re.match(r"# ([a-z]\w*)", block) for block in reversed(system))  # a solver's sheet may follow
    stage = next(found[1] for found in stages if found)
    return role, "light" if stage == "everything" else stage  # the last stage stands for a run without stages


def turn_of(params: Params) -> int:
    """How many turns of the model there are in a conversation."""
    return sum(message["role"] == "assistant" for message in params["messages"])


def words_of(params: Params) -> str:
    """All that is said in a request's messages, results of tools included."""
    return "\n".join(texts(params))


def last_words(params: Params) -> str:
    """What the user said last."""
    return "\n".join(texts({"messages": params["messages"][-1:]}))


def _nth(turns: Sequence[Turn], place: int) -> Turn:
    return turns[min(place, len(turns) - 1)]


def _task(params: Params) -> str:
    """What the planner was last asked for, complaints about its answers apart."""
    asked = ("Write the ", "The stage ", "Attempt ", "Before the film")
    return next(text for text in reversed(list(texts(params))) if text.startswith(asked))


def texts(params: Params) -> list[str]:
    """All that the user said and tools answered, in words."""
    found: list[str] = []
    for message in params["messages"]:
        if message["role"] != "user":
            continue
        for block in message["content"]:
            inner = block["content"] if block["type"] == "tool_result" else [block]
            found += [one["text"] for one in inner if one["type"] == "text"]
    return found
