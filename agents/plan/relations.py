"""The relations of a plan: nodes of a bipartite graph, so that one relation can join any number of objects.

Source: the paper's "Bipartite plan graph" and its appendix "Scene Protocol and Verifier Ruleset".
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, model_validator

from agents.plan.part import Length, Node, PlanPart, Vector

if TYPE_CHECKING:
    from collections.abc import Iterator

_NODE_FIELDS = frozenset(
    {
        "child",
        "parent",
        "parents",
        "part",
        "host",
        "filler",
        "content",
        "container",
        "a",
        "b",
        "members",
        "about",
    }
)

Reference = Annotated[
    Literal["world", "reference", "camera"],
    Field(
        description="Whose left and right: the world's (front is −Y), the second object's own, or the camera's."
    ),
]


class RelationPart(PlanPart):
    """Base class of the relations.

    ``when`` it must hold: at the first or the last frame, only at the last (once all has moved), or at both.
    """

    when: Literal["start_or_end", "end", "always"] = "start_or_end"

    @property
    def named_nodes(self) -> Iterator[tuple[str, str]]:
        """(field, node) for every object that it joins: ``("child", "Cup")``, ``("parents[1]", "Table/Top")``."""
        for field in type(self).model_fields:
            value: Any = getattr(self, field)
            if field in _NODE_FIELDS and isinstance(value, str):
                yield field, value
            elif field in _NODE_FIELDS and isinstance(value, tuple):
                yield from ((f"{field}[{i}]", node) for i, node in enumerate(value) if isinstance(node, str))

    @property
    def nodes(self) -> tuple[str, ...]:
        """The objects that it joins, in the order of its fields."""
        return tuple(node for _, node in self.named_nodes)


class SupportedBy(RelationPart):
    """The child rests stably on its parents."""

    kind: Literal["SupportedBy"]
    child: Node
    parents: tuple[Node, ...] = Field(min_length=1)


class StableAgainst(RelationPart):
    """The child leans on the parent, or lies flush against one of its faces."""

    kind: Literal["StableAgainst"]
    child: Node
    parent: Node


class FixedAttachment(RelationPart):
    """The part is fastened to the host: it touches the host and moves with it."""

    kind: Literal["FixedAttachment"]
    part: Node
    host: Node


class Aperture(RelationPart):
    """The filler closes an opening in the host, as a window in a wall; it touches the rim."""

    kind: Literal["Aperture"]
    filler: Node
    host: Node


class Inside(RelationPart):
    """The content lies in the container's cavity; an open container ends at its rim."""

    kind: Literal["Inside"]
    content: Node
    container: Node
    partial: bool = Field(default=False, description="Up to half of the content may stick out.")


class EmbeddedIn(RelationPart):
    """The part is sunk into the host, ``depth`` metres deep."""

    kind: Literal["EmbeddedIn"]
    part: Node
    host: Node
    depth: Length


class OnTopOf(RelationPart):
    """``a`` is higher than ``b``, and over it when seen from above."""

    kind: Literal["OnTopOf"]
    a: Node
    b: Node


class NextTo(RelationPart):
    """The surfaces of ``a`` and ``b`` are between ``gap[0]`` and ``gap[1]`` metres apart."""

    kind: Literal["NextTo"]
    a: Node
    b: Node
    gap: tuple[Annotated[float, Field(ge=0)], Annotated[float, Field(ge=0)]] = (0.0, 0.5)

    @model_validator(mode="after")
    def _ordered(self) -> NextTo:
        if self.gap[0] > self.gap[1]:
            raise ValueError(
                f"gap: the smallest distance, {self.gap[0]}, is larger than the largest, {self.gap[1]}"
            )
        return self


class Direction(RelationPart):
    """``a`` lies on that side of ``b``, as seen in ``frame``."""

    kind: Literal["LeftOf", "RightOf", "InFrontOf", "Behind", "Above", "Below"]
    a: Node
    b: Node
    frame: Reference = "world"


# Kind of Direction → (axis of the frame, sign). The front is −Y, as in Blender's front view.
SIDES = {
    "LeftOf": (0, -1.0),
    "RightOf": (0, 1.0),
    "InFrontOf": (1, -1.0),
    "Behind": (1, 1.0),
    "Above": (2, 1.0),
    "Below": (2, -1.0),
}


class Upright(RelationPart):
    """The object's own Z axis points up."""

    kind: Literal["Upright"]
    a: Node


class Facing(RelationPart):
    """The front of ``a`` (its −Y axis) points to ``b``."""

    kind: Literal["Facing"]
    a: Node
    b: Node


class ParallelTo(RelationPart):
    """The axes of ``a`` and ``b`` point in the same directions."""

    kind: Literal["ParallelTo"]
    a: Node
    b: Node


class Distributed(RelationPart):
    """The members are evenly spaced on a circle, an arc, a line or a grid.

    ``about`` is the centre: an object or a point in metres. ``radius`` and ``spacing`` are in metres, ``arc`` in
    degrees; what is left out is measured in the scene.
    """

    kind: Literal["Distributed"]
    members: tuple[Node, ...] = Field(min_length=2)
    pattern: Literal["circle", "arc", "line", "grid"]
    fold: int | None = Field(default=None, ge=2, description="How many members there must be.")
    about: Node | Vector | None = None
    radius: Length | None = None
    spacing: Length | tuple[Length, Length] | None = None
    arc: float | None = Field(default=None, gt=0, le=360)
    rows: int | None = Field(default=None, ge=1)
    columns: int | None = Field(default=None, ge=1)
    facing: Literal["inwards", "outwards"] | None = None


class SymmetricAbout(RelationPart):
    """The members mirror each other across a plane, given by a point (metres) and a normal."""

    kind: Literal["SymmetricAbout"]
    members: tuple[Node, ...] = Field(min_length=2)
    point: Vector = (0.0, 0.0, 0.0)
    normal: Vector = (1.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _has_direction(self) -> SymmetricAbout:
        if not any(self.normal):
            raise ValueError("normal: (0, 0, 0) has no direction; give the direction across the plane")
        return self


class CoMoves(RelationPart):
    """``a`` moves with ``b`` and keeps its place relative to it."""

    kind: Literal["CoMoves"]
    a: Node
    b: Node


Relation = Annotated[
    SupportedBy
    | StableAgainst
    | FixedAttachment
    | Aperture
    | Inside
    | EmbeddedIn
    | OnTopOf
    | NextTo
    | Direction
    | Upright
    | Facing
    | ParallelTo
    | Distributed
    | SymmetricAbout
    | CoMoves,
    Field(discriminator="kind"),
]
CONTACTS = (SupportedBy, StableAgainst, FixedAttachment, Aperture, EmbeddedIn)
