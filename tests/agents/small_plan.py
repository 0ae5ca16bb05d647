"""A scene plan with a bit of everything, for tests that only need one."""

from __future__ import annotations

from typing import Any


def small_plan() -> dict[str, Any]:
    """A ball rolls off a shelf; sound."""
    return {
        "title": "A ball on a shelf",
        "frame_end": 48,
        "systems": ["ground", "room"],
        "objects": [
            {
                "name": "Floor",
                "systems": ["ground"],
                "dimensions": [4, 4, 0.1],
                "position": [0, 0, -0.1],
                "role": "ground",
            },
            {
                "name": "Shelf",
                "systems": ["room"],
                "dimensions": [1, 0.3, 0.8],
                "position": [0, 0, 0],
                "parts": ["Board"],
            },
            {
                "name": "Ball",
                "systems": ["room"],
                "dimensions": [0.1, 0.1, 0.1],
                "position": [0.4, 0, 0.8],
                "role": "rigid",
                "material": {"name": "Rubber", "base_color": [0.8, 0.1, 0.1]},
            },
        ],
        "relations": [
            {"kind": "SupportedBy", "child": "Shelf", "parents": ["Floor"]},
            {"kind": "SupportedBy", "child": "Ball", "parents": ["Shelf/Board"]},
            {"kind": "LeftOf", "a": "Shelf", "b": "Ball", "frame": "camera"},
        ],
        "lighting": [{"name": "Sun", "kind": "sun", "energy": 3}],
        "camera": {"position": [0, -4, 1.5], "target": "Ball", "lens": 120, "subjects": ["Ball"]},
        "render": {"kind": "animation"},
        "motion": {
            "phases": [
                {"name": "falls", "actor": "Ball", "kind": "fall", "start": 12, "end": 24, "extent": 0.8}
            ]
        },
        "opt_out": ["uv"],
    }
