"""Runs rules over a scene: collects their measurement requests, has them measured in one batch, and judges."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from agents.protocol.causes import without_consequences
from agents.protocol.findings import Finding, Report
from agents.protocol.judging.old_bakes import as_played
from agents.protocol.measures.requests import Unmeasured, measure
from agents.protocol.rule import NO_PLAN, NotApplicable, RuleContext
from agents.protocol.structure import SceneStructure
from agents.protocol.tolerances import TOLERANCES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.plan.scene import ScenePlan
    from agents.protocol.facts import SceneFacts
    from agents.protocol.findings import Severity
    from agents.protocol.measures.requests import MeasureInBlender, Measures, Request
    from agents.protocol.rule import Rule


def verify(
    facts: SceneFacts,
    measure_in_blender: MeasureInBlender,
    rules: Sequence[Rule],
    plan: ScenePlan | None = None,
    *,
    plays: bool = False,
) -> Report:
    """Judges a scene by ``rules``. A rule that raises, or that cannot measure, gives a finding of its own.

    The last frame of what is not baked is judged if a rule follows motion, or if it ``plays``. Raises what
    ``measure_in_blender`` raises.
    """
    began = time.perf_counter()
    tolerances, refused = TOLERANCES.tightened(plan.tolerances if plan else {})
    unbaked = any(cache.on and (not cache.baked or cache.outdated) for cache in facts.caches)
    judges_end = plays or not unbaked or any(rule.follows_motion for rule in rules)
    context = RuleContext(facts, SceneStructure(facts), tolerances, plan, judges_end)
    findings = [_error("plan", "soft", f"The plan's tolerances: {reason}.") for reason in refused]
    not_applicable: dict[str, str] = {}
    requests: dict[Request[Any], None] = {}
    ready: list[Rule] = []
    for rule in rules:
        if rule.needs_plan and plan is None:
            not_applicable[rule.id] = NO_PLAN
            continue
        try:
            requests |= dict.fromkeys(rule.requests(context))
            ready.append(rule)
        except NotApplicable as reason:
            not_applicable[rule.id] = str(reason)
        except Exception as error:
            findings.append(_failed(rule, error))
    measures = measure(requests, measure_in_blender)
    passed: list[str] = []
    for rule in ready:
        try:
            of_rule = _judge(rule, context, measures)
        except NotApplicable as reason:
            not_applicable[rule.id] = str(reason)
            continue
        findings += of_rule
        if not of_rule:
            passed.append(rule.id)
    findings = without_consequences(findings)
    return Report(tuple(findings), tuple(passed), not_applicable, time.perf_counter() - began)


def _judge(rule: Rule, context: RuleContext, measures: Measures) -> list[Finding]:
    """The findings of a rule. Raises NotApplicable where it has nothing to judge."""
    findings: list[Finding] = []
    try:
        for finding in as_played(rule, context, rule.judge(context, measures)):
            findings.append(finding)
    except NotApplicable:
        if not findings:
            raise
    except Unmeasured as reason:
        findings.append(rule.undecided((), reason))
    except Exception as error:
        findings.append(_failed(rule, error))
    return findings


def _failed(rule: Rule, error: Exception) -> Finding:
    return _error(rule.id, rule.severity, f"The rule failed: {type(error).__name__}: {error}.")


def _error(rule: str, severity: Severity, message: str) -> Finding:
    return Finding(rule, severity, (), message, outcome="error")
