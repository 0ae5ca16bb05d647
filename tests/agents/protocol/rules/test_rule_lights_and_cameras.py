"""W3 to W5: lights, cameras and fields."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from scenes import build, the_finding, verified

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

SCENE = """
thing("Lamp", box("Pole", (-0.1, -0.1, 0), (0.1, 0.1, 1)))
lamp, root = bpy.data.collections["Lamp"], bpy.data.objects["Lamp root"]

def light(energy=5, kind="POINT"):
    made = bpy.data.objects.new("Bulb", bpy.data.lights.new("Bulb", kind))
    made.data.energy = energy
    return made

def field(kind="WIND"):
    made = bpy.data.objects.new("Wind", None)
    scene.collection.objects.link(made)
    with bpy.context.temp_override(object=made, active_object=made, selected_objects=[made]):
        bpy.ops.object.forcefield_toggle()
    made.field.type = kind
    scene.collection.objects.unlink(made)
    return made

def world(strength=1.0, color=(0.05, 0.05, 0.05, 1)):
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    inputs = scene.world.node_tree.nodes["Background"].inputs
    inputs["Strength"].default_value, inputs["Color"].default_value = strength, color
    return scene.world.node_tree

def surface(tree):
    return tree.nodes["World Output"].inputs["Surface"]
"""


@pytest.mark.parametrize(
    "more",
    [
        'system("lighting").objects.link(light())\nsystem("physics").objects.link(field())\n'
        "camera((3, -3, 2), (0, 0, 0))",
        'scene.collection.objects.link(light(kind="SUN"))\ncamera((3, -3, 2), (0, 0, 0))',
    ],
)
def test_a_stage_that_is_set_has_nothing_to_find(session: LiveSession, more: str) -> None:
    build(session, SCENE + more)
    report = verified(session, "W3,W4,W5")
    assert report.findings == ()
    assert report.passed == ("W3", "W4", "W5")


@pytest.mark.parametrize(
    ("change", "name", "what"),
    [
        ("lamp.objects.link(light())", "Bulb", "light"),
        (
            'camera((3, -3, 2), (0, 0, 0))\nsystem("cameras").objects.unlink(scene.camera)\n'
            "lamp.objects.link(scene.camera)",
            "Camera", "camera",
        ),
        ("lamp.objects.link(field())", "Wind", "force field"),
        # A light that hangs in a collection of the object's own is inside it, too.
        (
            'inner = bpy.data.collections.new("Inner")\nlamp.children.link(inner)\ninner.objects.link(light())',
            "Bulb", "light",
        ),
    ],
)  # fmt: skip
def test_what_does_not_belong_into_an_object_is_told(
    session: LiveSession, change: str, name: str, what: str
) -> None:
    build(session, SCENE + change)
    found = the_finding(verified(session, "W3"))
    assert (found.rule, found.severity, found.objects) == ("W3", "soft", (name, "Lamp"))
    assert found.message.startswith(f"The {what} ")


def test_a_mesh_that_is_a_force_field_is_told(session: LiveSession) -> None:
    build(
        session,
        SCENE + 'pole = bpy.data.objects["Pole"]\n'
        "with bpy.context.temp_override(object=pole, active_object=pole, selected_objects=[pole]):\n"
        "    bpy.ops.object.forcefield_toggle()",
    )
    assert the_finding(verified(session, "W3")).objects == ("Pole", "Lamp")


def test_a_scene_without_a_camera_is_warned_of_and_still_ok(session: LiveSession) -> None:
    build(session, SCENE)
    report = verified(session, "W4")
    found = the_finding(report)
    assert (found.rule, found.severity, found.measured) == ("W4", "soft", 0)
    assert report.ok


SKY = """
tree = world(1, (0, 0, 0, 1))
tree.links.new(tree.nodes.new("ShaderNodeTexSky").outputs[0], tree.nodes["Background"].inputs["Color"])
"""
GROUP = """
group = bpy.data.node_groups.new("Sky", "ShaderNodeTree")
group.interface.new_socket("Sky", in_out="OUTPUT", socket_type="NodeSocketShader")
group.links.new(group.nodes.new("ShaderNodeBackground").outputs[0], group.nodes.new("NodeGroupOutput").inputs[0])
tree = world(0)
node = tree.nodes.new("ShaderNodeGroup")
node.node_tree = group
tree.links.new(node.outputs[0], surface(tree))
"""
GLOW = """
tree = world(0)
tree.links.new(tree.nodes.new("ShaderNodeEmission").outputs[0], surface(tree))
"""


@pytest.mark.parametrize(
    ("world", "strength"),
    [
        ("world(1)", None),
        ("world(0.5, (0.05, 0, 0, 1))", None),
        (SKY, None),
        (GROUP, None),
        (GLOW, None),
        ("", 0.0),
        ("world(0)", 0.0),
        ("world(5, (0, 0, 0, 1))", 0.0),
        ("world(0.01, (0.05, 0, 0, 1))", 5e-4),
        ("world(5).links.clear()", 0.0),
    ],
)
def test_a_world_lights_a_scene_if_it_shines(
    session: LiveSession, world: str, strength: float | None
) -> None:
    build(session, SCENE + world)
    report = verified(session, "W5")
    if strength is None:
        assert report.passed == ("W5",)
    else:
        found = the_finding(report)
        assert (found.rule, found.severity, found.objects) == ("W5", "soft", ())
        assert found.measured == pytest.approx(strength, abs=1e-6)


@pytest.mark.parametrize(
    ("light", "lit"),
    [
        ("scene.collection.objects.link(light(1))", True),
        ("scene.collection.objects.link(light(0))", False),
        ("bulb = light(5)\nscene.collection.objects.link(bulb)\nbulb.hide_render = True", False),
        ('system("lighting").objects.link(light(5))\nsystem("lighting").hide_render = True', False),
        (
            'system("lighting").objects.link(light(5))\n'
            'bpy.context.view_layer.layer_collection.children["lighting"].exclude = True',
            False,
        ),
    ],
)
def test_a_light_lights_a_scene_if_renders_see_it(session: LiveSession, light: str, lit: bool) -> None:
    build(session, SCENE + light)
    report = verified(session, "W5")
    assert report.passed == (("W5",) if lit else ())
    assert len(report.findings) == (not lit)
