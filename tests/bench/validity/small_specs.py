"""Specs that the small scenes meet."""

from __future__ import annotations

from typing import Any

from bench.scenes.spec import Spec

_NO_FAKES = ["dense_transform_keys", "animated_shape_keys"]
STILL: list[Any] = [
    {
        "name": "table",
        "synonyms": ["desk"],
        "role": "collider",
        "must_have": ["renderable", "solver_enabled"],
    },
    {"name": "lamp", "synonyms": ["lantern"], "role": "static", "must_have": ["renderable"]},
    {"name": "floor", "synonyms": ["ground"], "role": "rigid_passive", "must_have": ["rigid_settings"]},
]
DRAPE: dict[str, Any] = {
    "id": "cloth_D3_99",
    "category": "cloth",
    "level": "D3",
    "prompt": "A tablecloth sinks onto a table, two dominoes drop on the floor, and sparks rise beside a lamp.",
    "frames": {"min": 12},
    "actors": [
        {
            "name": "tablecloth",
            "synonyms": ["linen"],
            "role": "cloth",
            "must_have": [
                *("renderable", "solver_enabled", "cloth_modifier", "cloth_cache_baked", "cloth_pin_group"),
                {"cloth_collision_partners": {"partners": ["table"]}},
            ],
            "must_not_have": _NO_FAKES,
        },
        {
            "name": "domino",
            "synonyms": ["tile stone"],
            "role": "rigid_active",
            "count": 2,
            "must_have": [
                *("renderable", "solver_enabled", "rigid_settings", "rigid_cache_baked"),
                {"rigid_type": {"type": "ACTIVE"}},
                {"rigid_world_populated": {"min": 3}},
            ],
            "must_not_have": ["dense_transform_keys"],
        },
        {
            "name": "brazier",
            "synonyms": ["fire bowl"],
            "role": "particle_emitter",
            "must_have": ["renderable", "solver_enabled", "particle_system", "particle_cache_baked"],
        },
        *STILL,
    ],
    "relations": [
        {"type": "Above", "a": "tablecloth", "b": "floor"},
        {"type": "SupportedBy", "a": "table", "b": "floor", "when": ["start"], "tolerance": 0.02},
        {"type": "SupportedBy", "a": "lamp", "b": "floor", "tolerance": 0.02},
    ],
}
POUR: dict[str, Any] = {
    "id": "fluid_D1_99",
    "category": "fluid",
    "level": "D1",
    "prompt": "Water runs out of a tap and falls into a sink of white china at noon.",
    "frames": {"min": 8},
    "actors": [
        {
            "name": "water",
            "synonyms": ["liquid"],
            "role": "fluid_domain",
            "must_have": [
                *("solver_enabled", "fluid_modifier", "fluid_cache_baked", "fluid_mesh"),
                {"fluid_type": {"type": "DOMAIN", "kind": "LIQUID"}},
            ],
        },
        {
            "name": "tap",
            "synonyms": ["faucet"],
            "role": "fluid_flow",
            "must_have": ["renderable", "solver_enabled", "fluid_domain_exists"],
        },
    ],
    "relations": [{"type": "NextTo", "a": "tap", "b": "water", "when": ["end"], "tolerance": 0.5}],
}
ROOM: dict[str, Any] = {
    "id": "static_D1_99",
    "category": "static",
    "level": "D1",
    "prompt": "A lamp of brass stands on a wooden floor beside a stack of books.",
    "actors": [
        {"name": "lamp", "synonyms": ["lantern"], "role": "static", "must_have": ["renderable"]},
        {"name": "book", "synonyms": ["volume"], "role": "static", "count": 3, "must_have": ["renderable"]},
        {"name": "floor", "synonyms": ["ground"], "role": "static", "must_have": ["renderable"]},
    ],
    "relations": [
        {"type": "SupportedBy", "a": "lamp", "b": "floor", "tolerance": 0.02},
        {"type": "NextTo", "a": "book", "b": "lamp", "tolerance": 2.0},
    ],
    "assertions": ["static_has_cache", "static_has_rigid_world", "static_has_solver"],
}


def spec_like(given: dict[str, Any], **changed: Any) -> Spec:
    """A spec, with some of it otherwise."""
    return Spec.model_validate({**given, **changed})
