"""V1: declared contact is measured contact (paper, appendix "Scene Protocol and Verifier Ruleset")."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agents.protocol.judging.declared_contacts import DeclaredContact, declared_contacts
from agents.protocol.judging.move_advice import describe_closing_move, gap_vector
from agents.protocol.judging.sample_frames import relation_frames, sample_frames
from agents.protocol.judging.sizes import contact_gap
from agents.protocol.measures.geometry import GapMeasure, GapRequest
from agents.protocol.measures.requests import Measures, Names, Unmeasured
from agents.protocol.rule import NotApplicable, Rule, RuleContext
from agents.protocol.tolerances import CONTACT

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.findings import Finding

_NAMED = 6


@dataclass(frozen=True, slots=True)
class _ContactPair:
    """The surfaces of a declared contact, the frames at which it may hold, and the largest gap."""

    contact: DeclaredContact
    a: Names
    b: Names
    frames: tuple[int | None, ...]
    most: float

    @property
    def gaps(self) -> list[GapRequest]:
        return [GapRequest(self.a, self.b, frame, self.most) for frame in self.frames]


def _pairs(context: RuleContext) -> Iterator[_ContactPair]:
    """Every declared contact, once for those whose names stand for the same surfaces."""
    seen: set[frozenset[Names]] = set()
    for contact in declared_contacts(context):
        a, b = context.structure.surfaces_of(contact.a), context.structure.surfaces_of(contact.b)
        if _of_one_fluid(context, contact) or _of_own_parts(context, contact, a, b):
            continue  # they may touch, and need not
        if set(a) & set(b):  # a part touches the rest of its object
            a, b = (a, _without(b, a)) if len(a) < len(b) else (_without(a, b), b)
        key = frozenset((a, b))
        if key not in seen or not a or not b:
            seen.add(key)
            frames = (
                relation_frames(context, contact.relation)
                if contact.relation is not None
                else sample_frames(context, contact.a, contact.b)
            )
            if not frames:
                continue  # it is to touch once all has moved
            yield _ContactPair(contact, a, b, frames, contact_gap(context, a, b))


def _of_own_parts(context: RuleContext, contact: DeclaredContact, a: Names, b: Names) -> bool:
    """Whether an object of several meshes, or its root, is declared to touch itself; renders may show but one."""
    if not a or set(a) != set(b):
        return False
    item = context.structure.objects.get(contact.a)
    is_whole = contact.a in context.structure.by_name or (item is not None and item.is_root)
    owner = context.structure.logical_object_of(contact.a)
    return len(a) > 1 or (is_whole and owner is not None and len(owner.meshes) > 1)


def _of_one_fluid(context: RuleContext, contact: DeclaredContact) -> bool:
    """Whether a contact joins a fluid's domain and something in it of the same object, which needs no touch."""
    objects = context.structure.objects
    ends = [context.structure.logical_object_of(node) for node in (contact.a, contact.b)]
    domains = [node for node in (contact.a, contact.b) if node in objects and objects[node].is_fluid_domain]
    return bool(domains) and ends[0] is not None and ends[0] == ends[1]


def _without(names: Names, others: Names) -> Names:
    return tuple(name for name in names if name not in others)


def _requests(context: RuleContext) -> Iterator[GapRequest]:
    pairs = list(_pairs(context))
    if not pairs:
        raise NotApplicable("no contact is declared")
    for pair in pairs:
        if pair.a and pair.b:
            yield from pair.gaps


def _judge(context: RuleContext, measures: Measures) -> Iterator[Finding]:
    for pair in _pairs(context):
        if not pair.a or not pair.b:
            yield _invalid(context, pair.contact)
            continue
        nearest: tuple[GapMeasure, int | None] | None = None
        unmeasured: Unmeasured | None = None
        for request in pair.gaps:
            try:
                gap = measures[request]
            except Unmeasured as reason:
                unmeasured = reason
                continue
            if nearest is None or gap.distance < nearest[0].distance:
                nearest = gap, request.frame
        names = (pair.contact.a, pair.contact.b)
        if nearest is not None and nearest[0].distance <= pair.most:
            continue
        if nearest is None or unmeasured is not None:
            yield V1.undecided(names, unmeasured)
            continue
        gap, frame = nearest
        when = f" at frame {frame}" if frame is not None else ""
        move = describe_closing_move(context, (names[0], pair.a), (names[1], pair.b), gap_vector(gap))
        yield V1.finding(
            names,
            f"{names[0]!r} and {names[1]!r} are declared to touch ({pair.contact.by}), but are "
            f"{gap.distance * 1000:.1f} mm apart{when}.",
            # A moving object is where its animation puts it; a move at one frame would be no fix.
            fix=V1.fix
            if frame is not None or not move
            else f"{move}; or remove the declaration if they should not touch.",
            measured=gap.distance,
            tolerance=pair.most,
            unit="m",
            at=gap.here,
            frame=frame,
        )


def _invalid(context: RuleContext, contact: DeclaredContact) -> Finding:
    """The finding for a contact with something unknown, or of something with itself."""
    unknown = [node for node in (contact.a, contact.b) if not context.structure.surfaces_of(node)]
    problem = (
        f"names {unknown[0]!r}, but nothing of that name has a surface"
        if unknown
        else f"says that {contact.a!r} touches {contact.b!r}, which is the same object"
    )
    return V1.finding(
        (contact.a, contact.b),
        f"{contact.by} {problem}.",
        fix=_fix_of_name(context, unknown[0] if unknown else ""),
    )


def _fix_of_name(context: RuleContext, node: str) -> str:
    owner, _, part = node.partition("/")
    if part and (thing := context.structure.by_name.get(owner)):
        return (
            f"Call a mesh of {owner!r} {part!r} or {f'{owner}_{part}'!r}; its meshes are "
            f"{', '.join(map(repr, thing.surfaces[:_NAMED])) or 'none yet'}."
        )
    return "Name other meshes, roots or objects of the scene in contact_with, exactly as they are called."


V1 = Rule(
    "V1",
    "contact",
    "hard",
    "Objects that are declared to touch do: their nearest surfaces are at most ε apart.",
    "A leg that floats 5 mm above the floor looks right in a render, but falls or hangs in a simulation.",
    "Move one of the two until the surfaces meet, or remove the declaration if they should not touch.",
    _judge,
    _requests,
    tolerances=CONTACT,
)
RULES = (V1,)
