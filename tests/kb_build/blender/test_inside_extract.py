"""What the extractor gets out of the Blender of this environment."""

from __future__ import annotations

import itertools
import json
import os
import re
import subprocess
import sys
from collections import Counter
from typing import TYPE_CHECKING, Any

import pytest
from statements_in_blender import run_statements

from kb_build.blender.extractor import extract_api
from kb_build.symbols.flag_names import (
    ALSO,
    ENDS_BEFORE,
    NOT_ENOUGH,
    REFUSED_ALL,
    WITHOUT_ACTIVE,
    WITHOUT_AREA,
)
from kb_build.symbols.flags import (
    fillers,
    never_taken,
    operator_active,
    operator_also,
    operator_areas,
    refused_nothing,
    usual_default,
)
from kb_build.symbols.lines import operator_needs, poll_line, shown_when, type_text
from kb_build.symbols.records import NewValue
from simworlds.sandbox.runtime import find_runtime

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from kb_build.blender.extract_reader import Extract
    from kb_build.symbols.records import EnumItem, Symbol

pytestmark = pytest.mark.blender

MODULES = (
    "mathutils", "mathutils.bvhtree", "mathutils.geometry", "mathutils.interpolate", "mathutils.kdtree",
    "mathutils.noise", "bmesh", "bmesh.ops", "bmesh.types", "bmesh.utils", "bmesh.geometry", "gpu",
    "gpu.types", "gpu.state", "gpu.shader", "gpu.texture", "gpu_extras", "gpu_extras.batch", "bpy.app",
    "bpy.app.handlers", "bpy.app.timers", "bpy.app.translations", "bpy.props", "bpy.utils", "bpy.utils.units",
    "bpy.utils.previews", "bpy.path", "bpy.msgbus", "bpy_extras", "bpy_extras.anim_utils",
    "bpy_extras.io_utils", "bpy_extras.view3d_utils", "aud", "blf", "bl_math", "idprop", "idprop.types",
    "imbuf", "imbuf.types", "freestyle", "freestyle.types", "freestyle.functions", "freestyle.utils",
)  # fmt: skip

# Run by this interpreter: asks Blender itself for what the extract claims.
ASK_SOCKETS = """
import json, os, sys, bpy
claims, answers = json.load(open(sys.argv[1])), {}
for identifier, tree, sockets in claims:
    node = bpy.data.node_groups.new("scratch", tree).nodes.new(identifier)
    for side, key in sockets:
        try:
            answers[f"{identifier}.{side}[{key}]"] = getattr(node, side)[key].identifier
        except KeyError:
            answers[f"{identifier}.{side}[{key}]"] = None
json.dump(answers, open(sys.argv[2], "w"))
os._exit(0)
"""
ASK_PROPERTIES = """
import json, os, sys, bpy
rows = {}
for name in dir(bpy.types):
    rna = getattr(getattr(bpy.types, name), "bl_rna", None)
    if rna is not None:
        rows[name] = [prop.identifier for prop in rna.properties if prop.identifier != "rna_type"]
json.dump(rows, open(sys.argv[2], "w"))
os._exit(0)
"""


def ask_blender(script: str, folder: Path, claims: object = None) -> Any:
    """What a script prints into a file when Blender's interpreter runs it."""
    program, asked, told = folder / "ask.py", folder / "asked.json", folder / "told.json"
    program.write_text(script)
    asked.write_text(json.dumps(claims))
    words = [sys.executable, str(program), str(asked), str(told)]
    subprocess.run(words, env=os.environ | {"TMPDIR": str(folder)}, check=True, capture_output=True)
    return json.loads(told.read_text())


@pytest.fixture(scope="module")
def symbols(extract: Extract) -> dict[str, Symbol]:
    return {symbol.path: symbol for symbol in extract.symbols}


@pytest.fixture(scope="module")
def rna_classes(extract: Extract) -> dict[str, Symbol]:
    """The classes that RNA describes: those that descend from bpy_struct."""
    bases = {symbol.path: symbol.base for symbol in extract.symbols if symbol.kind == "class"}

    def root(path: str) -> str:
        return root(bases[path]) if bases.get(path) else path

    return {
        symbol.path: symbol
        for symbol in extract.symbols
        if symbol.kind == "class"
        and symbol.owner == "bpy.types"
        and root(symbol.path) == "bpy.types.bpy_struct"
        and symbol.base
    }


def lineage(path: str, symbols: Mapping[str, Symbol]) -> Iterable[Symbol]:
    while path in symbols:
        yield symbols[path]
        path = symbols[path].base


def test_every_step_ran_without_a_fault(extract: Extract) -> None:
    assert extract.faults == ()
    assert extract.version.startswith("5.")
    assert len(extract.build) == 12
    assert "cycles" in extract.addons


def test_no_class_is_missing_and_each_has_its_group(rna_classes: dict[str, Symbol]) -> None:
    groups = Counter(symbol.group for symbol in rna_classes.values())
    assert sum(groups.values()) >= 3_900
    assert groups["data"] >= 1_645
    assert groups["ui"] >= 1_972
    assert groups["operator"] >= 283


@pytest.mark.parametrize(
    ("name", "group"),
    [("Object", "data"), ("Panel", "data"), ("UILayout", "data"), ("CyclesRenderSettings", "data"),
     ("VIEW3D_MT_object", "ui"), ("OBJECT_PT_transform", "ui"), ("VIEW3D_HT_header", "ui"), ("MESH_UL_vgroups", "ui"),
     ("OBJECT_OT_select_hierarchy", "operator")],
)  # fmt: skip
def test_a_class_is_of_the_group_that_a_reader_expects(
    symbols: dict[str, Symbol], name: str, group: str
) -> None:
    assert symbols[f"bpy.types.{name}"].group == group


def test_no_property_of_a_data_type_is_missing(
    extract: Extract, rna_classes: dict[str, Symbol], tmp_path: Path
) -> None:
    """RNA's own count has ``rna_type`` on every class without a base, which says nothing and is left out."""
    data = {path for path, symbol in rna_classes.items() if symbol.group == "data"}
    own = sum(symbol.kind == "property" and symbol.owner in data for symbol in extract.symbols)
    roots = sum(rna_classes[path].base == "bpy.types.bpy_struct" for path in data)
    assert own + roots >= 10_553
    paths = {symbol.path for symbol in extract.symbols}
    bases = {path: symbol.base for path, symbol in rna_classes.items()}

    def has(cls: str, name: str) -> bool:
        return f"{cls}.{name}" in paths or (cls in bases and has(bases[cls], name))

    missing = [
        f"{cls}.{name}"
        for cls, names in ask_blender(ASK_PROPERTIES, tmp_path).items()
        for name in names
        if not has(f"bpy.types.{cls}", name)
    ]
    assert missing == []


def test_every_operator_is_there_with_its_call(extract: Extract) -> None:
    operators = [symbol for symbol in extract.symbols if symbol.kind == "operator"]
    assert len(operators) >= 2_452
    for symbol in operators:
        assert symbol.signature.startswith(f"{symbol.path}(")
        assert "_OT_" in symbol.target
        for parameter in symbol.parameters:
            assert f"{parameter.name}=" in symbol.signature or parameter.required


def test_operators_are_described_and_their_arguments_labelled(extract: Extract) -> None:
    operators = [symbol for symbol in extract.symbols if symbol.kind == "operator"]
    arguments = [parameter for symbol in operators for parameter in symbol.parameters]
    assert sum(bool(symbol.description) for symbol in operators) > 0.95 * len(operators)
    assert sum(bool(argument.label or argument.description) for argument in arguments) > 0.9 * len(arguments)


def test_items_that_blender_computes_are_listed(symbols: dict[str, Symbol]) -> None:
    parameters = {p.name: p for p in symbols["bpy.ops.object.modifier_add"].parameters}
    assert {"SUBSURF", "CLOTH", "NODES", "ARRAY"} <= {
        item.identifier for item in parameters["type"].enum_items
    }
    engines = {item.identifier for item in symbols["bpy.types.RenderSettings.engine"].enum_items}
    assert {"CYCLES", "BLENDER_WORKBENCH"} <= engines
    views = {
        item.identifier for item in symbols["bpy.types.ColorManagedViewSettings.view_transform"].enum_items
    }
    assert {"AgX", "Standard", "Filmic"} <= views


def test_values_that_blender_names_when_asked_are_known(symbols: dict[str, Symbol]) -> None:
    def asked(path: str, name: str) -> tuple[str, ...]:
        return next(p.values_asked for p in symbols[path].parameters if p.name == name)

    assert asked("bpy.ops.export_scene.gltf", "export_format") == ("GLB", "GLTF_SEPARATE")
    assert "COPY_LOCATION" in asked("bpy.ops.object.constraint_add", "type")
    assert asked("bpy.ops.object.collection_link", "collection") == ()  # the file's own
    assert asked("bpy.ops.object.modifier_add", "type") == ()  # RNA lists them


def test_a_property_carries_everything_a_coder_needs(symbols: dict[str, Symbol]) -> None:
    quality = symbols["bpy.types.ClothSettings.quality"]
    assert (quality.type, quality.default, quality.hard_min, quality.hard_max) == ("int", 5, 1, None)
    assert (quality.soft_min, quality.soft_max) == (1, 80)
    assert quality.label == "Quality"
    assert "simulation" in quality.description
    mass = symbols["bpy.types.RigidBodyObject.mass"]
    assert (mass.unit, mass.hard_max) == ("MASS", None)
    assert symbols["bpy.types.Object.location"].array == (3,)
    assert symbols["bpy.types.Object.matrix_world"].array == (4, 4)
    assert symbols["bpy.types.Object.rotation_euler"].unit == "ROTATION"
    assert "readonly" in symbols["bpy.types.Object.type"].flags
    assert [item.identifier for item in symbols["bpy.types.ParticleSettings.type"].enum_items] == [
        "EMITTER",
        "HAIR",
    ]
    assert symbols["bpy.types.Object.modifiers"].collection == "ObjectModifiers"
    assert symbols["bpy.types.ClothModifier.settings"].target == "ClothSettings"


def test_deprecations_carry_versions(extract: Extract) -> None:
    deprecated = [symbol for symbol in extract.symbols if symbol.deprecation]
    assert deprecated
    for symbol in deprecated:
        assert symbol.deprecation is not None
        assert symbol.deprecation.note
        assert symbol.deprecation.since.count(".") <= 1


def test_classes_that_hang_only_on_pointers_are_there(symbols: dict[str, Symbol]) -> None:
    cycles = [
        symbol
        for cls in lineage("bpy.types.CyclesRenderSettings", symbols)
        for symbol in symbols.values()
        if symbol.owner == cls.path and symbol.kind == "property"
    ]
    assert len({symbol.name for symbol in cycles} - {"id_data"}) + len(["rna_type"]) >= 106
    for owner, target in (
        ("Scene", "CyclesRenderSettings"), ("Object", "CyclesObjectSettings"), ("Light", "CyclesLightSettings"),
        ("Material", "CyclesMaterialSettings"), ("World", "CyclesWorldSettings"), ("Mesh", "CyclesMeshSettings"),
        ("ViewLayer", "CyclesRenderLayerSettings"),
    ):  # fmt: skip
        assert symbols[f"bpy.types.{owner}.cycles"].target == target
        assert f"bpy.types.{target}" in symbols


def test_methods_written_in_c_or_python_are_there_with_their_call(symbols: dict[str, Symbol]) -> None:
    for path, argument in (
        ("bpy_struct.keyframe_insert", "data_path"), ("bpy_struct.driver_add", "path"),
        ("bpy_struct.path_resolve", "path"), ("bpy_prop_collection.foreach_get", "attr"),
        ("bpy_prop_collection.find", "key"), ("Context.temp_override", "window"),
        ("Mesh.from_pydata", "vertices"),
    ):  # fmt: skip
        symbol = symbols[f"bpy.types.{path}"]
        assert symbol.kind == "function"
        assert argument in {parameter.name for parameter in symbol.parameters}, path
        assert symbol.signature.startswith(f"{symbol.name}(")
        assert symbol.description
    returned = symbols["bpy.types.ID.evaluated_get"].returns
    assert returned[0].type == "ID"


def test_functions_have_parameters_and_results(symbols: dict[str, Symbol]) -> None:
    ray = symbols["bpy.types.Object.ray_cast"]
    assert [p.name for p in ray.parameters][:3] == ["origin", "direction", "distance"]
    assert [p.required for p in ray.parameters][:3] == [True, True, False]
    assert [p.name for p in ray.returns] == ["result", "location", "normal", "index"]


@pytest.mark.parametrize("name", MODULES)
def test_a_module_is_there_with_its_contents(extract: Extract, symbols: dict[str, Symbol], name: str) -> None:
    assert symbols[name].kind == "module"
    assert any(symbol.owner == name for symbol in extract.symbols)


@pytest.mark.parametrize(
    "path",
    ["mathutils.Vector.lerp", "mathutils.Matrix.Rotation", "mathutils.geometry.intersect_line_plane",
     "mathutils.kdtree.KDTree.find_n", "bmesh.ops.create_cube", "bmesh.types.BMVert.co", "bmesh.types.BMesh.from_mesh",
     "gpu.types.GPUShader", "gpu.state.blend_set", "gpu_extras.batch.batch_for_shader",
     "bpy.app.handlers.frame_change_post", "bpy.app.timers.register", "bpy.app.version", "bpy.props.FloatProperty",
     "bpy.utils.register_class",
     "bpy.path.abspath", "bpy.msgbus.subscribe_rna", "bpy_extras.io_utils.ImportHelper",
     "bpy_extras.object_utils.world_to_camera_view", "aud.Sound.file", "blf.draw", "bl_math.clamp",
     "idprop.types.IDPropertyArray", "imbuf.load", "freestyle.types.Stroke",
     "freestyle.functions.DensityF1D.__call__",
     "freestyle.shaders.SmoothingShader.shade"],
)  # fmt: skip
def test_a_name_of_a_module_is_there(symbols: dict[str, Symbol], path: str) -> None:
    assert path in symbols


def test_a_struct_sequence_has_only_its_fields(symbols: dict[str, Symbol]) -> None:
    fields = {path for path in symbols if path.startswith("bpy.app.handlers.")}
    assert "bpy.app.handlers.render_post" in fields
    assert not {path for path in fields if path.endswith((".count", ".index", "_fields"))}


def test_docstrings_are_read_as_markup(symbols: dict[str, Symbol]) -> None:
    lerp = symbols["mathutils.Vector.lerp"]
    assert [parameter.name for parameter in lerp.parameters] == ["other", "factor"]
    assert lerp.returns[0].type == "Vector"
    for symbol in symbols.values():
        assert ":arg " not in symbol.description, symbol.path
        assert ".. function::" not in symbol.description, symbol.path


def test_types_are_words_and_not_memory(extract: Extract) -> None:
    assert [symbol.path for symbol in extract.symbols if "<" in symbol.type or " at 0x" in symbol.type] == []


def test_deferred_properties_of_mixins_are_read(symbols: dict[str, Symbol]) -> None:
    filepath = symbols["bpy_extras.io_utils.ImportHelper.filepath"]
    assert (filepath.type, filepath.label, filepath.subtype) == ("string", "File Path", "FILE_PATH")


def test_an_operator_without_a_description_has_none(symbols: dict[str, Symbol]) -> None:
    assert symbols["bpy.ops.render.render"].description == ""
    assert not [path for path, symbol in symbols.items() if "(undocumented operator)" in symbol.description]


def test_context_members_say_where_they_are_none(symbols: dict[str, Symbol]) -> None:
    flags = {
        name: symbols[f"bpy.context.{name}"].flags
        for name in ("object", "active_object", "space_data", "scene")
    }
    assert WITHOUT_ACTIVE in flags["object"]
    assert WITHOUT_ACTIVE in flags["active_object"]
    assert WITHOUT_AREA in flags["space_data"]
    assert not {WITHOUT_ACTIVE, WITHOUT_AREA}.intersection(flags["scene"])


def test_what_is_there_without_an_area_once_an_object_is_active_does_not_depend_on_areas(
    tmp_path: Path,
) -> None:
    assert ask_blender(ASK_SHOWN, tmp_path) == {"object": WITHOUT_ACTIVE, "edit_image": WITHOUT_AREA}


def test_members_of_the_contexts_class_are_there_in_every_editor(symbols: dict[str, Symbol]) -> None:
    """Some of them editors have as well: the video sequencer its own tool settings."""
    own = [
        symbol
        for symbol in symbols.values()
        if symbol.owner == "bpy.types.Context" and symbol.kind == "property"
    ]
    assert {"tool_settings", "scene"} <= {symbol.name for symbol in own}
    for symbol in own:
        member = symbols[f"bpy.context.{symbol.name}"]
        assert (member.same_as, member.editors, member.label) == (symbol.path, (), symbol.label)


def test_context_members_have_types(symbols: dict[str, Symbol]) -> None:
    expected = {
        "active_bone": ("pointer", "EditBone"), "selected_objects": ("collection", "Object"),
        "active_object": ("pointer", "Object"), "scene": ("pointer", "Scene"), "view_layer": ("pointer", "ViewLayer"),
        "selected_pose_bones": ("collection", "PoseBone"), "object": ("pointer", "Object"),
        "evaluated_depsgraph_get": None, "visible_objects": ("collection", "Object"), "mode": ("enum", ""),
    }  # fmt: skip
    for name, told in expected.items():
        member = symbols.get(f"bpy.context.{name}")
        if told is None:
            assert f"bpy.types.Context.{name}" in symbols
        elif name == "active_bone":
            assert member is not None
            assert member.target in {"EditBone", "Bone"}
        else:
            assert member is not None
            assert (member.type, member.target) == told


def test_templates_and_manual_links_are_extracted(extract: Extract) -> None:
    assert len(extract.templates) >= 38
    for page in extract.templates:
        assert page.slug.startswith("templates_py/")
        assert page.text.startswith(f"# {page.title}\n\n```python\n")
        assert page.text.endswith("\n```")
    manual = {link.source: link.target for link in extract.links if link.kind == "manual"}
    assert len(manual) > 15_000
    assert manual["bpy.types.ClothSettings.quality"].startswith("physics/cloth/settings/index")
    assert manual["bpy.ops.object.modifier_add"] == (
        "scene_layout/object/editing/modifiers#bpy-ops-object-modifier-add"
    )


def test_links_lead_to_symbols_that_exist(extract: Extract, symbols: dict[str, Symbol]) -> None:
    for link in extract.links:
        assert link.source in symbols
        assert link.kind == "manual" or link.target in symbols, link


@pytest.mark.parametrize(
    ("path", "parent"),
    [
        ("bpy_extras.node_shader_utils.PrincipledBSDFWrapper", "ShaderWrapper"),
        ("freestyle.types.FEdge", "Interface1D"),
        ("aud.Sequence", "Sound"),
    ],
)
def test_a_base_that_follows_its_class_in_the_alphabet_is_known(
    symbols: dict[str, Symbol], path: str, parent: str
) -> None:
    assert symbols[path].base == f"{path.rpartition('.')[0]}.{parent}"


def test_everything_has_an_owner_that_exists_and_a_path_of_its_own(extract: Extract) -> None:
    paths = [symbol.path for symbol in extract.symbols]
    assert len(paths) == len(set(paths))
    known = set(paths)
    for symbol in extract.symbols:
        assert not symbol.owner or symbol.owner in known, symbol.path
        assert not symbol.base or symbol.base in known, symbol.path
        assert symbol.kind == "enum" or symbol.path.startswith(symbol.owner), symbol.path


def test_nodes_have_their_sockets(extract: Extract, symbols: dict[str, Symbol]) -> None:
    nodes = [symbol for symbol in extract.symbols if symbol.trees]
    assert len(nodes) >= 526
    trees = Counter(tree for node in nodes for tree in node.trees)
    assert set(trees) == {"ShaderNodeTree", "GeometryNodeTree", "CompositorNodeTree", "TextureNodeTree"}
    specular = symbols['bpy.types.ShaderNodeBsdfPrincipled.inputs["Specular IOR Level"]']
    assert (specular.type, specular.default) == ("value", 0.5)
    assert (specular.soft_min, specular.soft_max) == (0, 1)
    assert "identifier:Specular IOR Level" in specular.flags


def test_sockets_list_the_modes_that_show_them(symbols: dict[str, Symbol]) -> None:
    mix = {
        symbol.flags[0]: symbol.modes
        for symbol in symbols.values()
        if symbol.owner == "bpy.types.ShaderNodeMix" and symbol.kind == "socket"
    }
    assert mix["identifier:A_Float"] == ("data_type=FLOAT",)
    assert mix["identifier:A_Color"] == ("data_type=RGBA",)
    clamped = symbols['bpy.types.ShaderNodeMath.inputs["Value_001"]']
    assert clamped.modes[0].startswith("operation=ADD|SUBTRACT|")
    assert "SQRT" not in clamped.modes[0].split("|")


def test_passes_have_sockets_while_their_settings_are_on(symbols: dict[str, Symbol]) -> None:
    outputs = {
        symbol.label: symbol
        for symbol in symbols.values()
        if symbol.owner == "bpy.types.CompositorNodeRLayers" and symbol.kind == "socket"
    }
    assert shown_when(outputs["Image"]) == ""
    assert shown_when(outputs["Depth"]) == "view_layer.use_pass_z=True"
    assert outputs["Depth"].subscripts == ('outputs["Depth"]',)
    assert shown_when(outputs["UV"]) == "view_layer.use_pass_uv=True and scene.render.engine=CYCLES"
    settings = [re.match(r"view_layer\.(?:\w+\.)?(\w+)=", shown_when(symbol)) for symbol in outputs.values()]
    assert len({match[1] for match in settings if match}) > 25


def test_sockets_say_what_decides_their_type_and_their_names(symbols: dict[str, Symbol]) -> None:
    switch = symbols['bpy.types.GeometryNodeSwitch.inputs["True"]']
    assert switch.type_settings == ("input_type",)
    assert symbols['bpy.types.GeometryNodeSwitch.inputs["Switch"]'].type_settings == ()
    assert symbols['bpy.types.ShaderNodeMix.inputs["A"]'].type_settings == ()
    assert type_text(switch) == "value, or as input_type says"
    first = symbols['bpy.types.GeometryNodeMeshBoolean.inputs["Mesh 2"]']
    assert first.socket_names == ("Mesh 2", "Mesh")
    assert 'inputs["Mesh"]' not in first.subscripts


def test_subscripts_are_python_that_finds_the_socket(extract: Extract, tmp_path: Path) -> None:
    """``node.inputs["X"]``, evaluated by Blender, is the socket that the extract lists the subscript for."""
    trees = {symbol.path: symbol.trees[0] for symbol in extract.symbols if symbol.trees}
    expected: dict[str, str] = {}
    claims: dict[str, tuple[str, str, list[tuple[str, str | int]]]] = {}
    for symbol in extract.symbols:
        in_zone = symbol.owner.endswith(("Input", "Output"))  # their sockets depend on pairs and trees
        if symbol.kind == "socket" and not in_zone and "hidden-by-default" not in symbol.flags:
            identifier = symbol.owner.removeprefix("bpy.types.")
            side = symbol.path[len(symbol.owner) + 1 :].partition("[")[0]
            row = claims.setdefault(symbol.owner, (identifier, trees[symbol.owner], []))
            for subscript in symbol.subscripts:
                key = json.loads(subscript[len(side) + 1 : -1])
                row[2].append((side, key))
                expected[f"{identifier}.{side}[{key}]"] = symbol.flags[0].removeprefix("identifier:")
    answers = ask_blender(ASK_SOCKETS, tmp_path, list(claims.values()))
    assert len(answers) > 3_000
    assert {name: answer for name, answer in answers.items() if answer != expected[name]} == {}


def test_an_ambiguous_name_is_told_apart_by_place(symbols: dict[str, Symbol]) -> None:
    color = symbols['bpy.types.ShaderNodeMix.inputs["A_Color"]']
    assert color.subscripts == ("inputs[6]",)
    assert {"name-when-shown", "hidden-by-default"} <= set(color.flags)
    rotation = symbols['bpy.types.ShaderNodeMix.inputs["A_Rotation"]']
    assert rotation.modes == ("data_type=ROTATION",)  # which only geometry nodes have
    steps = symbols['bpy.types.ShaderNodeMapRange.inputs["Steps_FLOAT3"]']
    assert steps.modes == ("interpolation_type=STEPPED", "data_type=FLOAT_VECTOR")
    factor = symbols['bpy.types.ShaderNodeMixRGB.inputs["Factor"]']
    assert factor.subscripts == ('inputs["Factor"]', 'inputs["Fac"]', "inputs[0]")


def test_former_names_of_sockets_and_nodes_are_tried(extract: Extract) -> None:
    works = dict(extract.still_works)
    noise = "bpy.types.ShaderNodeTexNoise.outputs"
    assert works[f'{noise}["Fac"]'] == f'{noise}["Factor"]'
    assert works["bpy.types.ShaderNodeBsdfGlossy"] == "bpy.types.ShaderNodeBsdfAnisotropic"
    assert 'bpy.types.ShaderNodeBsdfPrincipled.inputs["Specular"]' not in works
    known = {symbol.path for symbol in extract.symbols}
    assert not works.keys() & known
    assert known >= set(works.values())


@pytest.mark.parametrize(
    ("path", "default", "new"),
    [
        ("ClothCollisionSettings.damping", 1, 0),
        ("ShaderNodeTexNoise.noise_dimensions", "1D", "3D"),
        ("ShaderNodeBsdfPrincipled.distribution", "GGX", "MULTI_GGX"),
        ("SoftBodySettings.mass", 0, 1),
        ("CollisionSettings.thickness_outer", 0, 0.02),
        ("ChildOfConstraint.use_location_x", False, True),
        ("PointCache.frame_end", 0, 250),
        ("EffectorWeights.gravity", 0, 1),
        ("Keyframe.interpolation", "CONSTANT", "BEZIER"),
        ("RigidBodyObject.collision_shape", "BOX", "CONVEX_HULL"),
        ("Modifier.show_viewport", False, True),
        ("RigidBodyConstraint.type", "POINT", "FIXED"),
        ("Driver.type", "AVERAGE", "SCRIPTED"),
        ("Material.roughness", 0.4, 0.4),
    ],
)
def test_new_things_tell_what_rna_does_not(
    symbols: dict[str, Symbol], path: str, default: object, new: object
) -> None:
    symbol = symbols[f"bpy.types.{path}"]
    assert (symbol.default, usual_default(symbol)) == (default, new)


def test_what_blender_starts_with_is_not_called_new(symbols: dict[str, Symbol]) -> None:
    new, started = symbols["bpy.types.Material.roughness"].new_values
    assert (new.value, new.by, new.is_startup) == (0.4, 'bpy.data.materials.new("Material")', False)
    assert (started.value, started.is_startup) == (0.5, True)
    settings = symbols["bpy.types.RenderSettings.use_stamp_memory"].new_values
    assert [(one.value, one.by) for one in settings] == [(True, 'bpy.data.scenes.new("Scene")'), (False, "")]


@pytest.mark.parametrize(
    "path",
    [
        "Object.matrix_world", "PoseBone.matrix", "EditBone.tail", "NlaStrip.frame_start", "NodeSocket.type",
        "NodeSocketColor.default_value",
    ],
)  # fmt: skip
def test_what_blender_computes_has_no_default(symbols: dict[str, Symbol], path: str) -> None:
    assert usual_default(symbols[f"bpy.types.{path}"]) is None


def test_ways_and_modes_of_making_are_told_apart(symbols: dict[str, Symbol]) -> None:
    energy = symbols["bpy.types.SunLight.energy"].new_values
    assert [new.value for new in energy] == [10, 1]
    assert energy[1].made == ("sun light by object.light_add(type='SUN')",)
    border = symbols["bpy.types.FluidDomainSettings.use_collision_border_back"]
    assert [(new.value, new.when) for new in border.new_values] == [(True, "domain_type='LIQUID'")]
    codec = symbols["bpy.types.FFmpegSettings.codec"].new_values
    assert [(new.value, new.when) for new in codec] == [
        ("NONE", ""),
        ("H264", "ImageFormatSettings.media_type='VIDEO'"),
    ]
    brush = symbols["bpy.types.Brush.use_paint_image"].new_values
    assert [new.value for new in brush] == [True, False]
    assert all("mode=" in label for label in brush[1].made)


def test_one_call_makes_one_value(symbols: dict[str, Symbol]) -> None:
    for path, symbol in symbols.items():
        calls = [(new.by, new.when) for new in symbol.new_values if new.by]
        assert len(set(calls)) == len(calls), path


def test_what_a_mode_gives_to_some_is_not_told_of_what_began_in_it(symbols: dict[str, Symbol]) -> None:
    """A scene's images are of 8 bit, and those of a File Output node that is switched to images of 16."""
    depths = symbols["bpy.types.ImageFormatSettings.color_depth"].new_values
    assert [(new.value, new.made) for new in depths if new.when == "media_type='IMAGE'"] == [
        ("16", ("CompositorNodeOutputFile",))
    ]


@pytest.mark.parametrize(
    ("path", "calls"),
    [
        ("Object.field", ["bpy.ops.object.forcefield_toggle()"]),
        ("Object.collision", ["obj.modifiers.new(\"name\", 'COLLISION')"]),
        ("Object.soft_body", ["obj.modifiers.new(\"name\", 'SOFT_BODY')"]),
        ("Object.rigid_body", ["bpy.ops.rigidbody.object_add()"]),
        (
            "Object.rigid_body_constraint",
            ["bpy.ops.rigidbody.world_add()", "bpy.ops.rigidbody.constraint_add()"],
        ),
        ("Scene.rigidbody_world", ["bpy.ops.rigidbody.world_add()"]),
        ("Scene.sequence_editor", ["scene.sequence_editor_create()"]),
        ("Mesh.shape_keys", ["obj.shape_key_add()"]),
        ("Material.animation_data", ["material.animation_data_create()"]),
        ("FluidModifier.domain_settings", ["fluid_modifier.fluid_type = 'DOMAIN'"]),
        ("DynamicPaintModifier.brush_settings", ["bpy.ops.dpaint.type_toggle(type='BRUSH')"]),
        ("ParticleSettings.boids", ["particle_settings.physics_type = 'BOIDS'"]),
        ("Texture.color_ramp", ["texture.use_color_ramp = True"]),
        ("ParticleSystem.cloth", ["particle_system.use_hair_dynamics = True"]),
        ("Scene.compositing_node_group", []),
        ("Object.parent", []),
    ],
)
def test_pointers_that_are_none_on_new_things_say_what_fills_them(
    symbols: dict[str, Symbol], path: str, calls: list[str]
) -> None:
    symbol = symbols[f"bpy.types.{path}"]
    assert symbol.new_values == (NewValue(None),)
    assert fillers(symbol) == calls


def test_pointers_that_lead_to_something_are_not_called_none(symbols: dict[str, Symbol]) -> None:
    for path in ("Material.node_tree", "Scene.render", "ParticleSystem.settings"):
        assert "compared" in symbols[f"bpy.types.{path}"].flags
        assert symbols[f"bpy.types.{path}"].new_values == ()
    data = symbols["bpy.types.Object.data"].new_values[0]
    assert (data.value, "empty object" in data.made, "mesh object" in data.made) == (None, True, False)


def where_taken(items: Iterable[EnumItem]) -> dict[str, str]:
    return {item.identifier: item.where.text if item.where else "" for item in items}


@pytest.mark.parametrize(
    ("path", "where"),
    [
        (
            "FluidFlowSettings.flow_source",
            {"MESH": "", "PARTICLES": "not with flow_type='LIQUID'"},
        ),
        (
            "UnitSettings.length_unit",
            {"ADAPTIVE": "", "METERS": "only with system='METRIC'", "FEET": "only with system='IMPERIAL'"},
        ),
        (
            "ColorManagedViewSettings.look",
            {"None": "", "AgX - Punchy": "only with view_transform='AgX'"},
        ),
    ],
)
def test_items_say_where_they_are_taken(symbols: dict[str, Symbol], path: str, where: dict[str, str]) -> None:
    items = where_taken(symbols[f"bpy.types.{path}"].enum_items)
    assert {name: items.get(name) for name in where} == where


# Run by this interpreter: whether a scene takes a value once its other settings, by their classes, have theirs.
ASK_ITEMS = """
import json, os, sys, bpy
claims, answers = json.load(open(sys.argv[1])), []
for path, value, others in claims:
    scene = bpy.data.scenes.new("scratch")
    owners = {"FFmpegSettings": scene.render.ffmpeg, "ImageFormatSettings": scene.render.image_settings,
              "ColorManagedDisplaySettings": scene.display_settings, "ColorManagedViewSettings": scene.view_settings}
    for setting, other in others:
        owner, name = setting.split(".")
        setattr(owners[owner], name, other)
    owner, name = path.split(".")
    try:
        setattr(owners[owner], name, value)
        answers.append(True)
    except TypeError:
        answers.append(False)
json.dump(answers, open(sys.argv[2], "w"))
os._exit(0)
"""
VIDEO = ["ImageFormatSettings.media_type", "VIDEO"]
CODEC, DEVICE = "FFmpegSettings.codec", "ColorManagedDisplaySettings.display_device"


@pytest.mark.parametrize(
    ("path", "item", "setting", "states"),
    [
        ("ImageFormatSettings.color_depth", "10", CODEC, [VIDEO]),
        ("ImageFormatSettings.color_depth", "16", CODEC, [VIDEO]),
        ("ColorManagedViewSettings.view_transform", "Filmic", DEVICE, []),
        ("ColorManagedViewSettings.view_transform", "AgX - HDR 1000 nits", DEVICE, []),
    ],
)
def test_items_that_depend_on_a_neighbour_name_the_values_that_blender_takes_them_with(
    symbols: dict[str, Symbol], tmp_path: Path, path: str, item: str, setting: str, states: list[list[str]]
) -> None:
    where = next(row.where for row in symbols[f"bpy.types.{path}"].enum_items if row.identifier == item)
    assert where
    named = [*where.settings, *([where.beside.needed] if where.beside else ())]
    told = [value for each in named if each.name == setting for value in each.values]
    values = [row.identifier for row in symbols[f"bpy.types.{setting}"].enum_items]
    claims = [(path, item, [*states, [setting, value]]) for value in values]
    answers = zip(values, ask_blender(ASK_ITEMS, tmp_path, claims), strict=True)
    assert told
    assert set(told) == {value for value, taken in answers if taken}


def test_a_second_setting_of_a_neighbour_is_told_where_it_matters(symbols: dict[str, Symbol]) -> None:
    items = where_taken(symbols["bpy.types.ImageFormatSettings.color_mode"].enum_items)
    assert "'PRORES' (with ffmpeg_prores_profile='4444'|'4444_XQ')" in items["RGBA"]
    assert items["RGB"] == ""


# Run by this interpreter: whether operators can run with an empty scene, with an object, and after something else.
ASK_POLLS = """
import json, os, sys, bpy
claims, answers = json.load(open(sys.argv[1])), []

def make():
    obj = bpy.data.objects.new("asked", bpy.data.meshes.new("asked"))
    obj.data.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    return obj

def asked(paths):
    found = []
    for path in paths:
        module, name = path.split(".")[2:]
        try:
            found.append(getattr(getattr(bpy.ops, module), name).poll())
        except Exception:
            found.append(False)
    return found

for code, paths in claims:
    scene = bpy.context.window.scene = bpy.data.scenes.new("asked")
    bpy.context.workspace.sequencer_scene = None
    empty = asked(paths)
    obj = make()
    before = asked(paths)
    material = bpy.data.materials.new("asked")
    exec(code)
    answers.append([empty, before, asked(paths)])
    if bpy.context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
json.dump(answers, open(sys.argv[2], "w"))
os._exit(0)
"""
ASK_NEEDS = """
import json, os, sys
from kb_build.blender.inside.apart import Beside
from kb_build.blender.inside.instances.observer import Observer
from kb_build.blender.inside.preconditions import operator_needs
from kb_build.blender.inside.wire import Writer
with open(sys.argv[2], "w") as file:
    operator_needs.find_all(Writer(file), Observer(), [], Beside("needs", lambda _write: os.abort()))
with open(sys.argv[2]) as file:
    rows = [json.loads(line) for line in file]
told = {row["path"]: row.get("needs") or row.get("areas") for row in rows if "path" in row}
json.dump(told, open(sys.argv[2], "w"))
os._exit(0)
"""
# An editor still shows an object that is active no more; the image of its space is there in an area alone.
ASK_SHOWN = """
import json, os, sys
from kb_build.blender.inside.classes import context
asked = context.ask_editors
def ask_editors(names, found):
    for name in ("object", "edit_image"):
        found.setdefault(name, ("pointer", "ID"))
    asked(names, found)
context.ask_editors = ask_editors
json.dump(context.probe(("object", "edit_image"))[1], open(sys.argv[2], "w"))
os._exit(0)
"""
# Run by this interpreter: whether operators can run in areas of types, with an object in a mode, and after statements.
ASK_AREAS = """
import json, os, sys, wave, bpy
claims, answers = json.load(open(sys.argv[1])), []
folder = os.path.dirname(sys.argv[2])
names = {"bpy": bpy, "image_path": os.path.join(folder, "a.png"), "sound_path": os.path.join(folder, "a.wav")}
image = bpy.data.images.new("asked", 8, 8)
image.filepath_raw, image.file_format = names["image_path"], "PNG"
image.save()
with wave.open(names["sound_path"], "wb") as sound:
    sound.setparams((1, 2, 8000, 0, "NONE", ""))
    sound.writeframes(bytes(16000))
window = bpy.context.window
area = names["area"] = window.screen.areas[0]

for kind, mode, types, statements, paths in claims:
    missing = []
    for area_type in types:
        names["scene"] = window.scene = bpy.data.scenes.new("asked")
        bpy.context.workspace.sequencer_scene = None
        if kind:
            if kind == "MESH":
                bpy.ops.mesh.primitive_plane_add()
            else:
                bpy.ops.object.add(type=kind)
            names["obj"] = bpy.context.object
            if kind == "CURVE":
                names["obj"].data.dimensions = "3D"
        of_area = next((at for at, text in enumerate(statements) if "area." in text), len(statements))
        for text in statements[:of_area]:
            exec(text, names)
        if mode:
            bpy.ops.object.mode_set(mode=mode)
        area.type = "CONSOLE" if area_type == "INFO" else "INFO"  # a new space
        if area_type != "no area":
            area.type = area_type
        for text in statements[of_area:]:
            exec(text, names)
        region = next(region for region in area.regions if region.type == "WINDOW")
        given = {"area": None, "region": None} if area_type == "no area" else {"area": area, "region": region}
        with bpy.context.temp_override(window=window, screen=window.screen, **given):
            for path in paths:
                module, name = path.split(".")[2:]
                if not getattr(getattr(bpy.ops, module), name).poll():
                    missing.append([path, area_type])
        if bpy.context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
    answers.append(missing)
json.dump(answers, open(sys.argv[2], "w"))
os._exit(0)
"""
TEXT = '`area.spaces.active.text = bpy.data.texts.new("name")`'
UVS = "an active object in mode 'EDIT', with `obj.data.uv_layers.new()`"
HAIR = "obj.modifiers.new(\"name\", 'PARTICLE_SYSTEM').particle_system.settings.type = 'HAIR'"
IN_EDIT_MODE = "bpy.ops.object.mode_set(mode='EDIT')"
OBJECT, EDIT = "an active object", "an active object of type 'MESH' in mode 'EDIT'"
OBJECT_MODE = "any active object or none in mode 'OBJECT'"
ADDS = re.compile(r"an active object(?: in mode '(?P<mode>EDIT)')? with what (?P<calls>.*) adds")


@pytest.fixture(scope="module")
def by_needs(extract: Extract) -> dict[str, list[str]]:
    """What operators want → their paths."""
    found: dict[str, list[str]] = {}
    for symbol in extract.symbols:
        if symbol.kind == "operator" and (needs := operator_needs(symbol)):
            found.setdefault(needs, []).append(symbol.path)
    return found


def test_operators_can_run_with_what_they_are_said_to_want(
    by_needs: dict[str, list[str]], tmp_path: Path
) -> None:
    added = {
        needs: "\n".join(
            [
                *match["calls"].replace("`", "").split(", then "),
                *([IN_EDIT_MODE] if match["mode"] else []),
            ]
        )
        for needs in by_needs
        if (match := ADDS.fullmatch(needs))
    }
    codes = {OBJECT: "", EDIT: IN_EDIT_MODE, **added}
    answers = ask_blender(ASK_POLLS, tmp_path, [(code, by_needs[needs]) for needs, code in codes.items()])
    assert len(added) > 6
    for needs, (empty, before, after) in zip(codes, answers, strict=True):
        assert not any(empty), needs
        assert all(before) if needs == OBJECT else not any(before), needs
        assert all(after), needs


def test_operators_that_want_no_object_refuse_only_the_modes_that_they_are_said_to(
    symbols: dict[str, Symbol], by_needs: dict[str, list[str]], tmp_path: Path
) -> None:
    free = [path for path, symbol in symbols.items() if refused_nothing(symbol)]
    of_object_mode, of_any = ask_blender(
        ASK_POLLS, tmp_path, [(IN_EDIT_MODE, by_needs[OBJECT_MODE]), (IN_EDIT_MODE, free)]
    )
    assert (len(by_needs[OBJECT_MODE]) > 50, len(free) > 300) == (True, True)
    assert (all(of_object_mode[0]), all(of_object_mode[1]), any(of_object_mode[2])) == (True, True, False)
    assert all(map(all, of_any))


@pytest.mark.parametrize(
    ("operator", "needs"),
    [
        ("fluid.bake_all", OBJECT),
        ("object.duplicate", OBJECT_MODE),
        (
            "object.shade_smooth",
            "any active object or none, not in mode 'EDIT'|'SCULPT', and only some types in mode 'OBJECT'",
        ),
        ("wm.append", "any active object or none, not in mode 'EDIT'"),
        (
            "sequencer.delete",
            "what `scene.sequence_editor_create()`, then `bpy.context.workspace.sequencer_scene = scene` adds",
        ),
        (
            "sequencer.effect_strip_add",
            "an area of type SEQUENCE_EDITOR, with `bpy.context.workspace.sequencer_scene = scene`",
        ),
        ("rigidbody.object_add", "an active object of type 'MESH'"),
        ("pose.transforms_clear", "an active object of type 'ARMATURE' in mode 'POSE'"),
        ("object.shape_key_add", "an active object, not of type 'EMPTY', not in mode 'EDIT'"),
        ("object.vertex_group_remove", "an active object with what `obj.vertex_groups.new()` adds"),
        ("rigidbody.connect", "an active object with what `bpy.ops.rigidbody.object_add()` adds"),
        ("uv.pack_islands", "an active object in mode 'EDIT' with what `obj.data.uv_layers.new()` adds"),
        # Vertex Paint Mode leaves one on a new object, too.
        ("geometry.color_attribute_remove", "an active object with what `obj.data.vertex_colors.new()` adds"),
        ("mesh.primitive_cube_add", ""),  # it runs in an empty scene
        ("view3d.view_selected", "an area of type VIEW_3D"),
        ("anim.keyframe_insert", "an area of any type"),
        (
            "graph.clean",
            "an area of type DOPESHEET_EDITOR or GRAPH_EDITOR and an active and selected object, with "
            '`obj.keyframe_insert("location")`',
        ),
        (
            "text.copy",
            "`edit_text` in the context (`temp_override(edit_text=…)`), or an area of type TEXT_EDITOR, with "
            + TEXT,
        ),
        # With a text alone it ends Blender.
        ("text.select_all", f"an area of type TEXT_EDITOR, with {TEXT}"),
        ("text.start_find", "an area of type TEXT_EDITOR"),
        ("mesh.knife_tool", "an area of type VIEW_3D and an active object of type 'MESH' in mode 'EDIT'"),
        ("uv.select_box", f"an area of type IMAGE_EDITOR and {UVS}, then `area.ui_type = 'UV'`"),
        ("particle.select_all", f"an active object in mode 'PARTICLE_EDIT' with what `{HAIR}` sets"),
        (
            "paint.face_select_more",
            "an active object in mode 'VERTEX_PAINT'|'WEIGHT_PAINT'|'TEXTURE_PAINT' with what "
            "`obj.data.use_paint_mask = True` sets",
        ),
        (
            "grease_pencil.layer_remove",
            "an active object of type 'GREASEPENCIL' with what `obj.data.layers.new(\"name\")` adds",
        ),
        ("scene.delete", 'what `bpy.data.scenes.new("name")` adds'),
        ("ptcache.bake", "`point_cache` in the context (`temp_override(point_cache=…)`)"),
        ("anim.clear_useless_actions", ""),  # which wants what no object has
    ],
)
def test_an_operator_says_what_it_wants(symbols: dict[str, Symbol], operator: str, needs: str) -> None:
    assert operator_needs(symbols[f"bpy.ops.{operator}"]) == needs


def kind_and_mode(operator: Symbol) -> tuple[str, str]:
    """The first type and mode of an active object that an operator is said to want; empty for none."""
    wants_active = operator.needs is not None and operator.needs.active in {"active", "selected"}
    types, modes = operator_active(operator)
    kind = "MESH" if types is None or types.takes("MESH") else types.names[0]
    tried = ("OBJECT", "EDIT", *modes.names) if modes else ()
    mode = next((mode for mode in tried if modes and modes.takes(mode)), "")
    return (kind if wants_active else ""), mode


def test_what_operators_are_said_to_want_in_areas_is_enough(
    symbols: dict[str, Symbol], tmp_path: Path
) -> None:
    groups: dict[tuple[object, ...], list[str]] = {}
    for path, symbol in symbols.items():
        types = operator_areas(symbol)
        if not types or types == ("any",) or ALSO + NOT_ENOUGH in symbol.flags:
            continue
        said = (*kind_and_mode(symbol), types, operator_also(symbol))
        groups.setdefault(said, []).append(path)
    answers = ask_blender(ASK_AREAS, tmp_path, [[*said, paths] for said, paths in groups.items()])
    assert sum(map(len, groups.values())) > 600
    assert [missing for missing in answers if missing] == []


def test_areas_of_any_type_are_those_of_all(symbols: dict[str, Symbol], tmp_path: Path) -> None:
    anywhere = [path for path, symbol in symbols.items() if operator_areas(symbol) == ("any",)]
    types = sorted({kind for symbol in symbols.values() for kind in operator_areas(symbol)} - {"any"})
    free = [path for path in anywhere if symbols[path].needs is None]
    ((*missing,),) = ask_blender(ASK_AREAS, tmp_path, [["", "", types, [], free]])
    assert (len(types) > 12, len(free) > 20, missing) == (True, True, [])


def test_operators_that_took_nothing_refuse_scenes_and_areas(
    symbols: dict[str, Symbol], tmp_path: Path
) -> None:
    refused = [path for path, symbol in symbols.items() if REFUSED_ALL in symbol.flags]
    types = sorted({kind for symbol in symbols.values() for kind in operator_areas(symbol)} - {"any"})
    claims = [[kind, "", ["no area", *types], [], refused] for kind in ("", "MESH", "ARMATURE")]
    refusing = {tuple(row) for row in itertools.product(refused, ("no area", *types))}
    for missing in ask_blender(ASK_AREAS, tmp_path, claims):
        assert sorted(refusing - {tuple(row) for row in missing}) == []
    assert len(refused) > 100


def test_nothing_is_said_only_of_operators_that_refused_nothing(symbols: dict[str, Symbol]) -> None:
    silent = [symbol for symbol in symbols.values() if symbol.kind == "operator" and not poll_line(symbol)]
    assert len(silent) > 300
    assert [symbol.path for symbol in silent if not refused_nothing(symbol)] == []


def test_operators_are_asked_here_where_asking_them_beside_ended_blender(
    extract: Extract, tmp_path: Path
) -> None:
    told = ask_blender(ASK_NEEDS, tmp_path)
    of_extract = {symbol.path: symbol for symbol in extract.symbols if symbol.kind == "operator"}
    assert len(told) > 1_500
    assert told.keys() <= of_extract.keys()
    for path in ("object.duplicate", "object.vertex_group_remove", "view3d.view_selected"):
        assert told[f"bpy.ops.{path}"]


def test_a_choice_that_depends_on_the_instance_is_asked_of_instances(symbols: dict[str, Symbol]) -> None:
    new_socket = symbols["bpy.types.NodeTreeInterface.new_socket"]
    assert (
        new_socket.signature
        == "new_socket(name, *, description='', in_out='INPUT', socket_type=..., parent=None)"
    )
    (kind,) = [parameter for parameter in new_socket.parameters if parameter.name == "socket_type"]
    assert (kind.required, kind.default, kind.is_open) == (False, None, True)
    items = where_taken(kind.enum_items)
    assert items["NodeSocketColor"] == ""
    assert items["NodeSocketShader"] == "only by shader node tree"
    assert items["NodeSocketMenu"] == "not by texture node tree"
    assert "DEFAULT" not in items  # which RNA lists, and no tree takes


def test_names_that_the_maker_gives_and_times_are_not_defaults(symbols: dict[str, Symbol]) -> None:
    for path in ("FieldSettings.seed", "Light.type", "ActionSlot.name_display", "NlaStrip.frame_end"):
        assert "compared" not in symbols[f"bpy.types.{path}"].flags


@pytest.mark.whole
def test_a_blender_that_has_moved_is_asked_again_and_tells_another_user_the_same_bytes(
    base: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Without what Blender keeps there of its asset libraries.
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    runtime = find_runtime(None, home=tmp_path)
    first = next((base.parent.parent / "extracts").glob("*.jsonl"))
    kept = tmp_path / "extracts" / first.name
    kept.parent.mkdir()
    moved = first.read_text(encoding="utf-8").replace('"scripts":"', '"scripts":"/moved', 1)
    kept.write_text(moved, encoding="utf-8")
    assert extract_api(runtime, home=tmp_path) == kept
    theirs, ours = (path.read_text(encoding="utf-8").splitlines() for path in (kept, first))
    # Told by the lines that are of one only: pytest's own comparison of the two takes minutes where they differ.
    assert sorted({*theirs} ^ {*ours})[:10] == []
    is_same = kept.read_bytes() == first.read_bytes()
    assert is_same
    assert not [line for line in ours if " at 0x" in line]
    before = kept.stat().st_mtime_ns
    assert extract_api(runtime, home=tmp_path).stat().st_mtime_ns == before


def test_a_thing_is_as_it_was_after_edit_mode_was_tried(tmp_path: Path) -> None:
    lines = [
        "import bpy",
        "from kb_build.blender.inside.tried.refusals import is_taken_in_edit_mode",
        "curve = bpy.data.curves.new('curve', 'CURVE')",
        "spline = curve.splines.new('POLY')",
        "add = spline.bezier_points.bl_rna.functions['add']",
        "taken = is_taken_in_edit_mode(spline, spline.bezier_points, add, {'count': 1})",
    ]
    answers = run_statements(tmp_path, lines, {5: "[curve.splines[0] == spline, len(bpy.data.objects)]"})
    assert not any(error for error, _, _ in answers), answers
    assert answers[-1][1] == answers[-1][2]


@pytest.mark.parametrize(
    "operator", ["sculpt.face_sets_create", "paint.mask_flood_fill", "sculpt.dynamic_topology_toggle"]
)
def test_what_ends_blender_without_an_undo_step_is_known(symbols: dict[str, Symbol], operator: str) -> None:
    lines = ["import bpy", "bpy.ops.object.mode_set(mode='SCULPT')", f"bpy.ops.{operator}()"]
    ended = subprocess.run([sys.executable, "-c", "\n".join(lines)], capture_output=True, check=False)
    lines.insert(1, "bpy.ops.ed.undo_push()")
    subprocess.run([sys.executable, "-c", "\n".join(lines)], capture_output=True, check=True)
    known = symbols[f"bpy.ops.{operator}"].flagged(ENDS_BEFORE)
    assert known == (("bpy.ops.ed.undo_push()",) if ended.returncode < 0 else ())


def test_what_python_code_returns_has_the_type_of_its_elements(symbols: dict[str, Symbol]) -> None:
    module = "_bpy_internal.grease_pencil.stroke"
    slices = f"{module}.GreasePencilStrokeSlice[{module}.GreasePencilStroke]"
    assert symbols["bpy.types.GreasePencilDrawing.strokes"].type == slices
    assert f"{module}.GreasePencilStrokePoint.radius" in symbols
    assert symbols["bpy.types.Object.children_recursive"].type in {
        "",
        "list[Object]",
        "list[bpy.types.Object]",
    }


@pytest.mark.parametrize(
    ("items", "taken"),
    [
        ("NodeCompositorFileOutputItems", {"FLOAT", "VECTOR", "RGBA"}),
        (
            "NodeGeometryCaptureAttributeItems",
            {"BOOLEAN", "FLOAT", "INT", "VECTOR", "RGBA", "ROTATION", "MATRIX"},
        ),
    ],
)
def test_items_of_nodes_take_only_some_of_the_types_that_rna_lists(
    symbols: dict[str, Symbol], items: str, taken: set[str]
) -> None:
    new = symbols[f"bpy.types.{items}.new"]
    (kind,) = [parameter for parameter in new.parameters if parameter.name == "socket_type"]
    listed = {item.identifier for item in kind.enum_items}
    assert listed - never_taken(new, "socket_type") == taken < listed


def test_a_class_that_only_a_method_returns_has_its_methods(symbols: dict[str, Symbol]) -> None:
    (returned,) = symbols["bpy.types.bpy_struct.id_properties_ui"].returns
    update = symbols[f"{returned.type}.update"]
    assert {"min", "max", "soft_min", "soft_max", "description"} <= {one.name for one in update.parameters}
