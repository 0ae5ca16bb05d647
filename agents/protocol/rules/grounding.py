"""W1 and W2: what hangs together (paper, appendix "Scene Protocol and Verifier Ruleset")."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING

from agents.protocol.judging.contact_pairs import declared, diagonal_around
from agents.protocol.measures.measure import Measures, Pieces, Unmeasured
from agents.protocol.rule import Idle, Rule, Subject

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.findings import Finding
    from agents.protocol.structure import Thing


def _edges(subject: Subject) -> dict[str, set[str]]:
    """Object → the objects that it is declared to touch."""
    edges: dict[str, set[str]] = defaultdict(set)
    for contact in declared(subject):
        a, b = subject.structure.thing_of(contact.a), subject.structure.thing_of(contact.b)
        if a is not None and b is not None and a.name != b.name:
            edges[a.name].add(b.name)
            edges[b.name].add(a.name)
    return edges


def _reaches_the_ground(subject: Subject, _measures: Measures) -> Iterator[Finding]:
    structure = subject.structure
    if not structure.things:
        raise Idle("no collection is an object of the protocol")
    strict = subject.facts.strict_grounding or (subject.plan is not None and subject.plan.strict_grounding)
    edges, reached, waiting = _edges(subject), set[str](), list(structure.grounds)
    while waiting:
        name = waiting.pop()
        if name not in reached:
            reached.add(name)
            waiting += edges[name]
    for thing in structure.things:
        if thing.name not in reached and thing.surfaces:
            found = W1.finding(
                (thing.name,),
                f"Nothing that {thing.name!r} is declared to touch leads to an object of the ground.",
            )
            yield replace(found, severity="hard") if strict else found


def _pieces_of(subject: Subject, thing: Thing) -> Pieces | None:
    names = thing.surfaces
    if len(names) < 2 or thing.collection.allows_disconnected:
        return None
    allowed = subject.tolerances
    return Pieces(names, allowed.contact, allowed.contact_share, allowed.contact_most)


def _requests(subject: Subject) -> Iterator[Pieces]:
    wanted = [request for thing in subject.structure.things if (request := _pieces_of(subject, thing))]
    if not wanted:
        raise Idle("no object has several meshes that must touch")
    yield from wanted


def _is_one_piece(subject: Subject, measures: Measures) -> Iterator[Finding]:
    for thing in subject.structure.things:
        request = _pieces_of(subject, thing)
        if request is None:
            continue
        try:
            pieces = measures[request].pieces
        except Unmeasured as reason:
            yield W2.undecided((thing.name,), reason)
            continue
        if len(pieces) > 1:
            largest = max(pieces, key=lambda piece: (len(piece), diagonal_around(subject, piece)))
            loose = [name for piece in pieces if piece is not largest for name in piece]
            shown = ", ".join(map(repr, loose[:5])) + (
                f" and {len(loose) - 5} more" if len(loose) > 5 else ""
            )
            yield W2.finding(
                (thing.name, *loose),
                f"{thing.name!r} falls into {len(pieces)} pieces; apart from the rest: {shown}.",
                measured=float(len(pieces)),
                tolerance=1.0,
            )


W1 = Rule(
    "W1",
    "grounded",
    "soft",
    "Every object is connected to an object of the ground by declared contacts. Hard under strict_grounding.",
    "What stands on nothing floats, and falls as soon as it is simulated.",
    "Declare what it touches (contact_with, or a relation of the plan); or leave it, if it is to float.",
    _reaches_the_ground,
)
W2 = Rule(
    "W2",
    "one piece",
    "soft",
    "The meshes of an object touch each other, all of them in one piece, unless it allows_disconnected.",
    "A handle beside its cup, or a leg beside its table, is a mistake in placing.",
    "Move the loose meshes until they touch, or tag the object allows_disconnected if it is to be loose.",
    _is_one_piece,
    _requests,
    tolerances=("contact", "contact_share", "contact_most"),
)
RULES = (W1, W2)
