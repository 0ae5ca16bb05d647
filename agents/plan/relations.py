"""The relation graph: relations are nodes of their own, so that one may join any number of objects.

Source: the paper's "Bipartite plan graph" and its appendix "Scene Protocol and Verifier Ruleset".
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from agents.plan.part import Length, Node, Part, Vector

Reference = Annotated[
    Literal["world", "reference", "camera"],
    Field(
        description="Whose left and right: the world's (front is −Y), the second object's own, or the camera's."
    ),
]


class SupportedBy(Part):
    """The child rests on its parents: contact from below, stable."""

    kind: Literal["SupportedBy"]
    child: Node
    parents: tuple[Node, ...] = Field(min_length=1)

    @property
    def nodes(self) -> tuple[str, ...]:
        """Whom it joins."""
        return (self.child, *self.parents)


class StableAgainst(Part):
    """The child leans on the parent, or is flush with a face of it."""

    kind: Literal["StableAgainst"]
    child: Node
    parent: Node

    @property
    def nodes(self) -> tuple[str, ...]:
        """Whom it joins."""
        return (self.child, self.parent)


class FixedAttachment(Part):
    """The part is fastened to the host: touches it, and moves with it."""

    kind: Literal["FixedAttachment"]
    part: Node
    host: Node

    @property
    def nodes(self) -> tuple[str, ...]:
        """Whom it joins."""
        return (self.part, self.host)


class Aperture(Part):
    """The filler closes an opening of the host, as a window in a wall; its rim touches."""

    kind: Literal["Aperture"]
    filler: Node
    host: Node

    @property
    def nodes(self) -> tuple[str, ...]:
        """Whom it joins."""
        return (self.filler, self.host)


class Inside(Part):
    """The content lies in the container's cavity; an open container ends at its rim."""

    kind: Literal["Inside"]
    content: Node
    container: Node
    partial: bool = Field(default=False, description="Half of it may stick out.")

    @property
    def nodes(self) -> tuple[str, ...]:
        """Whom it joins."""
        return (self.content, self.container)


class EmbeddedIn(Part):
    """The part is sunk into the host, ``depth`` metres deep."""

    kind: Literal["EmbeddedIn"]
    part: Node
    host: Node
    depth: Length

    @property
    def nodes(self) -> tuple[str, ...]:
        """Whom it joins."""
        return (self.part, self.host)


class OnTopOf(Part):
    """``a`` is above ``b``, over it in plan view."""

    kind: Literal["OnTopOf"]
    a: Node
    b: Node

    @property
    def nodes(self) -> tuple[str, ...]:
        """Whom it joins."""
        return (self.a, self.b)


class NextTo(Part):
    """The surfaces of ``a`` and ``b`` are between ``gap[0]`` and ``gap[1]`` metres apart."""

    kind: Literal["NextTo"]
    a: Node
    b: Node
    gap: tuple[Annotated[float, Field(ge=0)], Annotated[float, Field(ge=0)]] = (0.0, 0.5)

    @model_validator(mode="after")
    def _ordered(self) -> NextTo:
        if self.gap[0] > self.gap[1]:
            raise ValueError(
                f"gap: the least distance, {self.gap[0]}, is more than the greatest, {self.gap[1]}"
            )
        return self

    @property
    def nodes(self) -> tuple[str, ...]:
        """Whom it joins."""
        return (self.a, self.b)


class Direction(Part):
    """``a`` lies on that side of ``b``, seen in ``frame``."""

    kind: Literal["LeftOf", "RightOf", "InFrontOf", "Behind", "Above", "Below"]
    a: Node
    b: Node
    frame: Reference = "world"

    @property
    def nodes(self) -> tuple[str, ...]:
        """Whom it joins."""
        return (self.a, self.b)


class Upright(Part):
    """The object's own Z axis points up."""

    kind: Literal["Upright"]
    a: Node

    @property
    def nodes(self) -> tuple[str, ...]:
        """Whom it joins."""
        return (self.a,)


class Facing(Part):
    """The front of ``a`` (its −Y axis) is turned to ``b``."""

    kind: Literal["Facing"]
    a: Node
    b: Node

    @property
    def nodes(self) -> tuple[str, ...]:
        """Whom it joins."""
        return (self.a, self.b)


class ParallelTo(Part):
    """The axes of ``a`` and ``b`` have the same directions."""

    kind: Literal["ParallelTo"]
    a: Node
    b: Node

    @property
    def nodes(self) -> tuple[str, ...]:
        """Whom it joins."""
        return (self.a, self.b)


class Distributed(Part):
    """The members stand regularly on a circle, an arc, a line or a grid.

    ``about`` is the centre: an object or a point in metres. ``radius`` and ``spacing`` are in metres, ``arc`` in
    degrees; what is not given is taken from the scene itself.
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

    @property
    def nodes(self) -> tuple[str, ...]:
        """Whom it joins."""
        return (*self.members, *((self.about,) if isinstance(self.about, str) else ()))


class SymmetricAbout(Part):
    """The members mirror each other in a plane, given by a point (metres) and a normal."""

    kind: Literal["SymmetricAbout"]
    members: tuple[Node, ...] = Field(min_length=2)
    point: Vector = (0.0, 0.0, 0.0)
    normal: Vector = (1.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _has_direction(self) -> SymmetricAbout:
        if not any(self.normal):
            raise ValueError("normal: a plane needs a direction; (0, 0, 0) is none")
        return self

    @property
    def nodes(self) -> tuple[str, ...]:
        """Whom it joins."""
        return self.members


class CoMoves(Part):
    """``a`` travels with ``b``."""

    kind: Literal["CoMoves"]
    a: Node
    b: Node

    @property
    def nodes(self) -> tuple[str, ...]:
        """Whom it joins."""
        return (self.a, self.b)


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
CONTACTS = (SupportedBy, StableAgainst, FixedAttachment, Aperture)
