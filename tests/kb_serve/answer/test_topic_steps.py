"""The steps of a topic can be done in their order: nothing is set before it is there."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from asking import TYPES, steps

from kb_build.index.analysis import terms
from kb_build.symbols.api_names import STRUCT
from kb_serve.answer.steps.names.topic_names import TopicNames
from kb_serve.answer.steps.order import Steps, numbered
from measurements.steps import do_steps

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader


def test_settings_that_a_new_thing_lacks_are_made_first_each_on_an_object_of_its_own(
    reader: BaseReader,
) -> None:
    found = steps(reader, "fluid", "FluidModifier", "FluidDomainSettings", "FluidFlowSettings")
    made = [line for line in found if "makes" in line]
    assert made[0].endswith("`modifier.fluid_type = 'DOMAIN'` makes `modifier.domain_settings`")
    assert made[1].endswith("`flow.fluid_type = 'FLOW'` makes `flow.flow_settings`")
    assert "`flow = other.modifiers.new(\"Fluid\", 'FLUID')`" in found[found.index(made[1]) - 1]
    assert "set on `modifier.domain_settings`" in found[found.index(made[0]) + 1]
    assert _done_in_blender(found)


def test_a_brush_that_paints_is_toggled_before_it_is_set(reader: BaseReader) -> None:
    found = steps(reader, "dynamic paint", "DynamicPaintModifier", "DynamicPaintBrushSettings")
    (made,) = [line for line in found if "makes" in line]
    assert "`bpy.ops.dpaint.type_toggle(type='BRUSH')` makes `modifier.brush_settings`" in made
    assert "set on `modifier.brush_settings`" in found[found.index(made) + 1]


def test_an_operator_says_what_it_takes_and_what_must_be_set(reader: BaseReader) -> None:
    names = TopicNames(frozenset({"fluid"}), (), operators={"bpy.ops.fluid.bake_all": 1.0})
    *made, run = numbered(Steps(reader, names).told())
    assert "`modifier.fluid_type = 'DOMAIN'` makes `modifier.domain_settings`" in made[1]
    assert made[2:] == ["3. `modifier.domain_settings.cache_type = 'ALL'`"]
    assert "Bake Entire Fluid Simulation (takes an active object; offered by Blender's panels only if" in run
    assert "`FluidDomainSettings.cache_type` is 'ALL' (a new one has `'REPLAY'`)" in run


def test_the_sockets_of_a_tree_are_those_that_it_takes(reader: BaseReader) -> None:
    (compositor,) = [
        line for line in steps(reader, "compositor", "CompositorNodeTree") if "new_socket" in line
    ]
    assert "`in_out='INPUT'|'OUTPUT'`" in compositor
    assert "'NodeSocketString'" in compositor
    assert "Shader" not in compositor
    assert "Geometry" not in compositor


def test_shader_nodes_are_made_in_the_tree_that_a_material_has(reader: BaseReader) -> None:
    found = " ".join(steps(reader, "volume scatter", "ShaderNodeVolumeScatter"))
    assert "`tree = material.node_tree`" in found
    assert "node_groups.new" not in found


@pytest.mark.parametrize(("cls", "name"), [("Light", "Light"), ("Camera", "Camera")])
def test_an_object_is_called_as_what_it_holds(reader: BaseReader, cls: str, name: str) -> None:
    found = " ".join(steps(reader, cls.lower(), cls))
    assert f'bpy.data.objects.new("{name}", object_data)' in found


def test_what_somebody_must_have_made_is_not_set_as_if_it_were_there(reader: BaseReader) -> None:
    found = " ".join(steps(reader, "collision", "CollisionModifier", "ClothCollisionSettings"))
    assert 'modifiers["Cloth"]' not in found


def test_what_is_none_until_something_makes_it_is_set_last(reader: BaseReader) -> None:
    found = steps(reader, "override", "IDOverrideLibrary", "RenderSettings")
    assert "set on `bpy.context.scene.render`" in found[0]
    assert "set, once it is not None, on `bpy.context.object.override_library`" in found[-1]


def test_a_pointer_that_is_none_is_filled_before_what_it_holds_is_set(reader: BaseReader) -> None:
    made, held = steps(reader, "force field", "FieldSettings")
    assert made.endswith("`bpy.ops.object.forcefield_toggle()` makes `obj.field`")
    assert "set on `obj.field`" in held


def test_a_node_goes_to_the_input_that_is_called_as_what_it_gives(reader: BaseReader) -> None:
    said = "\n".join(steps(reader, "displacement", "ShaderNodeDisplacement"))
    assert (
        """displacement.outputs["Displacement"], tree.get_output_node('ALL').inputs["Displacement"])"""
        in said
    )


def test_a_material_moves_what_its_nodes_displace(reader: BaseReader) -> None:
    told = steps(reader, "displacement", "ShaderNodeDisplacement", "CompositorNodeDisplace")
    assert "`material.displacement_method = 'DISPLACEMENT'`" in told[-1]
    assert _done_in_blender(told)
    assert "CompositorNodeDisplace" not in " ".join(told)  # no tree of a material takes it


def test_what_a_step_has_made_keeps_its_name(reader: BaseReader) -> None:
    told = " ".join(steps(reader, "output", "ShaderNodeOutputMaterial"))
    assert '`output_material = tree.nodes.new("ShaderNodeOutputMaterial")`' in told


def test_of_many_nodes_one_that_stands_alone_is_the_example(reader: BaseReader) -> None:
    ends = [f"GeometryNodeSimulation{end}" for end in ("Output", "Input")]
    alone = [f"GeometryNode{name}" for name in ("InstanceOnPoints", "CurveToMesh", "JoinGeometry")]
    many = "\n".join(steps(reader, "nodes", *ends, *alone))
    assert 'nodes.new("GeometryNodeInstanceOnPoints")' in many
    assert ".pair_with_output(" not in many
    assert ".pair_with_output(" in "\n".join(steps(reader, "simulation", *ends))


def test_a_world_has_a_background_and_no_rigid_bodies(reader: BaseReader) -> None:
    said = "\n".join(steps(reader, "world", "World", "RigidBodyWorld"))
    assert '`background = tree.nodes["Background"]`' in said
    assert '`inputs["Strength"].default_value` = 1' in said
    assert "Principled" not in said
    assert "rigidbody" not in said


def test_what_must_be_there_before_an_operator_is_made_before(kb: KnowledgeBase, reader: BaseReader) -> None:
    said = steps(reader, "rigid body constraint", "RigidBodyConstraint")
    assert said[0].startswith("1. `bpy.ops.rigidbody.world_add()` → `RigidBodyWorld`")
    assert said[1].startswith("2. `bpy.ops.rigidbody.constraint_add()` → `RigidBodyConstraint`")
    both = "made by `bpy.ops.rigidbody.world_add()`, then `bpy.ops.rigidbody.constraint_add()`"
    assert both in kb.query("bpy.types.RigidBodyConstraint").text.replace("; made by", "\nmade by")


def test_what_a_thing_works_on_is_a_setting_of_it(reader: BaseReader) -> None:
    found = " ".join(steps(reader, "boolean", "BooleanModifier"))
    assert "`object` = None (Object)" in found
    assert "`operation` = 'DIFFERENCE' (INTERSECT|UNION|DIFFERENCE)" in found


def test_deprecated_settings_are_not_steps(reader: BaseReader) -> None:
    assert "deprecated" not in " ".join(steps(reader, "adjustment", "AdjustmentStrip"))


def test_classes_with_the_whole_title_come_before_others_with_its_address(reader: BaseReader) -> None:
    found = " ".join(steps(reader, "text strip", "Text", "TextCurve", "TextStrip"))
    assert "new_effect(\"Text Strip\", 'TEXT'" in found
    assert "bpy.data.texts" not in found


def test_what_would_end_blender_is_set_before(reader: BaseReader) -> None:
    found = steps(reader, "white balance modifier", "WhiteBalanceModifier")
    made = next(place for place, line in enumerate(found) if "strip.modifiers.new(" in line)
    assert "`scene.sequence_editor_create()`" in found[0]
    assert "`bpy.context.workspace.sequencer_scene = scene`" in found[made - 1]


def test_an_effect_is_made_on_an_object_that_takes_it(reader: BaseReader) -> None:
    found = steps(reader, "blur", "ShaderFxBlur")
    assert "bpy.data.grease_pencils.new" in found[0]


def test_the_kinds_of_a_class_stand_for_one_that_is_not_made(reader: BaseReader) -> None:
    found = " ".join(steps(reader, "strip modifiers", "StripModifier", "PitchModifier", "MaskStripModifier"))
    assert "`PITCH`" in found or "'PITCH'" in found


def test_shape_keys_begin_with_the_one_that_others_are_relative_to(reader: BaseReader) -> None:
    told = steps(reader, "shape keys", "ShapeKey")
    assert told[0].startswith('1. `obj.shape_key_add(name="Basis")`')
    assert told[1] == '2. `key = obj.shape_key_add(name="Key")` → `ShapeKey`'
    assert told[2].startswith("3. set on `key`: `value`")
    (done,) = do_steps({"shape keys": told})
    assert not done.failed


def test_a_function_that_only_answers_is_no_step_unless_scripts_call_it(reader: BaseReader) -> None:
    told = "\n".join(steps(reader, "rigid body", "RigidBodyWorld", "RigidBodyObject", "RigidBodyConstraint"))
    assert "rigidbody.object_add()" in told
    assert "convex_sweep_test" not in told  # has no answer before the simulation was stepped
    assert "normals_vertex_get" not in "\n".join(steps(reader, "shape keys", "ShapeKey"))
    assert "object_data.view_frame(" in "\n".join(steps(reader, "camera", "Camera"))
    assert "group.add(" in "\n".join(steps(reader, "vertex groups", "VertexGroup"))


def test_custom_properties_are_made_by_subscript(reader: BaseReader) -> None:
    names = TopicNames(frozenset({"customproperties"}), (frozenset({"custom"}),), frozenset({STRUCT}))
    names.classes[STRUCT] = 1.0
    names.operators |= {"bpy.ops.wm.properties_edit": 9.0, "bpy.ops.wm.properties_edit_value": 8.0}
    told = numbered(Steps(reader, names).told())
    assert told[0].startswith('1. `obj["strength"] = 1.0`')
    assert not any(
        "properties_edit" in line for line in told
    )  # they work on what a path names, and on nothing else
    (done,) = do_steps({"custom properties": told})
    assert (done.done, list(done.failed)) == (len(told), [])


def _told(reader: BaseReader, names: TopicNames) -> list[str]:
    return numbered(Steps(reader, names).told())


def _done_in_blender(told: list[str]) -> bool:
    (done,) = do_steps({"told": told})
    return (done.done, done.left, list(done.failed)) == (len(told), 0, [])


def test_an_operator_on_files_is_told_with_the_file(reader: BaseReader) -> None:
    operators = {"bpy.ops.wm.alembic_export": 2.0, "bpy.ops.wm.alembic_import": 1.0}
    told = _told(reader, TopicNames(frozenset({"alembic"}), (), operators=operators))
    assert [line.partition("(")[2].partition(",")[0] for line in told] == ["filepath=filepath"] * 2
    assert not any(
        name in line for line in told for name in ("filter_", "check_existing", "hide_props_region")
    )


def test_edit_bones_are_added_in_edit_mode(reader: BaseReader) -> None:
    told = steps(reader, "armature", "Armature", "Bone")
    entered = next(place for place, line in enumerate(told) if "mode_set(mode='EDIT')" in line)
    assert "view_layer.objects.active = obj" in told[entered]
    assert '`bone = object_data.edit_bones.new("Bone")`' in told[entered + 1]
    assert "set on `bone`: `tail`, `head`" in told[entered + 2]
    assert _done_in_blender(told)


def test_an_operator_comes_after_the_mode_that_it_runs_in(reader: BaseReader) -> None:
    names = TopicNames(frozenset({"mesh"}), (), operators={"bpy.ops.mesh.subdivide": 9.0})
    entered, run = _told(reader, names)
    selected = "`bpy.ops.mesh.select_all(action='SELECT')`"
    assert entered == f"1. `bpy.ops.object.mode_set(mode='EDIT')`; {selected}"
    assert "bpy.ops.mesh.subdivide(" in run
    (done,) = do_steps({"subdivide": [entered, "2. `bpy.ops.mesh.subdivide()`"]})
    assert not done.failed


def test_an_operator_comes_after_what_its_poll_asks_for(reader: BaseReader) -> None:
    names = TopicNames(frozenset({"sequencer"}), (), operators={"bpy.ops.sequencer.refresh_all": 9.0})
    told = _told(reader, names)
    assert told[:2] == [
        "1. `scene.sequence_editor_create()`",
        "2. `bpy.context.workspace.sequencer_scene = scene`",
    ]
    assert _done_in_blender(told)


def test_what_never_ran_without_a_window_is_no_step(reader: BaseReader) -> None:
    names = TopicNames(frozenset({"world"}), (), operators={"bpy.ops.world.convert_volume_to_mesh": 9.0})
    assert _told(reader, names) == []


def test_what_takes_away_what_was_made_is_no_step(reader: BaseReader) -> None:
    told = " ".join(steps(reader, "meta strip", "MetaStrip", "StripsMeta"))
    assert "new_meta(" in told
    assert "separate" not in told
    assert "`.strips` (`Strip`, by `strip.strips.new_" in told
    assert "driver_remove" not in " ".join(steps(reader, "drivers", "Driver"))


def test_a_setting_that_hides_what_an_operator_does_is_switched_on_before(reader: BaseReader) -> None:
    told = steps(reader, "stereoscopy", "RenderView")
    assert told[0] == "1. `scene.render.use_multiview = True`"
    assert told[-1].partition("`bpy.ops.")[2].startswith("scene.render_view_add()")
    assert _done_in_blender(told)


def test_a_canvas_is_made_and_kept_in_images_before_it_is_baked(reader: BaseReader) -> None:
    classes = {f"{TYPES}DynamicPaintModifier": 2.0, f"{TYPES}DynamicPaintBrushSettings": 1.0}
    bake = {"bpy.ops.dpaint.bake": 9.0}
    words = (frozenset({"dynamic", "paint"}),)
    told = _told(reader, TopicNames(frozenset({"dynamicpaint"}), words, classes=classes, operators=bake))
    assert "`bpy.ops.dpaint.type_toggle(type='CANVAS')` makes `modifier.canvas_settings`" in told[-4]
    assert told[-3].endswith("`modifier.canvas_settings.canvas_surfaces.active.surface_format = 'IMAGE'`")
    assert "bpy.ops.dpaint.bake()" in told[-1]
    assert _done_in_blender(told)
    assert "`obj.data.uv_layers.new()`" in told[-2]


def test_what_an_operator_only_finds_in_the_context_is_not_made_by_it(reader: BaseReader) -> None:
    told = steps(reader, "boid", "BoidSettings", "BoidState")
    assert "state_add" not in " ".join(told)
    assert told[0].endswith("`bpy.ops.object.particle_system_add()` → `ParticleSystem`")
    assert ".settings.physics_type = 'BOIDS'` makes" in told[1]
    assert _done_in_blender(told)


def test_a_pointer_that_is_none_is_assigned_what_it_leads_to(reader: BaseReader) -> None:
    told = steps(reader, "line art", "MaterialLineArt")
    assert told[0].endswith(
        '`material = bpy.data.materials.new("Material")`; `obj.active_material = material`'
    )
    assert "set on `material.lineart`" in told[1]
    assert _done_in_blender(told)


def test_a_material_gets_strokes_settings_by_the_call_that_makes_them(reader: BaseReader) -> None:
    told = steps(reader, "grease pencil material", "MaterialGPencilStyle", "Material")
    assert sum('materials.new("Material")' in line for line in told) == 1
    made = next(place for place, line in enumerate(told) if "create_gpencil_data(material)" in line)
    assert "set on `material.grease_pencil`" in told[made + 1]
    assert _done_in_blender(told)


def test_a_material_has_a_shader_whose_inputs_are_set_and_no_strokes(reader: BaseReader) -> None:
    words = frozenset({"material"})
    weights = {"Material": 10.0, "MaterialSlot": 9.0, "MaterialLineArt": 8.0, "MaterialGPencilStyle": 2.0}
    classes = {f"{TYPES}{name}": weight for name, weight in weights.items()}
    told = _told(reader, TopicNames(words, (words,), classes=classes))
    there = next(place for place, line in enumerate(told) if '`principled = tree.nodes["Principled' in line)
    assert '`inputs["Base Color"].default_value` = (0.8, 0.8, 0.8, 1)' in told[there + 1]
    assert 'tree.nodes.new("ShaderNodeEmission")' in told[there + 2]
    said = "".join(told)
    assert "grease_pencil" not in said
    assert "material_slot_add" not in said
    assert _done_in_blender(told)


def test_a_constraint_between_two_objects_begins_with_these(reader: BaseReader) -> None:
    told = steps(reader, "rigid body constraint", "RigidBodyConstraint")
    between = "set on `bpy.context.object.rigid_body_constraint`: `object1` = None (Object), `object2` = None (Object)"
    assert between in " ".join(told)


_APPLY, _INVERSE = "bpy.ops.constraint.apply", "bpy.ops.constraint.childof_set_inverse"


@pytest.mark.parametrize(
    ("classes", "run"),
    [
        (("ChildOfConstraint",), [_APPLY, _INVERSE]),
        (("CopyLocationConstraint", "ChildOfConstraint"), [_APPLY]),
        (("KinematicConstraint",), []),  # which is on a bone
    ],
)
def test_an_operator_is_given_what_it_works_on(
    reader: BaseReader, classes: tuple[str, ...], run: list[str]
) -> None:
    words = frozenset({"constraint"})
    weights = {f"{TYPES}{name}": 10.0 - place for place, name in enumerate(classes)}
    names = TopicNames(words, (words,), classes=weights, operators=dict.fromkeys((_APPLY, _INVERSE), 9.0))
    told = [line for line in Steps(reader, names).told() if "bpy.ops.constraint." in line]
    assert [line.partition("(constraint=constraint.name, ")[0].lstrip("`") for line in told] == run


def test_a_kind_comes_before_what_belongs_to_one(reader: BaseReader) -> None:
    told = steps(reader, "constraint", "ConstraintTargetBone", "CopyRotationConstraint", "TrackToConstraint")
    assert told[0].startswith("1. `constraint = obj.constraints.new('COPY_ROTATION')`")


def test_an_area_that_an_operator_needs_on_its_way_is_told(reader: BaseReader) -> None:
    names = TopicNames(frozenset({"rigidbody"}), (), operators={"bpy.ops.rigidbody.bake_to_keyframes": 9.0})
    assert (
        "calls `bpy.ops.anim.keyframe_insert_by_name`, which takes an area of any type"
        in Steps(reader, names).told()[-1]
    )


def test_a_page_begins_with_what_it_explains(reader: BaseReader) -> None:
    words = (frozenset({"imag", "sequenc", "strip"}), frozenset({"imag"}))
    classes = {f"{TYPES}Image": 75.0, f"{TYPES}ImageUser": 36.0, f"{TYPES}ImageStrip": 9.0}
    explained = frozenset({f"{TYPES}ImageStrip"})
    told = _told(reader, TopicNames(frozenset({"image"}), words, explained, classes))
    assert "strips.new_image(" in told[1]
    assert "`.elements` (`StripElement`, by `strip.elements.append(filename)`)" in " ".join(told)
    assert "bpy.data" not in " ".join(told)


def test_settings_begin_with_what_is_called_so_and_is_made(reader: BaseReader) -> None:
    for settings, kind, call in (
        ("Itasc", "KinematicConstraint", "constraint = obj.pose.bones[\"Bone\"].constraints.new('IK')"),
        (
            "ObjectLineArt",
            "GreasePencilLineartModifier",
            "modifier = obj.modifiers.new(\"Lineart\", 'LINEART')",
        ),
    ):
        explained, of_kind = frozenset({f"{TYPES}{settings}"}), frozenset({f"{TYPES}{kind}"})
        classes = {f"{TYPES}{settings}": 9.0, f"{TYPES}{kind}": 5.0}
        names = TopicNames(frozenset({"a"}), (frozenset({"a"}),), explained, classes, of_kind=of_kind)
        told = _told(reader, names)
        made = next(place for place, line in enumerate(told) if f"`{call}`" in line)
        assert "set on `" not in "".join(told[:made])
        assert _done_in_blender(told)


def test_strokes_are_added_to_the_drawing_of_a_frame(reader: BaseReader) -> None:
    told = " ".join(steps(reader, "layer", "GreasePencilLayer", "GreasePencilDrawing"))
    assert "by `layer.frames.new(frame_number)`, then `frame.drawing.add_strokes(sizes)`" in told
    assert "get_frame_at" not in told
    told = " ".join(steps(reader, "frame", "GreasePencilFrame", "GreasePencilDrawing"))
    assert "call `frame.drawing.add_strokes(sizes)`" in told


def test_a_light_is_set_with_what_only_its_type_has(reader: BaseReader) -> None:
    told = steps(reader, "light", "Light")
    (own,) = [line for line in told if "(`PointLight`)" in line]
    assert "`energy` = 10" in own
    assert _done_in_blender(told)


def test_a_new_collection_gets_the_object(reader: BaseReader) -> None:
    told = steps(reader, "collections", "Collection")
    assert "`collection.objects.link(obj)`" in " ".join(told)
    assert "`collection.children.link(child)`" in " ".join(told)  # another one: none is its own child


def test_a_shape_key_has_points_that_are_moved(reader: BaseReader) -> None:
    told = steps(reader, "shape keys", "ShapeKey", "ShapeKeyPoint")
    assert any("set on each of `key.points` (`ShapeKeyPoint`): `co`" in line for line in told)
    assert "UnknownType" not in " ".join(told)
    assert _done_in_blender(told)


def test_what_a_file_alone_makes_is_loaded(reader: BaseReader) -> None:
    told = steps(reader, "text", "TextCurve", "VectorFont")
    assert any(line.endswith("`object_data.font = bpy.data.fonts.load(filepath)`") for line in told)
    assert "`VectorFont`" not in " ".join(told)


def test_settings_of_one_engine_come_after_it_is_chosen(reader: BaseReader) -> None:
    told = steps(reader, "rendering", "CyclesRenderSettings")
    chosen, set_on = (line.partition(". ")[2] for line in told)
    assert chosen.startswith("`scene.render.engine = 'CYCLES'`")
    assert set_on.startswith("set on `bpy.context.scene.cycles`")


def test_a_key_that_is_inserted_is_set_where_it_is(reader: BaseReader) -> None:
    words = (frozenset(terms("keyframes")),)
    names = TopicNames(
        frozenset({"keyframes"}),
        words,
        classes={f"{TYPES}Keyframe": 1.0},
        operators={"bpy.ops.anim.keying_set_export": 1.0},
        title="keyframes",
    )
    told = numbered(Steps(reader, names).told())
    assert len(told) == 4  # operators that do something else are none
    assert told[0].startswith("1. `obj.keyframe_insert(")
    assert told[1].endswith("fcurves[0]` → `FCurve`")
    assert told[2].startswith("3. set on `fcurve.keyframe_points[0]` (`Keyframe`): ")
    assert told[3].startswith("4. set on `fcurve` (`FCurve`): ")
    assert _done_in_blender(told)


def test_what_the_user_keeps_is_made_in_the_preferences(reader: BaseReader) -> None:
    library, mark = f"{TYPES}UserAssetLibrary", "bpy.ops.asset.mark"
    names = TopicNames(
        frozenset({"assetlibraries"}),
        (frozenset(terms("asset libraries")),),
        classes={library: 1.0},
        operators={mark: 1.0},
        title="assetlibraries",
        elsewhere=frozenset({library}),
    )
    told = numbered(Steps(reader, names).told())
    assert told[0].startswith("1. `obj.asset_mark()`")
    assert "`library = bpy.context.preferences.filepaths.asset_libraries.new()`" in told[1]
    assert "`path`" in told[2]
    assert _done_in_blender(told)
    assert "preferences" not in " ".join(steps(reader, "library", "UserAssetLibrary", "Library"))


def test_strips_of_all_sources_are_made_first(reader: BaseReader) -> None:
    kinds = ("SoundStrip", "TextStrip", "BrightContrastModifier", "MovieStrip", "ImageStrip")
    told = steps(reader, "editing", *kinds)
    made = [line.partition(".new")[2].partition("(")[0] for line in told if ".new" in line]
    assert made == ["_sound", "_effect", "_movie", "_image", ""]


def test_a_scene_that_is_rendered_has_a_camera(reader: BaseReader) -> None:
    names = TopicNames(
        frozenset({"rendering"}),
        (frozenset(terms("rendering")),),
        classes={f"{TYPES}RenderSettings": 2.0, f"{TYPES}Camera": 1.0},
        operators={"bpy.ops.render.render": 1.0},
        title="rendering",
    )
    told = numbered(Steps(reader, names).told())
    assert told[2] == "3. `scene.camera = obj`"
    assert any("bpy.ops.render.render(" in line for line in told[3:])
    assert _done_in_blender(told)


@pytest.mark.parametrize(("name", "selects"), [("uv.smart_project", True), ("mesh.knife_project", False)])
def test_what_works_on_what_is_selected_comes_after_that(
    reader: BaseReader, name: str, *, selects: bool
) -> None:
    names = TopicNames(frozenset({name.partition(".")[0]}), (), operators={f"bpy.ops.{name}": 1.0})
    told = " ".join(Steps(reader, names).told())
    assert f"bpy.ops.{name}(" in told
    assert ("bpy.ops.mesh.select_all(action='SELECT')" in told) is selects


def test_what_others_go_by_is_marked_first(reader: BaseReader) -> None:
    operators = {"bpy.ops.uv.unwrap": 2.0, "bpy.ops.uv.mark_seam": 1.0}
    names = TopicNames(frozenset({"uv"}), (), operators=operators)
    told = numbered(Steps(reader, names).told())
    run = [line for line in told if "`bpy.ops.uv." in line]
    assert "mark_seam" in run[0]
    assert "unwrap" in run[1]
    assert _done_in_blender(told)
