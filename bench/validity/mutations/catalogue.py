"""One row for each way in which a predicate is broken, and what else logically fails with it, by reason.

A sabotage flips the check that it is aimed at. Beyond that it may flip what ``Follows`` names, and nothing else: a
cloth modifier that is gone cannot be baked, but its table is still there.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

# Whose checks follow: of actors whose objects were changed; of those and of what moves with them; of actors that count
# a changed one as a partner (or anybody); of all.
Who = Literal["changed", "carried", "meeting", "all"]
# Whose objects are changed: the actor's; one partner's at a time (or everybody else's); whatever the change looks for.
On = Literal["actor", "partner", "scene"]


@dataclass(frozen=True, slots=True)
class Follows:
    """Checks that fail with the one that is aimed at, and why they do."""

    who: Who
    predicates: tuple[str, ...]
    why: str


@dataclass(frozen=True, slots=True)
class Sabotage:
    """``change`` is the function in ``inside`` that does it; ``options`` are what it needs beyond objects.

    ``given`` adds options read off the check: its parameters, and what it saw in the scene as it was. ``roles``: of
    which actors; () of all. ``optional``: there are scenes in which it has nothing to change.
    """

    change: str
    on: On = "actor"
    options: Mapping[str, Any] = field(default_factory=dict[str, Any])
    given: Callable[[Mapping[str, Any], Mapping[str, Any]], dict[str, Any]] | None = None
    follows: tuple[Follows, ...] = ()
    roles: tuple[str, ...] = ()
    optional: bool = False

    @property
    def told(self) -> str:
        """In a few words, for reports."""
        values = (
            ", ".join(value) if isinstance(value, list) else str(value) for value in self.options.values()
        )
        return f"{' '.join([self.change.replace('_', ' '), *values])}{' of a partner' if self.on == 'partner' else ''}"


def _on(change: str, types: str, *follows: Follows, roles: tuple[str, ...] = (), **options: Any) -> Sabotage:
    return Sabotage(change, "actor", {"types": [types], **options}, follows=follows, roles=roles)


# What follows, and why

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

_NO_SOLVER = Follows("changed", ("solver_enabled",), "what is gone is not on")
_NOT_DEFORMED = Follows("changed", ("particle_from_deformed",), "what does not deform, nothing comes from")
_NOT_FELT = Follows(
    "meeting", (*_MEETING, "soft_rigid_partners"), "what has no collision that is on, stops nothing"
)
_NOT_FELT_ITSELF = Follows("changed", ("rigid_collision_modifier",), "a collision that is off is none")
_STANDS = Follows(
    "carried", ("fluid_dynamic_effector",), "what no solver that was played moves, stands still"
)
_NO_FLOW = Follows("all", ("fluid_flow_count",), "a flow that is not open gives nothing")
_NO_DOMAIN = Follows(
    "all",
    ("fluid_domain_exists", "fluid_flow_count", "fluid_cache_baked", "fluid_guiding"),
    "without the domain, nothing flows in it, is kept or led",
)
_NO_GUIDE = Follows("all", ("fluid_guiding",), "what takes no part guides nothing")
_FEWER_BODIES = Follows("all", ("rigid_world_populated",), "there is a body less")
_UNTIED = Follows("all", ("rigid_constraint", "rigid_constraint_no_collision"), "a tie has two ends")
_NO_RIGID_PARTNER = Follows(
    "meeting", ("soft_rigid_partners",), "what is no body of the world is no rigid partner"
)
_ONE_WORLD = Follows("all", ("rigid_cache_baked",), "the world has one cache")
_OTHER_PART = Follows("changed", ("solver_enabled",), "what plays another role does not play this one")


def _mute(types: str, role: tuple[str, ...], *follows: Follows, **options: Any) -> tuple[Sabotage, ...]:
    """Off in renders; off in the viewport, where what does not move is seen too."""
    return (
        _on("mute", types, *follows, roles=role, **options),
        _on("mute", types, *follows, _STANDS, roles=role, where="show_viewport", **options),
    )


def _partners(types: str, path: str) -> tuple[Sabotage, ...]:
    """What it meets has no collision any more; it meets nothing any more."""
    gone = (_NOT_FELT, _NOT_FELT_ITSELF, _NO_SOLVER)
    return (
        Sabotage("remove", "partner", {"types": ["COLLISION"]}, follows=gone),
        _on("spare", types, path=path),
    )


def _caches(types: str, *follows: Follows) -> tuple[Sabotage, ...]:
    return _on("free", types, *follows), _on("shorten", types, *follows)


SABOTAGES: Mapping[str, tuple[Sabotage, ...]] = {
    "renderable": (Sabotage("hide"),),
    "solver_enabled": (
        *_mute("CLOTH", ("cloth",), _NOT_DEFORMED),
        *_mute("SOFT_BODY", ("soft",), _NOT_DEFORMED),
        *_mute("COLLISION", ("collider",), _NOT_FELT, _NOT_FELT_ITSELF),
        *_mute("FLUID", ("fluid_domain",), kind="DOMAIN"),
        *_mute("FLUID", ("fluid_flow",), _NO_FLOW, kind="FLOW"),
        *_mute("FLUID", ("fluid_effector",), _NO_GUIDE, _STANDS, kind="EFFECTOR"),
        *_mute("PARTICLE_SYSTEM", ("particle_emitter",), kind="EMITTER"),
        *_mute("PARTICLE_SYSTEM", ("particle_hair",), kind="HAIR"),
        Sabotage(
            "set_body",
            options={"attribute": "enabled", "value": False},
            follows=(_STANDS,),
            roles=("rigid_active", "rigid_passive"),
        ),
        Sabotage(
            "calm",
            follows=(Follows("all", ("particle_force_fields",), "a field without strength moves nothing"),),
            roles=("force",),
        ),
    ),
    "cloth_modifier": (
        _on(
            "remove",
            "CLOTH",
            Follows("changed", _CLOTH, "these are settings of the modifier"),
            _NO_SOLVER,
            _NOT_DEFORMED,
            _STANDS,
        ),
    ),
    "cloth_cache_baked": _caches("CLOTH", _STANDS),
    "cloth_self_collision": (
        _on("set_value", "CLOTH", path="collision_settings.use_self_collision", value=False),
    ),
    "cloth_pin_group": (
        _on("clear_group", "CLOTH", path="settings.vertex_group_mass"),
        _on("set_value", "CLOTH", path="settings.vertex_group_mass", value=""),
    ),
    "cloth_collision_partners": (
        *_partners("CLOTH", "collision_settings.collection"),
        _on("set_value", "CLOTH", path="collision_settings.use_collision", value=False),
    ),
    "fluid_modifier": (
        _on(
            "remove",
            "FLUID",
            Follows("changed", _FLUID, "these are settings of the modifier"),
            _NO_SOLVER,
            _NO_DOMAIN,
        ),
    ),
    "fluid_type": (
        Sabotage(
            "swap",
            given=lambda params, _: {"kind": params["type"]},
            follows=(
                Follows(
                    "all",
                    ("fluid_domain_exists", "fluid_flow_count", "fluid_guiding"),
                    "these ask for the same kind",
                ),
                Follows(
                    "changed",
                    ("fluid_mesh", "fluid_cache_baked"),
                    "another kind of fluid is kept in other files",
                ),
            ),
        ),
    ),
    "fluid_domain_exists": (
        Sabotage(
            "remove_domains",
            "scene",
            follows=(
                Follows("changed", _FLUID, "these are settings of the modifier"),
                _NO_SOLVER,
                _NO_DOMAIN,
            ),
        ),
        Sabotage(
            "put_away",
            follows=(
                Follows("changed", ("fluid_cache_baked",), "it does not flow into what is kept"),
                _NO_FLOW,
            ),
        ),
    ),
    "fluid_flow_count": (
        Sabotage(
            "close_flows",
            "scene",
            given=lambda _, seen: {"flows": seen["flows"], "least": seen["min"]},
            follows=(_NO_SOLVER,),
        ),
    ),
    "fluid_cache_baked": (
        Sabotage(
            "lose_files", "scene", follows=(Follows("all", ("fluid_cache_baked",), "so are all fluids'"),)
        ),
        Sabotage(
            "forget_bake",
            "scene",
            follows=(Follows("all", ("fluid_cache_baked",), "so are all fluids'"),),
            optional=True,
        ),
    ),
    "fluid_dynamic_effector": (
        Sabotage("ignore", follows=(_NO_GUIDE,)),
        Sabotage("stand_still", follows=(_NO_FLOW,), optional=True),
    ),
    "fluid_guiding": (
        Sabotage("unguide", "scene"),
        Sabotage(
            "ignore", "scene", follows=(Follows("all", ("fluid_dynamic_effector",), "it takes no part"),)
        ),
    ),
    "fluid_resolution": (
        Sabotage(
            "coarsen",
            given=lambda _, seen: {"least": seen["min"]},
            follows=(
                Follows(
                    "all", ("fluid_cache_baked",), "Blender frees a fluid's bake when its resolution is set"
                ),
            ),
        ),
    ),
    "fluid_mesh": (_on("set_value", "FLUID", kind="DOMAIN", path="domain_settings.use_mesh", value=False),),
    "rigid_settings": (
        Sabotage(
            "remove_body",
            follows=(
                Follows("changed", _BODY, "these are settings of the body"),
                _NO_SOLVER,
                _FEWER_BODIES,
                _UNTIED,
                _NO_RIGID_PARTNER,
                _STANDS,
            ),
        ),
        Sabotage("expel", follows=(_FEWER_BODIES, _UNTIED, _NO_RIGID_PARTNER, _STANDS)),
    ),
    "rigid_type": (
        Sabotage("turn_type", follows=(_OTHER_PART, _STANDS)),
        Sabotage("grab", follows=(_STANDS,), roles=("rigid_active",)),
    ),
    "rigid_shape": (
        Sabotage("other_shape", given=lambda params, _: {"shapes": list(params.get("shapes", ()))}),
    ),
    "rigid_world_populated": (
        Sabotage(
            "expel",
            given=lambda _, seen: {"count": seen["bodies"] - seen["min"] + 1},
            follows=(
                Follows("changed", ("rigid_settings",), "a body outside of the world is none"),
                _UNTIED,
                _NO_RIGID_PARTNER,
                _STANDS,
            ),
        ),
        Sabotage(
            "switch_off_world",
            "scene",
            follows=(Follows("changed", ("solver_enabled",), "its world is off"), _STANDS),
        ),
    ),
    "rigid_cache_baked": (
        Sabotage("free_world", "scene", follows=(_ONE_WORLD, _STANDS)),
        Sabotage("shorten_world", "scene", follows=(_ONE_WORLD, _STANDS)),
    ),
    "rigid_constraint": (Sabotage("untie", follows=(_UNTIED,)),),
    "rigid_constraint_no_collision": (
        Sabotage(
            "let_collide",
            follows=(Follows("all", ("rigid_constraint_no_collision",), "a tie is both its ends'"),),
        ),
    ),
    "rigid_collision_modifier": (
        _on("remove", "COLLISION", _NOT_FELT, _NO_SOLVER),
        _on("mute", "COLLISION", _NOT_FELT, _NO_SOLVER),
    ),
    "rigid_positive_mass": (Sabotage("set_body", options={"attribute": "mass", "value": 0.0}),),
    "particle_system": (
        _on(
            "remove",
            "PARTICLE_SYSTEM",
            Follows("changed", _PARTICLES, "these are settings of the system"),
            _NO_SOLVER,
        ),
    ),
    "particle_type": (
        Sabotage(
            "set_value",
            options={"types": ["PARTICLE_SYSTEM"], "path": "particle_system.settings.type"},
            given=lambda params, _: {
                "value": "HAIR" if params.get("type", "EMITTER") == "EMITTER" else "EMITTER"
            },
            follows=(
                _OTHER_PART,
                Follows("changed", ("particle_cache_baked",), "hair that does not move is not kept"),
            ),
        ),
    ),
    "particle_source": (_on("set_value", "PARTICLE_SYSTEM", path="particle_system.settings.count", value=0),),
    "particle_cache_baked": _caches("PARTICLE_SYSTEM"),
    "particle_collision_partners": _partners(
        "PARTICLE_SYSTEM", "particle_system.settings.collision_collection"
    ),
    "particle_from_deformed": (_on("put_first", "PARTICLE_SYSTEM"),),
    "particle_force_fields": (
        Sabotage(
            "calm", "scene", follows=(Follows("all", ("solver_enabled",), "a field without strength is off"),)
        ),
        _on("set_value", "PARTICLE_SYSTEM", path="particle_system.settings.effector_weights.all", value=0.0),
    ),
    "soft_modifier": (
        _on(
            "remove",
            "SOFT_BODY",
            Follows("changed", _SOFT, "these are settings of the modifier"),
            _NO_SOLVER,
            _NOT_DEFORMED,
            _STANDS,
        ),
    ),
    "soft_cache_baked": _caches("SOFT_BODY", _STANDS),
    "soft_collision_partners": _partners("SOFT_BODY", "settings.collision_collection"),
    "soft_goal_group": (
        _on("clear_group", "SOFT_BODY", path="settings.vertex_group_goal"),
        _on("set_value", "SOFT_BODY", path="settings.use_goal", value=False),
    ),
    "soft_rigid_partners": (
        Sabotage(
            "expel",
            "partner",
            follows=(
                Follows("changed", ("rigid_settings",), "a body outside of the world is none"),
                _FEWER_BODIES,
                _UNTIED,
                _STANDS,
            ),
        ),
        Sabotage(
            "remove", "partner", {"types": ["COLLISION"]}, follows=(_NOT_FELT, _NOT_FELT_ITSELF, _NO_SOLVER)
        ),
    ),
    "dense_transform_keys": (Sabotage("record"),),
    "animated_shape_keys": (Sabotage("reshape"), Sabotage("play_mesh")),
    "static_has_cache": (Sabotage("add_bake", "scene"),),
    "static_has_rigid_world": (Sabotage("add_body", "scene"),),
    "static_has_solver": (Sabotage("add_solver", "scene"),),
}
