"""Rules that judge relations of the plan: when a relation is checked, and what is reported where it does not hold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from agents.plan.relations import RelationPart
from agents.protocol.judging.sample_frames import relation_frames
from agents.protocol.measures.requests import Unmeasured
from agents.protocol.rule import NotApplicable, Rule

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from agents.protocol.facts import Vector
    from agents.protocol.findings import Finding
    from agents.protocol.measures.requests import Measures, Names, Request
    from agents.protocol.rule import RuleContext

Kind = TypeVar("Kind", bound=RelationPart)


@dataclass(frozen=True, slots=True)
class Violation:
    """One way in which a relation does not hold: a sentence, the measured value, and what to change.

    ``objects`` are those concerned, if not all that the relation joins.
    """

    sentence: str
    measured: float | None = None
    tolerance: float | None = None
    unit: str = ""
    at: Vector | None = None
    fix: str | None = None
    objects: tuple[str, ...] = ()


def relation_rule(  # noqa: PLR0913 - what a rule consists of
    rule_id: str,
    name: str,
    about: str,
    why: str,
    fix: str,
    *kinds: type[Kind],
    requests: Callable[[RuleContext, Kind, int | None], Iterable[Request[Any]]],
    violations: Callable[[RuleContext, Measures, Kind, int | None], Iterable[Violation]],
    tolerances: tuple[str, ...],
    only: Callable[[Kind], bool] | None = None,
    what: str = "",
) -> Rule:
    """A hard rule that judges the plan's relations of some ``kinds``, or ``only`` those that a test selects.

    ``requests`` yields what to measure for a relation at a frame, ``violations`` how it does
    not hold there (and may raise Unmeasured). ``what`` names the relations for plans without any.
    """

    def request(context: RuleContext) -> Iterator[Request[Any]]:
        relations = [relation for _, relation in relations_of(context, *kinds, only=only)]
        if not relations:
            raise NotApplicable(f"the plan has no {what or ' or '.join(kind.__name__ for kind in kinds)}")
        for relation in relations:
            if not _absent(context, relation):
                for frame in relation_frames(context, relation):
                    yield from requests(context, relation, frame)

    def judge(context: RuleContext, measures: Measures) -> Iterator[Finding]:
        for place, relation in relations_of(context, *kinds, only=only):
            if absent := _absent(context, relation):
                yield rule.undecided(relation.nodes, f"no object named {absent!r} has a surface")
                continue
            yield from _findings(rule, context, measures, (place, relation), violations)

    rule = Rule(
        rule_id, name, "hard", about, why, fix, judge, request, needs_plan=True, tolerances=tolerances
    )
    return rule


def _findings(
    rule: Rule,
    context: RuleContext,
    measures: Measures,
    indexed: tuple[int, Kind],
    violations: Callable[[RuleContext, Measures, Kind, int | None], Iterable[Violation]],
) -> Iterator[Finding]:
    """The findings of a relation that does not hold, from the frame that decides it.

    That is the one with the smallest violations, since a relation must hold at one of its frames; of a relation that
    must always hold, the one with the largest.
    """
    place, relation = indexed
    unmeasured: Unmeasured | None = None
    by_frame: list[tuple[int | None, list[Violation]]] = []
    for frame in relation_frames(context, relation):
        try:
            by_frame.append((frame, list(violations(context, measures, relation, frame))))
        except Unmeasured as reason:
            unmeasured = reason
    always = relation.when == "always"
    broken = [sample for sample in by_frame if sample[1]]
    holds = not broken if always else len(broken) < len(by_frame)
    if unmeasured is not None and (not broken if always else not holds):
        yield rule.undecided(relation.nodes, unmeasured)
        return
    if holds or not broken:  # or there is no frame yet at which it is to hold
        return
    decides = max if always else min
    frame, violated = decides(broken, key=lambda sample: (len(sample[1]), sum(map(_excess, sample[1]))))
    for violation in violated:
        yield rule.finding(
            violation.objects or relation.nodes,
            f"relations[{place}]: {violation.sentence}",
            fix=violation.fix or rule.fix,
            frame=frame,
            measured=violation.measured,
            tolerance=violation.tolerance,
            unit=violation.unit,
            at=violation.at,
        )


def _excess(violation: Violation) -> float:
    return abs((violation.measured or 0.0) - (violation.tolerance or 0.0))


def relations_of(
    context: RuleContext, *kinds: type[Kind], only: Callable[[Kind], bool] | None = None
) -> Iterator[tuple[int, Kind]]:
    """(index in the plan, relation) of some kinds; ``only`` may select among them."""
    for place, relation in enumerate(context.planned.relations):
        if isinstance(relation, kinds) and (only is None or only(relation)):
            yield place, relation


def surfaces(context: RuleContext, *nodes: str, but: Names = ()) -> Names:
    """The surfaces of some nodes, without ``but``, the surfaces of a node that is part of them."""
    names = dict.fromkeys(name for node in nodes for name in context.structure.surfaces_of(node))
    return tuple(name for name in names if name not in but)


def surface_pair(context: RuleContext, a: str, b: str) -> tuple[Names, Names]:
    """The surfaces of two nodes; if ``a`` is a part of ``b``, those of ``b`` without it."""
    own = surfaces(context, a)
    return own, surfaces(context, b, but=own)


def _absent(context: RuleContext, relation: RelationPart) -> str | None:
    """The first node without surfaces, or with no others than the relation's first node."""
    first, *rest = relation.nodes
    own = context.structure.surfaces_of(first)
    if not own:
        return first
    return next((node for node in rest if not surfaces(context, node, but=own)), None)
