"""Random single breaches of known kind, and the rules that own each kind.

Every breach is larger than the tolerance of a rule that owns it: by a factor from ``LEAST`` to ``MOST``, drawn at
random, of that tolerance for that very object. Breaches without a size (a missing tag, a removed cache) are made as
they are. What is aimed at, which way, and by how much, comes from one seeded generator.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutation import Aim, Mutation
from mutations_moving import drop_cache, fake_bodies, fake_cloth, shift
from mutations_still import (
    add_light,
    delete_contact,
    duplicate,
    hide,
    lift,
    move,
    rename,
    rotate,
    scale,
    take_off,
    unparent,
)
from valid_scenes import valid_scenes

if TYPE_CHECKING:
    from collections.abc import Callable
    from random import Random

_ALL = ("room", "dominoes", "cloth")
# What is made, and in which scenes; each comes up equally often.
KINDS: tuple[tuple[Callable[[Aim], Mutation], tuple[str, ...]], ...] = (
    (move, _ALL),
    (lift, ("room", "dominoes")),
    (take_off, _ALL),
    (rotate, _ALL),
    (scale, _ALL),
    (unparent, _ALL),
    (rename, _ALL),
    (delete_contact, _ALL),
    (add_light, _ALL),
    (hide, _ALL),
    (duplicate, _ALL),
    (drop_cache, ("dominoes", "cloth")),
    (fake_bodies, ("dominoes",)),
    (fake_cloth, ("cloth",)),
    (shift, ("dominoes", "cloth")),
)


def draw(random: Random, count: int) -> list[Mutation]:
    """``count`` mutations, scene by scene."""
    scenes = {scene.name: scene for scene in valid_scenes()}
    found: list[Mutation] = []
    for place in range(count):
        make, where = KINDS[place % len(KINDS)]
        found.append(make(Aim(random, scenes[random.choice(where)])))
    return sorted(found, key=lambda one: _ALL.index(one.scene))
