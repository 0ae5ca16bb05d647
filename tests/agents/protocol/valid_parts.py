"""What the valid scenes and their plans are made of."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from agents.plan.check import read_plan

if TYPE_CHECKING:
    from agents.plan.scene import ScenePlan

# Adds to the tools of scenes.py.
STAGE = """
def stage(at, target, lens):
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.lens, camera.location = lens, at
    camera.rotation_euler = (Vector(target) - Vector(at)).to_track_quat("-Z", "Y").to_euler()
    system("cameras").objects.link(camera)
    scene.camera = camera
    for name, kind, energy, place in (("Sun", "SUN", 3, (2, -3, 5)), ("Key", "AREA", 200, (-1, -3, 3))):
        light = bpy.data.objects.new(name, bpy.data.lights.new(name, kind))
        light.data.energy, light.location = energy, place
        light.rotation_euler = (Vector(target) - light.location).to_track_quat("-Z", "Y").to_euler()
        system("lighting").objects.link(light)

def touches(one, *names):
    bpy.data.objects[one]["contact_with"] = list(names)

def legs(name, reach, side, height, **where):
    (x, y), half = reach, side / 2
    return [
        box(f"{name} leg {number}", (a * x - half, b * y - half, 0), (a * x + half, b * y + half, height), **where)
        for number, (a, b) in enumerate([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    ]
"""


def an_object(name: str, size: Any, at: Any, system: str = "set", **more: Any) -> dict[str, Any]:
    """A planned object of that size, with its root there."""
    return {"name": name, "systems": [system], "dimensions": size, "position": at, **more}


def checked(**fields: Any) -> ScenePlan:
    """The plan of those fields and two lights, which contradicts itself nowhere."""
    plan, faults = read_plan(
        {
            "lighting": [
                {"name": "Sun", "kind": "sun", "energy": 3},
                {"name": "Key", "kind": "area", "energy": 200},
            ],
            **fields,
        }
    )
    assert plan is not None, [str(fault) for fault in faults]
    return plan
