"""The steps of topics are done in Blender, in their order, in a new scene."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

import pytest
from asking import TYPES, steps

from measurements.steps import do_steps

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader

pytestmark = pytest.mark.blender

# What people ask for, with classes that the manual's pages on it explain, the heaviest first.
TOPICS = {
    "actions": ("Action", "ActionSlot", "ActionChannelbag", "FCurve"),
    "armatures": ("Armature", "Bone", "EditBone", "BoneCollection"),
    "bones": ("EditBone", "PoseBone", "BoneCollection"),
    "cloth": ("ClothModifier", "ClothSettings", "ClothCollisionSettings"),
    "collections": ("Collection",),
    "compositing": ("CompositorNodeTree", "CompositorNodeGlare", "CompositorNodeViewer"),
    "constraints": ("CopyLocationConstraint", "ArmatureConstraint", "ConstraintTargetBone"),
    "curves": ("Curve", "Spline", "Curves"),
    "drivers": ("Driver", "DriverVariable", "DriverTarget"),
    "fluid": ("FluidModifier", "FluidDomainSettings", "FluidFlowSettings"),
    "geometry nodes": (
        "GeometryNodeSimulationOutput",
        "GeometryNodeSimulationInput",
        "GeometryNodeSetPosition",
    ),
    "grease pencil": ("GreasePencil", "GreasePencilLayer", "GreasePencilFrame"),
    "hooks": ("HookModifier",),
    "lights": ("Light", "PointLight", "SunLight"),
    "masks": ("Mask", "MaskLayer", "MaskSpline"),
    "materials": ("Material", "MaterialSlot"),
    "modifiers": ("NodesModifier", "SubsurfModifier"),
    "nla": ("NlaTrack", "NlaStrip"),
    "rigid body": ("RigidBodyObject", "RigidBodyWorld", "RigidBodyConstraint"),
    "shader nodes": ("ShaderNodeTree", "ShaderNodeBsdfPrincipled", "ShaderNodeTexImage"),
    "strips": ("TextStrip", "ColorStrip"),
    "texture nodes": ("TextureNodeTexMusgrave",),
    "uv": ("MeshUVLoopLayer",),
    "volumes": ("Volume", "VolumeToMeshModifier", "MeshToVolumeModifier"),
    "world": ("World",),
}


def test_what_people_ask_for_is_done_without_an_error(reader: BaseReader) -> None:
    told = {topic: steps(reader, topic, *classes) for topic, classes in TOPICS.items()}
    done = do_steps(told)
    assert [(topic.topic, *row) for topic in done for row in topic.failed] == []
    assert all(topic.done for topic in done)
    assert sum(topic.done for topic in done) > 4 * len(TOPICS)


def test_a_node_of_textures_is_put_in_the_tree_that_a_texture_has(reader: BaseReader) -> None:
    told = "\n".join(steps(reader, "texture nodes", "TextureNodeTexMusgrave"))
    assert "`tree = texture.node_tree`" in told
    assert 'tree.nodes["Output"].inputs["Color"]' in told
    assert "group.node_tree = tree" not in told  # a group cannot hold itself


def test_whatever_can_be_made_is_made_without_an_error(reader: BaseReader) -> None:
    data = [path for path, name in reader.names.data_classes if path == f"{TYPES}{name}"]
    makeable = sorted(reader.makers.creations(data))[::7]
    told = {
        path: steps(reader, path.removeprefix(TYPES).lower(), path.removeprefix(TYPES)) for path in makeable
    }
    done = do_steps({path: lines for path, lines in told.items() if lines})
    assert sum(topic.done for topic in done) > 150
    assert [(topic.topic, *row) for topic in done for row in topic.failed] == []


def test_every_node_with_items_gets_one_in_each_of_its_collections(reader: BaseReader) -> None:
    """And is linked by what it gets: nodes are joined to what goes through the tree, in sockets of one kind."""
    kinds = "owner LIKE 'bpy.types.%Node%' AND type = 'collection' AND collection LIKE '%Items'"
    items: dict[str, set[str]] = defaultdict(set)
    for node, name in reader.rows(f"SELECT owner, name FROM symbols WHERE {kinds}"):
        items[node].add(name)
    assert {
        f"{TYPES}GeometryNodeBake",
        f"{TYPES}NodeCombineBundle",
        f"{TYPES}GeometryNodeMenuSwitch",
    } <= items.keys()
    told = {node: steps(reader, node.removeprefix(TYPES).lower(), node.removeprefix(TYPES)) for node in items}
    for node, lines in told.items():
        added = {name for name in items[node] if any(f".{name}.new(" in line for line in lines)}
        assert added == items[node], node
        assert any("tree.links.new(" in line for line in lines), node
    assert [(topic.topic, *row) for topic in do_steps(told) for row in topic.failed] == []


@pytest.mark.parametrize(
    ("node", "links"),
    [
        (
            "GeometryNodeBake",
            (
                'group_input.outputs[0], bake.inputs["Geometry"]',
                'bake.outputs["Geometry"], group_output.inputs[0]',
            ),
        ),
        (
            "GeometryNodeIndexSwitch",
            (
                'group_input.outputs[0], switch.inputs["0"]',
                'switch.outputs["Output"], group_output.inputs[0]',
            ),
        ),
        (
            "NodeCombineBundle",
            (
                'group_input.outputs[0], bundle.inputs["Geometry"]',
                "group_input.outputs[0], group_output.inputs[0]",
                'bundle.outputs["Bundle"], group_output.inputs[1]',
            ),
        ),
        (
            "NodeSeparateBundle",
            (
                'group_input.outputs[0], bundle.inputs["Bundle"]',
                'bundle.outputs["Geometry"], group_output.inputs[0]',
            ),
        ),
        (
            "NodeClosureOutput",
            (
                'input.outputs["Geometry"], output.inputs["Geometry"]',
                "group_input.outputs[0], group_output.inputs[0]",
                'output.outputs["Closure"], group_output.inputs[1]',
            ),
        ),
        (
            "GeometryNodeForeachGeometryElementInput",
            (
                'group_input.outputs[0], input.inputs["Geometry"]',
                'input.outputs["Element"], output.inputs["Geometry"]',
                'output.outputs["Generation_0"], group_output.inputs[0]',
            ),
        ),
        (
            "FunctionNodeCombineMatrix",
            (
                'group_input.outputs[0], store.inputs["Geometry"]',
                'matrix.outputs["Matrix"], store.inputs["Value"]',
                'store.outputs["Geometry"], group_output.inputs[0]',
            ),
        ),
        (
            "FunctionNodeFormatString",
            (
                "group_input.outputs[0], group_output.inputs[0]",
                'string.outputs["String"], group_output.inputs[1]',
            ),
        ),
        (
            "CompositorNodeOutputFile",
            (
                'render_layers.outputs["Image"], file.inputs["Image"]',
                'render_layers.outputs["Image"], group_output.inputs[0]',
            ),
        ),
    ],
)
def test_a_node_is_linked_through_and_not_past(reader: BaseReader, node: str, links: tuple[str, ...]) -> None:
    lines = steps(reader, node.lower(), node)
    linked = [line.partition("`tree.links.new(")[2] for line in lines if "tree.links.new(" in line]
    assert linked == [f"{link})`" for link in links]


def test_a_step_that_fails_is_told() -> None:
    right = [
        "1. `mask = bpy.data.masks.new('a')`",
        "2. `layer = mask.layers[7]`",
        "3. set on `mask`: `frame_start` = 1",
    ]
    wrong = [
        "1. set on `obj`: `no_such_name`",
        "2. `tree = obj.animation_data`",
        "3. call `obj.delete_all()`",
    ]
    good, bad = do_steps({"good": right, "bad": wrong})
    assert [step for step, _ in good.failed] == right[1:2]
    assert [step for step, _ in bad.failed] == wrong
