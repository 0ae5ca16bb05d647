"""The table of successors agrees with the history, and what follows from it is right in each version."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

from kb_build.errors import StoreError
from kb_build.symbols.paths import joined_path, split_path
from kb_build.versions.history import ApiHistory, is_module
from kb_build.versions.successors import Succession, Successors, load_successors
from simworlds.releases import version_key

if TYPE_CHECKING:
    from pathlib import Path

    from kb_build.blender.extract_reader import Extract

# Names that no version's listing has, as those of add-ons that were switched off (see OF_ADD_ONS).
UNLISTED = (
    "bgl.gl",
    "bpy_extras.",
    "rna_prop_ui.",
    "gpu.shader.from_builtin(",
    'bpy.types.CompositorNodeRLayers.outputs["Volume',
    'bpy.types.CompositorNodeRLayers.outputs["GreasePencil',
)
OF_ADD_ONS = "Add-ons"  # the part of the release notes that a row is from
OF_MODULES = "modules that Blender 5.0 brings"  # the source of what its internal modules were called


@pytest.fixture(scope="module")
def history() -> ApiHistory:
    return ApiHistory.load()


@pytest.fixture(scope="module")
def table() -> list[Succession]:
    return load_successors()


def test_every_old_name_went_in_its_version(history: ApiHistory, table: list[Succession]) -> None:
    before = dict(pairwise(reversed(history.versions)))
    wrong = [
        row.old
        for row in table
        if "*" not in row.old
        and not (is_module(row.old) and not history.mask(row.old))
        and (history.mask(row.old) or not (row.old.startswith(UNLISTED) or row.source.endswith(OF_ADD_ONS)))
        and (history.exists(row.old, before[row.version]) is False or history.exists(row.old, row.version))
    ]
    assert len(table) > 1500
    assert wrong == []


def test_an_unknown_release_is_named_with_those_that_are_known(
    history: ApiHistory, table: list[Succession]
) -> None:
    successors = Successors(table, history, "5.1", {})
    assert successors.before("2.80") == "2.79"
    with pytest.raises(StoreError, match=r"Blender 2\.81\.5, which .* 2\.80, 2\.81.*successors\.csv"):
        successors.before("2.81.5")


@pytest.mark.parametrize(
    ("later", "here"),
    [
        ("bpy.types.TextStrip", "bpy.types.TextSequence"),
        ("bpy.types.TextStrip.font_size", "bpy.types.TextSequence.font_size"),
        ("bpy.types.Strip.channel", "bpy.types.Sequence.channel"),
        # Not only renamed, and in no other version.
        ("bpy.types.ActionSlot", ""),
        ("bpy.types.NoSuch", ""),
    ],
)
def test_a_name_of_later_versions_has_the_one_that_it_took_the_place_of(
    history: ApiHistory, table: list[Succession], later: str, here: str
) -> None:
    found = Successors(table, history, "4.2", {}).of(later)
    assert [target for row in found for target in row.new] == ([here] if here else [])
    assert not here or not Successors(table, history, "5.1", {}).of(later)


@pytest.mark.parametrize(
    ("later", "version", "here"),
    [
        # Of those that it took the place of, the ones that went when it came, and not a node's of long before.
        ("bpy.types.NodeTree.interface", "3.4", ["bpy.types.NodeTree.inputs", "bpy.types.NodeTree.outputs"]),
        # It holds much besides what it took the place of.
        ("bmesh.types.BMLayerAccessEdge.bool", "4.2", []),
        # Both were there for a while, on things that are both here.
        ("bpy.types.Mesh.shade_smooth", "3.4", []),
        # The class of that name is another one here.
        ("bpy.types.GreasePencil.layer_groups", "4.5", ["bpy.types.GreasePencilv3.layer_groups"]),
        ("bpy.types.GreasePencilFrame.drawing", "4.2", ["bpy.types.GPencilFrame.strokes"]),
    ],
)
def test_what_is_here_in_place_of_a_name_of_later_versions(
    history: ApiHistory, table: list[Succession], later: str, version: str, here: list[str]
) -> None:
    found = Successors(table, history, version, {}).of(later)
    assert [target for row in found for target in row.new] == here
    # None is written in the other's place with nothing else changed.
    assert all(row.how for row in found)


def test_a_name_came_when_it_took_the_place_of_another_where_nothing_else_is_known(
    history: ApiHistory, table: list[Succession]
) -> None:
    successors = Successors(table, history, "3.4", {})
    came = {span.path: successors.came(span) for span in history.removed_from("3.4") if not span.gone}
    principled = "bpy.types.ShaderNodeBsdfPrincipled.inputs"
    assert came[f'{principled}["Subsurface Weight"]'] == ("4.0", "")
    assert came["bpy.types.ColorManagedViewSettings.view_transform:AgX"] == ("4.2", "3.4")
    assert came["bpy.types.NodeTree.interface"] == ("4.0", "")


def test_every_new_name_came_by_then_or_later(history: ApiHistory, table: list[Succession]) -> None:
    wrong = [
        target
        for row in table
        for target in row.new
        if "*" not in target
        and version_key(history.versions[history.mask(target).bit_length() - 1]) < version_key(row.version)
    ]
    assert wrong == []


def test_every_pattern_fits_something(history: ApiHistory, table: list[Succession]) -> None:
    paths = [path for path, _, _ in history.symbols()]
    for row in table:
        if "*" in row.old:
            pattern = re.compile(re.escape(row.old).replace(r"\*", r"[^.()\[\]:]*"))
            assert any(pattern.fullmatch(path) for path in paths), row.old


def test_every_row_says_why_or_what_and_where_it_is_written(table: list[Succession]) -> None:
    assert all(row.source and (row.new or row.how) for row in table)
    assert all(row.how[-1:] in {"", ".", ")"} for row in table)
    olds = [row.old for row in table]
    assert len(olds) == len(set(olds))


@pytest.mark.parametrize("version", ["3.4", "4.2", "4.5", "5.0", "5.1", "5.2", "5.3"])
def test_successors_exist_in_every_version_that_can_be_built(
    history: ApiHistory, table: list[Succession], version: str
) -> None:
    successors = Successors(table, history, version, {})
    targets = [
        target
        for row in table
        if "*" not in row.old
        for found in successors.of(row.old)
        for target in found.new
    ]
    assert len(targets) > 500
    assert [target for target in targets if not history.exists(target, version)] == []


@pytest.mark.parametrize(
    ("path", "version", "targets"),
    [
        ("bpy.types.Object.draw_type", "5.1", ["bpy.types.Object.display_type"]),
        ("bpy.types.Object.draw_type:WIRE", "5.1", ["bpy.types.Object.display_type:WIRE"]),
        ("bpy.ops.mesh.primitive_cone_add(view_align)", "5.1", ["bpy.ops.mesh.primitive_cone_add(align)"]),
        ("bpy.types.Mesh.calc_normals", "5.1", [""]),
        ("bpy.types.MaterialHalo.size", "5.1", [""]),
        ("bpy.types.Mesh.no_such_member", "5.1", []),
        # Renamed twice: what 2.80 called it, and what took that name's place.
        ("bpy.types.BooleanModifier.solver:CARVE", "4.5", ["bpy.types.BooleanModifier.solver:FAST"]),
        ("bpy.types.BooleanModifier.solver:CARVE", "5.1", ["bpy.types.BooleanModifier.solver:FLOAT"]),
        # Members of one group that went to different owners.
        ("bpy.types.Camera.cycles", "5.1", ["bpy.types.Camera.panorama_type"]),
        ("bpy.types.CyclesCameraSettings.panorama_type", "5.1", ["bpy.types.Camera.panorama_type"]),
        (
            "bpy.types.CyclesCameraSettings.panorama_type:MIRRORBALL",
            "5.1",
            ["bpy.types.Camera.panorama_type:MIRRORBALL"],
        ),
        (
            "bpy.types.CyclesCameraSettings.aperture_size",
            "5.1",
            ["bpy.types.CameraDOFSettings.aperture_fstop"],
        ),
        (
            "bmesh.types.BMLoopUV.select",
            "5.1",
            [
                "bmesh.types.BMLoop.uv_select_vert",
                "bmesh.types.BMLoop.uv_select_edge",
                "bmesh.types.BMFace.uv_select",
            ],
        ),
        ("bpy.context.sequences", "5.1", ["bpy.context.strips"]),
        ("bpy.types.TextSequence.align_x:LEFT", "5.1", ["bpy.types.TextStrip.anchor_x:LEFT"]),
        ("bpy.types.TransformSequence.scale_start_x", "5.1", ["bpy.types.StripTransform.scale_x"]),
        # A pattern, and then another.
        ("bpy.types.NoiseGpencilModifier.layer", "4.3", ["bpy.types.GreasePencilNoiseModifier.layer_filter"]),
        (
            "bpy.types.NoiseGpencilModifier.layer",
            "5.1",
            ["bpy.types.GreasePencilNoiseModifier.tree_node_filter"],
        ),
        ("bpy.types.GPencilLayer.info", "4.3", []),
        (
            "bpy.types.GPencilLayer.info",
            "5.1",
            ["bpy.types.AnnotationLayer.info", "bpy.types.GreasePencilTreeNode.name"],
        ),
        # Properties of nodes that became sockets.
        (
            "bpy.types.CompositorNodeTonemap.tonemap_type",
            "5.1",
            ['bpy.types.CompositorNodeTonemap.inputs["Type"]'],
        ),
        (
            "bpy.types.CompositorNodeChromaMatte.threshold",
            "5.1",
            ['bpy.types.CompositorNodeChromaMatte.inputs["Minimum"]'],
        ),
        (
            "bpy.types.GeometryNodeTransform.mode",
            "5.1",
            ['bpy.types.GeometryNodeTransform.inputs["Mode"]'],
        ),
        ("bpy.types.CompositorNodeViewer.use_alpha", "5.1", [""]),
        ("bpy.types.GreasePencil.edit_curve_resolution", "5.1", [""]),
        # What has another meaning than its likes.
        ("bpy.types.CyclesRenderSettings.aa_samples", "5.1", [""]),
        ("bpy.app.version_char", "5.1", [""]),
        (
            "bpy.types.ShaderNodeTexSky.sky_type:NISHITA",
            "5.1",
            ["bpy.types.ShaderNodeTexSky.sky_type:SINGLE_SCATTERING"],
        ),
        ("bpy.ops.armature.armature_layers", "5.1", ["bpy.types.BoneCollection.is_visible"]),
        (
            "bpy.types.ObjectGpencilModifiers.new(type):GP_THICK",
            "5.1",
            ["bpy.types.ObjectModifiers.new(type):GREASE_PENCIL_THICKNESS"],
        ),
        ("bpy.types.LightProbe.grid_bake_samples", "5.1", ["bpy.types.LightProbeVolume.bake_samples"]),
        # Renamed, and then gone.
        (
            "bpy.ops.wm.alembic_export(visible_layers_only)",
            "4.5",
            ["bpy.ops.wm.alembic_export(visible_objects_only)"],
        ),
        ("bpy.ops.wm.alembic_export(visible_layers_only)", "5.1", [""]),
        # What is like it, and not what is called nearly so.
        (
            "bpy.types.SmokeDomainSettings.collision_group",
            "5.1",
            ["bpy.types.FluidDomainSettings.effector_group"],
        ),
        ("bpy.types.Bone.bbone_curveiny", "5.1", ["bpy.types.Bone.bbone_curveinz"]),
        ("bpy.types.EditBone.bbone_curveouty", "5.1", ["bpy.types.EditBone.bbone_curveoutz"]),
        ("bpy.ops.pose.push_rest", "5.1", ["bpy.ops.pose.blend_with_rest"]),
        ("bpy.ops.object.face_map_remove", "5.1", ["bpy.ops.geometry.attribute_remove"]),
        ("bpy.ops.object.face_map_select", "5.1", [""]),
        ("bpy.types.SpaceLogicEditor", "5.1", [""]),
        ("bpy.types.PythonController", "5.1", [""]),
        ("bpy.types.PythonController.module", "5.1", [""]),
        ("bpy.types.GameFloatProperty.value", "5.1", [""]),
        (
            "bpy.ops.sculpt.brush_stroke(mode):SMOOTH",
            "5.1",
            ["bpy.ops.sculpt.brush_stroke(brush_toggle):SMOOTH"],
        ),
        (
            "bpy.types.SpeedControlSequence.use_as_speed",
            "4.3",
            ["bpy.types.SpeedControlSequence.speed_control"],
        ),
        # Of what was renamed, and later lost it.
        ("bpy.types.PointLamp.falloff_type", "5.1", ["bpy.types.ShaderNodeLightFalloff"]),
        ("bpy.types.UserPreferencesSystem.multi_sample", "5.1", ["bpy.types.PreferencesSystem.viewport_aa"]),
        ("bpy.types.EnvironmentMap.resolution", "5.1", []),
        # Of one group of settings that went to another.
        (
            "bpy.types.UserPreferencesView.use_mouse_depth_navigate",
            "5.1",
            ["bpy.types.PreferencesInput.use_mouse_depth_navigate"],
        ),
        ("bpy.ops.view3d.select_border", "5.1", ["bpy.ops.view3d.select_box"]),
        ("bpy.ops.mesh.select_similar(type):SEAM", "5.1", ["bpy.ops.mesh.select_similar(type):EDGE_SEAM"]),
        ("bpy.ops.wm.usd_import(filter_collada)", "5.1", [""]),
        # Not yet removed, or not yet there.
        ("bpy.types.Action.fcurves", "4.5", []),
        (
            "bpy.types.Material.emit",
            "3.4",
            ['bpy.types.ShaderNodeBsdfPrincipled.inputs["Emission Strength"]'],
        ),
    ],
)
def test_a_name_leads_to_what_takes_its_place_in_that_version(
    history: ApiHistory, table: list[Succession], path: str, version: str, targets: list[str]
) -> None:
    found = Successors(table, history, version, {}).of(path)
    assert [row.new[0] if row.new else "" for row in found][: len(targets) or None] == targets


@pytest.mark.parametrize(
    "path",
    [
        "bpy.ops.sequencer.effect_strip_add(frame_end)",
        "bpy.ops.sequencer.image_strip_add(frame_end)",
        "bpy.types.StripsTopLevel.new_effect(frame_end)",
        "bpy.types.TransformStrip.rotation_start",
        "bpy.types.CompositorNodeVecBlur.factor",
        "bmesh.ops.bevel(vertex_only)",
        "bpy.ops.export_scene.obj(axis_forward)",
        "bpy.ops.object.move_to_layer",
        "bpy.ops.pose.bone_layers",
        "bpy.ops.wm.usd_export(export_textures)",
        "bpy.types.AssetHandle.get_full_library_path",
        "bpy.types.CompositorNodeAlphaOver.premul",
        "bpy.types.CompositorNodeBlur.use_bokeh",
        "bpy.types.CompositorNodeMixRGB",
        "bpy.types.SpeedControlSequence.multiply_speed",
    ],
)
def test_a_new_name_that_takes_another_value_says_which(
    history: ApiHistory, table: list[Succession], path: str
) -> None:
    """What a row says beside the name keeps its fix from being a sure one."""
    assert all(row.how for row in Successors(table, history, "5.1", {}).of(path))


def test_members_of_a_renamed_class_are_found_in_its_bases(
    history: ApiHistory, table: list[Succession]
) -> None:
    successors = Successors(table, history, "5.1", {"bpy.types.PointLight": "bpy.types.Light"})
    assert successors.of("bpy.types.PointLamp.energy")[0].new == ("bpy.types.PointLight.energy",)
    assert successors.of("bpy.types.PointLamp.color")[0].new == ("bpy.types.Light.color",)


def test_a_module_that_the_history_does_not_list_is_looked_up_among_the_symbols(
    history: ApiHistory, table: list[Succession]
) -> None:
    cyclic = "_bpy_internal.grease_pencil.stroke.GreasePencilStroke.cyclic"
    strokes = "bpy.types.GreasePencilDrawing.strokes"
    masks = {path: mask for path, mask in history.masks.items() if not path.startswith("_bpy_internal.")}
    without = replace(history, masks=masks)
    for known, targets in (({cyclic}, [cyclic, strokes]), (set[str](), [strokes])):
        found = Successors(table, without, "5.1", {}, known).of("bpy.types.GPencilStroke.use_cyclic")
        assert [row.new[0] for row in found] == targets


def test_a_date_between_two_known_versions_comes_from_the_table(
    history: ApiHistory, table: list[Succession]
) -> None:
    path = 'bpy.types.ShaderNodeBsdfPrincipled.inputs["Clearcoat"]'
    span = next(span for span in history.removed_from("5.1") if span.path == path)
    assert (span.last, span.gone) == ("3.4", "4.2")
    assert Successors(table, history, "5.1", {}).dated(span) == ("3.6", "4.0")


@pytest.mark.parametrize(
    ("setting", "dates"),
    [
        ("CyclesMaterialSettings.sample_as_light", ("3.4", "3.5")),
        ("CyclesMaterialSettings.displacement_method", ("4.0", "4.1")),
        ("CyclesCurveRenderSettings.primitive", ("2.83", "2.90")),
        ("CyclesCameraSettings", ("3.6", "4.0")),
        ("Camera.cycles", ("3.6", "4.0")),
        ("CyclesRenderSettings.sampling_pattern:SOBOL", ("3.4", "4.2")),
    ],
)
def test_settings_that_the_stubs_leave_out_are_dated_by_the_table(
    history: ApiHistory, table: list[Succession], setting: str, dates: tuple[str, str]
) -> None:
    span = next(span for span in history.removed_from("5.1") if span.path == f"bpy.types.{setting}")
    assert Successors(table, history, "5.1", {}).dated(span) == dates


def test_rows_that_lead_to_each_other_end(history: ApiHistory) -> None:
    rows = [Succession("a.x", ("a.y",), "", "2.80", "s"), Succession("a.y", ("a.x",), "", "2.80", "s")]
    assert Successors(rows, history, "5.1", {}).of("a.x") == []


@pytest.mark.blender
def test_members_of_python_classes_that_the_table_names_exist(
    extract: Extract, table: list[Succession]
) -> None:
    known = {symbol.path for symbol in extract.symbols}
    targets = {target for row in table for target in row.new if target.startswith("_bpy_internal.")}
    assert len(targets) > 15
    assert targets <= known


@pytest.mark.blender
def test_modules_that_the_table_says_to_be_gone_are_there_with_an_underscore(
    tmp_path: Path, table: list[Succession]
) -> None:
    names = [row.old for row in table if row.source == OF_MODULES]
    assert len(names) > 10
    told = run_statements(tmp_path, [f"import {start}{name}" for name in names for start in ("", "_")])
    errors = [error for error, *_ in told]
    assert not any(errors[1::2])
    assert all(error.startswith("ModuleNotFoundError") for error in errors[::2])


@pytest.mark.parametrize("text", ["", "old,new\n", "old,new,how,version,source\na,b\n"])
def test_a_table_that_cannot_be_read_is_named(tmp_path: Path, text: str) -> None:
    file = tmp_path / "successors.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(StoreError, match=r"successors\.csv"):
        load_successors(file)


@pytest.mark.parametrize(
    "path", ["a.b", "a.b(c)", "a.b(c):D", "a.b:D", 'a.B.inputs["x: (y.z)"]', 'a.B.outputs["O"]', "bpy"]
)
def test_a_split_path_can_be_joined(path: str) -> None:
    above, mark, name = split_path(path)
    assert joined_path(above, mark, name).lstrip(".") == path
