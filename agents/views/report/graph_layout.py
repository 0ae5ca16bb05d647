"""Places boxes in layers so that the lines between them cross little and run straight. The same input, the same output.

Boxes get their rank (0 at the bottom) from the caller. The order within a rank is found by sweeps that put each box at
the mean of its neighbours, the best of which is kept; then boxes are moved as near to their neighbours as that order
lets them (least squares, by pooling those that would overlap).
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from itertools import combinations, pairwise

Point = tuple[float, float]

_SWEEPS = 16
_PULLS = 24
_PORTS, _PORT_GAP = 0.7, 64.0  # of a box's side, lines may leave from so much; pixels between them at most
_ACROSS, _BETWEEN, _PASSING = 30.0, 38.0, 14.0  # pixels: beside each other, rank from rank, room for a line


@dataclass(frozen=True, slots=True)
class LayoutBox:
    """Something to be placed; sizes in pixels."""

    width: float
    height: float
    rank: int


@dataclass(frozen=True, slots=True)
class GraphLayout:
    """``centres`` of the boxes, and ``lines`` of points, one for each edge, in the order in which they were given."""

    centres: tuple[Point, ...]
    lines: tuple[tuple[Point, ...], ...]
    width: float
    height: float


def lay_out(boxes: list[LayoutBox], edges: list[tuple[int, int]]) -> GraphLayout:
    """Places ``boxes``; ``edges`` join two of them, of different ranks, by their places in the list."""
    if not boxes:
        return GraphLayout((), (), 0.0, 0.0)
    nodes, chains = _with_passages(boxes, edges)
    beside = _neighbours(chains, len(nodes))
    ranks = _ordered(nodes, beside)
    across = _across(nodes, ranks, beside)
    down = _down(nodes, ranks)
    left = min(x - node.width / 2 for x, node in zip(across, nodes, strict=True))
    points = [(x - left, down[node.rank] - node.height / 2) for x, node in zip(across, nodes, strict=True)]
    width = max(x + node.width / 2 for (x, _), node in zip(points, nodes, strict=True))
    height = max(y + node.height / 2 for (_, y), node in zip(points, nodes, strict=True))
    lines = _lines(chains, nodes, points)
    return GraphLayout(tuple(points[: len(boxes)]), lines, width, height)


def _with_passages(
    boxes: list[LayoutBox], edges: list[tuple[int, int]]
) -> tuple[list[LayoutBox], list[list[int]]]:
    """The boxes, and room in every rank that a line passes; each line as the chain of those that it joins."""
    nodes, chains = list(boxes), list[list[int]]()
    for start, end in edges:
        low, high = boxes[start].rank, boxes[end].rank
        step = 1 if high > low else -1
        chain = [start]
        for rank in range(low + step, high, step):
            chain.append(len(nodes))
            nodes.append(LayoutBox(_PASSING, 0.0, rank))
        chains.append([*chain, end])
    return nodes, chains


def _neighbours(chains: list[list[int]], count: int) -> list[list[int]]:
    beside: list[list[int]] = [[] for _ in range(count)]
    for chain in chains:
        for one, other in pairwise(chain):
            beside[one].append(other)
            beside[other].append(one)
    return beside


def _ordered(nodes: list[LayoutBox], beside: list[list[int]]) -> list[list[int]]:
    """The nodes of each rank, from left to right."""
    by_rank: defaultdict[int, list[int]] = defaultdict(list)
    for place, node in enumerate(nodes):
        by_rank[node.rank].append(place)
    ranks = [by_rank[rank] for rank in sorted(by_rank)]
    best, least = [list(rank) for rank in ranks], _crossings(ranks, beside)
    for sweep in range(_SWEEPS):
        if not least:
            break
        order = ranks if sweep % 2 else ranks[::-1]
        for fixed, free in pairwise(order):
            place = {node: number for number, node in enumerate(fixed)}
            now = {node: number for number, node in enumerate(free)}
            free.sort(key=lambda node, place=place, now=now: _mean(beside[node], place, now[node]))
        crossings = _crossings(ranks, beside)
        if crossings < least:
            best, least = [list(rank) for rank in ranks], crossings
    return best


def _mean(beside: list[int], place: dict[int, int], otherwise: float) -> float:
    found = [place[node] for node in beside if node in place]
    return sum(found) / len(found) if found else otherwise


def _crossings(ranks: list[list[int]], beside: list[list[int]]) -> int:
    count = 0
    for low, high in pairwise(ranks):
        place = {node: number for number, node in enumerate(high)}
        ends = [sorted(place[other] for other in beside[node] if other in place) for node in low]
        count += sum(a > b for left, right in combinations(ends, 2) for a in left for b in right)
    return count


def _across(nodes: list[LayoutBox], ranks: list[list[int]], beside: list[list[int]]) -> list[float]:
    """Where each node's centre is, from left to right."""
    across = [0.0] * len(nodes)
    for rank in ranks:
        _pool(rank, [0.0] * len(rank), nodes, across)
    for pull in range(_PULLS):
        for rank in ranks if pull % 2 else ranks[::-1]:
            wanted = [
                sum(across[other] for other in beside[node]) / len(beside[node])
                if beside[node]
                else across[node]
                for node in rank
            ]
            _pool(rank, wanted, nodes, across)
    return across


def _pool(rank: list[int], wanted: list[float], nodes: list[LayoutBox], across: list[float]) -> None:
    """Puts the nodes of a rank as near as can be to where they are wanted, without overlap and in their order."""
    offsets = [0.0]
    for one, other in pairwise(rank):
        offsets.append(offsets[-1] + (nodes[one].width + nodes[other].width) / 2 + _ACROSS)
    pools: list[tuple[float, int]] = []  # mean, count
    for want, offset in zip(wanted, offsets, strict=True):
        mean, count = want - offset, 1
        while pools and pools[-1][0] > mean:
            before, more = pools.pop()
            mean, count = (mean * count + before * more) / (count + more), count + more
        pools.append((mean, count))
    starts = [mean for mean, count in pools for _ in range(count)]
    for node, start, offset in zip(rank, starts, offsets, strict=True):
        across[node] = start + offset


def _down(nodes: list[LayoutBox], ranks: list[list[int]]) -> dict[int, float]:
    """Where the boxes of each rank stand, as a distance from the top."""
    down: dict[int, float] = {}
    y = 0.0
    for rank in reversed(ranks):
        tall = max(nodes[node].height for node in rank)
        down[nodes[rank[0]].rank] = y + tall
        y += tall + _BETWEEN
    return down


def _lines(
    chains: list[list[int]], nodes: list[LayoutBox], points: list[Point]
) -> tuple[tuple[Point, ...], ...]:
    """From box to box; what leaves a box by the same side leaves it side by side, in the order of where it goes."""
    leaving: defaultdict[tuple[int, bool], list[tuple[float, int, bool]]] = defaultdict(list)
    for number, chain in enumerate(chains):
        for is_end, (box, following) in enumerate((chain[:2], chain[:-3:-1])):
            up = points[following][1] < points[box][1]
            leaving[box, up].append((points[following][0], number, bool(is_end)))
    ports: dict[tuple[int, bool], Point] = {}
    for (box, up), found in leaving.items():
        x, y = points[box]
        room = nodes[box].width * _PORTS / max(1, len(found) - 1)
        gap = min(room, _PORT_GAP)
        for place, (_, number, is_end) in enumerate(sorted(found)):
            across = x + (place - (len(found) - 1) / 2) * gap
            ports[number, is_end] = (across, y + (-1 if up else 1) * nodes[box].height / 2)
    return tuple(
        (ports[number, False], *(points[node] for node in chain[1:-1]), ports[number, True])
        for number, chain in enumerate(chains)
    )
