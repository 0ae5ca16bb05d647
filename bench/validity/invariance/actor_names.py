"""The actors of a scene as rewrites need them: their objects, and another name for each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from bench.audit.assembly import Assemblies
from bench.audit.roles import UNMARKED

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bench.audit.actors import ActorResolution
    from bench.audit.facts import Scene
    from bench.scenes.spec import Spec

_NOT_MOVED = (*UNMARKED, "collider", "rigid_passive")


def actor_objects(spec: Spec, scene: Scene, found: Mapping[str, ActorResolution]) -> list[dict[str, Any]]:
    """Each actor: its name, its last synonym, whether nothing simulates it, its objects by unit.

    ``parts``: further objects that belong to a static actor by contact, such as legs to a table top.
    """
    units = {
        name: [[obj.name for obj in unit.objects if obj.in_scene] for unit in actor.units]
        for name, actor in found.items()
    }
    taken = {name for several in units.values() for unit in several for name in unit}
    assemblies = Assemblies(scene, taken)
    described: list[dict[str, Any]] = []
    for actor in spec.actors:
        stands = actor.role in _NOT_MOVED
        grown = {name for unit in units[actor.name] if stands for name in assemblies.grown(unit)}
        described.append(
            {
                "name": actor.name,
                "other": actor.synonyms[-1] if actor.synonyms else actor.name,
                "still": actor.role in UNMARKED,
                "units": units[actor.name],
                "parts": sorted(grown - taken),
            }
        )
        taken |= grown
    return described
