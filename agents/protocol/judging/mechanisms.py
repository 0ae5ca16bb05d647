"""What moves and deforms an object, by the facts: solvers, their caches, rigs and keys."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agents.protocol.structure import is_animated

if TYPE_CHECKING:
    from agents.protocol.facts import CacheFacts, ObjectFacts
    from agents.protocol.structure import LogicalObject, SceneStructure

MIN_DENSE_KEYS = 5
_CHANNELS = ("location", "rotation_euler", "rotation_quaternion", "rotation_axis_angle")
TRANSFORMS = (*_CHANNELS, *(f"delta_{channel}" for channel in _CHANNELS))
_RECORDINGS = {"MESH_CACHE": "Mesh Cache", "MESH_SEQUENCE_CACHE": "Mesh Sequence Cache"}
_DEFORMERS = frozenset(
    {"ARMATURE", "LATTICE", "CURVE", "HOOK", "MESH_DEFORM", "SIMPLE_DEFORM", "WAVE", "SURFACE_DEFORM"}
)
# deformation_kind → (the solver's modifiers, the kinds of its caches, what to call it).
SOLVERS: dict[str, tuple[frozenset[str], frozenset[str], str]] = {
    "sim_cloth": (frozenset({"CLOTH"}), frozenset({"cloth"}), "cloth modifier"),
    "sim_soft": (frozenset({"SOFT_BODY"}), frozenset({"soft_body"}), "soft-body modifier"),
    "sim_particle": (frozenset({"PARTICLE_SYSTEM"}), frozenset({"particles", "hair"}), "particle system"),
    "sim_fluid": (frozenset({"FLUID_DOMAIN", "FLUID_FLOW"}), frozenset({"fluid"}), "fluid domain or flow"),
    "sim_rigid": (frozenset(), frozenset({"rigid_body"}), "active rigid body"),
}


@dataclass(frozen=True, slots=True)
class Solver:
    """A solver in an object: ``actors`` are what it moves (none if it is off or absent), ``caches`` keep its result."""

    kind: str
    actors: tuple[ObjectFacts, ...]
    caches: tuple[CacheFacts, ...]


def solver_of(structure: SceneStructure, obj: LogicalObject, kind: str) -> Solver:
    """The solver of a kind (``sim_…``) in an object."""
    modifiers, cache_kinds, _ = SOLVERS[kind]
    caches = tuple(cache for cache in structure.facts.caches if cache.kind in cache_kinds)
    if kind == "sim_rigid":
        bodies = tuple(item for item in obj.members if _is_simulated_body(item))
        return Solver(kind, bodies, caches)
    actors = tuple(item for item in obj.members if item.has_modifier(modifiers))
    names = {item.name for item in actors}
    own = tuple(cache for cache in caches if cache.object in names)
    # A fluid's flow has no cache: its liquid is in the domain's.
    return Solver(kind, actors, caches if kind == "sim_fluid" and not own else own)


def _is_simulated_body(item: ObjectFacts) -> bool:
    return item.is_active_body and item.rigid_body is not None and not item.rigid_body.kinematic


def active_solvers(structure: SceneStructure, obj: LogicalObject) -> list[str]:
    """The kinds of solvers that move an object."""
    return [kind for kind in SOLVERS if _is_active(solver_of(structure, obj, kind))]


def _is_active(solver: Solver) -> bool:
    # Hair without dynamics is a particle system too; it has no cache.
    return bool(solver.actors) and (solver.kind != "sim_particle" or bool(solver.caches))


def has_rig(structure: SceneStructure, obj: LogicalObject) -> bool:
    """Whether a deformer that is no solver deforms an object, or a bone carries it."""
    if any(item.animated_shape_keys or item.has_modifier(_DEFORMERS) for item in (*obj.meshes, *obj.others)):
        return True
    return any(item.rigged for mesh in obj.meshes for item in structure.dependencies(mesh.name))


def animated_objects(structure: SceneStructure, obj: LogicalObject) -> list[ObjectFacts]:
    """The members of an object, and what they follow, that have keyframes, drivers or animated shape keys."""
    items = {item.name: item for member in obj.members for item in structure.dependencies(member.name)}
    return [item for item in items.values() if is_animated(item)]


def imitations(kind: str, item: ObjectFacts, dense: float) -> list[str]:
    """What moves or deforms an object frame by frame as a solver of that kind would, in words.

    ``dense``: number of keys on a channel from which they count. Objects that pour or emit may be moved.
    """
    texts: list[str] = []
    if kind not in {"sim_fluid", "sim_particle"}:
        texts = [
            f"{item.keys[name]} keyframes on {name}" for name in TRANSFORMS if item.keys.get(name, 0) >= dense
        ]
        texts += [f"a driver on {name}" for name in item.driven if name in TRANSFORMS]
    texts += ["animated shape keys"] if item.animated_shape_keys else []
    texts += [
        f"a {_RECORDINGS[modifier.type]} modifier"
        for modifier in item.modifiers
        if modifier.on and modifier.type in _RECORDINGS
    ]
    return texts


def parent_chain(structure: SceneStructure, obj: LogicalObject, item: ObjectFacts) -> list[ObjectFacts]:
    """A member of an object, and its parents within that object."""
    own = {member.name for member in obj.members}
    return [item, *(structure.objects[name] for name in structure.parents_of(item.name) if name in own)]
