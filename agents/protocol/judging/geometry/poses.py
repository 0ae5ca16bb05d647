"""Where the nodes of a plan are, and how they are rotated: the requests, and the answers as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.protocol.judging.geometry.vectors import place_and_axes
from agents.protocol.measures.geometry import PosesRequest

if TYPE_CHECKING:
    from agents.protocol.judging.geometry.vectors import Array
    from agents.protocol.measures.requests import Measures
    from agents.protocol.rule import RuleContext


def anchor(context: RuleContext, node: str) -> str | None:
    """The object whose transform is the node's: its root Empty, or the mesh that a part is."""
    structure = context.structure
    if "/" not in node and node in structure.by_name:
        roots = structure.by_name[node].roots
        if roots:
            return roots[0].name
    surfaces = structure.surfaces_of(node)
    return surfaces[0] if surfaces else (node if node in structure.objects else None)


def pose_request(context: RuleContext, node: str, frame: int | None) -> PosesRequest | None:
    """The request for the pose of a node's anchor; None if it has none."""
    name = anchor(context, node)
    return None if name is None else PosesRequest((name,), frame)


def pose(context: RuleContext, measures: Measures, node: str, frame: int | None) -> tuple[Array, Array]:
    """(place, axes) of a node's anchor: the rows of ``axes`` are its own X, Y and Z in the world.

    Raises Unmeasured.
    """
    request = pose_request(context, node, frame)
    assert request is not None
    return place_and_axes(measures[request].matrices[request.names[0]])
