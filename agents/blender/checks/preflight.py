"""The pre-flight of ``blender_execute``: code is checked for the running Blender before any of it runs.

Code that would run is not refused: an error counts if the run surely comes to it, and if the live Blender, which knows
what add-ons and earlier calls have registered, has nothing by that name either. Everything else is a warning.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

from pydantic import BaseModel

from agents.blender.tools.base import NotChecked
from simworlds.counting import counted

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from agents.blender.tools.base import Call, CallContext

_OF_BLENDER = re.compile(r"\b(?:bpy|mathutils|bmesh)\b")
_SYNTAX = "syntax-error"  # Blender's own Python decides, and executes nothing either
_LIVE_SECONDS = 10.0
_MOST_ASKED = 200
_MOST_ERRORS = 8
_MOST_WARNINGS = 3
_LONGEST = 400


class CodeFinding(BaseModel):
    """What a check has found in code: the part of ``blender_check``'s reply that is used here."""

    rule: str
    severity: Literal["error", "warning", "note"]
    line: int
    message: str
    fix: str
    sure: bool
    absent: list[str]
    reached: bool


class _Reply(BaseModel):
    findings: list[CodeFinding]
    complete: bool
    blender: str


@dataclass(frozen=True, slots=True)
class PreFlight:
    """What a check has found: ``errors`` that the code would surely raise, and ``warnings``."""

    errors: tuple[CodeFinding, ...] = ()
    warnings: tuple[CodeFinding, ...] = ()
    blender: str = ""

    def refusal(self) -> str:
        """Why nothing was executed, in words."""
        groups: dict[str, list[CodeFinding]] = {}
        for finding in self.errors:
            groups.setdefault(finding.message, []).append(finding)
        count = counted(len(self.errors), "error")
        parts = [f"**Nothing was executed; the scene is unchanged.** {count} for Blender {self.blender}:"]
        parts += [_described(group) for group in [*groups.values()][:_MOST_ERRORS]]
        if (left := len(groups) - _MOST_ERRORS) > 0:
            parts.append(f"- {left} more")
        parts.append('Mend this and call again. If it is right as it is, pass preflight="off".')
        return "\n".join(parts)

    def remarks(self) -> list[str]:
        """The warnings, each in a line."""
        return [f"Warning, line {finding.line}: {_clipped(finding.message)}" for finding in self._remarked]

    def remarked_lines(self) -> list[int]:
        """The lines of code that ``remarks`` speaks of."""
        return [finding.line for finding in self._remarked]

    @property
    def _remarked(self) -> tuple[CodeFinding, ...]:
        return self.warnings[:_MOST_WARNINGS]

    @property
    def data(self) -> list[dict[str, Any]]:
        """All findings as JSON."""
        return [finding.model_dump() for finding in (*self.errors, *self.warnings)]


def _described(group: Sequence[CodeFinding]) -> str:
    lines = list(dict.fromkeys(finding.line for finding in group))
    named = ", ".join(map(str, lines[:_MOST_ERRORS])) + (", …" if len(lines) > _MOST_ERRORS else "")
    text = f"- line{'s' if len(lines) > 1 else ''} {named}: {_clipped(group[0].message)}"
    if not group[0].fix:
        return text
    label = "Fix" if group[0].sure else "Perhaps"
    if len(lines) > 1:
        label += f" (line {lines[0]})"
    return f"{text}\n  {label}: `{_clipped(' '.join(group[0].fix.split()))}`"


def _clipped(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]} …"


def check_before_running(context: CallContext, code: str, call: Call) -> PreFlight:
    """What is wrong in code, as far as it can be known before it runs. Why nothing is known is noted once.

    Raises BlenderError if Blender is lost when it is asked.
    """
    if context.check is None or not _OF_BLENDER.search(code):
        return PreFlight()
    try:
        reply = _Reply.model_validate(context.check(code))
    except NotChecked as error:
        context.blender.note_once(f"Code is not checked before it runs: {error}")
        return PreFlight()
    found = [f for f in reply.findings if f.severity != "note" and f.rule != _SYNTAX]
    there = _present(context, [path for finding in found for path in finding.absent], call)
    found = [finding for finding in found if there.isdisjoint(finding.absent)]
    errors = [f for f in found if f.severity == "error" and f.reached and (reply.complete or not f.absent)]
    return PreFlight(tuple(errors), tuple(f for f in found if f not in errors), reply.blender)


def _present(context: CallContext, paths: Iterable[str], call: Call) -> set[str]:
    """Those of the paths that the live Blender has."""
    asked = list(dict.fromkeys(paths))[:_MOST_ASKED]
    if not asked:
        return set()
    reply = context.blender.call(
        "present",
        {"paths": asked},
        partial(_answers, len(asked)),
        timeout=_LIVE_SECONDS,
        what="the check of names before the code",
        cancelled=call.cancelled,
    )
    return {path for path, exists in zip(asked, reply.value, strict=True) if exists}


def _answers(count: int, value: Any) -> list[bool]:
    """The worker's answers: as many truth values as there were questions."""
    if not isinstance(value, list) or len(value) != count or not all(type(item) is bool for item in value):
        raise ValueError(f"it is not a list of {count} truth values")
    return value
