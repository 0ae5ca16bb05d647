"""What was tried in Blender beyond RNA: modes of sockets, ends of ranges, names of arguments, what is left out."""

from __future__ import annotations

import itertools
import re
from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

from kb_build.symbols.flag_names import (
    BARE_DATA,
    EMPTY_AT_START,
    FILLED_AT_START,
    GIVES_NONE,
    INVERTED,
    ITERATED,
    KEEPS_ITEMS,
    SAME_VALUE,
    SETS_ALSO,
    WINDOWLESS,
)
from kb_build.symbols.flags import usual_default
from kb_build.symbols.lines import default_text, shown_when, type_text
from kb_build.symbols.taken import AT_TIMES, Setting, Taken

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from kb_build.blender.extract_reader import Extract
    from kb_build.symbols.records import Parameter, Symbol

pytestmark = pytest.mark.blender

NODES = "bpy.types."


@pytest.fixture(scope="module")
def symbols(extract: Extract) -> Mapping[str, Symbol]:
    return {symbol.path: symbol for symbol in extract.symbols}


@pytest.mark.parametrize(
    ("socket", "when"),
    [
        ('ShaderNodeMapRange.inputs["Steps"]', "interpolation_type=STEPPED and data_type=FLOAT"),
        (
            'CompositorNodeRelativeToPixel.outputs["Vector Value"]',
            "reference_dimension=PER_DIMENSION, or data_type=VECTOR",
        ),
        ('ShaderNodeMix.inputs["Factor"]', "data_type=FLOAT|RGBA, or factor_mode=UNIFORM"),
        ('GeometryNodeMeshCube.inputs["Size"]', ""),
    ],
)
def test_a_socket_says_in_which_of_all_modes_together_it_is_shown(
    symbols: Mapping[str, Symbol], socket: str, when: str
) -> None:
    assert shown_when(symbols[NODES + socket]) == when


def test_blender_shows_the_sockets_of_a_node_in_just_the_modes_that_are_told(
    symbols: Mapping[str, Symbol], tmp_path: Path
) -> None:
    dimensions, features = (
        ("1D", "2D", "3D", "4D"),
        ("F1", "SMOOTH_F1", "DISTANCE_TO_EDGE", "N_SPHERE_RADIUS"),
    )
    states = list(itertools.product(dimensions, features))
    starting = [
        "import bpy",
        "node = bpy.data.materials.new('m').node_tree.nodes.new('ShaderNodeTexVoronoi')",
    ]
    code = [f"node.voronoi_dimensions, node.feature = {a!r}, {b!r}" for a, b in states]
    watched = dict.fromkeys(range(len(starting), len(starting) + len(code)), "node.outputs['W'].enabled")
    rows = run_statements(tmp_path, [*starting, *code], watched)[len(starting) :]
    modes = dict(mode.split("=") for mode in symbols[f'{NODES}ShaderNodeTexVoronoi.outputs["W"]'].modes)
    told = [
        a in modes["voronoi_dimensions"].split("|") and b in modes["feature"].split("|") for a, b in states
    ]
    assert [row[2] == "True" for row in rows] == told


def test_a_range_that_is_not_kept_says_so(symbols: Mapping[str, Symbol], tmp_path: Path) -> None:
    assert symbols["bpy.types.RigidBodyObject.mass"].flagged("unbounded:") == ("min",)
    assert set(symbols["bpy.types.RigidBodyObject.angular_damping"].flagged("unbounded:")) == {"min", "max"}
    assert not symbols["bpy.types.SubsurfModifier.levels"].flagged("unbounded:")
    assert not symbols["bpy.types.ClothSettings.quality"].flagged("unbounded:")
    # An end so far out that what is one beyond is nearly the same number.
    assert not symbols["bpy.types.ColorManagedViewSettings.white_balance_temperature"].flagged("unbounded:")
    assert not symbols["bpy.types.ParticleSettings.mass"].flagged("unbounded:")
    assert symbols["bpy.types.Scene.frame_current"].flagged("unbounded:") == ("max",)
    code = ["import bpy", "bpy.ops.rigidbody.object_add()", "bpy.context.object.rigid_body.mass = -1"]
    rows = run_statements(tmp_path, code, {2: "bpy.context.object.rigid_body.mass"})
    assert rows[2][2] == "-1.0"


def test_a_default_that_an_operator_never_takes_is_none(symbols: Mapping[str, Symbol]) -> None:
    def argument(path: str, name: str) -> Parameter:
        return next(one for one in symbols[path].parameters if one.name == name)

    material = argument("bpy.ops.rigidbody.mass_calculate", "material")
    assert material.has_stand_in
    assert material.default is None
    assert {"Steel", "Custom"} <= set(material.values_asked)
    # In areas alone.
    assert argument("bpy.ops.anim.keyframe_insert", "type").has_stand_in
    # One of a list whose others are taken.
    kind = argument("bpy.ops.graph.fmodifier_add", "type")
    assert (kind.default, kind.has_stand_in) == (None, False)
    assert "NULL" not in {item.identifier for item in kind.enum_items}
    # One of a list of which some contexts take only a part.
    kind = argument("bpy.ops.object.modifier_add", "type")
    assert (kind.default, kind.has_stand_in) == ("SUBSURF", False)
    assert argument("bpy.ops.object.select_all", "action").default == "TOGGLE"


def test_items_of_other_machines_are_listed_where_a_source_has_them(symbols: Mapping[str, Symbol]) -> None:
    denoiser = symbols["bpy.types.CyclesRenderSettings.denoiser"]
    assert not denoiser.enum_computed
    where = {item.identifier: item.where for item in denoiser.enum_items}
    assert where.keys() == {"OPENIMAGEDENOISE", "OPTIX"}
    assert (where["OPENIMAGEDENOISE"], where["OPTIX"] in {None, AT_TIMES}) == (None, True)
    assert {item.name for item in denoiser.enum_items} == {"OpenImageDenoise", "OptiX"}


def test_modes_that_nothing_enters_are_told(symbols: Mapping[str, Symbol]) -> None:
    def never(path: str) -> set[str]:
        return {item.identifier for item in symbols[path].enum_items if not item.is_taken}

    former = {f"{mode}_GPENCIL" for mode in ("EDIT", "PAINT", "SCULPT", "VERTEX", "WEIGHT")}
    assert never("bpy.types.Context.mode") == never("bpy.context.mode") == former
    assert never("bpy.types.Object.mode") == {"EDIT_GPENCIL"}


@pytest.mark.parametrize(
    ("number", "ends"),
    [
        ("NlaStrip.blend_in", {"min=0", "max=1"}),
        ("ClothSettings.shear_stiffness_max", {"min=shear_stiffness"}),
        ("CurveMapping.clip_min_x", {"max=clip_max_x"}),
        ("ParticleSettings.path_start", {"min=0", "max=1"}),
        ("MultiresModifier.levels", {"max=0"}),
        ("Scene.frame_current", {"min=0"}),
        # Its highest number is refused with all above it, and leaves what there was.
        ("UDIMTile.number", {"min=1001"}),
        # Assigning it makes another marker.
        ("MovieTrackingMarker.frame", set()),
        ("SubsurfModifier.levels", set()),
        ("RigidBodyObject.mass", set()),
        # Its usual number is this machine's.
        ("RenderSettings.threads", set()),
    ],
)
def test_a_number_that_stops_before_the_end_of_its_range_says_where(
    symbols: Mapping[str, Symbol], number: str, ends: set[str]
) -> None:
    assert set(symbols[NODES + number].flagged("stops:")) == ends


def test_what_has_elements_from_the_beginning_and_what_blender_starts_with_was_compared(
    symbols: Mapping[str, Symbol],
) -> None:
    told = {
        "GreasePencilLayerGroup.color_tag": "`'NONE'` (new grease pencil layer group); RNA says `'COLOR1'`",
        "FloatColorAttributeValue.color": (
            "`(1, 1, 1, 1)` (new float color attribute value); RNA says `(0, 0, 0, 0)`"
        ),
        "MovieTrackingCamera.sensor_width": "`35` (new movieclip); RNA says `0`",
        "SpaceProperties.show_properties_render": "`True` (new properties space); RNA says `False`",
        "ThemeGraphEditor.vertex_size": "`6` in the factory preferences; RNA says `0`",
        # Which folder it is the machine decides.
        "FileSelectParams.directory": "",
    }
    assert {name: default_text(symbols[NODES + name]) for name in told} == told


def test_an_item_that_is_taken_as_another_one_says_so(symbols: Mapping[str, Symbol], tmp_path: Path) -> None:
    items = {
        item.identifier: item.description for item in symbols[f"{NODES}Material.blend_method"].enum_items
    }
    told = {name for name, text in items.items() if text.endswith("Reads back as 'HASHED'")}
    start = ["import bpy", "material = bpy.data.materials.new('m')"]
    code = [f"material.blend_method = {name!r}" for name in items]
    rows = run_statements(
        tmp_path, [*start, *code], dict.fromkeys(range(2, 2 + len(code)), "material.blend_method")
    )
    kept = dict(zip(items, (row[2] for row in rows[2:]), strict=True))
    assert told == {name for name, value in kept.items() if value != repr(name)} == {"OPAQUE", "CLIP"}


def test_an_item_that_is_left_out_says_so(symbols: Mapping[str, Symbol], tmp_path: Path) -> None:
    items = {item.identifier: item.description for item in symbols[f"{NODES}Image.file_format"].enum_items}
    told = {name for name, text in items.items() if text.endswith("Assigned, it changes nothing")}
    code = ["import bpy", "image = bpy.data.images.new('i', 8, 8)"]
    for name in items:
        code += [f"image.file_format = {start!r}\nimage.file_format = {name!r}" for start in ("PNG", "BMP")]
    rows = run_statements(tmp_path, code, dict.fromkeys(range(2, len(code)), "image.file_format"))[2:]
    kept = dict(zip(items, zip(*[(row[2] for row in rows)] * 2, strict=True), strict=True))
    assert told == {name for name, values in kept.items() if values == ("'PNG'", "'BMP'")} == {"FFMPEG"}


def test_what_an_operator_takes_for_what_is_left_out_is_no_default(symbols: Mapping[str, Symbol]) -> None:
    cube = symbols["bpy.ops.mesh.primitive_cube_add"]
    given = {parameter.name: parameter for parameter in cube.parameters}
    assert given["scale"].description.endswith("Left out: (1, 1, 1)")
    assert given["location"].description.endswith("Left out: the 3D cursor's")
    assert (given["scale"].default, given["scale"].unit, given["location"].default) == (None, "", None)
    assert "location=..., rotation=(0, 0, 0), scale=..." in cube.signature


def test_this_blender_has_a_class_for_the_data_of_whatever_is_added(symbols: Mapping[str, Symbol]) -> None:
    adding = [
        symbol for path, symbol in symbols.items() if path.startswith("bpy.ops.") and path.endswith("_add")
    ]
    assert len(adding) > 20
    assert not [symbol.path for symbol in adding if BARE_DATA in symbol.flags]


@pytest.mark.parametrize(
    ("function", "signature"),
    [
        ("bmesh.utils.edge_split", "edge_split(edge, vert, fac, /)"),
        ("bmesh.types.BMVert.select_set", "select_set(select, /)"),
        ("bpy.utils.register_class", "register_class(cls, /)"),
        ("bmesh.types.BMVertSeq.new", "new(co=(0.0, 0.0, 0.0), /, source=None)"),
        ("bmesh.types.BMEdgeSeq.new", "new(verts, /, source=None)"),
        ("bmesh.types.BMFaceSeq.new", "new(verts, /, source=None)"),
        ("bmesh.types.BMDeformVert.get", "get(key, default=None, /)"),
        ("idprop.types.IDPropertyGroup.get", "get(key, default=None, /)"),
        ("idprop.types.IDPropertyGroup.pop", "pop(key, default=..., /)"),
        ("bpy.utils.flip_name", "flip_name(name, /, *, strip_digits=False)"),
        ("blf.bind_imbuf", "bind_imbuf(fontid, imbuf, /, *, display_name=None)"),
        ("gpu.types.GPUStageInterfaceInfo", "GPUStageInterfaceInfo(name, /)"),
        ("aud.PlaybackManager.setVolume", "setVolume(volume, catKey, /)"),
        ("mathutils.Vector.angle", "angle(other, fallback=..., /)"),
        ("mathutils.Matrix.inverted", "inverted(fallback=..., /)"),
        ("bmesh.types.BMEdge.calc_face_angle", "calc_face_angle(fallback=..., /)"),
        (
            "bmesh.utils.face_split",
            "face_split(face, vert_a, vert_b, *, coords=(), use_exist=True, source=None)",
        ),
    ],
)
def test_a_function_that_takes_no_names_shows_it(
    symbols: Mapping[str, Symbol], function: str, signature: str
) -> None:
    assert symbols[function].signature == signature


def test_several_items_at_once_are_a_set_though_none_is_the_default(symbols: Mapping[str, Symbol]) -> None:
    insert = symbols["bpy.types.FCurveKeyframePoints.insert"]
    assert next(one.default for one in insert.parameters if one.name == "options") == []
    assert "options=set()" in insert.signature


def test_an_array_that_is_as_long_as_its_instance_says_so_has_no_length(
    symbols: Mapping[str, Symbol],
) -> None:
    grid, coefficients, color = (
        symbols[f"{NODES}{name}"]
        for name in (
            "FluidDomainSettings.density_grid",
            "FModifierGenerator.coefficients",
            "Material.diffuse_color",
        )
    )
    assert (type_text(grid), type_text(coefficients), type_text(color)) == ("float[]", "float[]", "float[4]")
    assert grid.default is None


def test_a_switch_that_a_panel_shows_the_other_way_round_is_marked(symbols: Mapping[str, Symbol]) -> None:
    assert INVERTED in symbols[f"{NODES}Object.hide_render"].flags
    assert INVERTED in symbols[f"{NODES}LayerCollection.exclude"].flags
    assert INVERTED not in symbols[f"{NODES}Object.show_name"].flags


def test_what_hangs_on_nodes_and_their_modifier_was_tried(
    symbols: Mapping[str, Symbol], tmp_path: Path
) -> None:
    mode = symbols[f"{NODES}NodesModifierBake.bake_mode"]
    assert default_text(mode) == "`'STILL'` (new nodes modifier bake); RNA says `'ANIMATION'`"
    item = symbols[f"{NODES}NodeGeometryCaptureAttributeItem.data_type"]
    taken = [each.identifier for each in item.enum_items if not each.where]
    refused = [each.identifier for each in item.enum_items if each.where]
    assert (len(taken), {"INT8", "STRING", "FLOAT2"} <= {*refused}) == (7, True)
    assert default_text(item) == ""  # whoever makes one says of which type
    starting = [
        "import bpy",
        "tree = bpy.data.node_groups.new('t', 'GeometryNodeTree')",
        "items = tree.nodes.new('GeometryNodeCaptureAttribute').capture_items",
        "item = items.new('VECTOR', 'v')",
    ]
    code = [f"item.data_type = {name!r}" for name in (*taken, *refused)]
    watched = dict.fromkeys(range(len(starting), len(starting) + len(code)), "item.data_type")
    rows = run_statements(tmp_path, [*starting, *code], watched)[len(starting) :]
    assert [row[2] for row in rows[: len(taken)]] == [repr(name) for name in taken]
    assert {row[2] for row in rows[len(taken) :]}.isdisjoint(map(repr, refused))


def test_an_array_of_any_length_has_no_length(symbols: Mapping[str, Symbol]) -> None:
    (indices,) = symbols[f"{NODES}HookModifier.vertex_indices_set"].parameters
    assert indices.type == symbols[f"{NODES}VertexGroup.add"].parameters[0].type


def test_a_call_ends_with_its_own_bracket(symbols: Mapping[str, Symbol]) -> None:
    assert symbols["bpy.props.CollectionProperty"].signature.endswith("tags=set())")


def test_an_item_of_a_mode_of_the_context_is_said_to_be_taken_in_it(
    symbols: Mapping[str, Symbol], tmp_path: Path
) -> None:
    items = {
        item.identifier: item.where for item in symbols["bpy.types.BrushTextureSlot.map_mode"].enum_items
    }
    assert items["AREA_PLANE"] == Taken("only", (Setting("bpy.context.mode", ("SCULPT",)),))
    assert items["TILED"] is None
    assign = "brush.texture_slot.map_mode = 'AREA_PLANE'"
    lines = ["import bpy", "brush = bpy.data.brushes.new('b')", assign]
    lines += ["bpy.ops.object.mode_set(mode='SCULPT')", assign]
    assert [bool(error) for error, _, _ in run_statements(tmp_path, lines)] == [
        False,
        False,
        True,
        False,
        False,
    ]


def test_two_names_of_one_value_are_told_as_such(symbols: Mapping[str, Symbol]) -> None:
    for name, other in (("map_mode", "mask_map_mode"), ("mask_map_mode", "map_mode")):
        slot = symbols[f"bpy.types.BrushTextureSlot.{name}"]
        assert slot.flagged(SAME_VALUE) == (other,)
        assert default_text(slot) == "`'VIEW_PLANE'`"
    pairs = [path for path, symbol in symbols.items() if symbol.flagged(SAME_VALUE)]
    assert 4 <= len(pairs) < 20


def test_what_gave_none_for_every_index_says_so(symbols: Mapping[str, Symbol], tmp_path: Path) -> None:
    asked = (
        "GeometryNodeTrimCurve.output_template",
        "TextureNodeDistance.input_template",
        "ShaderNodeMath.input_template",
    )
    lines = ["import bpy", *(f"assert bpy.types.{name}(0) is None" for name in asked)]
    gave = [not error for error, _, _ in run_statements(tmp_path, lines)][1:]
    assert gave == [True, False, True]
    assert [GIVES_NONE in symbols[NODES + name].flags for name in asked] == gave
    assert all("classmethod" in symbols[NODES + name].flags for name in asked)


def test_what_wants_a_window_says_so(symbols: Mapping[str, Symbol], tmp_path: Path) -> None:
    calls = {
        "gpu.matrix.push": "()", "gpu.state.blend_set": "('ALPHA')", "gpu.types.GPUOffScreen": "(4, 4)",
        "gpu.capabilities.max_texture_size_get": "()", "gpu.types.GPUShaderCreateInfo": "()",
        "gpu.types.GPUStageInterfaceInfo": "('name')",
    }  # fmt: skip
    lines = ["import gpu", *(f"{path}{given}" for path, given in calls.items())]
    errors = [error for error, _, _ in run_statements(tmp_path, lines)][1:]
    told = [f"SystemError: {said}" for path in calls for said in symbols[path].flagged(WINDOWLESS) or [""]]
    assert told == [error or "SystemError: " for error in errors]
    assert [bool(error) for error in errors] == [True] * 4 + [False] * 2


def test_what_blender_starts_without_and_with_is_told(symbols: Mapping[str, Symbol]) -> None:
    of_data = "bpy.types.BlendData."
    assert EMPTY_AT_START in symbols[f"{of_data}brushes"].flags
    assert EMPTY_AT_START not in symbols[f"{of_data}materials"].flags
    assert EMPTY_AT_START in symbols["bpy.types.WindowManager.operators"].flags
    assert EMPTY_AT_START not in symbols["bpy.types.WindowManager.windows"].flags
    looped = [path for path, symbol in symbols.items() if ITERATED in symbol.flags]
    assert looped == ["bpy.types.Depsgraph.object_instances"]
    assert FILLED_AT_START in symbols["bpy.types.Object.active_material"].flags
    assert FILLED_AT_START not in symbols["bpy.types.Scene.active_clip"].flags
    settings = symbols["bpy.types.Brush.gpencil_settings"]
    assert default_text(settings).startswith(
        "`None` on a new Brush (but a new brush with mode='SCULPT_GREASE_PENCIL', "
    )


def test_sets_that_change_others_are_told_with_these(symbols: Mapping[str, Symbol], tmp_path: Path) -> None:
    base, individual = (
        symbols[f"bpy.types.ToolSettings.snap_elements_{end}"] for end in ("base", "individual")
    )
    assert "snap_elements_individual" in base.flagged(SETS_ALSO)
    assert "snap_elements_base" in individual.flagged(SETS_ALSO)
    assert {KEEPS_ITEMS} <= {*base.flags} & {*individual.flags}
    assert not symbols["bpy.types.DataTransferModifier.data_types_verts"].flags.count(KEEPS_ITEMS)
    lines = [
        "import bpy", "tool = bpy.context.scene.tool_settings", "tool.snap_elements_base = {'VERTEX'}",
        "tool.snap_elements_individual = {'FACE_NEAREST'}", "assert tool.snap_elements_base == set()",
        "tool.snap_elements_individual = set()", "assert tool.snap_elements_individual == {'FACE_NEAREST'}",
    ]  # fmt: skip
    assert not any(error for error, _, _ in run_statements(tmp_path, lines))


def test_what_new_objects_of_tracking_have_is_compared(symbols: Mapping[str, Symbol]) -> None:
    keyframes = [symbols[f"bpy.types.MovieTrackingObject.keyframe_{end}"] for end in "ab"]
    assert [usual_default(keyframe) for keyframe in keyframes] == [1, 30]


def test_descriptions_have_no_marks_of_another_markup(symbols: Mapping[str, Symbol]) -> None:
    texts = [symbol.description for symbol in symbols.values() if symbol.path.startswith("bpy.types.")]
    functions = [symbol for symbol in symbols.values() if symbol.kind == "function"]
    texts += [parameter.description for symbol in functions for parameter in symbol.parameters]
    assert [
        text for text in texts if re.search(r"(?<!`)``(?!`)", text) or re.search(r"[^.]\.\.$", text)
    ] == []


def test_a_decorator_has_the_words_of_where_it_stands(symbols: Mapping[str, Symbol]) -> None:
    persistent = symbols["bpy.app.handlers.persistent"]
    assert "not to be removed when loading new files" in persistent.description
    assert persistent.type == ""


@pytest.mark.parametrize(
    ("function", "signature"),
    [
        ("bpy.types.IDPropertyUIManager.update_from", "update_from(ui_manager_source, /)"),
        ("bpy_extras.io_utils.path_reference_copy", "path_reference_copy(copy_set, report=print)"),
        ("freestyle.utils.pairwise", "pairwise(iterable, types={Stroke, StrokeVertexIterator})"),
        ("freestyle.types.Noise.rand", ""),
    ],
)
def test_a_call_is_as_blender_takes_it_and_written_as_python(
    symbols: Mapping[str, Symbol], function: str, signature: str
) -> None:
    assert symbols[function].signature == signature


def test_every_call_of_a_function_written_in_python_can_be_read(symbols: Mapping[str, Symbol]) -> None:
    calls = {path: symbol.signature for path, symbol in symbols.items() if "(" in symbol.signature}
    assert len(calls) > 5_000
    assert not {path: call for path, call in calls.items() if "<" in call.partition("(")[2]}


@pytest.mark.parametrize(
    ("function", "argument", "taken"),
    [
        ("SpaceNodeEditor.draw_handler_add", "draw_type", "BACKDROP"),
        ("SpaceView3D.draw_handler_add", "region_type", "WINDOW"),
        ("WindowManager.draw_cursor_add", "space_type", "VIEW_3D"),
        ("BlendData.user_map", "value_types", "MESH"),
        ("BlendDataLibraries.write", "path_remap", "RELATIVE_ALL"),
        ("WindowManager.popup_menu", "icon", "ERROR"),
        ("WindowManager.popup_menu_pie", "icon", "NONE"),
    ],
)
def test_an_argument_has_the_texts_that_its_function_or_what_that_calls_takes(
    symbols: Mapping[str, Symbol], function: str, argument: str, taken: str
) -> None:
    parameter = next(one for one in symbols[f"bpy.types.{function}"].parameters if one.name == argument)
    items = [item.identifier for item in parameter.enum_items]
    assert taken in items
    assert "?" not in items
    assert len(items) == len(set(items))
