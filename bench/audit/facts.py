"""What the audit knows of a .blend: read once, with the file open at its first frame (``inside/facts.py``).

Lengths are metres (the scene's unit scale is applied), times are frames, masses kilograms. Names are Blender's own:
enum items in capitals as Python sees them. Everything is in a fixed order: the same file gives the same facts.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

Vector: TypeAlias = tuple[float, float, float]
CacheLocation: TypeAlias = Literal["blend", "disk", "external"]
Topology: TypeAlias = Literal["open", "closed"]
AnimationSource: TypeAlias = Literal["action", "nla", "driver"]

# What a modifier is called that simulates what it stands on.
SOLVERS = ("CLOTH", "SOFT_BODY", "FLUID", "PARTICLE_SYSTEM", "DYNAMIC_PAINT")
# Objects that a render shows as they are.
GEOMETRY = ("MESH", "CURVE", "SURFACE", "FONT", "META", "CURVES", "POINTCLOUD", "VOLUME", "GREASEPENCIL")


@dataclass(frozen=True, slots=True)
class PointCache:
    """The cache of a cloth, soft body, particle system or rigid-body world. ``range`` is its own.

    ``frames``: how many it holds; ``expected``: how many a bake over its whole range holds (an emitter has none before
    and after its particles). ``outdated`` is Blender's word for it, which a rigid-body world always gets on opening.
    """

    range: tuple[int, int]
    step: int
    is_baked: bool
    outdated: bool
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
    """``kind``: REPLAY, MODULAR, ALL. ``baked``: the parts that Blender calls baked. ``parts``: what lies on disk.

    ``directory`` as the file has it; ``moved``: it is not there, but one of the same name beside the file was taken.
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
    """What of force fields and collisions reaches a simulation: collections (None: all), and weights of fields.

    ``weights``: by field type in capitals, with ALL; 1 where left out.
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
    """Settings of a fluid domain. ``kind``: LIQUID, GAS. Collections that limit what takes part: None for all.

    ``guide_source``: EFFECTOR, DOMAIN; ``guide_domain``: an object, where it is a domain. ``low`` and ``high``: the
    corners of the domain's box in world space, whose evaluated surface may be the liquid's.
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

    ``emission``: first and last frame of birth. ``cache``: None for hair without dynamics. ``instance``: what it shows
    in a particle's place (an object's or a collection's name).
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
    """A modifier, where it stands in the stack, with the settings of whatever it simulates."""

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
        """Whether it acts, in the viewport and in the render."""
        return self.show_viewport and self.show_render


@dataclass(frozen=True, slots=True)
class RigidBody:
    """``type``: ACTIVE, PASSIVE. ``in_world``: is of the rigid-body world's collection. ``kinematic``: animated."""

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
    """``weighted``: how many vertices have a weight above zero in it."""

    name: str
    weighted: int


@dataclass(frozen=True, slots=True)
class Channel:
    """An animated property. ``path`` as in f-curves, without the axis; of all its curves the densest.

    ``keys``: how many it has (a baked curve's samples too); ``span``: frames from the first to the last of them.
    ``generated``: by a driver or an f-curve modifier, which give a value at every frame. ``varies``: not all the same.
    """

    path: str
    way: AnimationSource
    keys: int
    span: float
    generated: bool
    varies: bool


@dataclass(frozen=True, slots=True)
class Constraint:
    """An object constraint that is on, and what it takes motion from (objects, or a cache file)."""

    type: str
    targets: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ObjectAtFrame:
    """An object at a frame, evaluated: the corners of its bounds in world space, its place and rotation (quaternion).

    Bounds are None for what has no extent.
    """

    frame: int
    low: Vector | None
    high: Vector | None
    location: Vector
    rotation: tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Object:
    """An object of the scene, or one that only a collection instance shows (``in_scene`` false).

    ``collections``: those that it is linked into, by name. ``instances``: the collection that it shows. ``moments``: at
    start, middle and end; where the motion was not played, at the start alone. ``islands``: parts of its mesh that do
    not hang together.
    ``follows``: objects that its motion may come from (parent, constraints, deforming modifiers).
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
    """``objects``: linked into it itself. ``properties``: custom ones that are text, numbers or switches, as text."""

    name: str
    parent: str | None
    objects: tuple[str, ...]
    properties: dict[str, str]


@dataclass(frozen=True, slots=True)
class Library:
    """A .blend that is linked."""

    path: str
    missing: bool


@dataclass(frozen=True, slots=True)
class Scene:
    """The file's active scene. ``range``: its first and last frame.

    ``unplayed``: why its motion was not looked at; "" if it was.
    ``blender``: what read it; ``saved_by``: what wrote it (major, minor).
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
    scripts: tuple[str, ...]  # what in the file would have run code, had it been let

    @property
    def length(self) -> int:
        """Frames of the clip."""
        return self.range[1] - self.range[0] + 1

    def moments(self) -> tuple[int, int, int]:
        """The frames that are looked at: start, middle, end."""
        first, last = self.range
        return first, (first + last) // 2, last
