"""The facts of a scene as read from Blender once, before anything is measured. Metres, radians, frames."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict, Field

if TYPE_CHECKING:
    from collections.abc import Collection

Vector = tuple[float, float, float]
Matrix = tuple[float, ...]  # 16 numbers, row by row


class _Frozen(BaseModel):
    """Base class of the facts: frozen; fields that only a newer reader knows are ignored."""

    model_config = ConfigDict(frozen=True, extra="ignore")


class WorldBox(_Frozen):
    """A box along the world's axes."""

    low: Vector
    high: Vector

    @property
    def diagonal(self) -> float:
        """The length of its diagonal."""
        return sum((high - low) ** 2 for low, high in zip(self.low, self.high, strict=True)) ** 0.5

    def joined(self, other: WorldBox) -> WorldBox:
        """The smallest box around both."""
        low = tuple(map(min, self.low, other.low))
        high = tuple(map(max, self.high, other.high))
        return WorldBox(low=(low[0], low[1], low[2]), high=(high[0], high[1], high[2]))


class CollectionFacts(_Frozen):
    """A collection. ``parents``: the collections that hold it ("" is the scene's own); ``objects``: its direct ones."""

    name: str
    parents: tuple[str, ...] = ()
    objects: tuple[str, ...] = ()
    role: str | None = None
    deformation_kind: str | None = None
    motion_kind: str | None = None
    allows_disconnected: bool = False


class ModifierFacts(_Frozen):
    """A modifier. ``on``: it is switched on for renders. ``target``: the object that it works with.

    ``pinned``: it is a cloth with pins. ``copies``: the objects that a particle system shows its particles as.
    """

    name: str
    type: str
    on: bool = True
    target: str | None = None
    pinned: bool = False
    copies: tuple[str, ...] = ()


class ConstraintFacts(_Frozen):
    """A constraint. ``on``: it is switched on. ``target``: the object that it follows."""

    type: str
    target: str | None = None
    on: bool = True


class FluidFacts(_Frozen):
    """What an object is to the fluid solver.

    ``matter`` is liquid, gas (a domain) or smoke, fire, both, liquid (a flow); ``behavior`` of a flow: geometry, inflow
    or outflow. ``cell`` is the size of a domain's cells in metres. ``surface``: the domain's mesh is the liquid's
    surface, at least at some frame of its bake, not always only the domain's box.
    """

    role: str
    matter: str = ""
    behavior: str = ""
    cell: float = 0.0
    surface: bool = False


class RigidBodyFacts(_Frozen):
    """A rigid body. ``active``: the solver moves it; ``kinematic``: its animation moves it instead, all the time.

    ``off_centre``: how far the middle of its own mesh is from its origin, on which primitive collision shapes are
    centred; ``origin_outside``: how far its origin, its centre of mass, is outside the bounds of that mesh, 0 for the
    parts of a compound. Metres.
    """

    active: bool
    kinematic: bool = False
    enabled: bool = True
    shape: str = ""
    off_centre: float = 0.0
    origin_outside: float = 0.0


class ObjectFacts(_Frozen):
    """An object of Blender.

    ``dimensions`` are the evaluated extents along its own axes, ``box`` surrounds the evaluated geometry in the world;
    both are None for objects without geometry. ``surface``: it, or what it instances, has evaluated polygons.
    ``rendered``: renders show it. ``evaluated`` is false for objects that are hidden from the viewport or outside the
    view layer. ``keys`` counts keyframes by channel (``location``, ``rotation_euler``, …; ``other``) of curves that
    change over time; ``driven`` are the channels that drivers set; ``animated_shape_keys``: shape keys move it.
    ``rigged``: a bone carries it, by parent or constraint, or its parent deforms it.
    ``force_reach``: a force field has no effect beyond this many metres; None for no limit.
    ``fault`` says why it could not be described; it is "" where all went well.
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
    box: WorldBox | None = None
    surface: bool = False
    polygons: int = 0
    rendered: bool = True
    evaluated: bool = True
    modifiers: tuple[ModifierFacts, ...] = ()
    constraints: tuple[ConstraintFacts, ...] = ()
    rigid_body: RigidBodyFacts | None = None
    fluid: FluidFacts | None = None
    force_field: str | None = None
    force_strength: float = 1.0
    force_reach: float | None = None
    keys: dict[str, int] = Field(default_factory=dict[str, int])
    animated_shape_keys: bool = False
    rigged: bool = False
    drivers: int = 0
    driven: tuple[str, ...] = ()
    light: str | None = None
    energy: float = 0.0
    fault: str = ""

    def has_modifier(self, types: Collection[str]) -> bool:
        """Whether a modifier of one of the ``types`` is switched on."""
        return any(modifier.on and modifier.type in types for modifier in self.modifiers)

    @property
    def is_fluid_domain(self) -> bool:
        """Whether it is a fluid's domain, which encloses the simulation and is no body itself."""
        return any(modifier.type == "FLUID_DOMAIN" for modifier in self.modifiers)

    @property
    def is_only_a_box(self) -> bool:
        """Whether its mesh is only the box of a fluid's domain, without a liquid's surface: it is no body."""
        return self.fluid is not None and self.fluid.role == "domain" and not self.fluid.surface

    @property
    def is_gas(self) -> bool:
        """Whether it is the domain of smoke or fire."""
        return self.fluid is not None and (self.fluid.role, self.fluid.matter) == ("domain", "gas")

    @property
    def is_active_body(self) -> bool:
        """Whether it is a rigid body that the solver or its animation moves."""
        return self.rigid_body is not None and self.rigid_body.active and self.rigid_body.enabled


class JointFacts(_Frozen):
    """A rigid-body constraint at an object. ``a`` and ``b`` are the bodies; ``limited``: it limits how they move."""

    type: str
    a: str | None = None
    b: str | None = None
    limited: bool = False


class CacheFacts(_Frozen):
    """A physics cache. ``kind`` is cloth, soft_body, particles, rigid_body, fluid, …; ``owner`` is the modifier's name.

    ``missing`` counts the frames that a bake lacks; ``on``: its solver is switched on. ``changed``: what has changed
    since it was baked, as far as that is known.
    """

    object: str
    kind: str
    owner: str = ""
    frame_start: int
    frame_end: int
    baked: bool = False
    outdated: bool = False
    changed: tuple[str, ...] = ()
    missing: int = 0
    on: bool = True


class SceneFacts(_Frozen):
    """A scene at its current frame."""

    version: str
    scene: str
    frame: int
    frame_start: int
    frame_end: int
    fps: float
    gravity: Vector = (0.0, 0.0, -9.81)
    metres: float = Field(default=1.0, description="Metres in one Blender unit.")
    strict_grounding: bool = False
    camera: str | None = None
    world_light: float = 0.0
    collections: tuple[CollectionFacts, ...] = ()
    objects: tuple[ObjectFacts, ...] = ()
    caches: tuple[CacheFacts, ...] = ()
    joints: tuple[JointFacts, ...] = ()
