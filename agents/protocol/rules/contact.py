"""V1: declared contact is measured contact (paper, appendix "Scene Protocol and Verifier Ruleset")."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agents.protocol.judging.contact_pairs import Contact, declared, smallest_diagonal
from agents.protocol.judging.move_advice import across, told_join
from agents.protocol.judging.sample_frames import moments
from agents.protocol.measures.measure import Gap, GapMeasure, Measures, Names, Unmeasured
from agents.protocol.rule import Idle, Rule, Subject

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.findings import Finding


@dataclass(frozen=True, slots=True)
class _Pair:
    """Two groups of surfaces that are said to touch, and when that may hold. ``a`` and ``b`` are the names given."""

    contact: Contact
    a: Names
    b: Names
    frames: tuple[int | None, ...]
    most: float

    @property
    def gaps(self) -> list[Gap]:
        return [Gap(self.a, self.b, frame, self.most) for frame in self.frames]


def _pairs(subject: Subject) -> Iterator[_Pair]:
    """Every declared contact, once for those whose names stand for the same surfaces."""
    seen: set[frozenset[Names]] = set()
    for contact in declared(subject):
        a, b = subject.structure.find(contact.a), subject.structure.find(contact.b)
        if set(a) & set(b):  # a part touches what is left of the object without it
            a, b = (a, _without(b, a)) if len(a) < len(b) else (_without(a, b), b)
        key = frozenset((a, b))
        if key not in seen or not a or not b:
            seen.add(key)
            most = subject.tolerances.contact_gap(smallest_diagonal(subject, a, b))
            yield _Pair(contact, a, b, moments(subject, contact.a, contact.b), most)


def _without(names: Names, others: Names) -> Names:
    return tuple(name for name in names if name not in others)


def _requests(subject: Subject) -> Iterator[Gap]:
    pairs = list(_pairs(subject))
    if not pairs:
        raise Idle("no contact is declared")
    for pair in pairs:
        if pair.a and pair.b:
            yield from pair.gaps


def _judge(subject: Subject, measures: Measures) -> Iterator[Finding]:
    for pair in _pairs(subject):
        if not pair.a or not pair.b:
            yield _nobody(subject, pair.contact)
            continue
        nearest: tuple[GapMeasure, int | None] | None = None
        reason: Unmeasured | None = None
        for gap in pair.gaps:
            try:
                found = measures[gap]
            except Unmeasured as told:
                reason = told
                continue
            if nearest is None or found.distance < nearest[0].distance:
                nearest = found, gap.frame
        names = (pair.contact.a, pair.contact.b)
        if nearest is not None and nearest[0].distance <= pair.most:
            continue
        if nearest is None or reason is not None:
            yield V1.undecided(names, reason)
            continue
        found, frame = nearest
        when = f" at frame {frame}" if frame is not None else ""
        move = told_join(subject, (names[0], pair.a), (names[1], pair.b), across(found))
        yield V1.finding(
            names,
            f"{names[0]!r} and {names[1]!r} are said to touch ({pair.contact.by}), but are "
            f"{found.distance * 1000:.1f} mm apart{when}.",
            # What moves is where something moves it to: at another frame it would be moved by something else.
            fix=V1.fix
            if frame is not None
            else f"{move}; or take the declaration back if they are not to touch.",
            measured=found.distance,
            tolerance=pair.most,
            unit="m",
            at=found.here,
            frame=frame,
        )


def _nobody(subject: Subject, contact: Contact) -> Finding:
    """What is said of a contact that joins nothing, or something with itself."""
    unknown = [node for node in (contact.a, contact.b) if not subject.structure.find(node)]
    said = (
        f"names {unknown[0]!r}, but there is nothing of that name with a surface"
        if unknown
        else f"says that {contact.a!r} touches {contact.b!r}, which is itself"
    )
    return V1.finding(
        (contact.a, contact.b),
        f"{contact.by} {said}.",
        fix="Name other meshes, roots or objects of the scene in contact_with, as they are called.",
    )


V1 = Rule(
    "V1",
    "contact",
    "hard",
    "What is declared to touch does: the nearest surfaces are at most ε apart.",
    "A leg that floats 5 mm above the floor looks right in a render and falls, or hangs, when the scene is simulated.",
    "Move one of the two until the surfaces meet, or take the declaration back if they are not to touch.",
    _judge,
    _requests,
    tolerances=("contact", "contact_share", "contact_most"),
)
RULES = (V1,)
