"""Which objects and trees a pointer takes is told as Blender has it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

from kb_build.symbols.accepted import (
    CRASHES,
    ITSELF,
    LEAVES,
    REFUSES,
    TAKES,
    accepted,
    accepted_text,
    fatal_kinds,
)
from kb_build.symbols.flag_names import NAMES_PART

if TYPE_CHECKING:
    from kb_build.blender.extract_reader import Extract
    from kb_build.symbols.records import Symbol

pytestmark = pytest.mark.blender

_START = """\
import bpy
D = bpy.data
mesh, camera = D.meshes.new("a"), D.cameras.new("a")
curve, lattice, armature = D.curves.new("a", "CURVE"), D.lattices.new("a"), D.armatures.new("a")
owner = D.objects.new("owner", D.meshes.new("owner"))
bone_owner = D.objects.new("b", armature)
bpy.context.collection.objects.link(bone_owner)
bpy.context.view_layer.objects.active = bone_owner
bpy.ops.object.mode_set(mode="EDIT")
armature.edit_bones.new("Bone").tail = (0, 0, 1)
bpy.ops.object.mode_set(mode="OBJECT")
bone = bone_owner.pose.bones[0]
"""
_GIVEN = {
    "MESH": 'D.objects.new("m", mesh)', "CURVE": 'D.objects.new("c", curve)', "EMPTY": 'D.objects.new("e", None)',
    "CAMERA": 'D.objects.new("x", camera)', "LATTICE": 'D.objects.new("l", lattice)',
    "ARMATURE": 'D.objects.new("r", armature)',
}  # fmt: skip
# What has the pointer, as scripts make it, and what that belongs to.
_POINTERS = {
    **{
        f"{name}Modifier.{pointer}": (f'owner.modifiers.new("n", {kind!r})', "owner")
        for name, kind, pointer in (
            ("Boolean", "BOOLEAN", "object"), ("Armature", "ARMATURE", "object"), ("Curve", "CURVE", "object"),
            ("Lattice", "LATTICE", "object"), ("Shrinkwrap", "SHRINKWRAP", "target"),
            ("Mirror", "MIRROR", "mirror_object"), ("Array", "ARRAY", "curve"), ("MeshDeform", "MESH_DEFORM", "object"),
            ("Hook", "HOOK", "object"), ("SurfaceDeform", "SURFACE_DEFORM", "target"), ("Cast", "CAST", "object"),
        )
    },
    "TrackToConstraint.target": ('bone.constraints.new("TRACK_TO")', "bone_owner"),
    "ChildOfConstraint.target": ('bone.constraints.new("CHILD_OF")', "bone_owner"),
    "FollowPathConstraint.target": ('owner.constraints.new("FOLLOW_PATH")', ""),
    "PoseBone.custom_shape": ("bone", "bone_owner"),
    "Curve.bevel_object": ('D.curves.new("n", "CURVE")', ""),
    "Object.parent": ("owner", "owner"),
    "Scene.camera": ("bpy.context.scene", ""),
}  # fmt: skip
_TREES = ("ShaderNodeTree", "GeometryNodeTree", "CompositorNodeTree", "TextureNodeTree")


@pytest.fixture(scope="module")
def symbols(extract: Extract) -> dict[str, Symbol]:
    return {symbol.path: symbol for symbol in extract.symbols}


def _outcome(error: str, taken: str) -> str:
    return REFUSES if error else TAKES if taken == "True" else LEAVES


def test_what_becomes_of_objects_is_told_as_blender_has_it(
    symbols: dict[str, Symbol], tmp_path_factory: pytest.TempPathFactory
) -> None:
    lines, watched, asked = _START.splitlines(), {}, []
    for name, (made, itself) in _POINTERS.items():
        for kind, given in {**_GIVEN, **({ITSELF: itself} if itself else {})}.items():
            lines += [f"thing, given = {made}, {given}", f"thing.{name.rpartition('.')[2]} = given"]
            watched[len(lines) - 1] = f"thing.{name.rpartition('.')[2]} == given"
            asked.append((name, kind, len(lines) - 1))
    answers = run_statements(tmp_path_factory.mktemp("accepted"), lines, watched)
    assert not any(error for error, *_ in answers[: len(_START.splitlines())])
    seen: dict[str, dict[str, str]] = {}
    for name, kind, place in asked:
        error, _, taken = answers[place]
        seen.setdefault(name, {})[kind] = _outcome(error, taken)
    told = {
        name: accepted(symbols[f"bpy.types.{name}"]) for name in seen if f"bpy.types.{name}" in symbols
    }  # fmt: skip
    wrong = [
        (name, kind, outcome) for name, kinds in seen.items() for kind, outcome in kinds.items()
        if told.get(name, {}).get(kind, TAKES) != outcome
    ]  # fmt: skip
    assert wrong == []
    assert {outcome for kinds in seen.values() for outcome in kinds.values()} == {TAKES, LEAVES, REFUSES}


def test_a_group_takes_trees_of_its_own_kind(
    symbols: dict[str, Symbol], tmp_path_factory: pytest.TempPathFactory
) -> None:
    lines, watched, asked = ["import bpy"], {}, []
    for tree in _TREES:
        node = tree.replace("NodeTree", "NodeGroup")
        for kind in _TREES:
            lines += [
                f'given = bpy.data.node_groups.new("g", {kind!r})',
                f'node = bpy.data.node_groups.new("t", {tree!r}).nodes.new({node!r})',
                "node.node_tree = given",
            ]
            watched[len(lines) - 1] = "node.node_tree == given"
            asked.append((f"bpy.types.{node}.node_tree", kind, len(lines) - 1))
    answers = run_statements(tmp_path_factory.mktemp("trees"), lines, watched)
    for path, kind, place in asked:
        assert accepted(symbols[path])[kind] == _outcome(answers[place][0], answers[place][2])
        assert (symbols[path].target == kind) is (accepted(symbols[path])[kind] == TAKES)


def test_words_say_the_shorter_side(symbols: dict[str, Symbol]) -> None:
    def told(name: str) -> str:
        return accepted_text(symbols[f"bpy.types.{name}"])

    assert told("BooleanModifier.object") == (
        "takes objects of type MESH alone: any other is left out without an error"
    )  # fmt: skip
    assert told("PoseBone.custom_shape") == "takes no object of type ARMATURE: refused"
    assert told("ShaderNodeGroup.node_tree") == "any other tree is left out without an error"
    assert told("MirrorModifier.mirror_object") == told("Scene.camera") == ""


def test_what_crashes_blender_is_told_as_that(symbols: dict[str, Symbol]) -> None:
    symbol = symbols["bpy.types.NodesModifier.node_group"]
    assert accepted(symbol).get("GeometryNodeTree") == TAKES
    if CRASHES in accepted(symbol).values():
        assert fatal_kinds(symbol).startswith("a tree of type ")
    assert sum(CRASHES in accepted(each).values() for each in symbols.values()) <= 1


def test_texts_that_name_a_part_alone_are_told(
    symbols: dict[str, Symbol], tmp_path_factory: pytest.TempPathFactory
) -> None:
    start = [
        *_START.splitlines(),
        'flat = D.meshes.new("f")',
        "flat.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])",
        'thing = D.objects.new("thing", flat)',
        "bpy.context.collection.objects.link(thing)",
        *(
            f'{kind} = thing.modifiers.new("n", {kind.upper()!r})'
            for kind in ("cloth", "wave", "uv_warp", "warp")
        ),
        'thing.modifiers.new("n", "PARTICLE_SYSTEM")',
        'soft = thing.modifiers.new("n", "SOFT_BODY").settings',
        'camera_track = thing.constraints.new("TRACK_TO")',
    ]
    texts = {
        "ClothSettings.vertex_group_mass": "cloth.settings.vertex_group_mass",
        "WaveModifier.vertex_group": "wave.vertex_group", "WaveModifier.uv_layer": "wave.uv_layer",
        "UVWarpModifier.uv_layer": "uv_warp.uv_layer", "WarpModifier.bone_from": "warp.bone_from",
        "ParticleSystem.vertex_group_density": "thing.particle_systems[0].vertex_group_density",
        "SoftBodySettings.vertex_group_goal": "soft.vertex_group_goal", "Modifier.name": "wave.name",
        "TrackToConstraint.subtarget": "camera_track.subtarget", "ID.name": "thing.name",
    }  # fmt: skip
    lines = list(start)
    # Blender 5.1 crashes where a UV map is called like a vertex group.
    groups = "thing.vertex_groups"
    with_map = f'{groups}.remove({groups}["Named"]); flat.uv_layers.new(name="Named")'
    for add in ("None", f'{groups}.new(name="Named")', with_map):
        lines += [add, *(f'{text} = "Named"' for text in texts.values())]
    watched = {at: line.partition(" = ")[0] for at, line in enumerate(lines) if line.endswith('= "Named"')}
    answers = run_statements(tmp_path_factory.mktemp("texts"), lines, watched)
    assert not any(error for error, *_ in answers)
    kept = [value == "'Named'" for at, (_, _, value) in enumerate(answers) if at in watched]
    count = len(texts)
    for at, name in enumerate(texts):
        without, with_group, with_map = kept[at], kept[at + count], kept[at + 2 * count]
        part = "" if without else "vertex group" if with_group else "UV map" if with_map else ""
        assert "".join(symbols[f"bpy.types.{name}"].flagged(NAMES_PART)) == part
    assert kept.count(False) > count
