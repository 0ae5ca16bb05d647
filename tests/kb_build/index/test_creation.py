"""The calls that make things are those that Blender takes, and weights tell what counts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

from kb_build.blender.access_paths import reached_expressions
from kb_build.index.creation import Creation, creation_calls
from kb_build.index.weights import symbol_weights
from kb_build.symbols.records import Symbol
from kb_build.usage.examples import Example, Uses

if TYPE_CHECKING:
    from pathlib import Path

    from kb_build.blender.extract_reader import Extract

STRIPS = "bpy.types.StripsTopLevel"


@pytest.fixture(scope="module")
def calls(extract: Extract) -> dict[str, Creation]:
    reached = reached_expressions(extract.symbols, names=extract.names)
    return creation_calls(
        extract.symbols,
        {f"bpy.types.{name}": expression for name, expression in reached.items()},
        extract.names,
    )


@pytest.mark.parametrize(
    ("cls", "call"),
    [
        ("ClothModifier", "obj.modifiers.new(\"Cloth\", 'CLOTH')"),
        ("SunLight", "bpy.data.lights.new(\"Sun\", 'SUN')"),
        ("NodesModifier", "obj.modifiers.new(\"GeometryNodes\", 'NODES')"),
        ("TrackToConstraint", "obj.constraints.new('TRACK_TO')"),
        ("KinematicConstraint", "obj.pose.bones[\"Bone\"].constraints.new('IK')"),
        ("TextCurve", "bpy.data.curves.new(\"Text\", 'FONT')"),
        ("ActionSlot", 'scene.animation_data.action.slots.new(scene.id_type, "Action slot")'),
        ("Material", 'bpy.data.materials.new("Material")'),
        ("MeshUVLoopLayer", "mesh.uv_layers.new()"),
        ("ShaderNodeMath", 'tree.nodes.new("ShaderNodeMath")'),
        ("ShaderFxWave", "obj.shader_effects.new(\"WaveDistortion\", 'FX_WAVE')"),
        (
            "SpeedControlStrip",
            "scene.sequence_editor.strips.new_effect("
            "\"SpeedControl Strip\", 'SPEED', channel, frame_start, input1=input1)",
        ),
        ("Driver", 'obj.driver_add("location", 2).driver'),
        ("RigidBodyWorld", "bpy.ops.rigidbody.world_add()"),
        (
            "NodeSocketFloat",
            "tree.interface.new_socket(\"Name\", in_out='INPUT', socket_type='NodeSocketFloat')",
        ),
        (
            "NodeTreeInterfaceSocketMenu",
            "geometry_tree.interface.new_socket(\"Name\", in_out='INPUT', socket_type='NodeSocketMenu')",
        ),
    ],
)
def test_a_class_is_made_as_scripts_make_it(calls: dict[str, Creation], cls: str, call: str) -> None:
    assert calls[f"bpy.types.{cls}"].call == call


def test_calls_are_functions_and_classes_that_exist(calls: dict[str, Creation], extract: Extract) -> None:
    symbols = {symbol.path: symbol for symbol in extract.symbols}
    assert len(calls) > 500
    for path, creation in calls.items():
        assert symbols[path].kind == "class"
        assert symbols[creation.maker].kind in {"function", "operator"}
        types = next(
            (p for p in symbols[creation.maker].parameters if p.name in {"type", "socket_type"}), None
        )
        items = {item.identifier for item in types.enum_items} if types else set[str]()
        assert not creation.choice or creation.choice in items | {symbols[path].name}


def test_what_only_lists_things_or_is_a_value_is_not_made(calls: dict[str, Creation]) -> None:
    assert not {"bpy.types.NlaTracks", "bpy.types.NodeSocketFloatFactor", "mathutils.Color"} & calls.keys()


@pytest.mark.blender
def test_blender_makes_a_strip_of_the_class_for_every_call(
    calls: dict[str, Creation], tmp_path: Path
) -> None:
    strips = {
        cls: creation.call for cls, creation in calls.items() if creation.maker.startswith(f"{STRIPS}.new_")
    }
    assert len(strips) > 20
    starting = [
        "import bpy", "scene = bpy.context.scene", "strips = scene.sequence_editor_create().strips",
        "filepath, channel, frame_start, length = 'none', 5, 1, 9", "mask = bpy.data.masks.new('a')",
        "input1, input2 = (strips.new_effect('a', 'COLOR', n, 1, length=9) for n in (1, 2))",
    ]  # fmt: skip
    made = [f"made = {call}" for call in strips.values()]
    watched = dict.fromkeys(range(len(starting), len(starting) + len(made)), "type(made).__name__")
    answers = run_statements(tmp_path, [*starting, *made], watched)[len(starting) :]
    # A film must be there.
    rows = {cls: row for cls, row in zip(strips, answers, strict=True) if "MovieStrip" not in cls}
    assert {cls: row[0] for cls, row in rows.items() if row[0]} == {}
    assert {f"bpy.types.{row[2][1:-1]}" for row in rows.values()} == rows.keys()


@pytest.mark.blender
@pytest.mark.parametrize(("maker", "least"), [("ObjectModifiers.new", 40), ("ObjectShaderFx.new", 9)])
def test_blender_makes_a_modifier_of_the_class_for_every_call(
    calls: dict[str, Creation], maker: str, least: int
) -> None:
    bpy = pytest.importorskip("bpy")
    objects = [bpy.data.objects.new("made", bpy.data.meshes.new("made"))]
    objects.append(bpy.data.objects.new("drawn", bpy.data.grease_pencils.new("drawn")))
    made = 0
    try:
        for path, creation in calls.items():
            if creation.maker.endswith(maker):
                for obj in objects:
                    try:
                        modifier = eval(creation.call, {"obj": obj})
                    except RuntimeError:  # a modifier of the other kind of object
                        continue
                    if modifier is not None:  # some are there once, or not at all for such an object
                        assert modifier.bl_rna.identifier == path.rpartition(".")[2]
                        made += 1
        assert made >= least
    finally:
        for obj in objects:
            bpy.data.objects.remove(obj)


@pytest.mark.blender
def test_blender_makes_a_strip_modifier_of_the_class_for_every_call(
    calls: dict[str, Creation], tmp_path: Path
) -> None:
    modifiers = {
        cls: creation.call.replace("scene.sequence_editor.active_strip", "strip")
        for cls, creation in calls.items()
        if creation.maker == "bpy.types.StripModifiers.new"
    }
    assert len(modifiers) >= 10
    starting = [
        "import bpy", "scene = bpy.context.scene", "bpy.context.workspace.sequencer_scene = scene",
        "strip = scene.sequence_editor_create().strips.new_effect('a', 'COLOR', 1, 1, length=9)",
    ]  # fmt: skip
    made = [f"made = {call}" for call in modifiers.values()]
    watched = dict.fromkeys(range(len(starting), len(starting) + len(made)), "type(made).__name__")
    rows = run_statements(tmp_path, [*starting, *made], watched)[len(starting) :]
    assert [f"bpy.types.{row[2][1:-1]}" for row in rows] == list(modifiers)


@pytest.mark.blender
def test_calls_that_made_new_things_run(extract: Extract) -> None:
    bpy = pytest.importorskip("bpy")
    calls: dict[str, str] = {}
    for symbol in extract.symbols:
        calls.update({new.by: symbol.owner for new in symbol.new_values if new.by.startswith("bpy.data.")})
    assert {'bpy.data.scenes.new("Scene")', 'bpy.data.images.new("Image", 8, 8)'} <= calls.keys()
    assert calls["bpy.data.lights.new(\"Sun\", 'SUN')"] == "bpy.types.SunLight"
    for call in calls:
        assert eval(call, {"bpy": bpy}), call


def test_what_is_used_asked_for_and_explained_weighs_more() -> None:
    symbols = [Symbol(f"m.{name}", "property", "m") for name in ("used", "asked", "explained", "none")]
    weights = symbol_weights(symbols, {"m.explained"}, {"m.asked": "one; two; three"}, {"m.used": Uses(7, 2)})
    assert weights == {"m.used": 6.0, "m.asked": 1.5, "m.explained": 1.0}


def test_an_operator_that_only_menus_name_weighs_less_than_one_that_scripts_call() -> None:
    symbols = [Symbol(f"bpy.ops.uv.{name}", "operator", "bpy.ops.uv") for name in ("in_menus", "called")]
    call = Example(1.0, "bake.py", 3, "bpy.ops.uv.called()")
    usage = {"bpy.ops.uv.in_menus": Uses(9, 1), "bpy.ops.uv.called": Uses(3, 1, [call])}
    assert symbol_weights(symbols, (), {}, usage) == {"bpy.ops.uv.in_menus": 2.0, "bpy.ops.uv.called": 4.0}
