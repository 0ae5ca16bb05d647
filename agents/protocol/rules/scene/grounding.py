"""W1 and W2: what is connected (paper, appendix "Scene Protocol and Verifier Ruleset")."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING

from agents.plan.graph import reachable
from agents.protocol.judging.declared_contacts import declarations
from agents.protocol.judging.sizes import diagonal_around
from agents.protocol.measures.geometry import PiecesRequest
from agents.protocol.measures.requests import Measures, Unmeasured
from agents.protocol.rule import NotApplicable, Rule, RuleContext
from agents.protocol.tolerances import CONTACT

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from agents.protocol.facts import WorldBox
    from agents.protocol.findings import Finding
    from agents.protocol.structure import LogicalObject

_MAX_LISTED = 5


class _Contacts:
    """Who is declared to touch whom: logical objects, and objects without tags that a declaration names."""

    def __init__(self, context: RuleContext) -> None:
        self._context = context
        self.neighbours: dict[str, set[str]] = defaultdict(set)
        self._holders: dict[str, dict[str, None]] = defaultdict(dict)  # in the order of the declarations
        self.untagged: set[str] = set()
        for contact in declarations(context):
            a, b = self._node(contact.a), self._node(contact.b)
            if a is not None and b is not None and a != b:
                self.neighbours[a].add(b)
                self.neighbours[b].add(a)
                self._holders[a][b] = None

    def _node(self, name: str) -> str | None:
        obj = self._context.structure.logical_object_of(name)
        if obj is not None:
            return obj.name
        if name in self._context.structure.owners or name not in self._context.structure.objects:
            return None
        self.untagged.add(name)
        return name

    def foot(self, name: str) -> str:
        """What it is connected to that declares no contact itself; the lowest where all declare each other."""
        found = reachable([name], lambda one: self._holders.get(one, ()))
        open_ones = [one for one in found if one not in self._holders]
        return open_ones[0] if open_ones else min(found, key=self._height)

    def _height(self, name: str) -> float:
        structure = self._context.structure
        names = structure.by_name[name].surfaces if name in structure.by_name else (name,)
        return min((box.low[2] for one in names if (box := _box(self._context, one))), default=math.inf)


def _resting(context: RuleContext, names: Iterable[str]) -> set[str]:
    """Those of some objects without tags that stand on the ground, by the boxes around them.

    In a scene without a tagged ground, the ground is what lies lowest.
    """
    structure = context.structure
    grounds = [
        box
        for name in structure.grounds
        for one in structure.by_name[name].surfaces
        if (box := _box(context, one))
    ]
    if not grounds:
        boxes = [
            mesh.box for mesh in structure.meshes if mesh.surface and mesh.rendered and mesh.box is not None
        ]
        grounds = [min(boxes, key=lambda box: (box.low[2], box.high[2]))] if boxes else []
    return {
        name
        for name in names
        if (box := _box(context, name)) and any(_is_on(context, box, ground) for ground in grounds)
    }


def _box(context: RuleContext, name: str) -> WorldBox | None:
    return context.structure.objects[name].box


def _is_on(context: RuleContext, box: WorldBox, ground: WorldBox) -> bool:
    """Whether a box ends in another one or on it, within what counts as contact."""
    gap = context.tolerances.contact_gap(min(box.diagonal, ground.diagonal))
    beside = any(box.high[axis] < ground.low[axis] or ground.high[axis] < box.low[axis] for axis in (0, 1))
    return not beside and ground.low[2] - gap <= box.low[2] <= ground.high[2] + gap


def _planned_to_move(context: RuleContext) -> set[str]:
    """Objects that move by the plan: unless it declares a contact, they begin in the air, as is meant."""
    planned = context.plan.objects if context.plan else ()
    return {obj.name for obj in planned if obj.mechanism[1] != "none"}


def _ungrounded(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    structure = context.structure
    if not structure.logical_objects:
        raise NotApplicable("no collection is an object (L3)")
    strict = context.facts.strict_grounding or (context.plan is not None and context.plan.strict_grounding)
    contacts = _Contacts(context)
    starts = {*structure.grounds, *_resting(context, contacts.untagged)}
    grounded = reachable(sorted(starts), lambda name: contacts.neighbours[name])
    airborne = set[str]() if strict else _planned_to_move(context)
    for obj in structure.logical_objects:
        if obj.name not in grounded and obj.surfaces and obj.name not in airborne:
            finding = _finding(obj.name, contacts.foot(obj.name))
            yield replace(finding, severity="hard") if strict else finding


def _finding(name: str, foot: str) -> Finding:
    """The finding about an object; ``foot`` is what lacks a contact, if it is not the object itself."""
    if name == foot:
        return W1.finding((name,), f"{name!r} is not connected to the ground by declared contacts.")
    return W1.finding(
        (name, foot),
        f"{name!r} is connected to {foot!r} by declared contacts, but {foot!r} to nothing that stands on the ground.",
        fix=f"Declare what {foot!r} touches (contact_with, or a relation of the plan); leave it if it should float.",
    )


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
