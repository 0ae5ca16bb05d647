"""What moves and shapes an object, by the facts: solvers, their caches, rigs and keys."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agents.protocol.structure import is_animated

if TYPE_CHECKING:
    from agents.protocol.facts import CacheFacts, ObjectFacts
    from agents.protocol.structure import Structure, Thing

FEWEST_DENSE = 5
_CHANNELS = ("location", "rotation_euler", "rotation_quaternion", "rotation_axis_angle")
TRANSFORMS = (*_CHANNELS, *(f"delta_{channel}" for channel in _CHANNELS))
_RECORDED = {"MESH_CACHE": "Mesh Cache", "MESH_SEQUENCE_CACHE": "Mesh Sequence Cache"}
_DEFORMERS = frozenset(
    {"ARMATURE", "LATTICE", "CURVE", "HOOK", "MESH_DEFORM", "SIMPLE_DEFORM", "WAVE", "SURFACE_DEFORM"}
)
# Kind of deformation → (modifiers that make it, kinds of caches that keep it, what to call it).
SOLVERS: dict[str, tuple[frozenset[str], frozenset[str], str]] = {
    "sim_cloth": (frozenset({"CLOTH"}), frozenset({"cloth"}), "cloth modifier"),
    "sim_soft": (frozenset({"SOFT_BODY"}), frozenset({"soft_body"}), "soft-body modifier"),
    "sim_particle": (frozenset({"PARTICLE_SYSTEM"}), frozenset({"particles", "hair"}), "particle system"),
    "sim_fluid": (frozenset({"FLUID_DOMAIN", "FLUID_FLOW"}), frozenset({"fluid"}), "fluid domain or flow"),
    "sim_rigid": (frozenset(), frozenset({"rigid_body"}), "active rigid body"),
}


@dataclass(frozen=True, slots=True)
class Mechanism:
    """A solver at work in an object: ``actors`` are what it moves, ``caches`` what keeps its result."""

    kind: str
    actors: tuple[ObjectFacts, ...]
    caches: tuple[CacheFacts, ...]


def solver_of(structure: Structure, thing: Thing, kind: str) -> Mechanism:
    """The solver of a kind (``sim_…``) in an object; no actors where it is not at work."""
    modifiers, kept_as, _ = SOLVERS[kind]
    objects = (*thing.meshes, *thing.others, *thing.roots)
    if kind == "sim_rigid":
        actors = tuple(one for one in objects if _is_driven(one))
        caches = tuple(cache for cache in structure.facts.caches if cache.kind in kept_as)
        return Mechanism(kind, actors, caches)
    actors = tuple(one for one in objects if any(m.type in modifiers and m.on for m in one.modifiers))
    names = {one.name for one in actors}
    caches = tuple(
        cache for cache in structure.facts.caches if cache.kind in kept_as and cache.object in names
    )
    if kind == "sim_fluid" and not caches:
        # A flow has no cache of its own: its liquid is in the domain's.
        caches = tuple(cache for cache in structure.facts.caches if cache.kind in kept_as)
    return Mechanism(kind, actors, caches)


def _is_driven(one: ObjectFacts) -> bool:
    body = one.rigid_body
    return body is not None and body.active and body.enabled and not body.kinematic


def at_work(structure: Structure, thing: Thing) -> list[str]:
    """The kinds of solvers that move an object."""
    return [kind for kind in SOLVERS if _is_at_work(solver_of(structure, thing, kind))]


def _is_at_work(found: Mechanism) -> bool:
    # Hair that only stands there is a particle system too; it has no cache.
    return bool(found.actors) and (found.kind != "sim_particle" or bool(found.caches))


def has_rig(thing: Thing) -> bool:
    """Whether something bends it that is no solver."""
    return any(
        one.animated_shape_keys or any(m.type in _DEFORMERS and m.on for m in one.modifiers)
        for one in (*thing.meshes, *thing.others)
    )


def keyed(structure: Structure, thing: Thing) -> list[ObjectFacts]:
    """What has keyframes, drivers or animated shape keys, of an object or of what it follows."""
    found = {
        one.name: one
        for own in (*thing.meshes, *thing.others, *thing.roots)
        for one in structure.followed(own.name)
    }
    return [one for one in found.values() if is_animated(one)]


def imitations(kind: str, one: ObjectFacts, most: float) -> list[str]:
    """What moves or deforms an object frame by frame as if a solver of that kind did, in words.

    ``most``: so many keys on a channel do. What pours or emits may be moved about.
    """
    found: list[str] = []
    if kind not in {"sim_fluid", "sim_particle"}:
        found = [
            f"{one.keys[name]} keyframes on {name}" for name in TRANSFORMS if one.keys.get(name, 0) >= most
        ]
        found += [f"a driver on {name}" for name in one.driven if name in TRANSFORMS]
    found += ["animated shape keys"] if one.animated_shape_keys else []
    found += [
        f"a {_RECORDED[modifier.type]} modifier"
        for modifier in one.modifiers
        if modifier.on and modifier.type in _RECORDED
    ]
    return found


def chain(structure: Structure, thing: Thing, one: ObjectFacts) -> list[ObjectFacts]:
    """Something of an object and what it is parented to within that object."""
    own = {part.name for part in (*thing.meshes, *thing.others, *thing.roots)}
    above = [structure.objects[name] for name in structure.parents_of(one.name) if name in own]
    return [one, *above]
