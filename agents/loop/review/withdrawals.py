"""What the planner took back of the plan: findings about it are told, and keep no stage open."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from agents.loop.record.events import Withdrew, read_event

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from typing import Any

    from agents.plan.tactical import Withdrawal
    from agents.protocol.findings import Finding

_TAKEN_BACK = "The planner took back what the plan says where these rules find it broken: {}."
_NOT_TO_BE_MENDED = "It is measured all the same, and not to be mended."


def withdrawn_in(rows: Iterable[Mapping[str, Any]]) -> Iterator[Withdrawal]:
    """What the planner took back in a run, as its journal has it."""
    for event in map(read_event, rows):
        if isinstance(event, Withdrew) and event.decision:
            yield from event.decision.withdraw


def as_soft(findings: Iterable[Finding], withdrawn: Sequence[Withdrawal]) -> tuple[list[Finding], str]:
    """The findings, those about what was withdrawn as soft ones, and what models are told of these ("": none)."""
    read: list[Finding] = []
    gone: list[Finding] = []
    for finding in findings:
        is_gone = any(withdrawal.covers(finding) for withdrawal in withdrawn)
        gone += [finding] if is_gone else []
        read.append(replace(finding, severity="soft") if is_gone else finding)
    if not gone:
        return read, ""
    named = dict.fromkeys(f"{finding.rule} {', '.join(dict.fromkeys(finding.objects))}" for finding in gone)
    hard = sum(finding.severity == "hard" for finding in read)
    left = f"{hard} hard beside {'it' if len(named) == 1 else 'them'}" if hard else "no other is hard"
    return (
        read,
        f"Withdrawn by the planner, and not counted, though told as hard below: {'; '.join(named)} ({left}).",
    )


def format_withdrawn(withdrawn: Sequence[Withdrawal], *, to_builder: bool = False) -> str:
    """What was withdrawn, in words; "" for nothing. ``to_builder``: for whoever would mend it."""
    if not withdrawn:
        return ""
    told = _TAKEN_BACK.format("; ".join(map(str, withdrawn)))
    return f"{told} {_NOT_TO_BE_MENDED}" if to_builder else told
