"""Runs the rules over a scene: facts, then one batch of measurements, then judgements."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from agents.protocol.findings import Finding, Report
from agents.protocol.measures.measure import Unmeasured, measure
from agents.protocol.rule import Idle, Subject
from agents.protocol.structure import Structure
from agents.protocol.tolerances import TOLERANCES

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from agents.plan.scene import ScenePlan
    from agents.protocol.facts import Facts
    from agents.protocol.findings import Severity
    from agents.protocol.measures.measure import Measures, Request
    from agents.protocol.rule import Rule

    Ask = Callable[[list[dict[str, Any]]], list[dict[str, Any]]]


def verify(facts: Facts, ask: Ask, rules: Sequence[Rule], plan: ScenePlan | None = None) -> Report:
    """Judges a scene by ``rules``. ``ask`` measures (see :func:`agents.protocol.measures.measure.measure`).

    A rule that raises, and one that could not measure, is a finding of its own. Raises what ``ask`` raises.
    """
    began = time.perf_counter()
    tolerances, refused = TOLERANCES.tightened(plan.tolerances if plan else {})
    subject = Subject(facts, Structure(facts), tolerances, plan)
    findings = [_error("plan", "soft", f"The plan's tolerances: {one}.") for one in refused]
    idle: dict[str, str] = {}
    requests: dict[Request[Any], None] = {}
    ready: list[Rule] = []
    for rule in rules:
        if rule.needs_plan and plan is None:
            idle[rule.id] = "there is no plan"
            continue
        try:
            requests |= dict.fromkeys(rule.requests(subject))
            ready.append(rule)
        except Idle as reason:
            idle[rule.id] = str(reason)
        except Exception as error:
            findings.append(_failed(rule, error))
    measures = measure(requests, ask)
    passed: list[str] = []
    for rule in ready:
        try:
            found = _judged(rule, subject, measures)
        except Idle as reason:
            idle[rule.id] = str(reason)
            continue
        findings += found
        if not found:
            passed.append(rule.id)
    return Report(tuple(findings), tuple(passed), idle, time.perf_counter() - began)


def _judged(rule: Rule, subject: Subject, measures: Measures) -> list[Finding]:
    """What a rule finds. Raises Idle where it has nothing to judge."""
    found: list[Finding] = []
    try:
        for one in rule.judge(subject, measures):
            found.append(one)
    except Idle:
        if not found:
            raise
    except Unmeasured as reason:
        found.append(rule.undecided((), reason))
    except Exception as error:
        found.append(_failed(rule, error))
    return found


def _failed(rule: Rule, error: Exception) -> Finding:
    return _error(rule.id, rule.severity, f"The rule failed: {type(error).__name__}: {error}.")


def _error(rule: str, severity: Severity, message: str) -> Finding:
    return Finding(rule, severity, (), message, outcome="error")
