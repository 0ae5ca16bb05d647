"""The stills in neutral light: the file's own materials, whatever the scene's light."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

import pytest
from PIL import Image
from preview_views import build

from agents.blender.tools import material_preview
from agents.blender.tools.bake import TOOL as BAKE
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.blender.tools.base import Result

pytestmark = pytest.mark.blender

# Two boxes with a procedural pattern, one without a material, in a closed room without a lamp.
CLOSED_ROOM = """
for at, x in enumerate((-1, 0, 1)):
    box(f'Chest {at}', (1.3 * x, 0, .5), (1, 1, 1))
material = bpy.data.materials.new('Checks'); material.use_nodes = True
tree = material.node_tree
checks, place = tree.nodes.new('ShaderNodeTexChecker'), tree.nodes.new('ShaderNodeTexCoord')
checks.inputs['Color1'].default_value, checks.inputs['Color2'].default_value = (.8, 0, 0, 1), (0, 0, .8, 1)
checks.inputs['Scale'].default_value = 2
tree.links.new(place.outputs['Object'], checks.inputs['Vector'])
tree.links.new(checks.outputs['Color'], tree.nodes['Principled BSDF'].inputs['Base Color'])
for at in (0, 1):
    bpy.data.objects[f'Chest {at}'].data.materials.append(material)
box('Shell', (0, 0, 1.25), (4.4, 4.4, 2.5), (.6, .6, .6))
for name in ('Chest 0', 'Chest 1', 'Chest 2', 'Shell'):
    collection(f'The {name}', 'object', bpy.data.objects[name])
"""


@pytest.fixture(autouse=True)
def _small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(material_preview, "_PANEL", 64)


def pictures(result: Result) -> list[Image.Image]:
    return [Image.open(io.BytesIO(image.png)).convert("RGB") for image in result.pictures]


def share(picture: Image.Image, colour: str) -> float:
    """The share of a picture that is red or blue."""
    at = "RGB".index(colour)
    strong = [max(others) * 1.5 < own for own, *others in _by_channel(picture, at)]
    return sum(strong) / len(strong)


def _by_channel(picture: Image.Image, first: int) -> list[tuple[int, ...]]:
    data = picture.tobytes()
    rows = [data[at : at + 3] for at in range(0, len(data), 3)]
    return [(row[first], *(row[at] for at in range(3) if at != first)) for row in rows]


def test_shows_procedural_textures_in_a_closed_room_without_a_lamp(session: LiveSession) -> None:
    build(session, CLOSED_ROOM)
    result = session.use(material_preview.TOOL, show="scene", width=96)
    (whole,) = pictures(result)
    assert share(whole, "R") > 0.01
    assert share(whole, "B") > 0.01
    data = whole.convert("L").tobytes()
    assert sum(data) / len(data) > 70, "the room is dark"
    assert "Shell" in result.text, "what was cut away is not named"


def test_stills_are_denoised_quickly(session: LiveSession) -> None:
    used = session.run(
        "import importlib\n"
        "studio = importlib.import_module('simworlds_worker.preview.lit_studio').LitStudio(1)\n"
        "with studio:\n"
        "    used = studio.scene.cycles.denoising_quality\n"
        "used"
    )
    assert used == "BALANCED"


def test_shows_each_look_once_and_names_what_has_no_material(session: LiveSession) -> None:
    build(session, CLOSED_ROOM)
    result = session.use(material_preview.TOOL, show="objects")
    shown = {one["name"]: one for one in result.data["objects"]}
    assert shown.keys() == {"The Chest 0", "The Chest 2", "The Shell"}
    assert shown["The Chest 0"]["materials"] == ["Checks"]
    assert shown["The Chest 0"]["alike"] == ["The Chest 1"]
    assert shown["The Chest 2"]["bare"] == ["Chest 2"]
    assert "The Chest 2: no material" in result.text


def test_an_object_of_choice_is_alone_in_its_picture(session: LiveSession) -> None:
    build(session, CLOSED_ROOM)
    result = session.use(material_preview.TOOL, show="objects", objects=["The Chest 2"])
    (sheet,) = pictures(result)
    assert share(sheet, "R") == share(sheet, "B") == 0
    assert [one["name"] for one in result.data["objects"]] == ["The Chest 2"]


def test_shows_the_scene_at_frames_through_its_camera(session: LiveSession) -> None:
    build(
        session,
        "ball = box('Ball', (0, 0, 0), rgb=(.8, 0, 0))\n"
        "ball.keyframe_insert('location', frame=1); ball.location.x = 50; ball.keyframe_insert('location', frame=9)\n"
        "bpy.ops.object.camera_add(location=(0, -6, 0), rotation=(math.pi / 2, 0, 0))\n"
        "scene = bpy.context.scene; scene.camera = bpy.context.object; scene.frame_set(1)\n"
        "scene.render.resolution_x, scene.render.resolution_y = 64, 32\n"
        "box('Far', (0, 90, 0))",
    )
    result = session.use(material_preview.TOOL, show="scene", frames=[1, 9], width=64)
    first, last = pictures(result)
    assert first.size == last.size == (64, 32)
    assert share(first, "R") > 0.02
    assert share(last, "R") == 0
    assert session.run("bpy.context.scene.frame_current") == 1


@pytest.mark.parametrize(
    ("shape", "shown"), [((160, 90), (96, 54)), ((90, 90), (96, 96)), ((45, 90), (48, 96))]
)
def test_the_scene_is_shown_as_wide_as_asked_for(
    session: LiveSession, shape: tuple[int, int], shown: tuple[int, int]
) -> None:
    build(
        session,
        "box('Mug'); bpy.ops.object.camera_add(location=(0, -6, 0), rotation=(math.pi / 2, 0, 0))\n"
        "scene = bpy.context.scene; scene.camera = bpy.context.object\n"
        f"scene.render.resolution_x, scene.render.resolution_y = {shape}",
    )
    sizes = {picture.size for picture in pictures(session.use(material_preview.TOOL, show="scene", width=96))}
    assert sizes == {shown}


def test_objects_alone_share_the_width_that_is_asked_for(session: LiveSession) -> None:
    build(session, "box('Mug'); box('Jug', (3, 0, 0))")

    def wide(*objects: str, width: int) -> int:
        found = session.use(material_preview.TOOL, show="objects", objects=list(objects), width=width)
        return pictures(found)[0].width

    margins = wide("Mug", width=400) - 400
    assert 0 <= margins < 50
    assert wide("Mug", width=300) == 300 + margins
    assert wide("Mug", "Jug", width=300) == pytest.approx(300 + margins, abs=20), "beside each other"
    assert wide("Mug", "Jug", width=64) == pytest.approx(2 * 64 + margins, abs=20), (
        "no smaller than can be read"
    )


def test_what_one_call_has_no_room_for_is_named_with_the_reason(session: LiveSession) -> None:
    build(session, "for at in range(14): box(f'Post {at:02}', (2 * at, 0, 0))")
    text = session.use(material_preview.TOOL, show="objects").text
    assert "Not shown alone, since at most 12 objects are in one call: 'Post 12', 'Post 13'." in text


# Beside a chest of 1 m a floor of 80 m, whose squares of 5 cm are grey from where all of it is seen.
VAST_FLOOR = CLOSED_ROOM.split("box('Shell'", maxsplit=1)[0].replace("= 2\n", "= 20\n") + (
    "box('Floor', (0, 0, -.5), (80, 80, 1)).data.materials.append(material)\n"
    "for name in ('Chest 0', 'Chest 1', 'Chest 2', 'Floor'):\n"
    "    collection(f'The {name}', 'object', bpy.data.objects[name])\n"
)


def test_what_is_far_larger_than_all_others_is_shown_close_up_as_well(
    session: LiveSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(material_preview, "_PANEL", 96)
    build(session, VAST_FLOOR)
    found = session.use(material_preview.TOOL, show="objects", objects=["The Floor"])
    assert found.data["patches"] == ["The Floor"]
    assert found.data["rendered"] == 2
    assert "- close up: The Floor" in found.text
    (sheet,) = pictures(found)
    panels = [sheet.crop((left, 60, left + 98, sheet.height)) for left in (12, 12 + 98 + 8)]
    whole, close = (min(share(panel, "R"), share(panel, "B")) for panel in panels)
    assert close > 0.1
    assert close > 2 * whole
    again = session.use(material_preview.TOOL, show="objects", objects=["The Floor"])
    assert (again.data["rendered"], again.data["kept"]) == (0, 2)
    assert session.use(material_preview.TOOL, show="objects", objects=["The Chest 0"]).data["patches"] == []


@pytest.mark.whole
def test_objects_come_as_they_were_named(session: LiveSession) -> None:
    build(session, CLOSED_ROOM)
    named = session.use(material_preview.TOOL, show="objects", objects=["The Shell", "The Chest 1"])
    assert [one["name"] for one in named.data["objects"]] == ["The Shell", "The Chest 1"]


def test_what_the_plan_is_about_comes_first_then_what_acts_then_what_merely_differs(
    session: LiveSession,
) -> None:
    build(session, CLOSED_ROOM)
    session.run("bpy.data.collections['The Chest 1'].__setitem__('deformation_kind', 'sim_soft')")
    shown = session.use(material_preview.TOOL, show="objects", first=["The Shell"]).data["objects"]
    assert [one["name"] for one in shown] == ["The Shell", "The Chest 1", "The Chest 2"]
    assert shown[1]["alike"] == ["The Chest 0"]


SMOKE = """
bpy.context.scene.frame_end = 4
box('Air', (0, 0, 1), (2, 2, 2))
air = bpy.data.objects['Air'].modifiers.new('Fluid', 'FLUID')
air.fluid_type = 'DOMAIN'
air.domain_settings.domain_type, air.domain_settings.resolution_max = 'GAS', 16
box('Fire', (0, 0, .5), (.6, .6, .6), (.8, 0, 0))
flow = bpy.data.objects['Fire'].modifiers.new('Fluid', 'FLUID')
flow.fluid_type = 'FLOW'
flow.flow_settings.flow_type, flow.flow_settings.flow_behavior = 'SMOKE', 'INFLOW'
"""


def test_gas_is_said_to_be_drawn_without_its_shader(session: LiveSession) -> None:
    build(session, SMOKE)
    session.use(BAKE)
    told = "Drawn as blocks, without its shader: the gas of 'Air'"
    assert told in session.use(material_preview.TOOL, show="scene", width=64, frames=[4]).text
    session.run(
        "flow = bpy.data.objects['Fire'].modifiers['Fluid'].flow_settings\nflow.use_inflow = False\n"
        "bpy.context.scene.frame_set(1)"
    )
    session.use(BAKE)
    text = session.use(material_preview.TOOL, show="scene", width=64, frames=[1]).text
    assert "Not shown, without gas at frame 1: 'Air'." in text
    assert told not in text
    session.run("bpy.data.objects['Air'].modifiers.clear()")
    assert told not in session.use(material_preview.TOOL, show="scene", width=64).text


def test_what_has_no_size_yet_is_named_and_the_others_are_shown(session: LiveSession) -> None:
    build(session, "box('Mug', (0, 0, 0)); box('Seed', (3, 0, 0), (0, 0, 0))")
    result = session.use(material_preview.TOOL, show="objects")
    assert [one["name"] for one in result.data["objects"]] == ["Mug"]
    assert "Not shown alone, without any size at this frame: 'Seed'." in result.text


def test_where_nothing_can_be_shown_no_file_is_named(session: LiveSession) -> None:
    build(session, "box('Mug'); box('Ghost', (3, 0, 0)).hide_render = True")
    text = session.use(material_preview.TOOL, show="objects", objects=["Ghost"]).text
    assert text.startswith("Nothing is shown:\n")
    assert "Saved as" not in text


def test_an_unknown_name_is_refused_with_the_nearest(session: LiveSession) -> None:
    build(session, CLOSED_ROOM)
    with pytest.raises(Refusal, match="Nearest: 'The Chest 2'"):
        session.use(material_preview.TOOL, objects=["The Chest 9", "The Chest 2"])


def test_time_that_is_over_leaves_out_stills_and_says_which(session: LiveSession) -> None:
    build(session, CLOSED_ROOM)
    result = session.use(
        material_preview.TOOL, show="objects", seconds=1, objects=["The Chest 0", "The Shell"]
    )
    left = {"The Chest 0", "The Shell"} - {one["name"] for one in result.data["objects"]}
    assert all(repr(name) in result.text for name in left)
    assert ("since the 1 seconds were over" in result.text) == bool(left)
    assert len(left) < 2, "nothing is shown at all"


def test_of_an_edit_only_what_its_plan_names_or_what_is_new_is_shown_alone(session: LiveSession) -> None:
    build(session, CLOSED_ROOM)
    everything = ["Chest 0", "Chest 1", "Chest 2", "Shell"]

    def alone(first: list[str], old: list[str] | None = everything) -> list[str]:
        asked = {"show": "objects", "only_first": True, "first": first, "old": old}
        return [one["name"] for one in session.use(material_preview.TOOL, **asked).data["objects"]]

    assert alone(["The Chest 2", "World"]) == ["The Chest 2"]
    assert alone(["Chest 2"], None) == ["The Chest 2"], "a part of it is named"
    assert alone(["Checks"]) == ["The Chest 0"], "its material is named"
    assert alone(["World"]) == []
    assert alone([], everything[:-1]) == ["The Shell"], "it is new"


def test_what_is_unchanged_is_not_rendered_again(session: LiveSession) -> None:
    build(session, CLOSED_ROOM.replace("(.8, 0, 0, 1)", "(.7, 0, 0, 1)"))  # no other test has shown it
    whole = session.use(material_preview.TOOL, width=64)
    assert (whole.data["rendered"], whole.data["kept"]) == (4, 0)
    some = session.use(
        material_preview.TOOL, width=64, first=["The Shell"], objects=["The Shell", "The Chest 2"]
    )
    assert (some.data["rendered"], some.data["kept"]) == (0, 3), "asked otherwise, it shows the same"
    assert "Shown as before, since nothing has changed: 3 stills." in some.text
    assert pictures(some)[0].tobytes() == pictures(whole)[0].tobytes()
    larger = session.use(material_preview.TOOL, width=96, show="scene")
    assert (larger.data["rendered"], larger.data["kept"]) == (1, 0)
    session.run(
        "bpy.data.materials['Checks'].node_tree.nodes['Checker Texture'].inputs['Scale'].default_value = 5"
    )
    changed = session.use(material_preview.TOOL, width=64, show="scene")
    assert (changed.data["rendered"], changed.data["kept"]) == (1, 0)


def test_what_an_unbaked_simulation_shows_is_rendered_each_time(session: LiveSession) -> None:
    build(
        session,
        "drop = box('Drop', (0, 0, 2))\n"
        "bpy.context.view_layer.objects.active = drop\n"
        "bpy.ops.rigidbody.object_add()\n"
        "for frame in range(1, 4):\n    bpy.context.scene.frame_set(frame)",
    )
    for _ in range(2):
        assert session.use(material_preview.TOOL, width=64, show="scene").data["kept"] == 0
    session.run("bpy.context.scene.frame_set(1)")
    session.use(material_preview.TOOL, width=64, show="scene")
    assert session.use(material_preview.TOOL, width=64, show="scene").data["kept"] == 1, (
        "nothing has moved yet"
    )
