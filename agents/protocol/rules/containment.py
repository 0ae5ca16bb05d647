"""R9: what is in a container, and what is sunk into something."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.plan.relations import EmbeddedIn, Inside
from agents.protocol.judging.relation_judge import Miss, asked, judged, smallest, surfaces
from agents.protocol.measures.contact import Embedding, Enclosure
from agents.protocol.rule import Rule, Subject

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from typing import Any

    from agents.protocol.findings import Finding
    from agents.protocol.measures.measure import Measures, Request


def _request(subject: Subject, relation: Inside | EmbeddedIn, frame: int | None) -> Enclosure | Embedding:
    inner, outer = relation.nodes
    own = surfaces(subject, inner)
    other = surfaces(subject, outer, but=own)
    if isinstance(relation, EmbeddedIn):
        return Embedding(own, other, frame)
    return Enclosure(own, other, subject.tolerances.noise(smallest(subject, own, other)), frame)


def _ask(subject: Subject) -> Iterator[Request[Any]]:
    def ask(subject: Subject, relation: Inside | EmbeddedIn, frame: int | None) -> Iterator[Request[Any]]:
        yield _request(subject, relation, frame)

    yield from asked(subject, Inside, EmbeddedIn, ask=ask)


def _misses(
    subject: Subject, measures: Measures, relation: Inside | EmbeddedIn, frame: int | None
) -> Iterable[Miss]:
    request = _request(subject, relation, frame)
    if isinstance(relation, EmbeddedIn):
        assert isinstance(request, Embedding)
        return _not_so_deep(subject, measures, relation, request)
    assert isinstance(request, Enclosure)
    return _not_inside(subject, measures, relation, request)


def _not_inside(subject: Subject, measures: Measures, relation: Inside, request: Enclosure) -> Iterator[Miss]:
    found = measures[request]
    tolerances = subject.tolerances
    least = 1 - (tolerances.outside_partial if relation.partial else tolerances.outside_share)
    if found.inside < least:
        content, container = relation.content, relation.container
        wall = f", {found.wall:.1%} in its wall" if found.wall > 0 else ""
        yield Miss(
            f"{found.inside:.1%} of {content!r} is inside {container!r}{wall}; it should be {least:.0%}.",
            found.inside,
            least,
            "",
            found.at,
            "Move the content into the cavity, below the rim and off the walls; or make it smaller.",
        )


def _not_so_deep(
    subject: Subject, measures: Measures, relation: EmbeddedIn, request: Embedding
) -> Iterator[Miss]:
    found = measures[request]
    most = subject.tolerances.depth_share * relation.depth
    if abs(found.depth - relation.depth) > most:
        yield Miss(
            f"{relation.part!r} is {found.depth * 1000:.1f} mm deep in {relation.host!r}; "
            f"planned are {relation.depth * 1000:g} mm.",
            found.depth,
            most,
            "m",
            found.at,
            "Push the part in, or pull it out, by the difference.",
        )


def _judge(subject: Subject, measures: Measures) -> Iterator[Finding]:
    return judged(R9, subject, measures, Inside, EmbeddedIn, misses=_misses)


R9 = Rule(
    "R9",
    "inside, embedded",
    "hard",
    "Inside(content, container): samples of the content's surface are in the container's cavity: not in its wall, and "
    "surrounded by it (an open one ends at its rim). EmbeddedIn(part, host, depth): so far the part would have to be "
    "pulled to be out of the host.",
    "Fruit that sticks through its bowl, or hovers over it, is the commonest mistake that a render hides.",
    "Move the one into the other, as far as planned.",
    _judge,
    _ask,
    needs_plan=True,
    tolerances=("outside_share", "outside_partial", "depth_share", "penetration", "penetration_share"),
)
RULES = (R9,)
