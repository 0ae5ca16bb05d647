"""What each role means in Blender's data: which objects can have it, and by which modifiers or settings."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bench.audit.facts import Modifier, Object, Scene

_MODIFIERS = {"cloth": "CLOTH", "soft": "SOFT_BODY", "collider": "COLLISION"}
_FLUIDS = {"fluid_domain": "DOMAIN", "fluid_flow": "FLOW", "fluid_effector": "EFFECTOR"}
_PARTICLES = {"particle_emitter": "EMITTER", "particle_hair": "HAIR"}
_BODIES = {"rigid_active": "ACTIVE", "rigid_passive": "PASSIVE"}
# Nothing in a file marks an object as having one of these roles.
UNMARKED = ("static", "keyframed")


def modifiers_of_role(one: Object, role: str) -> tuple[Modifier, ...]:
    """The modifiers that give an object the role, on or off."""
    if role in _MODIFIERS:
        return one.of_type(_MODIFIERS[role])
    if role in _FLUIDS:
        wanted = _FLUIDS[role]
        return tuple(each for each in one.of_type("FLUID") if each.fluid and each.fluid.type == wanted)
    if role in _PARTICLES:
        wanted = _PARTICLES[role]
        found = one.of_type("PARTICLE_SYSTEM")
        return tuple(each for each in found if each.particles and each.particles.type == wanted)
    return ()


def plays(one: Object, role: str) -> bool:
    """Whether an object has what marks the role; never for unmarked roles."""
    if role in _BODIES:
        return one.rigid_body is not None and one.rigid_body.type == _BODIES[role]
    if role == "force":
        return one.force is not None
    return bool(modifiers_of_role(one, role))


def simulates(one: Object, scene: Scene) -> bool:
    """Whether a solver that is on moves it or its surface: cloth, soft body, fluid domain, active rigid body."""
    world, body = scene.rigid_world, one.rigid_body
    if world is not None and world.enabled and body is not None and body.in_world:
        return body.type == "ACTIVE" and body.enabled and not body.kinematic
    domains = modifiers_of_role(one, "fluid_domain")
    return any(each.on for each in (*one.of_type("CLOTH", "SOFT_BODY"), *domains))
