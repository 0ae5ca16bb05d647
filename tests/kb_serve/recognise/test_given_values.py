"""Wrong values and arguments in lines of code are told, right ones are not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.recognise.likely.likely_keywords import likely_keywords
from kb_serve.recognise.likely.likely_values import likely_values

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase


@pytest.mark.parametrize(
    ("query", "said"),
    [
        ("obj.display_type = 'WIREFRAME'", "Closest: `'WIRE'`"),
        ("km.keymap_items.new('object.delete', 'DELETE', 'PRESS')", "Closest: `'DEL'`."),  # labelled so
        ("ob.modifiers.new('x', 'SUBDIVISION_SURFACE')", "Closest: `'SUBSURF'`."),
        ("ob.constraints.new('INVERSE_KINEMATICS')", "Closest: `'IK'`."),
        # What is refused a second time only, or in a mode, is taken.
        ("fcurve.modifiers.new(type='CYCLE')", "Closest: `'CYCLES'`."),
        ("obj.modifiers.new('c', 'CLOTHS')", "Closest: `'CLOTH'`."),
        ("mesh.attributes.new('x', 'FLOAT3', 'POINT')", "`'FLOAT3'` is not a value of"),
        # Loops are said to be face corners. What is in no scene may be a mesh's, or a point cloud's: all take the same.
        (
            "mesh.attributes.new('x', 'FLOAT', 'LOOP')",
            "AttributeGroupMesh.new(domain)`. Closest: `'CORNER'`.",
        ),
        ("obj.data.attributes.new(name='x', type='FLOAT', domain='LOOP')", "Closest: `'CORNER'`."),
        ("attributes.new(name='x', type='FLOAT', domain='LOOP')", "AttributeGroupMesh.new(domain)`. Closest"),
        (
            'TypeError: AttributeGroupMesh.new(): error with argument 3, "domain" -  enum "LOOP" not found in '
            "('POINT', 'EDGE', 'FACE', 'CORNER', 'CURVE', 'INSTANCE', 'LAYER')",
            "closest: `CORNER`.",
        ),
        ("bpy.ops.wm.obj_export(filepath='x', forward_axis='-Z')", "Closest: `'NEGATIVE_Z'`"),
        ("constraint.track_axis = 'TRACK_-Z'", "Closest: `'TRACK_NEGATIVE_Z'`"),
        ("bpy.data.lights.new('L', type='POINT', energy=5)", "takes no `energy`"),
        # Several begin alike.
        ("obj.parent_type = 'VERTEX_TRI'", "Closest: `'VERTEX'`, `'VERTEX_3'`."),
        # A set of flags.
        ("self.report('ERROR', 'x')", "`type` of `bpy.types.Operator.report` takes a set: `{'ERROR'}`."),
        ("bpy.ops.wm.save_as_mainfile(filepath, copy=True)", "by name only: `filepath=filepath`."),
        ("bpy.ops.object.join(target=1)", "takes no arguments"),
        ('bpy.data.images.load("/tmp/x.png", check=True)', "takes no `check`; closest: `check_existing`."),
        (
            'import bpy\nbpy.ops.wm.stl_export(filepath="out/x.stl", use_selection=True)\nprint(1)',
            "takes no `use_selection`; closest: `export_selected_objects`.",
        ),
        # The words that say what it is, and not "use"; its label; few of its other arguments say "select".
        ("bpy.ops.export_scene.fbx(use_animation=True)", "takes no `use_animation`; closest: `bake_anim`."),
        ("bpy.ops.export_scene.fbx(use_anim=True)", "Similar names: `bpy.ops.export_scene.fbx(bake_anim=…)`"),
        ("bpy.ops.mesh.bevel(width=1)", "takes no `width`; closest: `offset`."),
        ("bpy.ops.wm.stl_export(use_selection=True)", "closest: `export_selected_objects`."),
        ("bpy.ops.wm.obj_import(axis_forward='Y')", "closest: `forward_axis`."),
    ],
)
def test_what_is_none_is_told(kb: KnowledgeBase, query: str, said: str) -> None:
    assert any(said in note for note in kb.query(query).notes)


@pytest.mark.parametrize(
    "query",
    [
        "obj.display_type = 'WIRE'",
        "scene.render.engine = 'LUXCORE'",  # an add-on's
        "self.report({'ERROR'}, 'x')",
        "bpy.ops.wm.save_as_mainfile(filepath=filepath, copy=True)",
        "mesh = bpy.data.meshes.new('M')\nob = bpy.data.objects.new('O', mesh)",
        "nodes.new('ShaderNodeMath'); links.new(a, b)",
        "track = obj.animation_data.nla_tracks.new()\nstrip = track.strips.new('s', 1, action)",
        "bm = bmesh.new()\nlayer = bm.edges.layers.float.new('crease_edge')",
        "node.inputs[0].links[0].from_node",
        "key_block.data[0].co = (0, 0, 0)",
        "noise.noise_dimensions = '4D'",
        "layout.operator('object.select_all').action = 'SELECT'",
        "attributes.new('x', 'FLOAT', 'CORNER')",
        "modifiers.new('x', 'NOISE')",  # of an object or an F-curve: which do not take the same
        "importlib.reload(sys.modules[name])",
        "obj.keyframe_insert(data_path='location', frame=1)",
        "prop = PointerProperty(type=Object, poll=lambda self, obj: obj.type == 'MESH')",
    ],
)
def test_what_is_right_is_not_denied(kb: KnowledgeBase, query: str) -> None:
    denied = ("has no", "takes", "not a value", "does not exist")
    assert [note for note in kb.query(query).notes if any(words in note for words in denied)] == []


def test_the_likeliest_value_points_the_same_way() -> None:
    axes = ("X", "Y", "Z", "NEGATIVE_X", "NEGATIVE_Y", "NEGATIVE_Z")
    assert likely_values("-Y", axes) == ["NEGATIVE_Y"]
    assert likely_values("FORWARD_NEGATIVE_Z", ("TRACK_Z", "TRACK_NEGATIVE_Z")) == ["TRACK_NEGATIVE_Z"]
    domains = ("POINT", "EDGE", "FACE", "CORNER", "CURVE", "INSTANCE", "LAYER")
    assert likely_values("VERTEX", domains) == ["POINT"]
    assert likely_values("LOOP", domains) == ["CORNER"]
    assert likely_values("POLYGON", domains) == ["FACE"]
    assert likely_values("VERTEX", ("VERT", "EDGE", "FACE")) == ["VERT"]


def test_the_likeliest_argument_says_most_of_the_same() -> None:
    """What is like a name in its empty words alone is not meant; a misspelling comes first."""
    names = ["use_selection", "bake_anim", "bake_anim_use_all_bones", "use_visible", "segments", "use_tspace"]
    labels = dict.fromkeys(names, "")
    assert likely_keywords("use_animation", labels)[:1] == ["bake_anim"]
    assert likely_keywords("use_nothing", labels) == []
    assert likely_keywords("segmants", labels) == likely_keywords("segs", labels) == ["segments"]
    assert likely_keywords("visible_use", labels)[0] == "use_visible"
    assert likely_keywords("width", {"offset": "Width", "width_pct": ""})[0] == "offset"


def test_only_what_a_call_takes_is_named_in_place_of_a_wrong_value(kb: KnowledgeBase) -> None:
    notes = kb.query("mesh.attributes.new('a', type='FLOAT', domain='WHOLE')").notes
    assert any("It takes `'POINT'`, `'EDGE'`, `'FACE'`, `'CORNER'`." in note for note in notes)
    notes = kb.query("bpy.ops.object.parent_set(type='ARMATURE_AUTOMATIC')").notes
    assert any(note.endswith("Closest: `'ARMATURE_AUTO'`.") for note in notes)


@pytest.mark.parametrize(
    ("query", "owner"),
    [
        ("mapping.vector_type = 'UV'", "ShaderNodeMapping.vector_type"),
        ("image_texture.projection = 'CUBE'", "ShaderNodeTexImage.projection"),
        ("file_output.format.media_type = 'EXR'", "ImageFormatSettings.media_type"),
        ('blur.inputs["Type"].default_value = "Gauss"', 'CompositorNodeBlur.inputs["Type"]'),
    ],
)
def test_a_value_that_nothing_so_called_takes_is_told_whatever_the_variable_is(
    query: str, owner: str, kb: KnowledgeBase
) -> None:
    assert any(f"is not a value of `bpy.types.{owner}`" in note for note in kb.query(query).notes)


@pytest.mark.parametrize("query", ["x.type = 'BEVEL'", "c.type == 'COPY_LOCATION'", "socket.type == 'VALUE'"])
def test_a_value_that_another_one_so_called_takes_is_not_told(query: str, kb: KnowledgeBase) -> None:
    assert not any("is not a value" in note for note in kb.query(query).notes)


@pytest.mark.parametrize("value", ["High Contrast", "Filmic - High Contrast"])
def test_a_look_of_another_view_leads_to_that_of_this_one(kb: KnowledgeBase, value: str) -> None:
    (note,) = kb.query(f"scene.view_settings.look = '{value}'").notes
    assert "`'AgX - High Contrast'` " in note
    assert "only with view_transform='AgX'" in note


@pytest.mark.parametrize(
    ("query", "note"),
    [
        (
            "bpy.ops.export_scene.gltf(filepath='a', export_colors=True)",
            "`True` is not a value of `bpy.ops.export_scene.gltf(export_vertex_color)`. It takes `'MATERIAL'`",
        ),
        (
            "bpy.ops.wm.obj_export(filepath='a', axis_forward='-Z')",
            "`'-Z'` is not a value of `bpy.ops.wm.obj_export(forward_axis)`. Closest: `'NEGATIVE_Z'`.",
        ),
        (
            "bpy.ops.export_mesh.ply(filepath='a', use_colors=True)",
            "`True` is not a value of `bpy.ops.wm.ply_export(export_colors)`. It takes `'NONE'`",
        ),
    ],
)
def test_what_took_the_place_of_a_keyword_takes_other_values(
    kb: KnowledgeBase, query: str, note: str
) -> None:
    assert [one for one in kb.query(query).notes if one.startswith(note)]


@pytest.mark.parametrize(
    "query",
    [
        "bpy.ops.export_scene.gltf(filepath='a', export_colors='MATERIAL')",
        "bpy.ops.wm.obj_export(filepath='a', axis_forward='NEGATIVE_Z')",
        "bpy.ops.mesh.primitive_cube_add(radius=1)",
    ],
)
def test_values_that_it_takes_as_well_are_not_denied(kb: KnowledgeBase, query: str) -> None:
    assert not [note for note in kb.query(query).notes if "is not a value of" in note]
