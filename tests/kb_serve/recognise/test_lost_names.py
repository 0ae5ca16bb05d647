"""Code whose variables tell no class: what only older versions had comes first, or is named beside what is there."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from asking import paths

from kb_build.symbols.paths import last_name

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader

T = "bpy.types."


@pytest.mark.parametrize(
    ("written", "gone"),
    [
        # the data of an object, whatever it is called
        ("jelly.data.use_auto_smooth = True", "Mesh.use_auto_smooth"),
        ("q.data.pixel_factor = 2", "GreasePencil.pixel_factor"),
        # … or called like its data
        ("sun.data.use_contact_shadow = True", "SunLight.use_contact_shadow"),
        ("cam.data.cycles.aperture_size = 0.1", "Camera.cycles"),
        ("cam_data.cycles.aperture_size = 0.1", "Camera.cycles"),
        # what a chain leads to, from anywhere
        ("pivot.animation_data.action.fcurves.find('location')", "Action.fcurves"),
        ("what.action.groups.new('A')", "Action.groups"),
        ("some.data[loop.index].select = True", "MeshUVLoop.select"),
        ("loop[uv_layer].select = True", "bmesh.types.BMLoopUV.select"),
        # sockets that no node has, or that hardly any node counts as much as the one that lost it
        (
            "b.inputs['Emission'].default_value = (0, 0.8, 1, 1)",
            'ShaderNodeBsdfPrincipled.inputs["Emission"]',
        ),
        ("node.inputs['Specular'].default_value = 0.6", 'ShaderNodeBsdfPrincipled.inputs["Specular"]'),
        ("x.inputs['Transmission'].default_value = 1", 'ShaderNodeBsdfPrincipled.inputs["Transmission"]'),
        # … members of classes that count far more, or of which none else takes the value
        ("r.tile_x = 256", "RenderSettings.tile_x"),
        ("q.use_zbuffer = True", "ImageFormatSettings.use_zbuffer"),
        ("c.progressive = 'PATH'", "CyclesRenderSettings.progressive"),
        # names that scripts use
        ("seq.sequences.new_effect('A', 'COLOR', 1)", "SequenceEditor.sequences"),
        ("for s in seq.sequences_all: pass", "SequenceEditor.sequences_all"),
        ("strip.use_translation = True", "EffectSequence.use_translation"),
        ("tex.color_space = 'NONE'", "ShaderNodeTexImage.color_space"),
        # … of several classes that had it the one that lost it last
        ("m.shadow_method = 'NONE'", "Material.shadow_method"),
    ],
)
def test_what_is_gone_is_told_first(kb: KnowledgeBase, written: str, gone: str) -> None:
    path = gone if gone.startswith("bmesh.") else f"{T}{gone}"
    assert kb.query(written).notes[0].startswith(f"`{path}` does not exist in Blender")


@pytest.mark.parametrize(
    ("written", "first"),
    [
        (
            "hair.inputs['Transmission'].default_value = 1",
            'ShaderNodeBsdfHairPrincipled.inputs["Transmission"]',
        ),
        ("x.inputs['Roughness'].default_value = 1", 'ShaderNodeBsdfPrincipled.inputs["Roughness"]'),
        ("thing.show_edge_seams = True", "View3DOverlay.show_edge_seams"),  # which it moved to
        ("x.fcurves", "ActionChannelbag.fcurves"),
        ("rgbc.mapping.curves[3]", "CurveMapping.curves"),  # the game engine's had no successor
        ("var.type = 'SINGLE_PROP'", "DriverVariable.type"),
        ("bag.fcurves.new('location')", "ActionChannelbagFCurves.new"),
    ],
)
def test_what_may_well_be_meant_is_not_denied(kb: KnowledgeBase, written: str, first: str) -> None:
    answer = kb.query(written)
    assert answer.hits[0].id == f"{T}{first}"
    assert [note for note in answer.notes if "does not exist" in note] == []


@pytest.mark.parametrize(
    "written",
    [
        "props.mode = 'GROW'",
        "op.type = 'BACK'",
        "self.data.use_auto_smooth = True",
        "MyTool.use_auto_smooth = True",
        "x.frobnicate.use_it = True",
    ],
)
def test_the_scripts_own_is_left_alone(kb: KnowledgeBase, written: str) -> None:
    assert [note for note in kb.query(written).notes if "does not exist" in note] == []


@pytest.mark.parametrize(
    ("written", "lost", "version"),
    [
        ("terrain.select = True", "Object.select", "2.80"),
        ("q.hide = True", "Object.hide", "2.80"),
        ("bone.select = True", "Bone.select", "5.0"),
        ("cb.lift = (0.95, 0.98, 1.05)", "CompositorNodeColorBalance.lift", "5.0"),
    ],
)
def test_what_a_likelier_thing_had_is_named(kb: KnowledgeBase, written: str, lost: str, version: str) -> None:
    answer = kb.query(written)
    variable = written.partition(".")[0]
    assert f"If `{variable}` is what had `{lost}`, that was removed in {version}" in answer.text
    assert answer.hits[0].id.endswith(lost.partition(".")[2])


@pytest.mark.parametrize("written", ["bone.use_deform = True", "x.location = (1, 2, 3)", "x.type = 'MESH'"])
def test_nothing_lost_is_named_where_the_variable_or_the_name_tells(kb: KnowledgeBase, written: str) -> None:
    assert "is what had" not in kb.query(written).text


def test_every_thing_of_a_name_being_of_one_class_it_is_said_to_lack_a_member(kb: KnowledgeBase) -> None:
    (note,) = [note for note in kb.query("w.field.falloff_angle = 30").notes if "has no" in note]
    assert note.startswith(f"`{T}FieldSettings` has no `falloff_angle`")
    assert f"`{T}FieldSettings.falloff_type`" in note.partition("Closest: ")[2]


def test_one_of_the_closest_begins_alike(kb: KnowledgeBase) -> None:
    message = "AttributeError: 'FieldSettings' object has no attribute 'falloff_angle'"
    assert f"`{T}FieldSettings.falloff_type`" in kb.query(message).notes[0].partition("Closest: ")[2]


@pytest.mark.parametrize(
    "code", ["n.{}.default_value = {}", 'n = ng.nodes.new("{2}")\nn.{0}.default_value = {1}']
)
def test_right_lines_that_set_inputs_of_nodes_are_not_denied(
    kb: KnowledgeBase, reader: BaseReader, code: str
) -> None:
    denied: list[str] = []
    for path in paths(reader, "socket", 150):
        socket = reader.symbol(path)
        assert socket is not None
        if "inputs[" not in path or not isinstance(socket.default, int | float):
            continue
        line = code.format(path.removeprefix(f"{socket.owner}."), socket.default, last_name(socket.owner))
        denied += [line for note in kb.query(line).notes if "does not exist" in note or "has no `" in note]
    assert denied == []


def test_what_a_part_has_today_is_not_told_as_lost_with_a_class(kb: KnowledgeBase) -> None:
    answer = kb.query("scene.resolution_x = 100")
    assert answer.hits[0].id == f"{T}RenderSettings.resolution_x"
    assert "removed" not in "\n".join(answer.notes)


def test_a_text_that_what_was_lost_never_took_tells_nothing_of_it(kb: KnowledgeBase) -> None:
    assert "does not exist" not in "\n".join(kb.query("x.operation = 'MUL'").notes)
