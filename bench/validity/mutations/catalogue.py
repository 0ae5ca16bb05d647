"""The mutations of every predicate: how it can be broken, and which other checks then fail for a logical reason.

A mutation fails the check that it is aimed at. Beyond that it may only fail the checks that its consequences name: a
cloth modifier that was removed cannot be baked, but its table is still there.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

# Whose checks may fail too: of actors whose objects were changed; of these and of what moves with them; of actors that
# have a changed one (or any) as a partner; of all.
Who = Literal["changed", "carried", "meeting", "all"]
# Whose objects are changed: the actor's; one partner's at a time (or everybody else's); whatever the change looks for.
On = Literal["actor", "partner", "scene"]


@dataclass(frozen=True, slots=True)
class Consequence:
    """Checks that may fail with the one that is aimed at, and why."""

    who: Who
    predicates: tuple[str, ...]
    why: str


@dataclass(frozen=True, slots=True)
class Mutation:
    """One way to break a check: ``change`` is a function in ``inside``, ``options`` its arguments besides objects.

    ``given`` derives further options from the check: its parameters, and the values that it saw before. ``roles``: of
    which actors; () of all. ``optional``: some scenes have nothing that it could change.
    """

    change: str
    on: On = "actor"
    options: Mapping[str, Any] = field(default_factory=dict[str, Any])
    given: Callable[[Mapping[str, Any], Mapping[str, Any]], dict[str, Any]] | None = None
    consequences: tuple[Consequence, ...] = ()
    roles: tuple[str, ...] = ()
    optional: bool = False

    @property
    def label(self) -> str:
        """A few words for reports."""
        values = (
            ", ".join(value) if isinstance(value, list) else str(value) for value in self.options.values()
        )
        return f"{' '.join([self.change.replace('_', ' '), *values])}{' of a partner' if self.on == 'partner' else ''}"


def _on(
    change: str, types: str, *consequences: Consequence, roles: tuple[str, ...] = (), **options: Any
) -> Mutation:
    return Mutation(change, "actor", {"types": [types], **options}, consequences=consequences, roles=roles)


# Consequences

_CLOTH = ("cloth_cache_baked", "cloth_self_collision", "cloth_pin_group", "cloth_collision_partners")
_SOFT = ("soft_cache_baked", "soft_collision_partners", "soft_goal_group", "soft_rigid_partners")
_PARTICLES = (
    "particle_type", "particle_source", "particle_cache_baked", "particle_collision_partners", "particle_from_deformed",
    "particle_force_fields",
)  # fmt: skip
_FLUID = (
    "fluid_modifier", "fluid_type", "fluid_domain_exists", "fluid_cache_baked", "fluid_dynamic_effector",
    "fluid_guiding", "fluid_resolution", "fluid_mesh",
)  # fmt: skip
_BODY = (
    "rigid_type", "rigid_shape", "rigid_constraint", "rigid_constraint_no_collision", "rigid_collision_modifier",
    "rigid_positive_mass",
)  # fmt: skip
_MEETING = ("cloth_collision_partners", "soft_collision_partners", "particle_collision_partners")

_NO_SOLVER = Consequence("changed", ("solver_enabled",), "a solver that was removed is not on")
_NOT_DEFORMED = Consequence("changed", ("particle_from_deformed",), "nothing deforms the mesh any more")
_NO_COLLISION = Consequence(
    "meeting", (*_MEETING, "soft_rigid_partners"), "an object without an active collision stops nothing"
)
_OWN_COLLISION_OFF = Consequence("changed", ("rigid_collision_modifier",), "its collision is off")
_STANDS_STILL = Consequence("carried", ("fluid_dynamic_effector",), "no baked solver moves it any more")
_NO_FLOW = Consequence("all", ("fluid_flow_count",), "a flow that is off does not count")
_NO_DOMAIN = Consequence(
    "all",
    ("fluid_domain_exists", "fluid_flow_count", "fluid_cache_baked", "fluid_guiding"),
    "there is no domain any more",
)
_NO_GUIDE = Consequence("all", ("fluid_guiding",), "a disabled effector guides nothing")
_ONE_BODY_LESS = Consequence("all", ("rigid_world_populated",), "the world has one body less")
_NO_CONSTRAINT = Consequence(
    "all", ("rigid_constraint", "rigid_constraint_no_collision"), "a constraint needs both of its objects"
)
_NO_RIGID_PARTNER = Consequence(
    "meeting", ("soft_rigid_partners",), "a partner must be in the rigid-body world"
)
_ONE_WORLD = Consequence("all", ("rigid_cache_baked",), "all bodies share one cache")
_OTHER_ROLE = Consequence("changed", ("solver_enabled",), "it has another role now")


def _switched_off(
    types: str, role: tuple[str, ...], *consequences: Consequence, **options: Any
) -> tuple[Mutation, ...]:
    """Switches modifiers off in renders, or in the viewport, where a lack of motion shows too."""
    return (
        _on("switch_off", types, *consequences, roles=role, **options),
        _on("switch_off", types, *consequences, _STANDS_STILL, roles=role, where="show_viewport", **options),
    )


def _without_collisions(types: str, path: str) -> tuple[Mutation, ...]:
    """Removes the collision of a partner, or limits collisions to an empty collection."""
    gone = (_NO_COLLISION, _OWN_COLLISION_OFF, _NO_SOLVER)
    return (
        Mutation("remove_modifier", "partner", {"types": ["COLLISION"]}, consequences=gone),
        _on("collide_with_nothing", types, path=path),
    )


def _without_bake(types: str, *consequences: Consequence) -> tuple[Mutation, ...]:
    return _on("free_bake", types, *consequences), _on("shorten_cache", types, *consequences)


MUTATIONS: Mapping[str, tuple[Mutation, ...]] = {
    "renderable": (Mutation("hide_in_render"),),
    "solver_enabled": (
        *_switched_off("CLOTH", ("cloth",), _NOT_DEFORMED),
        *_switched_off("SOFT_BODY", ("soft",), _NOT_DEFORMED),
        *_switched_off("COLLISION", ("collider",), _NO_COLLISION, _OWN_COLLISION_OFF),
        *_switched_off("FLUID", ("fluid_domain",), kind="DOMAIN"),
        *_switched_off("FLUID", ("fluid_flow",), _NO_FLOW, kind="FLOW"),
        *_switched_off("FLUID", ("fluid_effector",), _NO_GUIDE, _STANDS_STILL, kind="EFFECTOR"),
        *_switched_off("PARTICLE_SYSTEM", ("particle_emitter",), kind="EMITTER"),
        *_switched_off("PARTICLE_SYSTEM", ("particle_hair",), kind="HAIR"),
        Mutation(
            "set_body",
            options={"attribute": "enabled", "value": False},
            consequences=(_STANDS_STILL,),
            roles=("rigid_active", "rigid_passive"),
        ),
        Mutation(
            "remove_field_strength",
            consequences=(
                Consequence("all", ("particle_force_fields",), "a field without strength does not count"),
            ),
            roles=("force",),
        ),
    ),
    "cloth_modifier": (
        _on(
            "remove_modifier",
            "CLOTH",
            Consequence("changed", _CLOTH, "these are settings of the modifier"),
            _NO_SOLVER,
            _NOT_DEFORMED,
            _STANDS_STILL,
        ),
    ),
    "cloth_cache_baked": _without_bake("CLOTH", _STANDS_STILL),
    "cloth_self_collision": (
        _on("set_value", "CLOTH", path="collision_settings.use_self_collision", value=False),
    ),
    "cloth_pin_group": (
        _on("clear_group", "CLOTH", path="settings.vertex_group_mass"),
        _on("set_value", "CLOTH", path="settings.vertex_group_mass", value=""),
    ),
    "cloth_collision_partners": (
        *_without_collisions("CLOTH", "collision_settings.collection"),
        _on("set_value", "CLOTH", path="collision_settings.use_collision", value=False),
    ),
    "fluid_modifier": (
        _on(
            "remove_modifier",
            "FLUID",
            Consequence("changed", _FLUID, "these are settings of the modifier"),
            _NO_SOLVER,
            _NO_DOMAIN,
        ),
    ),
    "fluid_type": (
        Mutation(
            "swap_fluid_type",
            given=lambda params, _: {"kind": params["type"]},
            consequences=(
                Consequence(
                    "all",
                    ("fluid_domain_exists", "fluid_flow_count", "fluid_guiding"),
                    "these need a fluid of the same type",
                ),
                Consequence(
                    "changed",
                    ("fluid_mesh", "fluid_cache_baked"),
                    "a fluid of another type has other files",
                ),
            ),
        ),
    ),
    "fluid_domain_exists": (
        Mutation(
            "remove_domains",
            "scene",
            consequences=(
                Consequence("changed", _FLUID, "these are settings of the modifier"),
                _NO_SOLVER,
                _NO_DOMAIN,
            ),
        ),
        Mutation(
            "move_out_of_domain",
            consequences=(
                Consequence("changed", ("fluid_cache_baked",), "it does not flow into the baked domain"),
                _NO_FLOW,
            ),
        ),
    ),
    "fluid_flow_count": (
        Mutation(
            "close_flows",
            "scene",
            given=lambda _, seen: {"flows": seen["flows"], "least": seen["min"]},
            consequences=(_NO_SOLVER,),
        ),
    ),
    "fluid_cache_baked": (
        Mutation(
            "lose_fluid_files",
            "scene",
            consequences=(Consequence("all", ("fluid_cache_baked",), "it is done to all fluids"),),
        ),
        Mutation(
            "clear_fluid_bake",
            "scene",
            consequences=(Consequence("all", ("fluid_cache_baked",), "it is done to all fluids"),),
            optional=True,
        ),
    ),
    "fluid_dynamic_effector": (
        Mutation("disable_effector", consequences=(_NO_GUIDE,)),
        Mutation("remove_keys", consequences=(_NO_FLOW,), optional=True),
    ),
    "fluid_guiding": (
        Mutation("disable_guiding", "scene"),
        Mutation(
            "disable_effector",
            "scene",
            consequences=(Consequence("all", ("fluid_dynamic_effector",), "the effector is disabled"),),
        ),
    ),
    "fluid_resolution": (
        Mutation(
            "lower_resolution",
            given=lambda _, seen: {"least": seen["min"]},
            consequences=(
                Consequence(
                    "all", ("fluid_cache_baked",), "Blender frees a fluid's bake when its resolution is set"
                ),
            ),
        ),
    ),
    "fluid_mesh": (_on("set_value", "FLUID", kind="DOMAIN", path="domain_settings.use_mesh", value=False),),
    "rigid_settings": (
        Mutation(
            "remove_body",
            consequences=(
                Consequence("changed", _BODY, "these are settings of the body"),
                _NO_SOLVER,
                _ONE_BODY_LESS,
                _NO_CONSTRAINT,
                _NO_RIGID_PARTNER,
                _STANDS_STILL,
            ),
        ),
        Mutation(
            "remove_from_world",
            consequences=(_ONE_BODY_LESS, _NO_CONSTRAINT, _NO_RIGID_PARTNER, _STANDS_STILL),
        ),
    ),
    "rigid_type": (
        Mutation("swap_body_type", consequences=(_OTHER_ROLE, _STANDS_STILL)),
        Mutation("keep_kinematic", consequences=(_STANDS_STILL,), roles=("rigid_active",)),
    ),
    "rigid_shape": (
        Mutation("change_shape", given=lambda params, _: {"shapes": list(params.get("shapes", ()))}),
    ),
    "rigid_world_populated": (
        Mutation(
            "remove_from_world",
            given=lambda _, seen: {"count": seen["bodies"] - seen["min"] + 1},
            consequences=(
                Consequence("changed", ("rigid_settings",), "a body outside of the world does not count"),
                _NO_CONSTRAINT,
                _NO_RIGID_PARTNER,
                _STANDS_STILL,
            ),
        ),
        Mutation(
            "switch_off_world",
            "scene",
            consequences=(Consequence("changed", ("solver_enabled",), "its world is off"), _STANDS_STILL),
        ),
    ),
    "rigid_cache_baked": (
        Mutation("free_world_bake", "scene", consequences=(_ONE_WORLD, _STANDS_STILL)),
        Mutation("shorten_world_cache", "scene", consequences=(_ONE_WORLD, _STANDS_STILL)),
    ),
    "rigid_constraint": (Mutation("detach_constraint", consequences=(_NO_CONSTRAINT,)),),
    "rigid_constraint_no_collision": (
        Mutation(
            "enable_constraint_collisions",
            consequences=(
                Consequence(
                    "all", ("rigid_constraint_no_collision",), "a constraint belongs to both of its objects"
                ),
            ),
        ),
    ),
    "rigid_collision_modifier": (
        _on("remove_modifier", "COLLISION", _NO_COLLISION, _NO_SOLVER),
        _on("switch_off", "COLLISION", _NO_COLLISION, _NO_SOLVER),
    ),
    "rigid_positive_mass": (Mutation("set_body", options={"attribute": "mass", "value": 0.0}),),
    "particle_system": (
        _on(
            "remove_modifier",
            "PARTICLE_SYSTEM",
            Consequence("changed", _PARTICLES, "these are settings of the system"),
            _NO_SOLVER,
        ),
    ),
    "particle_type": (
        Mutation(
            "set_value",
            options={"types": ["PARTICLE_SYSTEM"], "path": "particle_system.settings.type"},
            given=lambda params, _: {
                "value": "HAIR" if params.get("type", "EMITTER") == "EMITTER" else "EMITTER"
            },
            consequences=(
                _OTHER_ROLE,
                Consequence("changed", ("particle_cache_baked",), "static hair has no cache"),
            ),
        ),
    ),
    "particle_source": (_on("set_value", "PARTICLE_SYSTEM", path="particle_system.settings.count", value=0),),
    "particle_cache_baked": _without_bake("PARTICLE_SYSTEM"),
    "particle_collision_partners": _without_collisions(
        "PARTICLE_SYSTEM", "particle_system.settings.collision_collection"
    ),
    "particle_from_deformed": (_on("move_first", "PARTICLE_SYSTEM"),),
    "particle_force_fields": (
        Mutation(
            "remove_field_strength",
            "scene",
            consequences=(Consequence("all", ("solver_enabled",), "a field without strength is off"),),
        ),
        _on("set_value", "PARTICLE_SYSTEM", path="particle_system.settings.effector_weights.all", value=0.0),
    ),
    "soft_modifier": (
        _on(
            "remove_modifier",
            "SOFT_BODY",
            Consequence("changed", _SOFT, "these are settings of the modifier"),
            _NO_SOLVER,
            _NOT_DEFORMED,
            _STANDS_STILL,
        ),
    ),
    "soft_cache_baked": _without_bake("SOFT_BODY", _STANDS_STILL),
    "soft_collision_partners": _without_collisions("SOFT_BODY", "settings.collision_collection"),
    "soft_goal_group": (
        _on("clear_group", "SOFT_BODY", path="settings.vertex_group_goal"),
        _on("set_value", "SOFT_BODY", path="settings.use_goal", value=False),
    ),
    "soft_rigid_partners": (
        Mutation(
            "remove_from_world",
            "partner",
            consequences=(
                Consequence("changed", ("rigid_settings",), "a body outside of the world does not count"),
                _ONE_BODY_LESS,
                _NO_CONSTRAINT,
                _STANDS_STILL,
            ),
        ),
        Mutation(
            "remove_modifier",
            "partner",
            {"types": ["COLLISION"]},
            consequences=(_NO_COLLISION, _OWN_COLLISION_OFF, _NO_SOLVER),
        ),
    ),
    "dense_transform_keys": (Mutation("key_every_frame"),),
    "animated_shape_keys": (Mutation("animate_shape_key"), Mutation("add_mesh_cache")),
    "static_has_cache": (Mutation("add_bake", "scene"),),
    "static_has_rigid_world": (Mutation("add_body", "scene"),),
    "static_has_solver": (Mutation("add_solver", "scene"),),
}
