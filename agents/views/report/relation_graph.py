"""The plan's relation graph as a drawing: objects are cards, relations boxes between them, what bears is below."""

from __future__ import annotations

from collections import defaultdict, deque
from dataclasses import dataclass
from typing import TYPE_CHECKING

from agents.protocol.report.text_format import plain
from agents.views.formatting import shortened, swatch
from agents.views.report.graph_layout import Box, lay_out
from agents.views.report.links import Card, LinkBox, label, linked, told_pill

if TYPE_CHECKING:
    from agents.plan.scene import ScenePlan
    from agents.views.report.graph_layout import Point
    from agents.views.report.links import Linked

MOST = 160  # cards and boxes that one can still read
_MARGIN = 14.0
_LETTER, _SMALL_LETTER = 8.4, 6.9  # widths in pixels
_LONGEST = 30
_PILL, _ROW = 20.0, 23.0


@dataclass(frozen=True, slots=True)
class Pill:
    """A relation's kind, from the top left of its box."""

    x: float
    y: float
    width: float
    text: str
    category: str
    hint: str


@dataclass(frozen=True, slots=True)
class Shape:
    """A card (with ``title`` and ``note``) or a box of relations, by its top left. ``layers``: it stands for many."""

    x: float
    y: float
    width: float
    height: float
    pills: tuple[Pill, ...]
    title: str = ""
    note: str = ""
    hint: str = ""
    swatch: str = ""
    is_ground: bool = False
    layers: int = 1


@dataclass(frozen=True, slots=True)
class Line:
    """A line between a card and a box of relations, as an SVG path. ``at`` is where its label stands."""

    path: str
    category: str
    is_directed: bool
    label: str
    at: Point


@dataclass(frozen=True, slots=True)
class Drawing:
    """A drawing of that size in pixels."""

    width: float
    height: float
    cards: tuple[Shape, ...]
    boxes: tuple[Shape, ...]
    lines: tuple[Line, ...]


def draw_graph(plan: ScenePlan) -> Drawing | None:
    """The drawing; None where there are more cards and boxes than one can read."""
    graph = linked(plan)
    if len(graph.cards) + len(graph.boxes) > MOST:
        return None
    ranks = _ranks(graph)
    sizes = [_card_size(card) for card in graph.cards] + [_box_size(box) for box in graph.boxes]
    ranks += [_between(box, ranks) for box in graph.boxes]
    boxes = [Box(*size, rank) for size, rank in zip(sizes, ranks, strict=True)]
    first = len(graph.cards)
    ends = [(place, card) for place, box in enumerate(graph.boxes) for card in box.cards]
    laid = lay_out(boxes, [(card, first + place) for place, card in ends])

    def corner(place: int) -> Point:
        (x, y), box = laid.centres[place], boxes[place]
        return (x - box.width / 2 + _MARGIN, y - box.height / 2 + _MARGIN)

    return Drawing(
        laid.width + 2 * _MARGIN,
        laid.height + 2 * _MARGIN,
        tuple(_card(card, corner(place), sizes[place]) for place, card in enumerate(graph.cards)),
        tuple(
            _box(box, corner(first + place), sizes[first + place]) for place, box in enumerate(graph.boxes)
        ),
        tuple(
            _drawn_line(graph, graph.boxes[place], card, points)
            for (place, card), points in zip(ends, laid.lines, strict=True)
        ),
    )


# Ranks


def _ranks(graph: Linked) -> list[int]:
    """Even ranks: what is held stands above what holds it, what is not held beside those it is related to."""
    bearers: defaultdict[int, set[int]] = defaultdict(set)
    borne: defaultdict[int, set[int]] = defaultdict(set)
    for child, bearer in graph.held:
        bearers[child].add(bearer)
        borne[bearer].add(child)
    ranks = [0] * len(graph.cards)
    left = {card: len(bearers[card]) for card in range(len(graph.cards))}
    ready = deque(card for card, count in left.items() if not count)
    done: set[int] = set()
    while len(done) < len(left):
        if not ready:  # what leans on each other in a circle: somebody has to be the first
            ready.append(min(left.keys() - done, key=lambda card: (left[card], card)))
        card = ready.popleft()
        if card in done:
            continue
        done.add(card)
        ranks[card] = max((ranks[bearer] + 2 for bearer in bearers[card] & done), default=0)
        for child in sorted(borne[card] - done):
            left[child] -= 1
            if not left[child]:
                ready.append(child)
    for card in range(len(graph.cards)):
        if not bearers[card] and not borne[card]:
            near = [ranks[other] for box in graph.boxes if card in box.cards for other in box.cards]
            ranks[card] = max(near, default=0)
    return ranks


def _between(box: LinkBox, ranks: list[int]) -> int:
    """The odd rank for a box: between its cards, or above them all."""
    found = [ranks[card] for card in box.cards]
    if box.subject is not None and len(found) > 1:
        own = ranks[box.subject]
        others = [ranks[card] for card in box.cards if card != box.subject]
        if own > max(others):
            return own - 1
        if own < min(others):
            return min(others) - 1
    return max(found) - 1 if min(found) < max(found) else max(found) + 1


# Shapes


def _pill_texts(box: LinkBox | Card) -> list[tuple[str, str, str]]:
    """(text, category, hint)"""
    return [
        (told_pill(word, details), category, "; ".join(dict.fromkeys(filter(None, details))))
        for (word, category), details in box.pills.items()
    ]


def _pill_width(text: str) -> float:
    return len(text) * _SMALL_LETTER + 16


def _pills(box: LinkBox | Card, left: float, top: float) -> tuple[Pill, ...]:
    return tuple(
        Pill(left, top + place * _ROW, _pill_width(text), text, category, hint)
        for place, (text, category, hint) in enumerate(_pill_texts(box))
    )


def _card_words(card: Card) -> tuple[str, str]:
    one = card.objects[0]
    sizes = {other.dimensions for other in card.objects}
    note = " × ".join(f"{size:g}" for size in one.dimensions) + " m" if len(sizes) == 1 else "sizes differ"
    return shortened(card.name, _LONGEST), f"{one.role} · {note}"


def _card_size(card: Card) -> Point:
    title, note = _card_words(card)
    widest = max(
        [len(title) * _LETTER, len(note) * _SMALL_LETTER, *(_pill_width(t) for t, _, _ in _pill_texts(card))]
    )
    return (
        widest + (44 if card.objects[0].material else 24),
        46 + (4 + _ROW * len(card.pills) if card.pills else 0),
    )


def _card(card: Card, corner: Point, size: Point) -> Shape:
    title, note = _card_words(card)
    one = card.objects[0]
    return Shape(
        *corner, *size,
        pills=_pills(card, 12, 46),
        title=title,
        note=note,
        hint=plain(", ".join(other.name for other in card.objects[:40])),
        swatch=swatch(one.material.base_color) if one.material else "",
        is_ground=one.role == "ground",
        layers=min(3, len(card.objects)),
    )  # fmt: skip


def _box_size(box: LinkBox) -> Point:
    return (max(_pill_width(text) for text, _, _ in _pill_texts(box)), _ROW * len(box.pills) - (_ROW - _PILL))


def _box(box: LinkBox, corner: Point, size: Point) -> Shape:
    pills = _pills(box, 0, 0)
    return Shape(*corner, *size, pills=pills)


def _drawn_line(graph: Linked, box: LinkBox, card: int, points: tuple[Point, ...]) -> Line:
    placed = [(x + _MARGIN, y + _MARGIN) for x, y in points]
    (x, y), *rest = placed
    path = f"M{x:.1f} {y:.1f}"
    before = (x, y)
    for x, y in rest:
        bend = (before[1] + y) / 2
        path += f" C{before[0]:.1f} {bend:.1f} {x:.1f} {bend:.1f} {x:.1f} {y:.1f}"
        before = (x, y)
    near, far = placed[0], placed[1]
    return Line(
        path=path,
        category=next(category for _, category in box.pills),
        is_directed=box.subject is not None and card != box.subject,
        label=shortened(label(graph.cards[card], box.used[card]), _LONGEST),
        at=(near[0] * 0.7 + far[0] * 0.3, near[1] * 0.62 + far[1] * 0.38),
    )
