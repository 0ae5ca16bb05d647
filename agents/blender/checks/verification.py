"""Runs the verifier on the open scene: gets its facts and measurements from Blender."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import ConfigDict, Field

from agents.plan.part import STAGES
from agents.protocol.engine import verify
from agents.protocol.facts import SceneFacts
from agents.protocol.findings import Finding
from agents.protocol.rules_by_stage import first_stage
from simworlds.counting import format_list
from simworlds.sandbox.errors import Refusal, ToolBroke
from simworlds.sandbox.replies import Claim, Frame, Name, Text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.blender.supervisor import Supervisor
    from agents.blender.tools.base import Call
    from agents.plan.scene import ScenePlan
    from agents.protocol.findings import Report
    from agents.protocol.rule import Rule

SNAPSHOT_SECONDS = 60.0
MEASURE_SECONDS = 600.0
_LISTED = 4
_PENETRATION = "V2"  # which looks at a few frames, not at all of them


class ScenePosition(Claim):
    """The open scene, and the frame that it is at."""

    scene: Name
    frame: Frame


class _Divergence(Claim):
    """A simulation that is not finite: its object, the first such frame, and likely causes."""

    object: Name
    frame: Frame
    causes: list[Text] = Field(max_length=20)


class _Unanswered(Claim):
    """An answer without a value, because a simulation is not finite."""

    model_config = ConfigDict(extra="forbid")
    unmeasured: Annotated[str, Field(max_length=4000)]
    diverged: _Divergence


def read_measures(count: int, value: Any) -> list[dict[str, Any]]:
    """Blender's answers to ``count`` requests; each is read by its request's own model. Raises ValueError."""
    if (
        not isinstance(value, list)
        or len(value) != count
        or not all(isinstance(each, dict) for each in value)
    ):
        raise ValueError(f"it does not hold {count} answers")
    for answer in value:
        if "diverged" in answer:
            _Unanswered.model_validate(answer)
    return value


def verify_scene(
    blender: Supervisor, rules: Sequence[Rule], plan: ScenePlan | None, call: Call, *, plays: bool = False
) -> Report:
    """Checks the open scene against rules. Raises BlenderError if Blender is lost or cannot give the facts.

    Simulations are stepped through only if a rule follows motion, or if it ``plays`` them; else the scene is judged at
    its first frame, and where it stands, while any is not baked. A simulation that is not finite is one finding, in
    place of all that could not be measured.
    """
    diverged: list[_Unanswered] = []

    def measure(requests: list[dict[str, Any]]) -> list[dict[str, Any]]:
        try:
            answers = blender.call(
                "measure",
                {"requests": requests},
                partial(read_measures, len(requests)),
                timeout=MEASURE_SECONDS,
                progress=call.progress,
                cancelled=call.cancelled,
            ).value
        except (Refusal, ToolBroke) as error:
            return [{"unmeasured": str(error)}] * len(requests)
        diverged.extend(_Unanswered.model_validate(answer) for answer in answers if "diverged" in answer)
        return answers

    facts = blender.call(
        "scene_facts", {}, SceneFacts.model_validate, timeout=SNAPSHOT_SECONDS, cancelled=call.cancelled
    ).value
    remarks: tuple[str, ...] = ()
    if not plays and not any(map(_follows_motion, rules)) and (waiting := _unbaked_caches(facts)):
        facts = facts.model_copy(update={"frame_end": facts.frame_start})
        remarks = (
            f"Judged at {_frames(facts)} only, since no rule here follows motion and these are not baked: "
            f"{format_list(waiting, _LISTED)}.",
        )
    elif facts.caches and any(rule.id == _PENETRATION for rule in rules):
        remarks = (f"{_PENETRATION} compares meshes at {_frames(facts)} only.",)
    report = replace(verify(facts, measure, rules, plan, plays=plays), remarks=remarks)
    return _as_one_cause(report, diverged[0]) if diverged else report


def _frames(facts: SceneFacts) -> str:
    """The frames at which what moves is compared, in words."""
    *others, last = sorted({facts.frame_start, facts.frame, facts.frame_end})
    return f"frames {', '.join(map(str, others))} and {last}" if others else f"frame {last}"


def _unbaked_caches(facts: SceneFacts) -> list[str]:
    """The caches that would be simulated if frames were stepped through, in words."""
    waiting = [cache for cache in facts.caches if cache.on and (not cache.baked or cache.outdated)]
    return [f"{cache.kind.replace('_', ' ')} of {cache.object or 'the scene'!r}" for cache in waiting]


def _follows_motion(rule: Rule) -> bool:
    return STAGES.index(first_stage(rule)) >= STAGES.index("motion")


def _as_one_cause(report: Report, answer: _Unanswered) -> Report:
    """The report with one finding for a simulation that is not finite, instead of one for each missing measure."""
    cause = answer.diverged
    finding = Finding(
        "simulation",
        "hard",
        (cause.object,),
        answer.unmeasured,
        f"{_capital('; or '.join(cause.causes))}."
        if cause.causes
        else "Change the solver's settings, and try again.",
        frame=cause.frame,
    )
    others = [other for other in report.findings if not _is_due_to(other, answer)]
    left = {other.rule for other in others}
    unjudged = {other.rule for other in report.findings} - left
    why = f"the simulation of {cause.object!r} breaks down at frame {cause.frame}"
    return replace(
        report,
        findings=(finding, *others),
        not_applicable={**report.not_applicable, **dict.fromkeys(sorted(unjudged), why)},
    )


def _is_due_to(finding: Finding, answer: _Unanswered) -> bool:
    return finding.outcome == "undecided" and answer.unmeasured in finding.message


def _capital(words: str) -> str:
    return words[:1].upper() + words[1:]
