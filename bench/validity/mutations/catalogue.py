"""The mutations of every predicate: how it can be broken, and which other checks then fail for a logical reason.

A mutation fails the check that it is aimed at. Beyond that it may only fail the checks that its consequences name: a
cloth modifier that was removed cannot be baked, but its table is still there.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    Given = Callable[[Mapping[str, Any], Mapping[str, Any]], dict[str, Any]]

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
    given: Given | None = None
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


def _mutation(
    change: str,
    *consequences: Consequence,
    on: On = "actor",
    roles: tuple[str, ...] = (),
    given: Given | None = None,
    optional: bool = False,
    **options: Any,
) -> Mutation:
    return Mutation(change, on, options, given, consequences, roles, optional)


def _of_modifier(change: str, types: str, *consequences: Consequence, **how: Any) -> Mutation:
    return _mutation(change, *consequences, types=[types], **how)


def _changed(why: str, *predicates: str) -> Consequence:
    return Consequence("changed", predicates, why)


def _all(why: str, *predicates: str) -> Consequence:
    return Consequence("all", predicates, why)


# Consequences

_OF_MODIFIER, _OF_SYSTEM = "these are settings of the modifier", "these are settings of the system"
_CLOTH = _changed(
    _OF_MODIFIER, "cloth_cache_baked", "cloth_self_collision", "cloth_pin_group", "cloth_collision_partners"
)
_SOFT = _changed(
    _OF_MODIFIER, "soft_cache_baked", "soft_collision_partners", "soft_goal_group", "soft_rigid_partners"
)
_PARTICLES = _changed(
    _OF_SYSTEM, "particle_type", "particle_source", "particle_cache_baked", "particle_collision_partners",
    "particle_from_deformed", "particle_force_fields",
)  # fmt: skip
_FLUID = _changed(
    _OF_MODIFIER, "fluid_modifier", "fluid_type", "fluid_domain_exists", "fluid_cache_baked", "fluid_dynamic_effector",
    "fluid_guiding", "fluid_resolution", "fluid_mesh",
)  # fmt: skip
_BODY = _changed(
    "these are settings of the body", "rigid_type", "rigid_shape", "rigid_constraint", "rigid_constraint_no_collision",
    "rigid_collision_modifier", "rigid_positive_mass",
)  # fmt: skip
_NO_SOLVER = _changed("a solver that was removed is not on", "solver_enabled")
_NOT_DEFORMED = _changed("nothing deforms the mesh any more", "particle_from_deformed")
_OTHER_ROLE = _changed("it has another role now", "solver_enabled")
_NOT_IN_WORLD = _changed("a body outside of the world does not count", "rigid_settings")
_NO_COLLISION = Consequence(
    "meeting",
    ("cloth_collision_partners", "soft_collision_partners", "particle_collision_partners", "soft_rigid_partners"),
    "an object without an active collision stops nothing",
)  # fmt: skip
_OWN_COLLISION_OFF = _changed("its collision is off", "rigid_collision_modifier")
_STANDS_STILL = Consequence("carried", ("fluid_dynamic_effector",), "no baked solver moves it any more")
_NO_FLOW = _all("a flow that is off does not count", "fluid_flow_count")
_NO_DOMAIN = _all(
    "there is no domain any more", "fluid_domain_exists", "fluid_flow_count", "fluid_cache_baked", "fluid_guiding"
)  # fmt: skip
_NO_GUIDE = _all("a disabled effector guides nothing", "fluid_guiding")
_ALL_FLUIDS = _all("it is done to all fluids", "fluid_cache_baked")
_ONE_BODY_LESS = _all("the world has one body less", "rigid_world_populated")
_NO_CONSTRAINT = _all(
    "a constraint needs both of its objects", "rigid_constraint", "rigid_constraint_no_collision"
)
_NO_RIGID_PARTNER = Consequence(
    "meeting", ("soft_rigid_partners",), "a partner must be in the rigid-body world"
)
_ONE_WORLD = _all("all bodies share one cache", "rigid_cache_baked")


def _switched_off(types: str, role: str, *consequences: Consequence, **options: Any) -> tuple[Mutation, ...]:
    """Switches modifiers off in renders, or in the viewport, where a lack of motion shows too."""
    return tuple(
        _of_modifier("switch_off", types, *consequences, *more, roles=(role,), **where, **options)
        for more, where in (((), {}), ((_STANDS_STILL,), {"where": "show_viewport"}))
    )


def _without_collisions(types: str, path: str) -> tuple[Mutation, ...]:
    """Removes the collision of a partner, or limits collisions to an empty collection."""
    return _PARTNER_WITHOUT_COLLISION, _of_modifier("collide_with_nothing", types, path=path)


_PARTNER_WITHOUT_COLLISION = _of_modifier(
    "remove_modifier", "COLLISION", _NO_COLLISION, _OWN_COLLISION_OFF, _NO_SOLVER, on="partner"
)


def _without_bake(types: str, *consequences: Consequence) -> tuple[Mutation, ...]:
    return tuple(_of_modifier(change, types, *consequences) for change in ("free_bake", "shorten_cache"))


def _set(types: str, path: str, value: Any, **how: Any) -> Mutation:
    return _of_modifier("set_value", types, path=path, value=value, **how)


MUTATIONS: Mapping[str, tuple[Mutation, ...]] = {
    "renderable": (_mutation("hide_in_render"),),
    "solver_enabled": (
        *_switched_off("CLOTH", "cloth", _NOT_DEFORMED),
        *_switched_off("SOFT_BODY", "soft", _NOT_DEFORMED),
        *_switched_off("COLLISION", "collider", _NO_COLLISION, _OWN_COLLISION_OFF),
        *_switched_off("FLUID", "fluid_domain", kind="DOMAIN"),
        *_switched_off("FLUID", "fluid_flow", _NO_FLOW, kind="FLOW"),
        *_switched_off("FLUID", "fluid_effector", _NO_GUIDE, _STANDS_STILL, kind="EFFECTOR"),
        *_switched_off("PARTICLE_SYSTEM", "particle_emitter", kind="EMITTER"),
        *_switched_off("PARTICLE_SYSTEM", "particle_hair", kind="HAIR"),
        _mutation(
            "set_body",
            _STANDS_STILL,
            roles=("rigid_active", "rigid_passive"),
            attribute="enabled",
            value=False,
        ),
        _mutation(
            "remove_field_strength",
            _all("a field without strength does not count", "particle_force_fields"),
            roles=("force",),
        ),
    ),
    "cloth_modifier": (
        _of_modifier("remove_modifier", "CLOTH", _CLOTH, _NO_SOLVER, _NOT_DEFORMED, _STANDS_STILL),
    ),
    "cloth_cache_baked": _without_bake("CLOTH", _STANDS_STILL),
    "cloth_self_collision": (_set("CLOTH", "collision_settings.use_self_collision", value=False),),
    "cloth_pin_group": (
        _of_modifier("clear_group", "CLOTH", path="settings.vertex_group_mass"),
        _set("CLOTH", "settings.vertex_group_mass", ""),
    ),
    "cloth_collision_partners": (
        *_without_collisions("CLOTH", "collision_settings.collection"),
        _set("CLOTH", "collision_settings.use_collision", value=False),
    ),
    "fluid_modifier": (_of_modifier("remove_modifier", "FLUID", _FLUID, _NO_SOLVER, _NO_DOMAIN),),
    "fluid_type": (
        _mutation(
            "swap_fluid_type",
            _all(
                "these need a fluid of the same type",
                "fluid_domain_exists",
                "fluid_flow_count",
                "fluid_guiding",
            ),
            _changed("a fluid of another type has other files", "fluid_mesh", "fluid_cache_baked"),
            given=lambda params, _: {"kind": params["type"]},
        ),
    ),
    "fluid_domain_exists": (
        _mutation("remove_domains", _FLUID, _NO_SOLVER, _NO_DOMAIN, on="scene"),
        _mutation(
            "move_out_of_domain",
            _changed("it does not flow into the baked domain", "fluid_cache_baked"),
            _NO_FLOW,
        ),
    ),
    "fluid_flow_count": (
        _mutation(
            "close_flows",
            _NO_SOLVER,
            on="scene",
            given=lambda _, seen: {"flows": seen["flows"], "least": seen["min"]},
        ),
    ),
    "fluid_cache_baked": (
        _mutation("lose_fluid_files", _ALL_FLUIDS, on="scene"),
        _mutation("clear_fluid_bake", _ALL_FLUIDS, on="scene", optional=True),
    ),
    "fluid_dynamic_effector": (
        _mutation("disable_effector", _NO_GUIDE),
        _mutation("remove_keys", _NO_FLOW, optional=True),
    ),
    "fluid_guiding": (
        _mutation("disable_guiding", on="scene"),
        _mutation("disable_effector", _all("the effector is disabled", "fluid_dynamic_effector"), on="scene"),
    ),
    "fluid_resolution": (
        _mutation(
            "lower_resolution",
            _all("Blender frees a fluid's bake when its resolution is set", "fluid_cache_baked"),
            given=lambda _, seen: {"least": seen["min"]},
        ),
    ),
    "fluid_mesh": (
        _of_modifier("set_value", "FLUID", kind="DOMAIN", path="domain_settings.use_mesh", value=False),
    ),
    "rigid_settings": (
        _mutation(
            "remove_body", _BODY, _NO_SOLVER, _ONE_BODY_LESS, _NO_CONSTRAINT, _NO_RIGID_PARTNER, _STANDS_STILL
        ),
        _mutation("remove_from_world", _ONE_BODY_LESS, _NO_CONSTRAINT, _NO_RIGID_PARTNER, _STANDS_STILL),
    ),
    "rigid_type": (
        _mutation("swap_body_type", _OTHER_ROLE, _STANDS_STILL),
        _mutation("keep_kinematic", _STANDS_STILL, roles=("rigid_active",)),
    ),
    "rigid_shape": (
        _mutation("change_shape", given=lambda params, _: {"shapes": list(params.get("shapes", ()))}),
    ),
    "rigid_world_populated": (
        _mutation(
            "remove_from_world",
            *(_NOT_IN_WORLD, _NO_CONSTRAINT, _NO_RIGID_PARTNER, _STANDS_STILL),
            given=lambda _, seen: {"count": seen["bodies"] - seen["min"] + 1},
        ),
        _mutation(
            "switch_off_world", _changed("its world is off", "solver_enabled"), _STANDS_STILL, on="scene"
        ),
    ),
    "rigid_cache_baked": (
        _mutation("free_world_bake", _ONE_WORLD, _STANDS_STILL, on="scene"),
        _mutation("shorten_world_cache", _ONE_WORLD, _STANDS_STILL, on="scene"),
    ),
    "rigid_constraint": (_mutation("detach_constraint", _NO_CONSTRAINT),),
    "rigid_constraint_no_collision": (
        _mutation(
            "enable_constraint_collisions",
            _all("a constraint belongs to both of its objects", "rigid_constraint_no_collision"),
        ),
    ),
    "rigid_collision_modifier": (
        _of_modifier("remove_modifier", "COLLISION", _NO_COLLISION, _NO_SOLVER),
        _of_modifier("switch_off", "COLLISION", _NO_COLLISION, _NO_SOLVER),
    ),
    "rigid_positive_mass": (_mutation("set_body", attribute="mass", value=0.0),),
    "particle_system": (_of_modifier("remove_modifier", "PARTICLE_SYSTEM", _PARTICLES, _NO_SOLVER),),
    "particle_type": (
        _mutation(
            "set_value",
            _OTHER_ROLE,
            _changed("static hair has no cache", "particle_cache_baked"),
            types=["PARTICLE_SYSTEM"],
            path="particle_system.settings.type",
            given=lambda params, _: {
                "value": "HAIR" if params.get("type", "EMITTER") == "EMITTER" else "EMITTER"
            },
        ),
    ),
    "particle_source": (_set("PARTICLE_SYSTEM", "particle_system.settings.count", 0),),
    "particle_cache_baked": _without_bake("PARTICLE_SYSTEM"),
    "particle_collision_partners": _without_collisions(
        "PARTICLE_SYSTEM", "particle_system.settings.collision_collection"
    ),
    "particle_from_deformed": (_of_modifier("move_first", "PARTICLE_SYSTEM"),),
    "particle_force_fields": (
        _mutation(
            "remove_field_strength", _all("a field without strength is off", "solver_enabled"), on="scene"
        ),
        _set("PARTICLE_SYSTEM", "particle_system.settings.effector_weights.all", 0.0),
    ),
    "soft_modifier": (
        _of_modifier("remove_modifier", "SOFT_BODY", _SOFT, _NO_SOLVER, _NOT_DEFORMED, _STANDS_STILL),
    ),
    "soft_cache_baked": _without_bake("SOFT_BODY", _STANDS_STILL),
    "soft_collision_partners": _without_collisions("SOFT_BODY", "settings.collision_collection"),
    "soft_goal_group": (
        _of_modifier("clear_group", "SOFT_BODY", path="settings.vertex_group_goal"),
        _set("SOFT_BODY", "settings.use_goal", value=False),
    ),
    "soft_rigid_partners": (
        _mutation(
            "remove_from_world", _NOT_IN_WORLD, _ONE_BODY_LESS, _NO_CONSTRAINT, _STANDS_STILL, on="partner"
        ),
        _PARTNER_WITHOUT_COLLISION,
    ),
    "dense_transform_keys": (_mutation("key_every_frame"),),
    "animated_shape_keys": (_mutation("animate_shape_key"), _mutation("add_mesh_cache")),
    "static_has_cache": (_mutation("add_bake", on="scene"),),
    "static_has_rigid_world": (_mutation("add_body", on="scene"),),
    "static_has_solver": (_mutation("add_solver", on="scene"),),
}
