"""The plan's relations as links between cards: objects that are alike share a card, relations that say alike a box.

So twelve dominoes with their thirty-six relations are one card with one line to the table.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from agents.plan.graph import held_by
from agents.plan.part import owner_of
from agents.plan.relations import (
    Aperture,
    CoMoves,
    Direction,
    Distributed,
    EmbeddedIn,
    Facing,
    FixedAttachment,
    Inside,
    NextTo,
    OnTopOf,
    Relation,
    StableAgainst,
    SupportedBy,
    SymmetricAbout,
)
from agents.protocol.report.text_format import fold_names, format_value
from simworlds.terminal.text import plain

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.plan.scene import PlannedObject, ScenePlan

_CATEGORIES: tuple[tuple[str, tuple[type, ...]], ...] = (
    ("contact", (SupportedBy, StableAgainst, FixedAttachment, Aperture)),
    ("containment", (Inside, EmbeddedIn)),
    ("arrangement", (Distributed, SymmetricAbout)),
    ("motion", (CoMoves,)),
)
CATEGORIES = ("contact", "containment", "placement", "arrangement", "motion")
_DIRECTED = (
    SupportedBy, StableAgainst, FixedAttachment, Aperture, Inside, EmbeddedIn, OnTopOf, Direction, Facing, CoMoves,
)  # fmt: skip
_FEWEST_ALIKE = 3
_NAMED = 2  # objects on a line's end


@dataclass(frozen=True, slots=True)
class RelationLink:
    """A relation, or a phase that sets off another. ``nodes`` are as the plan names them, the one it is about first."""

    word: str
    category: str
    nodes: tuple[str, ...]
    detail: str = ""
    is_directed: bool = True


@dataclass(slots=True)
class ObjectCard:
    """Objects that are alike. ``pills`` are the links that join nothing else: (word, category) → details."""

    objects: list[PlannedObject]
    pills: dict[tuple[str, str], list[str]] = field(default_factory=dict[tuple[str, str], "list[str]"])

    @property
    def name(self) -> str:
        """It in a few words."""
        return fold_names((one.name for one in self.objects), _NAMED)


@dataclass(slots=True)
class LinkBox:
    """Links between the same cards. ``subject`` is the card that they are about, None where they have no direction.

    ``used`` are, by card, the nodes that they join.
    """

    cards: tuple[int, ...]
    subject: int | None
    pills: dict[tuple[str, str], list[str]] = field(default_factory=dict[tuple[str, str], "list[str]"])
    used: dict[int, set[str]] = field(default_factory=dict[int, "set[str]"])


@dataclass(frozen=True, slots=True)
class LinkGraph:
    """All of it. ``held`` are pairs of cards: what is held, what holds it."""

    cards: list[ObjectCard]
    boxes: list[LinkBox]
    held: list[tuple[int, int]]


def make_link_graph(plan: ScenePlan) -> LinkGraph:
    """The plan's objects and relations, folded. What names an object that the plan does not have is left out."""
    cards = _cards(plan)
    card_of = {one.name: place for place, card in enumerate(cards) for one in card.objects}
    boxes: dict[object, LinkBox] = {}
    for link in (*map(_link, plan.relations), *_causes(plan)):
        owners = [owner_of(node) for node in link.nodes]
        if not all(owner in card_of for owner in owners):
            continue
        ends = [card_of[owner] for owner in owners]
        joined = tuple(dict.fromkeys(ends))
        key = (link.word, link.category)
        if len(joined) == 1:
            cards[joined[0]].pills.setdefault(key, []).append(link.detail)
            continue
        subject = joined[0] if link.is_directed else None
        same = (subject, frozenset(joined))
        box = boxes.setdefault(same, LinkBox(joined, subject))
        box.pills.setdefault(key, []).append(link.detail)
        for end, node in zip(ends, link.nodes, strict=True):
            box.used.setdefault(end, set()).add(node)
    held = {
        (card_of[owner_of(child)], card_of[owner_of(bearer)])
        for relation in plan.relations
        for child, bearer in held_by(relation)
        if owner_of(child) in card_of and owner_of(bearer) in card_of
    }
    return LinkGraph(cards, list(boxes.values()), sorted(pair for pair in held if pair[0] != pair[1]))


def label(card: ObjectCard, used: set[str]) -> str:
    """Which of a card's objects and parts a line leads to; "" for all of them as a whole."""
    owners = {owner_of(node) for node in used}
    parts = sorted({plain(node.partition("/")[2]) for node in used} - {""})
    words = [fold_names(sorted(owners), _NAMED)] if len(owners) < len(card.objects) else []
    return " · ".join([*words, *parts[:_NAMED]])


def format_pill(word: str, details: list[str]) -> str:
    """``NextTo ×11``."""
    return f"{word} ×{len(details)}" if len(details) > 1 else word


def category_of(relation: Relation) -> str:
    """What kind of relation it is."""
    return next((name for name, kinds in _CATEGORIES if isinstance(relation, kinds)), "placement")


def _link(relation: Relation) -> RelationLink:
    is_directed = isinstance(relation, _DIRECTED)
    return RelationLink(
        relation.kind, category_of(relation), relation.nodes, describe_terms(relation), is_directed
    )


def _causes(plan: ScenePlan) -> Iterator[RelationLink]:
    by_name = {phase.name: phase for phase in plan.motion.phases}
    for phase in plan.motion.phases:
        cause = by_name.get(phase.cause or "")
        if cause and cause is not phase:
            nodes = (cause.actor, phase.actor)
            yield RelationLink("sets off", "motion", nodes, f"{plain(cause.name)} → {plain(phase.name)}")


def describe_terms(relation: Relation) -> str:
    """What a relation says beyond its kind and whom it joins."""
    words = ""
    match relation:
        case NextTo(gap=(least, most)):
            words = f"{format_value(least, 'm')} to {format_value(most, 'm')} apart"
        case EmbeddedIn(depth=depth):
            words = f"{format_value(depth, 'm')} deep"
        case Inside(partial=True):
            words = "half of it may stick out"
        case Direction(frame=frame):
            words = f"as the {frame} has it"
        case Distributed():
            words = _describe_pattern(relation)
        case SymmetricAbout(normal=normal):
            words = f"normal {', '.join(f'{value:g}' for value in normal)}"
        case _:
            pass
    return words


def _describe_pattern(relation: Distributed) -> str:
    words = [relation.pattern]
    if relation.rows or relation.columns:
        words.append(f"{relation.rows or '?'} × {relation.columns or '?'}")
    if relation.radius is not None:
        words.append(f"radius {format_value(relation.radius, 'm')}")
    if isinstance(relation.spacing, float):
        words.append(f"every {format_value(relation.spacing, 'm')}")
    if relation.arc is not None:
        words.append(f"{relation.arc:g}°")
    if relation.facing:
        words.append(f"facing {relation.facing}")
    return ", ".join(words)


def _cards(plan: ScenePlan) -> list[ObjectCard]:
    """Members of a group, or of a numbered series, that have the same role share a card."""
    grouped: dict[str, tuple[str, ...]] = {}
    for place, group in enumerate(plan.groups):
        for name in group.members if len(group.members) >= _FEWEST_ALIKE else ():
            grouped.setdefault(name, ("group", str(place)))
    series: defaultdict[tuple[object, ...], list[PlannedObject]] = defaultdict(list)
    for one in plan.objects:
        series[(grouped.get(one.name) or ("stem", _stem(one.name)), one.role)].append(one)
    cards: list[ObjectCard] = []
    placed: set[str] = set()
    for one in plan.objects:
        key = (grouped.get(one.name) or ("stem", _stem(one.name)), one.role)
        if one.name in placed:
            continue
        members = series[key] if len(series[key]) >= _FEWEST_ALIKE else [one]
        placed.update(member.name for member in members)
        cards.append(ObjectCard(members))
    return cards


def _stem(name: str) -> str:
    """The name without its number, if it has one."""
    return name.rstrip("0123456789").rstrip("._ -") or name
