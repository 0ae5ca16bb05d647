"""Rules about names that do not exist: what they report, what they must not, and the fixes."""

from __future__ import annotations

from textwrap import dedent
from typing import TYPE_CHECKING

import pytest

from kb_check.checker import Checker

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.fixture(scope="module")
def checker(base: Path) -> Iterator[Checker]:
    with Checker(base) as opened:
        yield opened


def errors(checker: Checker, code: str) -> list[tuple[int, str]]:
    return [(one.span.line, one.rule) for one in checker.check(dedent(code)) if one.severity == "error"]


def test_a_comparison_that_never_holds_is_a_warning(checker: Checker) -> None:
    code = (
        "import bpy\nif bpy.context.mode == 'WEIGHT_PAINT':\n    pass\nif bpy.context.mode == '':\n    pass"
    )
    (finding,) = checker.check(code)
    assert (finding.rule, finding.severity, finding.span.line) == ("never-true", "warning", 2)
    assert "never matches" in finding.message
    assert not checker.check("import bpy\nbpy.context.object.type in {'GPENCIL', 'GREASEPENCIL'}")
    assert checker.check("import bpy\nbpy.context.object.type in {'GPENCIL', 'MESH'}")
    (finding,) = checker.check("import bpy\nbpy.context.scene.render.engine = 'CYCLE'")
    assert (finding.rule, finding.severity) == ("unknown-value", "error")


@pytest.mark.parametrize(
    ("second", "found"),
    [
        ("elif ob.type == 'GREASEPENCIL'", 0),
        ("elif ob.type in ('MESH', 'GREASEPENCIL')", 0),
        ("elif ob.type == 'MESH':\n    pass\nelif ob.type == 'GREASEPENCIL'", 0),
        ("elif ob.type == 'MESH'", 1),
        ("elif other.type == 'GREASEPENCIL'", 1),
        ("if ob.type == 'GREASEPENCIL'", 1),
    ],
)
def test_an_old_value_is_right_in_a_chain_that_has_the_new_one(
    checker: Checker, second: str, found: int
) -> None:
    code = (
        f"import bpy\nob, other = bpy.data.objects\nif ob.type == 'GPENCIL':\n    pass\n{second}:\n    pass"
    )
    assert [one.rule for one in checker.check(code)] == ["never-true"] * found


def test_a_socket_by_a_former_name_that_still_works_is_no_finding(checker: Checker) -> None:
    code = """
        import bpy
        mix = bpy.data.materials[0].node_tree.nodes.new("ShaderNodeMixShader")
        mix.inputs["Fac"].default_value = 1
        mix.inputs["Facts"].default_value = 1
    """
    assert errors(checker, code) == [(5, "unknown-socket")]


def test_a_renamed_socket_is_fixed_in_its_literal(checker: Checker) -> None:
    code = "import bpy\nbpy.data.materials[0].node_tree.nodes['Principled BSDF'].inputs['Specular']"
    (finding,) = (one for one in checker.check(code) if one.rule == "unknown-socket")
    assert finding.fix is not None
    assert finding.fix.edits[0].text == "'Specular IOR Level'"


def test_a_property_that_became_a_socket_is_told_but_not_renamed(checker: Checker) -> None:
    code = "import bpy\ntree = bpy.data.node_groups.new('g', 'CompositorNodeTree')\n"
    (found,) = checker.check(f"{code}tree.nodes.new('CompositorNodeColorBalance').lift = (1, 1, 1)\n")
    assert found.rule == "unknown-attribute"
    assert any("inputs[" in path for path in found.instead)
    assert found.fix is None


@pytest.mark.parametrize(
    ("code", "told"),
    [
        # Not what every struct has of a like name: its own few members.
        ("bpy.data.actions[0].layers[0].strips[0].channelbags.ensure(0)", " It has `new`, `remove`."),
        ("bpy.context.object.modifiers['Mine'].segmants = 3", " Closest: `BevelModifier.segments`."),
        ("bpy.context.object.id_propertys_ensure()", " Closest: `id_properties_ensure`."),
        ("bpy.context.object.locaton", " Closest: `location`."),
        ("bpy.context.object.keyframe_add('location')", " Closest: `keyframe_insert`, `keyframe_delete`."),
        ("bpy.context.scene.cycles.denoise = True", " Closest: `use_denoising`, `denoiser`."),
        # Of classes below that of all collections it has nothing.
        ("bpy.data.pointclouds.new('x').points.add(4)", "sets how many there are: `pointcloud.resize(3)`."),
        ("bpy.data.hair_curves.new('x').curves.add(4)", "points each has: `curves.add_curves([4, 4])`."),
    ],
)
def test_what_may_be_meant_is_told(checker: Checker, code: str, told: str) -> None:
    (found,) = checker.check(f"import bpy\n{code}\n")
    assert (found.rule, found.severity) == ("unknown-attribute", "error")
    assert found.message.endswith(told)


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("bpy.context.selected", " Closest: `selected_objects`, `selected_nodes`, `selected_strips`."),
        ("bpy.ops.armature.bone_add()", " Closest: `armature.bone_primitive_add`."),
        (
            "bpy.types.NodeSocketInteger",
            " Closest: `NodeSocketInt`, `NodeSocketImage`, `NodeSocketIntFactor`.",
        ),
        ("import blf\nblf.size(0, 20, 72)", "Use `blf.size(size=…)`. Scale the size by dpi / 72 yourself."),
        ("import blf\nblf.size(0, 20, 72, 1)", "takes 2 arguments by place: `size(fontid, size, /)`."),
        ("bpy.context.object.modifiers.new('x', 'SUBDIVISION_SURFACE')", " Closest: `SUBSURF`."),
        ("bpy.context.object.modifiers.new('x', 'SUBDIVISION')", " Closest: `SUBSURF`."),
        ("bpy.context.object.constraints.new('INVERSE_KINEMATICS')", " Closest: `IK`."),
    ],
)
def test_what_counts_most_and_what_is_labelled_so_is_told_once(
    checker: Checker, code: str, told: str
) -> None:
    (found,) = checker.check(f"import bpy\n{code}\n")
    assert found.message.endswith(told)


@pytest.mark.parametrize(
    ("code", "meant", "not_meant"),
    [
        ("bpy.ops.wm.fbx_export(filepath='x')", "export_scene.fbx", "fbx_import"),
        ("bpy.ops.object.deselect_all()", "object.select_all", ""),
        ("bpy.data.curves.new('x', 'FONT').text = 'x'", "body", ""),
        ("bpy.context.object.rigid_body.bounciness = 1", "restitution", ""),
        ("bpy.context.object.constraints.new('IK').chain_length = 2", "chain_count", ""),
        ("bpy.ops.wm.usd_export(filepath='x', use_selection=True)", "selected_objects_only", "filter_blender"),
        ("bpy.types.FluidDomainSettings.resolution_divisions", "resolution_max", ""),
        ("m.attributes.new('x', 'FLOAT_VECTOR', 'POINT').data[0].value", "vector", "values"),
        ("bpy.context.object.constraints.new('FOLLOW_PATH').forward_axis = 'FORWARD_NEGATIVE_Z'",
         "TRACK_NEGATIVE_Z", "FORWARD_Z"),
        ("bpy.ops.wm.obj_export(filepath='x', forward_axis='FORWARD_NEGATIVE_Z')", "NEGATIVE_Z", ""),
        ("m.attributes.new('x', 'FLOAT_COLOR', 'VERTEX')", "AttributeGroupMesh", "AttributeGroupPointCloud"),
        ("m.attributes.new('x', 'FLOAT_COLOR', 'LOOP')", "CORNER", "EDGE"),
    ],
)  # fmt: skip
def test_names_are_told_by_what_menus_call_them(
    checker: Checker, code: str, meant: str, not_meant: str
) -> None:
    (finding,) = checker.check(f"import bpy\nm = bpy.data.meshes.new('m')\n{code}\n")
    told = finding.message.rpartition("5.")[2] if not_meant else finding.message
    assert f"`{meant}`" in finding.message or f".{meant}." in finding.message
    assert not not_meant or f"`{not_meant}`" not in told


def test_of_what_may_have_several_owners_the_usual_one_is_told(checker: Checker) -> None:
    (found,) = checker.check("import bpy\nbpy.context.object.data.attributes.new('x', 'FLOAT', 'LOOP')\n")
    assert found.symbol == "bpy.types.AttributeGroupMesh.new(domain):LOOP"
    assert found.instead == ("CORNER",)


def test_what_blender_lets_pass_is_a_warning(checker: Checker) -> None:
    (found,) = checker.check("import bpy\nbpy.context.object.driver_remove('locaton')\n")
    assert (found.rule, found.severity) == ("unknown-attribute", "warning")


def test_a_keyword_that_is_none_is_the_one_finding_of_a_call(checker: Checker) -> None:
    call = "strips.new_effect(name='x', type='COLOR', channel=1, frame_start=1{})"
    code = f"import bpy\nstrips = bpy.context.scene.sequence_editor_create().strips\n{call}\n"
    assert [one.rule for one in checker.check(code.format(", frame_end=9"))] == ["unknown-keyword"]
    assert [one.rule for one in checker.check(code.format(""))] == ["refused-call"]


def test_old_code_about_collections_is_told_with_what_took_its_place(checker: Checker) -> None:
    code = "import bpy\nbpy.context.scene.objects.link(bpy.context.object)\nbpy.context.object.data.use_auto_smooth"
    first, second = (one for one in checker.check(code) if one.rule == "unknown-attribute")
    assert first.symbol == "bpy.types.SceneObjects.link"
    assert "bpy.types.CollectionObjects.link" in first.instead
    assert second.symbol == "bpy.types.Mesh.use_auto_smooth"


def test_operators_and_names_that_other_builds_have_are_no_finding(checker: Checker) -> None:
    code = """
        import bpy
        class P(bpy.types.Panel):
            def draw(self, context):
                self.layout.operator("WM.save_mainfile")
                self.layout.operator("wm.console_toggle")
                self.layout.prop(context.preferences.inputs, "ndof_deadzone")
                self.layout.operator("wm.no_such")
    """
    assert errors(checker, code) == [(8, "unknown-operator")]


def test_every_text_by_which_a_layout_finds_a_property_is_read(checker: Checker) -> None:
    code = """
        import bpy
        class P(bpy.types.Panel):
            def draw(self, context):
                ob = context.object
                self.layout.prop_search(ob, "parent", bpy.data, "object")
                self.layout.prop_search(ob, "parent", search_property="object", search_data=bpy.data)
                self.layout.prop_search(ob, "parent", bpy.data, "objects", item_search_property="any")
                self.layout.template_list("UI_UL_list", "any", ob, "material_slot", ob, "active_material_index")
                self.layout.template_list("UI_UL_list", "", ob, "material_slots", ob, "active_material_indx")
                self.layout.template_color_ramp(ob.active_material, "colour")
                self.layout.template_color_ramp(self.found(), "colour")
    """
    places = [(line, "unknown-attribute") for line in (6, 7, 9, 10, 11)]
    assert errors(checker, code) == places


def test_files_of_a_package_know_what_the_others_register(checker: Checker) -> None:
    files = {
        "addon/__init__.py": "import bpy\nbpy.types.Scene.mine = bpy.props.IntProperty()",
        "addon/ui.py": "import bpy\nbpy.context.scene.mine\nbpy.context.scene.yours",
    }
    reads = checker.read_files(files)
    package = checker.package()
    for read in reads.values():
        package.add(read.analysis)
    found = checker.check(reads["addon/ui.py"], package)
    assert [one.symbol for one in found if one.severity == "error"] == ["bpy.types.Scene.yours"]


def test_nodes_that_went_or_never_were_are_told(checker: Checker) -> None:
    code = """
import bpy
nodes = bpy.data.materials.new("a").node_tree.nodes
nodes.new("ShaderNodeTexMusgrave")
nodes.new(type="ShaderNodeTexNoize")
nodes.new("ShaderNodeTexNoise")
nodes.new("MyOwnNode")
group = bpy.data.node_groups.new("g", "GeometryNodeTree")
group.interface.new_socket("A", socket_type="NodeSocketFloaty")
group.interface.new_socket("B", socket_type="NodeSocketFloat")

class Own(bpy.types.ShaderNodeCustomGroup):
    bl_idname = "ShaderNodeOfMine"

nodes.new("ShaderNodeOfMine")
"""
    found = [one for one in checker.check(code) if one.rule == "unknown-node"]
    assert [one.span.line for one in found] == [4, 5, 9]
    assert "bpy.types.ShaderNodeTexNoise" in found[0].instead
    assert "`ShaderNodeTexNoise`" in found[1].message


def test_values_that_only_blender_makes_are_no_finding(checker: Checker) -> None:
    code = """
        import bpy
        kind = bpy.context.object.particle_systems[0].settings.type
        kind == 'SPRAYFOAM'
        kind == 'REACTOR'
    """
    assert [(one.rule, one.span.line) for one in checker.check(dedent(code))] == [("never-true", 5)]


def test_the_name_that_registering_gives_a_property_is_a_keyword(checker: Checker) -> None:
    code = """
        import bpy
        bpy.types.Scene.one = bpy.props.IntProperty(attr="one", name="One")
        bpy.types.Scene.two = bpy.props.IntProperty(atr="two", name="Two")
    """
    assert errors(checker, code) == [(4, "unknown-keyword")]


def test_a_key_of_max_is_given_each_of_what_is_compared(checker: Checker) -> None:
    code = """
        import bpy
        largest = (0, "")
        for ob in bpy.data.objects:
            largest = max(largest, (len(ob.modifiers), ob.name), key=lambda pair: pair[0])
            max(3, ob.location, key=lambda one: one[0])
    """
    assert errors(checker, code) == []


def test_a_function_is_read_with_all_that_calls_pass(checker: Checker) -> None:
    """An attribute holds one of five classes in the end; that some of them lack it is no error."""
    code = """
        import bpy
        class Cache:
            def __init__(self, holder):
                self.holder = holder
            def end(self):
                self.holder.frame_end = 3
                self.holder.nowhere = 3
        def caches(scene, surface: bpy.types.DynamicPaintSurface):
            yield Cache(scene.rigidbody_world)
            yield from others(surface)
        def others(surface):
            yield Cache(bpy.context.object.modifiers.new("x", "CLOTH"))
            yield Cache(bpy.context.object.particle_systems[0])
            yield Cache(surface)
        caches(bpy.context.scene, None)
    """
    assert errors(checker, code) == [(8, "unknown-attribute")]


def test_what_took_the_place_of_a_name_is_judged_on(checker: Checker) -> None:
    code = """
        import bpy
        strips = bpy.context.scene.sequence_editor.sequences
        strips[0].channel
        strips[0].nowhere
        isinstance(strips[0], bpy.types.EffectSequence)
    """
    assert errors(checker, code) == [(3, "unknown-attribute"), (5, "unknown-attribute"), (6, "unknown-name")]


def test_a_parameter_called_as_usual_has_lost_what_its_class_lost(checker: Checker) -> None:
    code = """
        def settings(brush):
            brush.image_tool
            return brush.size
        def others(brush):
            brush.image_tol
            return brush.size
        def of_its_own(brush):
            brush.image_tool, brush.bristles
    """
    assert errors(checker, code) == [(3, "unknown-attribute")]
    own = "class Tool:\n    def __init__(self):\n        self.image_tool = 1\n"
    assert errors(checker, own + dedent(code)) == []


def test_who_goes_on_has_a_value_that_has_the_name(checker: Checker) -> None:
    code = """
        import bpy
        layer = bpy.context.object.data.layers.active
        layer.hide
        layer.nowhere
    """
    assert errors(checker, code) == [(5, "unknown-attribute")]


def test_a_class_with_a_computed_name_is_hardly_one_that_is_gone(checker: Checker) -> None:
    code = """
        import bpy
        for name in ("One", "Two"):
            bpy.utils.register_class(type(name, (bpy.types.Panel,), {}))
        bpy.types.One
        bpy.types.EffectSequence
    """
    assert errors(checker, code) == [(6, "unknown-name")]


def test_a_name_whose_value_would_be_refused_is_not_fixed(checker: Checker) -> None:
    code = "import bpy\nimage = bpy.data.images.new('image', 4, 4)\nimage.use_alpha = {}\n"
    (found,) = checker.check(code.format("True"))
    assert found.instead == ("bpy.types.Image.alpha_mode",)
    assert found.fix is None
    (found,) = checker.check(code.format("'NONE'"))
    assert found.fix is not None


def test_the_socket_that_makes_room_for_others_is_not_told_by_its_place(checker: Checker) -> None:
    code = """
        import bpy
        tree = bpy.data.node_groups.new("tree", "GeometryNodeTree")
        node = tree.nodes.new("GeometryNodeIndexSwitch")
        node.index_switch_items.new()
        node.inputs[3].default_value = 4.0
    """
    assert not checker.check(dedent(code))


_STROKE = """
import bpy
drawing = bpy.data.grease_pencils.new("g").layers.new("L").frames.new(1).drawing
drawing.add_strokes([3])
stroke = drawing.strokes[0]
"""
_NOISE = 'import bpy\nnoise = bpy.data.materials["M"].node_tree.nodes.new("ShaderNodeTexNoise")\n'
_MEMBERS = "_bpy_internal.grease_pencil.stroke.GreasePencilStroke"


@pytest.mark.parametrize(
    ("code", "instead", "fix"),
    [
        # Of classes, operators, functions and nodes that took the place of others: what those had.
        (f"{_STROKE}stroke.use_cyclic = True", f"{_MEMBERS}.cyclic", ""),
        (f"{_STROKE}stroke.points[0].pressure = 1", f"{_MEMBERS}Point.radius", ""),
        (f"{_STROKE}stroke.points.add(2)", f"{_MEMBERS}.add_points", ""),
        (f"{_STROKE}drawing.strokes.new()", "bpy.types.GreasePencilDrawing.add_strokes", ""),
        (
            "import bpy\nbpy.ops.wm.obj_export(filepath='x', use_selection=True)",
            "bpy.ops.wm.obj_export(export_selected_objects)",
            "export_selected_objects",
        ),
        (
            "import bpy\nbpy.ops.object.modifier_add(type='GP_THICK')",
            "bpy.ops.object.modifier_add(type):GREASE_PENCIL_THICKNESS",
            "'GREASE_PENCIL_THICKNESS'",
        ),
        (
            "import bpy\nbpy.context.object.modifiers.new('N', 'GP_NOISE')",
            "bpy.types.ObjectModifiers.new(type):GREASE_PENCIL_NOISE",
            "'GREASE_PENCIL_NOISE'",
        ),
        (f"{_NOISE}noise.inputs['Dimension']", 'bpy.types.ShaderNodeTexNoise.inputs["Roughness"]', ""),
        # Names that others resemble, and that mean another thing.
        ("import bpy\nbpy.context.scene.cycles.aa_samples = 4", "", ""),
        ("import bpy\nbpy.app.version_char", "", ""),
        (
            "import bpy\nbpy.ops.armature.armature_layers(layers=[True] * 32)",
            "bpy.types.BoneCollection.is_visible",
            "",
        ),
    ],
)
def test_what_took_the_place_is_told_and_written_only_where_it_means_the_same(
    checker: Checker, code: str, instead: str, fix: str
) -> None:
    (found,) = (one for one in checker.check(code) if one.severity == "error")
    assert "never had" not in found.message
    assert (found.instead[0] if found.instead else "") == instead
    assert (found.fix.edits[0].text if found.fix and found.fix.sure else "") == fix


def test_a_member_of_a_lost_class_is_looked_up_where_the_new_class_lacks_it(checker: Checker) -> None:
    code = "import bpy\nbpy.types.AssetHandle.{}\n"
    first, *_ = checker.check(code.format("get_full_library_path(None, None)"))
    assert first.fix is None
    assert first.instead == ("bpy.types.AssetRepresentation.full_library_path",)
    first, *_ = checker.check(code.format("local_id"))
    assert first.instead == ("bpy.types.AssetRepresentation",)


def test_an_argument_by_place_is_named_only_where_no_parameter_is_gone(checker: Checker) -> None:
    code = "import bpy\nstrips = bpy.context.scene.sequence_editor.strips\n"
    new = 'strips.new_effect("Title", "COLOR", 2, 1, 25)'
    (found,) = (one for one in checker.check(code + new) if one.rule == "positional-argument")
    assert found.fix is None
    assert "The length is frame_end - frame_start." in found.message
    (found,) = checker.check('import bpy\nbpy.context.object.shape_key_add("Smile")')
    assert found.fix is not None
    assert found.fix.sure
    assert found.fix.edits[0].text == "name="


def test_a_new_name_is_not_sure_where_the_call_gives_what_it_does_not_take(checker: Checker) -> None:
    code = "import bpy\nbpy.ops.sculpt.dirty_mask({})\n"
    for given, sure in (("", True), ("dirty_only=True", False)):
        found = next(one for one in checker.check(code.format(given)) if one.rule == "unknown-operator")
        assert found.fix is not None
        assert found.fix.sure is sure


def test_a_value_that_wants_a_setting_first_is_no_sure_fix(checker: Checker) -> None:
    (finding,) = checker.check(
        "import bpy\nbpy.context.scene.render.image_settings.file_format = 'AVI_JPEG'\n"
    )
    assert "'FFMPEG' is taken only with media_type='VIDEO'" in finding.message
    assert finding.fix is not None
    assert not finding.fix.sure


def test_what_one_of_several_owners_takes_is_not_denied(checker: Checker) -> None:
    """An object's modifiers take a name and a type, a curve's a type: whichever is read last."""
    code = (
        "import bpy\nobj = bpy.context.object\ncurve = obj.animation_data.drivers[0]\n"
        "one = obj.modifiers if obj.name else curve.modifiers\n"
        "two = curve.modifiers if obj.name else obj.modifiers\n"
    )
    assert checker.check(f"{code}one.new('x', 'SUBSURF')\ntwo.new('x', 'SUBSURF')\n") == []
    assert checker.check(f"{code}one.new(type='NOISE')\ntwo.new(name='x', type='SUBSURF')\n") == []
    found = checker.check(f"{code}one.new(type='NOTHING')\ntwo.new(type='NOTHING')\n")
    assert [row.rule for row in found] == ["unknown-value", "unknown-value"]


@pytest.mark.parametrize(
    ("code", "names"),
    [
        (
            "tree = bpy.data.node_groups.new('x', 'ShaderNodeTree')\ntree.nodes.new('ShaderNodeMix').inputs['Fac']",
            "`bpy.types.ShaderNodeMix` has no socket 'Fac', as what it took the place of had",
        ),
        (
            "bpy.ops.wm.obj_export(filepath='x', use_selection=True)",
            "`bpy.ops.wm.obj_export` takes no `use_selection`, as what it took the place of did",
        ),
    ],
)
def test_what_the_script_writes_is_named_before_what_it_took_the_place_of(
    rule_checker: Checker, code: str, names: str
) -> None:
    [finding] = rule_checker.check(f"import bpy\n{code}\n", rules=["unknown-socket", "unknown-keyword"])
    assert finding.message.startswith(f"{names}: ")


def test_what_holds_a_thing_is_told_where_the_thing_is_asked_to_do_it(checker: Checker) -> None:
    code = """
        import bpy
        ob = bpy.data.objects["Cube"]
        for modifier in ob.modifiers:
            modifier.remove()
        bpy.context.scene.collection.append(ob)
    """
    removing, appending = checker.check(dedent(code))
    assert ".modifiers.remove(modifier)" in removing.message
    assert removing.instead == ("bpy.types.ObjectModifiers.remove",)
    assert appending.instead == ("bpy.types.CollectionObjects.link", "bpy.types.CollectionChildren.link")
    assert removing.fix is None
