"""The steps of topics are done in Blender, in their order, in a new scene."""

from __future__ import annotations

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


def test_whatever_can_be_made_is_made_without_an_error(reader: BaseReader) -> None:
    data = [path for path, name in reader.data_classes if path == f"{TYPES}{name}"]
    makeable = sorted(reader.creations(data))[::7]
    told = {
        path: steps(reader, path.removeprefix(TYPES).lower(), path.removeprefix(TYPES)) for path in makeable
    }
    done = do_steps({path: lines for path, lines in told.items() if lines})
    assert sum(topic.done for topic in done) > 150
    assert [(topic.topic, *row) for topic in done for row in topic.failed] == []


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
