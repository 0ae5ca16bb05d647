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


def modifiers_of_role(obj: Object, role: str) -> tuple[Modifier, ...]:
    """The modifiers that give an object the role, on or off."""
    if role in _MODIFIERS:
        return obj.of_type(_MODIFIERS[role])
    if role in _FLUIDS:
        wanted = _FLUIDS[role]
        return tuple(
            modifier for modifier in obj.of_type("FLUID") if modifier.fluid and modifier.fluid.type == wanted
        )
    if role in _PARTICLES:
        wanted = _PARTICLES[role]
        systems = obj.of_type("PARTICLE_SYSTEM")
        return tuple(
            modifier for modifier in systems if modifier.particles and modifier.particles.type == wanted
        )
    return ()


def plays(obj: Object, role: str) -> bool:
    """Whether an object has what marks the role; never for unmarked roles."""
    if role in _BODIES:
        return obj.rigid_body is not None and obj.rigid_body.type == _BODIES[role]
    if role == "force":
        return obj.force is not None
    return bool(modifiers_of_role(obj, role))


def simulates(obj: Object, scene: Scene) -> bool:
    """Whether a solver that is on moves it or its surface: cloth, soft body, fluid domain, active rigid body."""
    world, body = scene.rigid_world, obj.rigid_body
    if world is not None and world.enabled and body is not None and body.in_world:
        return body.type == "ACTIVE" and body.enabled and not body.kinematic
    domains = modifiers_of_role(obj, "fluid_domain")
    return any(modifier.on for modifier in (*obj.of_type("CLOTH", "SOFT_BODY"), *domains))
