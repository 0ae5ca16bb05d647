"""Who plays in a scene, as the guises need it: actors with their objects, and another name for each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from bench.audit.assembly import Assemblies
from bench.audit.roles import UNMARKED

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bench.audit.actors import ActorResolution
    from bench.audit.facts import Scene
    from bench.scenes.spec import Spec

_STANDING = (*UNMARKED, "collider", "rigid_passive")


def cast_of(spec: Spec, scene: Scene, found: Mapping[str, ActorResolution]) -> list[dict[str, Any]]:
    """Each actor that was found: its name, its last synonym, whether nothing simulates it, its objects by unit.

    ``parts``: what else belongs to what stands still by contact, as legs to a table top.
    """
    units = {
        name: [[one.name for one in unit.objects if one.in_scene] for unit in one.units]
        for name, one in found.items()
    }
    taken = {name for several in units.values() for unit in several for name in unit}
    assemblies = Assemblies(scene, taken)
    told: list[dict[str, Any]] = []
    for actor in spec.actors:
        stands = actor.role in _STANDING
        grown = {name for unit in units[actor.name] if stands for name in assemblies.grown(unit)}
        told.append(
            {
                "name": actor.name,
                "other": actor.synonyms[-1] if actor.synonyms else actor.name,
                "still": actor.role in UNMARKED,
                "units": units[actor.name],
                "parts": sorted(grown - taken),
            }
        )
        taken |= grown
    return told
