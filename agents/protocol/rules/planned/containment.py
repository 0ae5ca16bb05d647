"""R9: what is in a container, and what is embedded in a host."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.plan.relations import EmbeddedIn, Inside
from agents.protocol.judging.planned_relations import Violation, relation_rule, surface_pair
from agents.protocol.judging.sizes import smallest_dimension
from agents.protocol.measures.contact import EmbeddingRequest, EnclosureRequest
from agents.protocol.tolerances import PENETRATION

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from agents.protocol.measures.requests import Measures
    from agents.protocol.rule import RuleContext

_CELLS = 1.5  # of its solver that a liquid's surface may be in a wall: one to creep, and half a particle
_LIQUID_FIX = (
    "Let the domain's own border hold the liquid: its box ends one cell outside of the cavity's floor and walls; or "
    "use smaller cells. Lower particle_radius where the liquid gains volume."
)


def _embedding(context: RuleContext, relation: EmbeddedIn, frame: int | None) -> EmbeddingRequest:
    return EmbeddingRequest(*surface_pair(context, *relation.nodes), frame)


def _enclosure(context: RuleContext, relation: Inside, frame: int | None) -> EnclosureRequest:
    content, container = surface_pair(context, *relation.nodes)
    noise = context.tolerances.noise(smallest_dimension(context, content, container))
    # A liquid's surface is only as exact as the cells that it is computed on.
    noise = max([noise, *(_CELLS * cell for cell in _cells_of(context, content))])
    return EnclosureRequest(content, container, noise, frame)


def _cells_of(context: RuleContext, names: Iterable[str]) -> list[float]:
    """The sizes of the cells of fluids, in metres."""
    return [fluid.cell for name in names if (fluid := context.structure.objects[name].fluid) is not None]


def _requests(
    context: RuleContext, relation: Inside | EmbeddedIn, frame: int | None
) -> Iterator[EmbeddingRequest | EnclosureRequest]:
    if isinstance(relation, EmbeddedIn):
        yield _embedding(context, relation, frame)
    else:
        yield _enclosure(context, relation, frame)


def _violations(
    context: RuleContext, measures: Measures, relation: Inside | EmbeddedIn, frame: int | None
) -> Iterable[Violation]:
    if isinstance(relation, EmbeddedIn):
        return _wrong_depth(context, measures, relation, _embedding(context, relation, frame))
    return _outside(context, measures, relation, _enclosure(context, relation, frame))


def _outside(
    context: RuleContext, measures: Measures, relation: Inside, request: EnclosureRequest
) -> Iterator[Violation]:
    enclosed = measures[request]
    tolerances = context.tolerances
    least = 1 - (tolerances.outside_partial if relation.partial else tolerances.outside_share)
    if enclosed.inside < least:
        wall = f", {enclosed.wall:.1%} is in its wall" if enclosed.wall > 0 else ""
        yield Violation(
            f"{enclosed.inside:.1%} of {relation.content!r} is inside {relation.container!r}{wall}; "
            f"at least {least:.0%} must be.",
            enclosed.inside,
            least,
            "",
            enclosed.at,
            _LIQUID_FIX
            if _cells_of(context, request.content)
            else "Move the content into the cavity, below the rim and clear of the walls, or make it smaller.",
        )


def _wrong_depth(
    context: RuleContext, measures: Measures, relation: EmbeddedIn, request: EmbeddingRequest
) -> Iterator[Violation]:
    embedded = measures[request]
    most = context.tolerances.depth_share * relation.depth
    if abs(embedded.depth - relation.depth) > most:
        yield Violation(
            f"{relation.part!r} is {embedded.depth * 1000:.1f} mm deep in {relation.host!r}; "
            f"the plan says {relation.depth * 1000:g} mm.",
            embedded.depth,
            most,
            "m",
            embedded.at,
            "Push the part in, or pull it out, by the difference.",
        )


R9 = relation_rule(
    "R9",
    "inside, embedded",
    "Inside(content, container): the content's surface is in the container's cavity, not in its wall; an open "
    "container ends at its rim. EmbeddedIn(part, host, depth): the part would have to be pulled that far to leave the "
    "host.",
    "Fruit that sticks through its bowl, or hovers over it, is the most common mistake that a render hides.",
    "Move one into the other, as far as planned.",
    Inside,
    EmbeddedIn,
    requests=_requests,
    violations=_violations,
    tolerances=("outside_share", "outside_partial", "depth_share", *PENETRATION),
)
RULES = (R9,)
