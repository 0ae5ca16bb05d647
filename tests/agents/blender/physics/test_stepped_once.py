"""Simulations are paid for once: what was stepped is kept, becomes the bake, and is dropped when something changes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from test_bake import PARTS, one

from agents.blender.checks.verification import read_measures
from agents.blender.tools.bake import TOOL as BAKE
from agents.blender.tools.base import Call
from agents.blender.tools.files import SAVE as SAVE_TOOL
from agents.blender.tools.motion_sheet import TOOL as MOTION
from agents.blender.tools.previews import TOOLS as PREVIEWS
from agents.blender.tools.verify import TOOL as VERIFY
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

(PREVIEW,) = (tool for tool in PREVIEWS if tool.name == "blender_scene_layout_preview")

CLOTH_ON_BALL = f"""{PARTS}
cloth()
bpy.ops.mesh.primitive_uv_sphere_add(radius=0.4, location=(0, 0, 1.5))
bpy.context.object.name = "Ball"
bpy.context.object.modifiers.new("Collision", "COLLISION")
"""
# Of each, Blender has the animated value under further names.
ANIMATED = f"""{CLOTH_ON_BALL}
settings = bpy.data.objects["Flag"].modifiers["Cloth"].settings
bpy.ops.object.effector_add(type="WIND", location=(0, -2, 1))
for frame, value in ((4, 50), (9, 0)):
    settings.pin_stiffness = bpy.context.object.field.strength = value
    settings.keyframe_insert("pin_stiffness", frame=frame)
    bpy.context.object.keyframe_insert("field.strength", frame=frame)
"""
LIQUID = f"{PARTS}\ntank(use_mesh=True)\nbpy.data.objects['Tank'].modifiers[0].domain_settings.cache_frame_end = 12"
SAVE = (
    "import os\nbpy.ops.wm.save_as_mainfile(filepath=os.path.abspath('scene.blend'))"  # as a run's own file
)


def visited(session: LiveSession, name: str, frame: int = 12) -> tuple[int, list[float]]:
    """How many frames a measurement of an object at a frame visits, and the low corner of its box there."""
    frames: list[str] = []
    _r = session.blender.call(
        "measure",
        {"requests": [{"kind": "boxes", "names": [name], "frame": frame}]},
        lambda value: read_measures(1, value),
        timeout=60,
        progress=lambda _done, _total, text: frames.append(text),
    )
    (answer,) = _r.value
    return len(frames), answer["value"]["boxes"][name]["low"]


@pytest.mark.parametrize(
    ("code", "name"),
    [pytest.param(CLOTH_ON_BALL, "Flag", marks=pytest.mark.whole), (ANIMATED, "Flag"), (LIQUID, "Tank")],
)
def test_what_was_stepped_is_measured_again_without_a_step_and_becomes_the_bake(
    session: LiveSession, code: str, name: str
) -> None:
    session.run(f"{code}\n{SAVE}")
    first = visited(session, name)
    assert first[0] == 12
    assert visited(session, name) == (1, first[1])
    session.run("bpy.data.objects['Lamp'] if 'Lamp' in bpy.data.objects else bpy.data.materials.new('Paint')")
    bake = session.use(BAKE)
    assert not bake.failed, bake.text
    assert one(bake)["kept"]
    assert "simulated before and kept" in bake.text
    assert (one(bake)["baked"], one(bake)["missing"], one(bake)["range"]) == (True, 0, [1, 12])
    assert visited(session, name) == (1, first[1])
    session.blender.keep("before a restart")
    session.blender.restore()
    assert visited(session, name)[1] == pytest.approx(first[1], abs=1e-5)


@pytest.mark.parametrize(
    "place", ["in the run", pytest.param("in Blender's temporary folder", marks=pytest.mark.whole)]
)
def test_what_a_liquid_was_stepped_to_outlives_saving(session: LiveSession, place: str) -> None:
    session.run(f"{LIQUID}\n{SAVE}")
    if place == "in the run":
        session.run("bpy.data.objects['Tank'].modifiers[0].domain_settings.cache_directory = '//frames'")
    first = visited(session, "Tank")
    session.run("bpy.context.scene.frame_set(1)")
    for name in ("stage", "scene"):
        saved = session.use(SAVE_TOOL, name=name, verify=False)
        session.run("bpy.context.view_layer.update()")
        (cache,) = saved.data["caches"]
        assert (cache["frames"], saved.data["beside"]["files"]) == (12, 3 * 12)
    assert visited(session, "Tank") == (1, first[1])
    bake = session.use(BAKE)
    assert one(bake)["kept"], bake.text


@pytest.mark.parametrize(
    "change",
    [
        "bpy.data.objects['Ball'].location.x = 0.3",
        "bpy.data.objects['Flag'].modifiers['Cloth'].settings.mass = 2",
        "bpy.context.scene.gravity.z = -3",
        "bpy.data.objects['Flag'].data.vertices[0].co.z += 0.1",
        # Stepped through with another setting, which is put back.
        """
ball = bpy.data.objects['Ball']
ball.location.x = 0.3
bpy.data.objects['Flag'].modifiers['Cloth'].point_cache.frame_step = 1
for frame in range(1, 13):
    bpy.context.scene.frame_set(frame)
ball.location.x = 0
""",
    ],
)
def test_a_change_has_everything_simulated_anew(session: LiveSession, change: str) -> None:
    session.run(CLOTH_ON_BALL)
    visited(session, "Flag")
    session.run(change)
    assert visited(session, "Flag")[0] == 12
    session.run("bpy.context.scene.gravity.z = -1")
    assert not one(session.use(BAKE))["kept"]


def test_a_moved_obstacle_has_a_liquid_simulated_anew(session: LiveSession) -> None:
    session.run(LIQUID)
    first = visited(session, "Tank", 6)
    session.run("bpy.data.objects['TankDrop'].location.z = 1.3")
    count, low = visited(session, "Tank", 6)
    assert count == 6
    assert low[2] > first[1][2] + 0.1


def test_rules_without_motion_step_no_frame_and_say_so(session: LiveSession) -> None:
    session.run(CLOTH_ON_BALL)
    told: list[str] = []
    found = session.use(VERIFY, Call(progress=lambda _done, _total, text: told.append(text)), rules=["V"])
    assert told == []
    assert "Judged at frame 1 only" in found.text
    assert "cloth of 'Flag'" in found.text
    session.use(BAKE)
    assert "Judged at frame" not in session.use(VERIFY, rules=["V"]).text


# What is not finite


def broken(kind: str) -> str:
    """A scene whose simulation is not finite from some frame on."""
    return (
        {
            "cloth": f"""{PARTS}
cloth('Thing')
settings = bpy.data.objects['Thing'].modifiers['Cloth'].settings
settings.use_pressure = True
settings.uniform_pressure_force = 1e30
""",
            "soft body": f"{PARTS}\nsoft('Thing')",
            "particles": f"{PARTS}\nemitter('Thing')",
        }[kind]
        + """
scene.frame_set(1)
bpy.ops.object.effector_add(type='WIND')
wind = bpy.context.object
wind.field.strength = 0
wind.field.keyframe_insert('strength', frame=5)
wind.field.strength = 3e38
wind.field.keyframe_insert('strength', frame=6)
"""
    )


@pytest.mark.parametrize("kind", ["cloth", "soft body", "particles"])
def test_a_bake_ends_at_the_first_frame_that_is_not_finite(session: LiveSession, kind: str) -> None:
    session.run(broken(kind))
    told: list[str] = []
    bake = session.use(BAKE, Call(progress=lambda _done, _total, text: told.append(text)))
    assert bake.failed
    entry = one(bake)
    assert not entry["baked"]
    assert f"{kind} of 'Thing' has coordinates that are not finite" in entry["fault"]
    assert "Likely cause: " in entry["fault"]
    assert not any("frame 12" in text for text in told)


def test_verifying_what_is_not_finite_gives_one_finding(session: LiveSession) -> None:
    session.run(broken("cloth"))
    found = session.use(VERIFY)
    causes = [one for one in found.data["findings"] if one["rule"] == "simulation"]
    assert [(cause["severity"], cause["objects"]) for cause in causes] == [("hard", ("Thing",))]
    assert causes[0]["frame"] is not None
    assert "quality" in causes[0]["fix"]
    assert not [one for one in found.data["findings"] if one["outcome"] == "undecided"]


# Freeing


def test_a_bake_is_freed_and_says_what_was(session: LiveSession) -> None:
    session.run(f"{CLOTH_ON_BALL}\nsoft()")
    session.use(BAKE, objects=["Flag"])
    freed = session.use(BAKE, free=True)
    assert freed.data == {"freed": ["cloth of 'Flag'"], "unbaked": ["soft body of 'Jelly'"]}
    assert session.run("bpy.data.objects['Flag'].modifiers['Cloth'].point_cache.is_baked") is False
    assert visited(session, "Flag")[0] == 12


def test_a_freed_liquid_simulates_again(session: LiveSession) -> None:
    session.run(LIQUID)
    session.use(BAKE)
    session.use(BAKE, free=True)
    state: Any = session.run(
        "(d := bpy.data.objects['Tank'].modifiers[0].domain_settings) and (d.cache_type, d.has_cache_baked_data)"
    )
    assert state == ("REPLAY", False)
    assert visited(session, "Tank")[0] == 12


def test_a_motion_that_is_not_finite_is_not_shown_as_baked(session: LiveSession) -> None:
    session.run(broken("cloth"))
    with pytest.raises(Refusal, match="not finite"):
        session.use(MOTION, actors=["Thing"])


def test_a_preview_shows_a_frame_that_was_simulated_and_says_where_it_was_not(session: LiveSession) -> None:
    session.run(CLOTH_ON_BALL)
    assert "Shown at frame 1, not 9" in session.use(PREVIEW, frame=9).text
    visited(session, "Flag")
    assert "Shown at frame" not in session.use(PREVIEW, frame=9).text
