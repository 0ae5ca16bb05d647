"""What an answer shows of a symbol: everything that a coder needs in one look."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from asking import classes, of_data, paths

from kb_build.symbols.flag_names import BARE_DATA
from kb_build.symbols.flags import is_stand_in, usual_default
from kb_build.symbols.lines import written
from kb_build.symbols.records import Deprecation, EnumItem, Parameter, Symbol
from kb_serve.answer.facts.properties import facts
from kb_serve.answer.render import MarkdownRenderer

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader

ALL = 1_000_000


@pytest.fixture(scope="module")
def renderer(reader: BaseReader) -> MarkdownRenderer:
    return MarkdownRenderer(reader)


def shown(renderer: MarkdownRenderer, symbol: Symbol) -> str:
    return "\n\n".join(block.text for block in renderer.symbol(symbol))


def test_a_property_in_one_look(kb: KnowledgeBase) -> None:
    text = kb.query("bpy.types.ClothSettings.quality").text
    for part in (
        "## `bpy.types.ClothSettings.quality`", "**Quality**", "type: `int`", "default: `5`",
        "range: 1 … ∞ (usual: 1 … 80)",
        'reached as `bpy.context.object.modifiers["Cloth"].settings.quality`', "manual: https://docs.blender.org/",
    ):  # fmt: skip
        assert part in text


@pytest.mark.parametrize(
    ("symbol", "expected"),
    [
        (Symbol("a", "property", type="float", unit="MASS", hard_min=0.0),
         ["type: `float`", "range: 0 … ∞", "unit: kg"]),
        (Symbol("a", "property", type="float", hard_min=-1048574.0, hard_max=1.5707963705062866),
         ["type: `float`", "range: -1048574 … 1.570796"]),
        (Symbol("a", "property", type="float", unit="ROTATION", hard_min=0, hard_max=1, soft_min=0, soft_max=1),
         ["type: `float`", "range: 0 … 1", "unit: radians"]),
        (Symbol("a", "property", type="int[2]", hard_min=-16777216, hard_max=16777216, soft_min=0, soft_max=1048576),
         ["type: `int[2]`", "range: -16777216 … 16777216 (usual: 0 … 1048576)"]),
        (Symbol("a", "property", type="float", soft_min=0.5), ["type: `float`", "usual: 0.5 … ∞, no limit"]),
        (Symbol("a", "property", type="float", array=(3,), default=[1, 2, 3], subtype="XYZ"),
         ["type: `float[3]`", "default: `(1, 2, 3)`", "subtype: XYZ"]),
        (Symbol("a", "property", type="boolean", default=False, flags=("readonly", "library-editable")),
         ["type: `boolean`", "default: `False`", "readonly"]),
        (Symbol("a", "socket", type="value", modes=("m=A", "n=B")), ["type: `value`", "shown when m=A and n=B"]),
        (Symbol("a", "property", type="float", unit="UNHEARD_OF"), ["type: `float`", "unit: unheard_of"]),
        (Symbol("a", "property", type="string", flags=("never-none",)), ["type: `string`"]),
        (Symbol("a", "property", type="pointer", target="A", flags=("never-none",)),
         ["type: `pointer → A`", "cannot be set to `None`"]),
        (Symbol("a", "property", type="pointer", target="A", flags=("never-none", "readonly")),
         ["type: `pointer → A`", "readonly"]),
        (Symbol("a", "property"), []),
    ],
)  # fmt: skip
def test_facts_list_known_properties(symbol: Symbol, expected: list[str]) -> None:
    assert list(facts(symbol)) == expected


def test_every_fact_of_every_property_is_shown(renderer: MarkdownRenderer, reader: BaseReader) -> None:
    for path in of_data(reader, "property", 300):
        symbol = reader.symbol(path)
        assert symbol is not None
        text = shown(renderer, symbol)
        assert f"`{path}`" in text
        assert symbol.description.strip() in text
        assert not symbol.label or f"**{symbol.label}**" in text
        assert (usual_default(symbol) is not None) <= ("default: `" in text)
        assert "readonly" not in symbol.flags or "readonly" in text
        for item in symbol.enum_items if not is_stand_in(symbol) else ():
            assert f"`{item.identifier!r}`" in text
            assert not item.is_taken or item.description in text


def test_an_operator_shows_its_call_with_defaults_and_every_argument(
    kb: KnowledgeBase, reader: BaseReader
) -> None:
    for path in paths(reader, "operator", 100):
        symbol = reader.symbol(path)
        assert symbol is not None
        text = kb.query(path, max_tokens=ALL).text
        if any(parameter.name == "filter_folder" for parameter in symbol.parameters):
            assert all(f"`{parameter.name}`" in text for parameter in symbol.parameters)
            continue
        call = text.partition("```python\n")[2].partition("\n```")[0]
        shown, more = (
            call.removesuffix(" more, see Parameters").split("  # and ") if "#" in call else (call, "0")
        )
        assert symbol.signature.startswith(shown.removesuffix(")"))
        assert shown.count("=") + int(more) == len(symbol.parameters)
        for parameter in symbol.parameters:
            assert f"- `{parameter.name}` (" in text
            assert parameter.description in text
            assert all(repr(item.identifier) in text for item in parameter.enum_items), parameter.name


def test_what_an_operator_only_asks_of_the_file_browser_stands_last(kb: KnowledgeBase) -> None:
    text = kb.query("bpy.ops.wm.obj_export", max_tokens=10_000).text
    call = text.partition("```python\n")[2].partition("\n")[0]
    assert call.startswith("bpy.ops.wm.obj_export(filepath='', check_existing=True, export_animation=False,")
    assert "filter_" not in call
    browsers = text.partition("- of the file browser; a script leaves them out: ")[2].partition("\n")[0]
    assert browsers.startswith("`filter_blender`, `filter_backup`, ")
    assert "`sort_method`" in browsers


def test_of_very_many_arguments_a_call_has_the_first_and_counts_the_others(kb: KnowledgeBase) -> None:
    text = kb.query("bpy.ops.wm.obj_export", max_tokens=10_000).text
    call = text.partition("```python\n")[2].partition("\n```")[0]
    shown, _, more = call.partition("  # and ")
    assert shown.count("=") == 20
    listed = text.partition("**Parameters**\n")[2].partition("- of the file browser")[0].count("\n- `")
    assert more == f"{listed + 1 - 20} more, see Parameters"


def test_a_function_shows_parameters_and_returns(kb: KnowledgeBase) -> None:
    text = kb.query("bpy.types.Object.ray_cast").text
    assert "```python\nObject.ray_cast(origin, direction, " in text
    for part in ("**Parameters**", "- `origin` (float[3], required)", "**Returns**", "- `location`"):
        assert part in text
    text = kb.query("mathutils.Vector.lerp").text
    assert "mathutils.Vector.lerp(other, factor" in text
    assert "- (Vector)" in text


def test_a_class_lists_its_own_members_and_counts_inherited_ones(
    kb: KnowledgeBase, reader: BaseReader
) -> None:
    for path in classes(reader, count=80):
        text = kb.query(path, max_tokens=ALL).text
        for entry in reader.members(path).values():
            if not entry.name.startswith("bl_rna_get_subclass") and entry.kind != "class":
                assert f"- {entry.line}" in text, entry.path
        lineage = list(reader.lineage(path))[1:]
        assert not lineage or "base classes: " + ", ".join(f"`{base.name}`" for base in lineage) in text
        inherited = text.partition("inherited: + ")[2].partition("\n")[0]
        assert len(inherited) < 40 * len(lineage)
        for ancestor in lineage[:-1]:
            own = [e for e in reader.members(ancestor.path).values() if e.kind == "property"]
            assert not own or f" of `{ancestor.name}`" in inherited


def test_a_collection_shows_what_adds_and_removes_its_elements(kb: KnowledgeBase) -> None:
    text = kb.query("bpy.types.Armature.edit_bones").text
    assert (
        "**Functions of `edit_bones`**\n- `new(name)` — Add a new bone (only in Edit Mode)\n- `remove("
        in text
    )
    text = kb.query("bpy.types.Curve.splines").text
    assert "- `new(type)` — Add a new spline to the curve\n" in text
    assert "bl_rna" not in text


def test_a_base_class_names_its_subclasses(kb: KnowledgeBase) -> None:
    text = kb.query("bpy.types.Modifier", max_tokens=ALL).text
    assert "**Subclasses**: " in text
    assert "ClothModifier" in text.split("**Subclasses**: ")[1]


def test_a_node_shows_its_sockets_and_its_trees(kb: KnowledgeBase) -> None:
    text = kb.query("bpy.types.ShaderNodeBsdfPrincipled", max_tokens=ALL).text
    assert "**Inputs and outputs**" in text
    assert '- `inputs["Specular IOR Level"]` · value = 0.5' in text
    assert "node of: ShaderNodeTree" in text


def test_a_node_that_no_tree_takes_is_not_said_to_be_made(kb: KnowledgeBase) -> None:
    text = kb.query("bpy.types.CompositorNodeGamma").text
    assert "no node tree takes it: `nodes.new` refuses it; it takes `ShaderNodeGamma`" in text
    assert "made by" not in text
    assert "reached as" not in text


def test_values_that_are_put_together_at_run_time_are_not_told_by_a_stand_in(kb: KnowledgeBase) -> None:
    text = kb.query("bpy.types.CyclesPreferences.compute_device_type").text
    assert "'NONE'" not in text
    assert "put together while Blender runs" in text
    assert "- `'ShaderNodeTree'` Shader Editor" in kb.query("bpy.types.SpaceNodeEditor.tree_type").text
    told = kb.query("bpy.types.CyclesPreferences", max_tokens=ALL).text
    assert "`compute_device_type` enum —" in told


def test_a_way_to_a_thing_says_what_is_none_on_it(kb: KnowledgeBase) -> None:
    told = "; `compositing_node_group` is `None` on a new Scene: assign `bpy.data.node_groups.new("
    assert told in kb.query("bpy.types.CompositorNodeGlare").text
    path = 'bpy.data.node_groups["Geometry Nodes"].interface.new_socket(…)'
    assert f"reached as `{path}`\n" in kb.query("bpy.types.NodeTreeInterface.new_socket").text


@pytest.mark.parametrize(
    ("path", "told"),
    [
        (
            "CameraBackgroundImage.alpha",
            "; `background_images` is empty (new Camera): add to it by `background_images.new()`",
        ),
        ("VertexGroup.index", "; `vertex_groups` is empty (new Object): add to it by `vertex_groups.new()`"),
        ("MaterialGPencilStyle.fill_color", "; made by `bpy.data.materials.create_gpencil_data(material)`"),
        ("ColorStrip.color", "; `sequence_editor` is `None` on a new Scene; made by"),
        ("WoodTexture.noise_basis", "reached as `bpy.data.textures[0].noise_basis`"),
    ],
)
def test_a_way_leads_through_what_new_things_have_or_says_that_they_lack_it(
    kb: KnowledgeBase, path: str, told: str
) -> None:
    assert told in kb.query(f"bpy.types.{path}").text
    assert "`animation_data_create()`" not in kb.query("bpy.types.Object.location").text
    assert "made by `obj.animation_data_create()`" in kb.query("bpy.types.AnimData.action").text


def test_a_module_lists_names_with_an_underscore_last(kb: KnowledgeBase) -> None:
    text = kb.query("bpy.app.handlers", max_tokens=ALL).text
    assert text.index("`version_update`") < text.index("`_extension_repos_sync`")


def test_a_module_lists_its_contents(kb: KnowledgeBase) -> None:
    text = kb.query("bpy.ops.rigidbody", max_tokens=ALL).text
    assert "**Contents**" in text
    assert "- `bake_to_keyframes(" in text


def test_a_context_member_says_where_it_is_none(kb: KnowledgeBase) -> None:
    assert "`None` where no object is active" in kb.query("bpy.context.object").text
    assert "`None` outside the areas of windows" in kb.query("bpy.context.space_data").text
    assert "provided by: \n" not in kb.query("bpy.context.space_data").text


def test_a_context_member_says_which_editors_provide_it(kb: KnowledgeBase) -> None:
    assert "provided by: " in kb.query("bpy.context.active_bone").text


def test_deprecation_is_shown_with_versions(renderer: MarkdownRenderer) -> None:
    symbol = Symbol("m.a", "property", "m", deprecation=Deprecation("Use b.", "5.0", "6.0"))
    assert "**Deprecated** since 5.0, removal planned for 6.0: Use b." in shown(renderer, symbol)
    symbol = Symbol("m.a", "property", "m", deprecation=Deprecation("Use b.", "5.10", "6.0"))
    assert "**Deprecated** since 5.1, removal planned for 6.0: Use b." in shown(renderer, symbol)
    symbol = Symbol("m.a", "property", "m", deprecation=Deprecation("Use b."))
    assert "**Deprecated**: Use b." in shown(renderer, symbol)


def test_newer_symbols_show_their_version(renderer: MarkdownRenderer, reader: BaseReader) -> None:
    ((path, version),) = reader.rows(
        "SELECT path, version FROM since WHERE path LIKE 'bpy.types.%' AND lacked = '' LIMIT 1"
    )
    for named, expected in ((path, True), ("bpy.types.Object.location", False)):
        symbol = reader.symbol(named)
        assert symbol is not None
        assert (f"since Blender {version}" in shown(renderer, symbol)) is expected
    told = "since Blender 4.2 or a little before (3.4 lacks it)"
    symbol = reader.symbol("bpy.types.GreasePencilArrayModifier")
    assert symbol is not None
    assert told in shown(renderer, symbol)


def test_arguments_tell_type_default_range_unit_and_choices(renderer: MarkdownRenderer) -> None:
    items = tuple(EnumItem(f"I{n}", f"Item {n}", f"Meaning {n}") for n in range(50))
    symbol = Symbol(
        "m.f", "function", "m", signature="f(a, b=1)",
        parameters=(
            Parameter("a", "float", "How big", required=True, hard_min=0, unit="LENGTH"),
            Parameter("b", "enum", default="I0", label="Kind", enum_items=items),
        ),
    )  # fmt: skip
    text = shown(renderer, symbol)
    assert "- `a` (float, required, range 0 … ∞, metres): How big" in text
    assert "- `b` (enum, default `'I0'`): Kind" in text
    assert "… 50 in all" in text
    assert all(f"Meaning {n}" in text for n in range(50))


def test_arrays_of_any_length_are_not_said_to_have_one_element(kb: KnowledgeBase) -> None:
    assert "`index` (int[any length], required" in kb.query("VertexGroup.add").text
    assert "`normals` (float[any length][3], required" in kb.query("Mesh.normals_split_custom_set").text
    assert "`value` (float[1], radians)" in kb.query("bpy.ops.transform.bend").text


def test_undescribed_enum_items_are_all_listed(renderer: MarkdownRenderer) -> None:
    items = tuple(EnumItem(f"ICON_{n}") for n in range(300))
    symbol = Symbol("m.f", "function", "m", parameters=(Parameter("icon", "enum", enum_items=items),))
    text = shown(renderer, symbol)
    assert [item.identifier for item in items if repr(item.identifier) not in text] == []


def test_values_that_were_asked_stand_instead_of_a_stand_in(renderer: MarkdownRenderer) -> None:
    kind = Parameter("kind", "enum", enum_items=(EnumItem("DEFAULT"),), values_asked=("A", "B"))
    text = shown(renderer, Symbol("m.f", "function", "m", parameters=(kind,)))
    assert "in a new file one of 'A', 'B'" in text
    assert "one of 'DEFAULT'" not in text


def test_a_socket_tells_of_those_that_have_its_name_in_other_modes(kb: KnowledgeBase) -> None:
    text = kb.query('FunctionNodeRandomValue.inputs["Min"]').text
    assert "**Others called Min**" in text
    line = '`inputs[2]`, `inputs["Min"]` while it is shown, identifier `Min_001` · value = 0 when data_type=FLOAT'
    assert line in text
    assert "outputs" not in text.partition("**Others")[2].partition("**In")[0]


def test_the_sockets_of_a_zone_are_those_of_a_pair(kb: KnowledgeBase) -> None:
    assert "once it is paired (`pair_with_output`)" in kb.query("GeometryNodeSimulationInput").text
    assert "once it is paired" not in kb.query("GeometryNodeMeshCube").text


@pytest.mark.parametrize(
    "query", ["ShaderNodeMath.inputs", "bpy.types.ShaderNodeMath.inputs", "ShaderNodeMath inputs"]
)
def test_the_sockets_of_a_class_come_before_what_all_nodes_say_of_them(kb: KnowledgeBase, query: str) -> None:
    text = kb.query(query).text
    assert text.startswith("**Inputs of `bpy.types.ShaderNodeMath`**\n- `")
    assert text.index("Value_001") < text.index("## `bpy.types.Node.inputs`")


def test_no_symbol_of_any_kind_fails_to_be_shown(renderer: MarkdownRenderer, reader: BaseReader) -> None:
    for kind in ("module", "class", "property", "function", "operator", "socket", "data", "context", "enum"):
        for path in paths(reader, kind, 150):
            symbol = reader.symbol(path)
            assert symbol is not None
            text = shown(renderer, symbol)
            assert text.startswith(f"## `{written(symbol)}`")
            assert "None" not in text.splitlines()[0]
            assert "\n\n\n\n" not in text


def test_how_a_member_is_reached_is_that_of_its_class(kb: KnowledgeBase, reader: BaseReader) -> None:
    for path in of_data(reader, "property", 60):
        cls = reader.symbol(path.rpartition(".")[0])
        if cls and cls.reached:
            assert (
                f"reached as `{cls.reached}.{path.rpartition('.')[2]}`" in kb.query(path, max_tokens=ALL).text
            )


def test_an_argument_shows_its_default_as_the_call_has_it(renderer: MarkdownRenderer) -> None:
    symbol = Symbol(
        "m.f", "function", "m", signature="f(a, *, b=None, c=Matrix(), d=set(), e=(1, 2), g=3)",
        parameters=(
            Parameter("a", required=True), Parameter("b", "str"), Parameter("c", "Matrix"),
            Parameter("d", "set[enum]"), Parameter("e", default=[1, 2]), Parameter("g", "int", default=3),
            Parameter("h"),
        ),
    )  # fmt: skip
    lines = shown(renderer, symbol).split("**Parameters**\n")[1].split("\n")
    assert lines == [
        "- `a` (required)", "- `b` (str, default `None`)", "- `c` (Matrix, default `Matrix()`)",
        "- `d` (set[enum], default `set()`)", "- `e` (default `(1, 2)`)", "- `g` (int, default `3`)", "- `h`",
    ]  # fmt: skip


def test_a_call_that_is_not_python_shows_the_known_defaults(renderer: MarkdownRenderer) -> None:
    symbol = Symbol("m.f", "function", "m", signature="f(a, [b])", parameters=(Parameter("b", default=1),))
    assert "- `b` (default `1`)" in shown(renderer, symbol)


@pytest.mark.parametrize(
    ("operator", "expected"),
    [
        (
            "mesh.bevel",
            "\n\nOf all that was tried, its poll takes an active object of type 'MESH' in mode 'EDIT'.\n",
        ),
        (
            "rigidbody.connect",
            "its poll takes an active object with what `bpy.ops.rigidbody.object_add()` adds.",
        ),
        # Nothing of its poll: that of another one fails while it works.
        (
            "rigidbody.bake_to_keyframes",
            "Its own script calls `bpy.ops.anim.keyframe_insert_by_name`, which takes an area of any type:",
        ),
        (
            "mesh.knife_tool",
            "its poll takes an area of type VIEW_3D and an active object of type 'MESH' in mode 'EDIT'.",
        ),
        (
            "paintcurve.new",
            "\n\nIts poll took nothing of what was tried (objects of every type in every mode, areas",
        ),
        ("brush.asset_revert", "\n\nWhat its poll takes is not known."),  # it is not asked
    ],
)
def test_an_operator_says_what_its_poll_takes(kb: KnowledgeBase, operator: str, expected: str) -> None:
    assert expected in kb.query(f"bpy.ops.{operator}").text
    assert "its poll" not in kb.query("bpy.ops.mesh.primitive_cube_add").text.lower()


@pytest.mark.parametrize(
    ("collection", "line"),
    [
        ("Annotation.layers", 'items by index, or by their `info`: `layers["…"]`'),
        ("Action.slots", 'items by index, or by their `identifier`: `slots["…"]`'),
        ("Object.modifiers", ""),  # by their name, as everybody expects
        ("Mesh.vertices", ""),
    ],
)
def test_what_items_are_found_by_is_told_where_it_is_no_name(
    kb: KnowledgeBase, collection: str, line: str
) -> None:
    told = [one for one in kb.query(collection).text.splitlines() if one.startswith("items by")]
    assert told == ([line] if line else [])


def test_the_values_that_only_some_trees_take_are_told_by_tree(kb: KnowledgeBase) -> None:
    text = kb.query("bpy.types.NodeGeometryRepeatOutputItems.new").text
    assert "\n  taken only by a repeat output in a shader node tree: 'SHADER'\n" in text


def test_a_socket_is_not_headed_by_what_raises_key_error(kb: KnowledgeBase) -> None:
    assert kb.query('ShaderNodeMix.inputs["A_Color"]').text.startswith(
        "## `bpy.types.ShaderNodeMix.inputs[6]`"
    )


def test_a_setting_without_a_value_says_so(kb: KnowledgeBase) -> None:
    text = kb.query("FFmpegSettings.ffmpeg_preset").text
    assert "default: `''` (made by" in text
    assert "`'GOOD'` in the startup file" in text


def test_a_decorator_is_said_to_be_one(kb: KnowledgeBase) -> None:
    assert (
        "`bpy.app.handlers.persistent` Function decorator for callback functions not to be removed"
        in kb.query("app handlers load_post keeps after new file").text
    )


def test_an_operator_that_makes_data_without_a_class_says_so(renderer: MarkdownRenderer) -> None:
    operator = Symbol("bpy.ops.object.new_add", "operator", flags=(f"{BARE_DATA}bpy.ops.object.old_add",))
    told = "no class for the data of the object that it adds: nothing in them can be read or set."
    assert f"{told} Use `bpy.ops.object.old_add`." in shown(renderer, operator)
    assert told in shown(renderer, Symbol("bpy.ops.object.new_add", "operator", flags=(BARE_DATA,)))
    assert told not in shown(renderer, Symbol("bpy.ops.object.new_add", "operator"))


def test_what_a_call_gave_or_wanted_is_said_of_it(kb: KnowledgeBase) -> None:
    text = kb.query("bpy.types.GeometryNodeTrimCurve.output_template").text
    assert "Gave `None` for every index that was tried: what a node has is in its `outputs`." in text
    assert "Gave `None`" not in kb.query("bpy.types.TextureNodeDistance.input_template").text
    assert "there it raises `SystemError`, “GPU functions" in kb.query("gpu.types.GPUOffScreen").text
    assert "SystemError" not in kb.query("gpu.types.GPUShaderCreateInfo").text


def test_what_ends_blender_is_not_called_refused(kb: KnowledgeBase) -> None:
    text = kb.query("bpy.ops.sculpt.mask_init").text
    assert "**Crashes Blender, as was tried**\n- where there is no undo step yet" in text
    assert "Refused" not in text


def test_a_member_of_a_node_that_no_tree_takes_says_so(kb: KnowledgeBase) -> None:
    text = kb.query("bpy.types.CompositorNodeGamma.input_template").text
    assert (
        "no node tree takes a `CompositorNodeGamma`: `nodes.new` refuses it; it takes `ShaderNodeGamma`"
        in text
    )
    assert "no node tree" not in kb.query("bpy.types.ShaderNode.poll").text


@pytest.mark.parametrize(
    ("path", "told"),
    [
        ("Brush.size", "`brushes` is empty in the start-up file"),
        (
            "BrushGpencilSettings.angle",
            "`brushes` is empty in the start-up file; `gpencil_settings` is `None` on a new Brush (but ",
        ),
        ("BoidRule.name", "`boids` is `None` on a new ParticleSettings; made by"),
        ("BoidState.volume", "`boids` is `None` on a new ParticleSettings; made by"),
        (
            "AnnotationLayer.color",
            "`annotation` is `None` on a new Scene; `layers` is empty (new Annotation): add to it by "
            "`layers.new(name)`",
        ),
        (
            "GreasePencilDrawing.type",
            "`layers` is empty (new GreasePencil): add to it by `layers.new(name)`; "
            "`frames` is empty (new GreasePencilLayer): add to it by `frames.new(frame_number)`",
        ),
        (
            "DepsgraphObjectInstance.matrix_world",
            "a loop gives it: `for object_instance in "
            "bpy.context.evaluated_depsgraph_get().object_instances:`",
        ),
        ("Operator.layout", "`operators` is empty in the start-up file"),
        ("View2D.region_to_view", "`region` is `None` outside the areas of windows"),
        ("AssetRepresentation.name", "`asset` is `None` while the interface shows none"),
        ("MovieClip.display_aspect", "`active_clip` is `None` on a new Scene"),
    ],
)
def test_every_empty_step_of_a_way_is_told(kb: KnowledgeBase, path: str, told: str) -> None:
    (line,) = [
        line for line in kb.query(f"bpy.types.{path}").text.splitlines() if line.startswith("reached as")
    ]
    assert f"; {told}" in line


@pytest.mark.parametrize("path", ["ShaderNodeMath", "World.color", "Mesh.vertices"])
def test_a_step_that_the_start_up_file_has_filled_is_not_called_empty(kb: KnowledgeBase, path: str) -> None:
    (line,) = [
        line for line in kb.query(f"bpy.types.{path}").text.splitlines() if line.startswith("reached as")
    ]
    assert ";" not in line


def test_a_class_that_scripts_call_tells_what_it_takes(kb: KnowledgeBase) -> None:
    text = kb.query("gpu.types.GPUBatch", max_tokens=ALL).text
    parameters, _, functions = text.partition("**Functions**")
    assert "- `type` (enum, required)" in parameters
    assert "one of 'POINTS', 'LINES', 'TRIS'" in parameters
    assert "`__init__" not in functions


def test_the_use_of_a_function_comes_before_very_many_values_of_an_argument(kb: KnowledgeBase) -> None:
    text = kb.query("bpy.types.KeyMapItems.new", max_tokens=ALL).text
    assert text.index("**Used**") < text.index("**Values of `type`**")
