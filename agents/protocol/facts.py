"""What Blender says of a scene: plain facts, taken once, before anything is measured. Metres, radians, frames."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, Field

Vector = tuple[float, float, float]
Matrix = tuple[float, ...]  # 16 numbers, row by row


class _Facts(BaseModel):
    """Facts are never changed; what a newer snapshot adds is passed over."""

    model_config = ConfigDict(frozen=True, extra="ignore")


class Box(_Facts):
    """A box along the world's axes."""

    low: Vector
    high: Vector

    @property
    def size(self) -> Vector:
        """Its extent along each axis."""
        return (self.high[0] - self.low[0], self.high[1] - self.low[1], self.high[2] - self.low[2])

    @property
    def diagonal(self) -> float:
        """The length of its diagonal."""
        return sum(extent**2 for extent in self.size) ** 0.5

    @property
    def centre(self) -> Vector:
        """Its middle."""
        low, high = self.low, self.high
        return ((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2)

    def joined(self, other: Box) -> Box:
        """The smallest box around both."""
        low = tuple(map(min, self.low, other.low))
        high = tuple(map(max, self.high, other.high))
        return Box(low=(low[0], low[1], low[2]), high=(high[0], high[1], high[2]))

    def overlaps(self, other: Box, margin: float = 0.0) -> bool:
        """Whether they share space, or come within ``margin`` of it."""
        return all(
            self.low[axis] - margin <= other.high[axis] and other.low[axis] - margin <= self.high[axis]
            for axis in range(3)
        )


class CollectionFacts(_Facts):
    """A collection. ``parents`` are the collections that hold it ("": the scene's own), ``objects`` its direct ones."""

    name: str
    parents: tuple[str, ...] = ()
    objects: tuple[str, ...] = ()
    role: str | None = None
    deformation_kind: str | None = None
    motion_kind: str | None = None
    allows_disconnected: bool = False


class ModifierFacts(_Facts):
    """A modifier: its name, type, whether it is on for renders, and what it works with."""

    name: str
    type: str
    on: bool = True
    target: str | None = None


class ConstraintFacts(_Facts):
    """A constraint: its type, the object that it follows, and whether it is on."""

    type: str
    target: str | None = None
    on: bool = True


class RigidBodyFacts(_Facts):
    """A rigid body. ``active``: the solver moves it; ``kinematic``: it follows its animation all the time instead."""

    active: bool
    kinematic: bool = False
    enabled: bool = True


class ObjectFacts(_Facts):
    """An object.

    ``dimensions`` are the evaluated extents along its own axes, ``box`` is around the evaluated geometry in the world:
    both None for what has none. ``surface``: it, or what it makes instances of, has evaluated polygons. ``rendered``:
    renders show it; ``evaluated`` is false for what is hidden from the viewport or left out of the view layer. ``keys``
    counts keyframes by channel (``location``, ``rotation_euler``, …; ``other``) of curves that change over time,
    ``driven`` are such channels that drivers set; ``animated_shape_keys`` tells whether shape keys move it. ``fault``
    says why it could not be described, "" where it could.
    """

    name: str
    type: str
    data: str | None = None
    collections: tuple[str, ...] = ()
    parent: str | None = None
    is_root: bool = False
    contact_with: tuple[str, ...] = ()
    matrix: Matrix
    scale: Vector = (1.0, 1.0, 1.0)
    dimensions: Vector | None = None
    box: Box | None = None
    surface: bool = False
    polygons: int = 0
    rendered: bool = True
    evaluated: bool = True
    modifiers: tuple[ModifierFacts, ...] = ()
    constraints: tuple[ConstraintFacts, ...] = ()
    rigid_body: RigidBodyFacts | None = None
    force_field: str | None = None
    keys: dict[str, int] = Field(default_factory=dict[str, int])
    animated_shape_keys: bool = False
    drivers: int = 0
    driven: tuple[str, ...] = ()
    light: str | None = None
    energy: float = 0.0
    fault: str = ""

    @property
    def location(self) -> Vector:
        """Its origin in the world."""
        return (self.matrix[3], self.matrix[7], self.matrix[11])


class CacheFacts(_Facts):
    """A physics cache. ``kind`` is cloth, soft_body, particles, rigid_body, fluid, …; ``owner`` the modifier's name.

    ``missing`` is how many frames of a bake are not there; ``on``: its solver is switched on.
    """

    object: str
    kind: str
    owner: str = ""
    frame_start: int
    frame_end: int
    baked: bool = False
    outdated: bool = False
    missing: int = 0
    on: bool = True


class Facts(_Facts):
    """A scene at the frame that it stands at."""

    version: str
    scene: str
    frame: int
    frame_start: int
    frame_end: int
    fps: float
    gravity: Vector = (0.0, 0.0, -9.81)
    metres: float = Field(default=1.0, description="Metres in a unit of Blender's.")
    strict_grounding: bool = False
    camera: str | None = None
    world_light: float = 0.0
    collections: tuple[CollectionFacts, ...] = ()
    objects: tuple[ObjectFacts, ...] = ()
    caches: tuple[CacheFacts, ...] = ()

    @classmethod
    def read(cls, told: dict[str, Any]) -> Facts:
        """Facts from what the snapshot told. Raises pydantic's ValidationError."""
        return cls.model_validate(told)
