"""The facts that the audit reads of a .blend, once, with the file open at its first frame (``inside/facts.py``).

Lengths are metres (the scene's unit scale is applied), times are frames, masses kilograms. Names and enum items are
Blender's own. Everything is in a fixed order: the same file gives the same facts.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

Vector: TypeAlias = tuple[float, float, float]
CacheLocation: TypeAlias = Literal["blend", "disk", "external"]
Topology: TypeAlias = Literal["open", "closed"]
AnimationSource: TypeAlias = Literal["action", "nla", "driver"]

# Types of modifiers that simulate their object.
SOLVERS = ("CLOTH", "SOFT_BODY", "FLUID", "PARTICLE_SYSTEM", "DYNAMIC_PAINT")
# Types of objects that a render shows.
GEOMETRY = ("MESH", "CURVE", "SURFACE", "FONT", "META", "CURVES", "POINTCLOUD", "VOLUME", "GREASEPENCIL")


@dataclass(frozen=True, slots=True)
class PointCache:
    """The cache of a cloth, soft body, particle system or rigid-body world. ``range`` is its own.

    ``frames``: how many it holds; ``expected``: how many a bake over its whole range holds (for an emitter, only while
    there are particles).
    """

    range: tuple[int, int]
    step: int
    is_baked: bool
    frames: int
    expected: int
    where: CacheLocation


@dataclass(frozen=True, slots=True)
class FluidPart:
    """A part of a fluid's cache on disk (data, mesh, noise, particles, guiding)."""

    name: str
    first: int
    last: int
    frames: int


@dataclass(frozen=True, slots=True)
class FluidCache:
    """``kind``: REPLAY, MODULAR, ALL. ``baked``: the parts that Blender marks as baked. ``parts``: those on disk.

    ``directory``: as the file has it; ``moved``: it is missing, and one of the same name beside the file is used.
    """

    kind: str
    range: tuple[int, int]
    directory: str
    moved: bool
    baked: tuple[str, ...]
    parts: tuple[FluidPart, ...]

    def part(self, name: str) -> FluidPart | None:
        """The part of that name, if any of it is on disk."""
        return next((part for part in self.parts if part.name == name), None)


@dataclass(frozen=True, slots=True)
class Effectors:
    """Which collisions and force fields act on a simulation: collections (None: all), and weights of fields.

    ``weights``: by field type, and ALL; 1 if left out.
    """

    collisions: str | None = None
    fields: str | None = None
    weights: dict[str, float] = field(default_factory=dict[str, float])


@dataclass(frozen=True, slots=True)
class Cloth:
    """Settings of a cloth modifier. ``pin_group``: a vertex group's name, "" for none."""

    cache: PointCache
    pin_group: str
    use_collision: bool
    use_self_collision: bool
    effectors: Effectors


@dataclass(frozen=True, slots=True)
class SoftBody:
    """Settings of a soft-body modifier. ``goal_group``: a vertex group's name, "" for none."""

    cache: PointCache
    use_goal: bool
    goal_group: str
    effectors: Effectors


@dataclass(frozen=True, slots=True)
class Domain:
    """Settings of a fluid domain. ``kind``: LIQUID, GAS. ``flows``, ``effectors``: limiting collections; None: all.

    ``guide_source``: EFFECTOR, DOMAIN; ``guide_domain``: the guiding domain's object. ``low`` and ``high``: the corners
    of the domain's own box in world space, since its evaluated mesh may be the liquid.
    """

    kind: str
    resolution: int
    use_mesh: bool
    use_noise: bool
    use_guide: bool
    guide_source: str
    guide_domain: str | None
    flows: str | None
    effectors: str | None
    low: Vector
    high: Vector
    cache: FluidCache


@dataclass(frozen=True, slots=True)
class Fluid:
    """A fluid modifier. ``type``: DOMAIN, FLOW, EFFECTOR, NONE.

    ``kind``: of a domain LIQUID, GAS; of a flow LIQUID, SMOKE, BOTH, FIRE; of an effector COLLISION, GUIDE.
    ``behavior`` (flow): INFLOW, OUTFLOW, GEOMETRY. ``used``: the flow or effector takes part.
    """

    type: str
    kind: str = ""
    behavior: str = ""
    used: bool = True
    domain: Domain | None = None


@dataclass(frozen=True, slots=True)
class Particles:
    """A particle system. ``type``: EMITTER, HAIR (others show a fluid's). ``source``: VERT, FACE, VOLUME.

    ``emission``: first and last frame of birth. ``cache``: None for hair without dynamics. ``instance``: the object or
    collection (by name) that is shown for each particle.
    """

    name: str
    settings: str
    type: str
    count: int
    source: str
    emission: tuple[float, float]
    lifetime: float
    hair_dynamics: bool
    render_type: str
    instance: str | None
    effectors: Effectors
    cache: PointCache | None


@dataclass(frozen=True, slots=True)
class Modifier:
    """A modifier, with the settings of its simulation."""

    name: str
    type: str
    show_viewport: bool
    show_render: bool
    target: str | None = None  # object, collection or file that it takes its shape or motion from
    cloth: Cloth | None = None
    soft: SoftBody | None = None
    fluid: Fluid | None = None
    particles: Particles | None = None

    @property
    def on(self) -> bool:
        """Whether it is on in the viewport and in renders."""
        return self.show_viewport and self.show_render


@dataclass(frozen=True, slots=True)
class RigidBody:
    """``type``: ACTIVE, PASSIVE. ``in_world``: it is in the rigid-body world's collection. ``kinematic``: animated."""

    type: str
    shape: str
    mass: float
    enabled: bool
    kinematic: bool
    in_world: bool


@dataclass(frozen=True, slots=True)
class RigidConstraint:
    """A rigid-body constraint on an object, between ``first`` and ``second`` (objects)."""

    type: str
    enabled: bool
    first: str | None
    second: str | None
    disable_collisions: bool
    in_world: bool


@dataclass(frozen=True, slots=True)
class RigidWorld:
    """The scene's rigid-body world; ``bodies`` and ``constraints`` are names of objects."""

    enabled: bool
    bodies: tuple[str, ...]
    constraints: tuple[str, ...]
    cache: PointCache


@dataclass(frozen=True, slots=True)
class ForceField:
    """``type`` as Blender has it: WIND, TURBULENCE, …; never NONE."""

    type: str
    strength: float


@dataclass(frozen=True, slots=True)
class VertexGroup:
    """``weighted``: the number of vertices with a weight above zero in it."""

    name: str
    weighted: int


@dataclass(frozen=True, slots=True)
class Channel:
    """An animated property. ``path`` as in f-curves, without the axis; its numbers are those of its densest curve.

    ``keys``: number of keys (or samples); ``span``: frames from the first to the last of them. ``generated``: a driver
    or an f-curve modifier sets it at every frame. ``varies``: its values differ.
    """

    path: str
    way: AnimationSource
    keys: int
    span: float
    generated: bool
    varies: bool


@dataclass(frozen=True, slots=True)
class Constraint:
    """An active object constraint, and its sources of motion (objects, or a cache file)."""

    type: str
    targets: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ObjectAtFrame:
    """An evaluated object at a frame: the corners of its bounds in world space, its location, rotation (quaternion).

    Bounds are None if it has no extent.
    """

    frame: int
    low: Vector | None
    high: Vector | None
    location: Vector
    rotation: tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Object:
    """An object of the scene, or one that only a collection instance shows (``in_scene`` false).

    ``collections``: those that it is linked into, by name. ``instances``: the collection that it instances.
    ``moments``: at start, middle and end; if its motion was not played, at the start only. ``islands``: number of loose
    pieces of its mesh. ``follows``: objects that its motion may come from (parent, constraints, deforming modifiers).
    """

    name: str
    type: str
    in_scene: bool
    data: str | None
    library: str | None
    parent: str | None
    follows: tuple[str, ...]
    collections: tuple[str, ...]
    instances: str | None
    renders: bool
    vertices: int
    faces: int
    islands: int
    topology: Topology | None
    moments: tuple[ObjectAtFrame, ...]
    modifiers: tuple[Modifier, ...]
    rigid_body: RigidBody | None
    rigid_constraint: RigidConstraint | None
    force: ForceField | None
    vertex_groups: tuple[VertexGroup, ...]
    shape_keys: int
    shape_channels: tuple[Channel, ...]
    channels: tuple[Channel, ...]
    constraints: tuple[Constraint, ...]
    materials: tuple[str, ...]

    @property
    def size(self) -> Vector:
        """Its extent along the axes at the start."""
        moment = self.moments[0] if self.moments else None
        if moment is None or moment.low is None or moment.high is None:
            return (0.0, 0.0, 0.0)
        (a, b, c), (x, y, z) = moment.low, moment.high
        return (x - a, y - b, z - c)

    @property
    def diagonal(self) -> float:
        """The length of its bounds' diagonal at the start."""
        return sum(side * side for side in self.size) ** 0.5

    def of_type(self, *types: str) -> tuple[Modifier, ...]:
        """Its modifiers of these types, in their order."""
        return tuple(modifier for modifier in self.modifiers if modifier.type in types)


@dataclass(frozen=True, slots=True)
class Collection:
    """``objects``: those linked directly. ``properties``: custom ones that are text, numbers or booleans, as text."""

    name: str
    parent: str | None
    objects: tuple[str, ...]
    properties: dict[str, str]


@dataclass(frozen=True, slots=True)
class Library:
    """A linked .blend."""

    path: str
    missing: bool


@dataclass(frozen=True, slots=True)
class Scene:
    """The file's active scene. ``range``: its first and last frame.

    ``unplayed``: why its motion was not played; "" if it was. ``blender``: the version that read it; ``saved_by``: the
    version that wrote it (major, minor).
    """

    name: str
    blender: str
    saved_by: tuple[int, int]
    range: tuple[int, int]
    fps: float
    unit_scale: float
    camera: str | None
    unplayed: str
    objects: tuple[Object, ...]
    collections: tuple[Collection, ...]
    rigid_world: RigidWorld | None
    libraries: tuple[Library, ...]
    scripts: tuple[str, ...]  # what in the file would have run code on opening

    @property
    def length(self) -> int:
        """Frames of the clip."""
        return self.range[1] - self.range[0] + 1

    def moments(self) -> tuple[int, int, int]:
        """The sample frames: start, middle, end."""
        first, last = self.range
        return first, (first + last) // 2, last
