"""W1 and W2: what is connected (paper, appendix "Scene Protocol and Verifier Ruleset")."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING

from agents.plan.graph import reachable
from agents.protocol.judging.declared_contacts import declared_contacts
from agents.protocol.judging.sizes import diagonal_around
from agents.protocol.measures.geometry import PiecesRequest
from agents.protocol.measures.requests import Measures, Unmeasured
from agents.protocol.rule import NotApplicable, Rule, RuleContext
from agents.protocol.tolerances import CONTACT

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.findings import Finding
    from agents.protocol.structure import LogicalObject

_MAX_LISTED = 5


def _neighbours(context: RuleContext) -> dict[str, set[str]]:
    """Object → the objects that it is declared to touch."""
    neighbours: dict[str, set[str]] = defaultdict(set)
    for contact in declared_contacts(context):
        a = context.structure.logical_object_of(contact.a)
        b = context.structure.logical_object_of(contact.b)
        if a is not None and b is not None and a.name != b.name:
            neighbours[a.name].add(b.name)
            neighbours[b.name].add(a.name)
    return neighbours


def _planned_to_move(context: RuleContext) -> set[str]:
    """Objects that move by the plan: unless it declares a contact, they begin in the air, as is meant."""
    planned = context.plan.objects if context.plan else ()
    return {obj.name for obj in planned if obj.mechanism[1] != "none"}


def _ungrounded(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    structure = context.structure
    if not structure.logical_objects:
        raise NotApplicable("no collection is an object (L3)")
    strict = context.facts.strict_grounding or (context.plan is not None and context.plan.strict_grounding)
    neighbours = _neighbours(context)
    grounded = reachable(structure.grounds, lambda name: neighbours[name])
    airborne = set[str]() if strict else _planned_to_move(context)
    for obj in structure.logical_objects:
        if obj.name not in grounded and obj.surfaces and obj.name not in airborne:
            finding = W1.finding(
                (obj.name,), f"{obj.name!r} is not connected to the ground by declared contacts."
            )
            yield replace(finding, severity="hard") if strict else finding


def _pieces_request(context: RuleContext, obj: LogicalObject) -> PiecesRequest | None:
    names = obj.surfaces
    if len(names) < 2 or obj.collection.allows_disconnected:
        return None
    tolerances = context.tolerances
    return PiecesRequest(names, tolerances.contact, tolerances.contact_share, tolerances.contact_most)


def _requests(context: RuleContext) -> Iterator[PiecesRequest]:
    requests = [
        request for obj in context.structure.logical_objects if (request := _pieces_request(context, obj))
    ]
    if not requests:
        raise NotApplicable("no object has several meshes that must touch")
    yield from requests


def _disconnected(context: RuleContext, measures: Measures) -> Iterator[Finding]:
    for obj in context.structure.logical_objects:
        request = _pieces_request(context, obj)
        if request is None:
            continue
        try:
            pieces = measures[request].pieces
        except Unmeasured as reason:
            yield W2.undecided((obj.name,), reason)
            continue
        if len(pieces) > 1:
            largest = max(pieces, key=lambda piece: (len(piece), diagonal_around(context, piece)))
            loose = [name for piece in pieces if piece is not largest for name in piece]
            names = ", ".join(map(repr, loose[:_MAX_LISTED]))
            more = f" and {len(loose) - _MAX_LISTED} more" if len(loose) > _MAX_LISTED else ""
            yield W2.finding(
                (obj.name, *loose),
                f"{obj.name!r} is in {len(pieces)} pieces; not connected to the rest: {names}{more}.",
                measured=float(len(pieces)),
                tolerance=1.0,
            )


W1 = Rule(
    "W1",
    "grounded",
    "soft",
    "Every object is connected to an object of the ground by declared contacts. Hard under strict_grounding.",
    "What stands on nothing floats, and falls as soon as it is simulated.",
    "Declare what it touches (contact_with, or a relation of the plan); leave it if it should float.",
    _ungrounded,
)
W2 = Rule(
    "W2",
    "one piece",
    "soft",
    "The meshes of an object touch each other and form one piece, unless it allows_disconnected.",
    "A handle that does not touch its cup, or a leg that does not touch its table, is misplaced.",
    "Move the loose meshes until they touch, or tag the object allows_disconnected if they should be loose.",
    _disconnected,
    _requests,
    tolerances=CONTACT,
)
RULES = (W1, W2)
