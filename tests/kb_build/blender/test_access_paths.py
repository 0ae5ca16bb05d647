"""How an instance of a class is reached: an expression that leads there, by the way a script would go."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender

from kb_build.blender.access_paths import reached_expressions
from kb_build.flow.blender.symbols import BaseSymbols
from kb_build.index.empty_ways import EmptyWays
from kb_build.symbols.flag_names import ITERATED, WITHOUT_AREA, WITHOUT_SHOWN
from kb_build.symbols.records import Symbol

if TYPE_CHECKING:
    from pathlib import Path

    from kb_build.blender.extract_reader import Extract

TYPES = "bpy.types."


def cls(name: str, base: str = "bpy_struct", **more: object) -> Symbol:
    return Symbol(TYPES + name, "class", "bpy.types", base=TYPES + base, **more)  # type: ignore[arg-type]


def prop(path: str, target: str, kind: str = "pointer") -> Symbol:
    owner = path.rpartition(".")[0]
    return Symbol(TYPES + path, "property", TYPES + owner, type=kind, target=target)


def member(name: str, target: str) -> Symbol:
    return Symbol(f"bpy.context.{name}", "context", "bpy.context", type="pointer", target=target)


SMALL = [
    cls("Context"), cls("BlendData"), cls("ID"), cls("Object", "ID", label="Object"), cls("Mesh", "ID", label="Mesh"),
    cls("Modifier"), cls("ClothModifier", "Modifier", label="Cloth Modifier"), cls("ClothSettings"),
    cls("Vertex"), cls("Far"),
    member("object", "Object"), member("active_nla_strip", "Far"),
    prop("BlendData.objects", "Object", "collection"), prop("BlendData.meshes", "Mesh", "collection"),
    prop("Object.modifiers", "Modifier", "collection"), prop("Object.data", "ID"),
    prop("ClothModifier.settings", "ClothSettings"), prop("Mesh.vertices", "Vertex", "collection"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("name", "expression"),
    [
        ("Object", "bpy.context.object"),
        ("ClothModifier", 'bpy.context.object.modifiers["Cloth"]'),
        ("ClothSettings", 'bpy.context.object.modifiers["Cloth"].settings'),
        ("Mesh", "bpy.context.object.data"),
        ("Vertex", "bpy.context.object.data.vertices[0]"),
        ("Context", "bpy.context"),
        ("BlendData", "bpy.data"),
    ],
)
def test_takes_the_shortest_path(name: str, expression: str) -> None:
    assert reached_expressions(SMALL, names={"ClothModifier": "Cloth"})[name] == expression


def test_a_key_is_the_name_that_blender_gives_or_an_index() -> None:
    named = reached_expressions(SMALL, names={"Modifier": "Any", "ClothModifier": 'Drape "2"'})
    assert named["ClothSettings"] == 'bpy.context.object.modifiers["Drape \\"2\\""].settings'
    unnamed = reached_expressions(SMALL)
    assert unnamed["ClothSettings"] == "bpy.context.object.modifiers[0].settings"


def test_what_a_pointer_leads_to_only_by_chance_is_sought_elsewhere() -> None:
    symbols = [
        *SMALL, cls("NodeTree", "ID"), cls("TextureNodeTree", "NodeTree"), prop("Object.tree", "NodeTree"),
        prop("Mesh.texture_tree", "TextureNodeTree"),
    ]  # fmt: skip
    assert reached_expressions(symbols)["TextureNodeTree"] == "bpy.context.object.data.texture_tree"


def test_of_two_ways_the_one_is_taken_that_scripts_take() -> None:
    symbols = [
        *SMALL, cls("Layer"), cls("Layers"), prop("Mesh.clone", "Layer"),
        replace(prop("Mesh.layers", "Layer", "collection"), collection="Layers"),
        prop("Layers.active", "Layer"),
    ]  # fmt: skip
    assert reached_expressions(symbols)["Layer"] == "bpy.context.object.data.layers.active"
    used = {f"{TYPES}Object.data": 90, f"{TYPES}Mesh.clone": 60}
    assert reached_expressions(symbols, used)["Layer"] == "bpy.context.object.data.clone"
    used = {f"{TYPES}Object.data": 90, f"{TYPES}Mesh.layers": 60}
    assert reached_expressions(symbols, used)["Layer"] == "bpy.context.object.data.layers[0]"


def test_a_collection_is_reached_and_no_way_leads_through_it() -> None:
    objects = replace(prop("BlendData.objects", "Object", "collection"), collection="BlendDataObjects")
    symbols = [cls("BlendDataObjects"), objects, *SMALL, prop("BlendDataObjects.far", "Far")]
    found = reached_expressions(symbols)
    assert found["BlendDataObjects"] == "bpy.data.objects"
    assert "Far" not in found


def test_what_a_loop_alone_gives_is_called_as_in_the_loop() -> None:
    parts = replace(prop("Object.far_parts", "Far", "collection"), flags=(ITERATED,))
    symbols = [*SMALL, parts, cls("Beyond"), prop("Far.beyond", "Beyond")]
    found = reached_expressions(symbols)
    assert found["Far"] == "far_part"
    assert "Beyond" not in found
    assert (
        EmptyWays(symbols, {TYPES + name: way for name, way in found.items()}).last_empty("Far") == parts.path
    )
    # What is reached without one keeps its way.
    assert reached_expressions([*symbols, prop("Mesh.far", "Far")])["Far"] == "bpy.context.object.data.far"


@pytest.mark.parametrize("flag", [WITHOUT_AREA, WITHOUT_SHOWN])
def test_a_member_of_the_context_that_is_mostly_none_is_what_the_way_lacks(flag: str) -> None:
    view = [cls("Region"), cls("View2D"), prop("Context.region", "Region"), prop("Region.view2d", "View2D")]
    symbols = [*SMALL, *view, replace(member("region", "Region"), flags=(flag,))]
    found = {TYPES + name: way for name, way in reached_expressions(symbols).items()}
    assert found[f"{TYPES}View2D"] == "bpy.context.region.view2d"
    ways = EmptyWays(symbols, found)
    assert {ways.last_empty(name) for name in ("Region", "View2D")} == {"bpy.context.region"}
    assert ways.last_empty("Object") == ""


def test_a_popup_is_the_last_way_to_a_region() -> None:
    symbols = [
        *SMALL,
        cls("Region"),
        prop("Context.region_popup", "Region"),
        prop("Context.region", "Region"),
    ]
    assert reached_expressions(symbols, {f"{TYPES}Context.region": 20})["Region"] == "bpy.context.region"


def test_a_ramp_is_reached_on_the_node_that_has_one() -> None:
    node = "ShaderNodeValToRGB"
    symbols = [
        *SMALL, cls("Material", "ID"), cls("ShaderNodeTree", "ID"), cls("Node"), cls("ColorRamp"),
        cls("ColorRampElement"),
        cls(node, "Node", trees=("ShaderNodeTree",)), prop("Object.active_material", "Material"),
        prop("Material.node_tree", "ShaderNodeTree"), prop("ShaderNodeTree.nodes", "Node", "collection"),
        prop("ClothModifier.color_ramp", "ColorRamp"), prop(f"{node}.color_ramp", "ColorRamp"),
        prop("ColorRamp.elements", "ColorRampElement", "collection"),
    ]  # fmt: skip
    found = reached_expressions(symbols)
    way = "bpy.context.object.active_material.node_tree.nodes[0].color_ramp"
    assert (found["ColorRamp"], found["ColorRampElement"]) == (way, f"{way}.elements[0]")


def test_an_unreachable_class_has_no_expression() -> None:
    assert "Far" not in reached_expressions(SMALL)  # a context member that only an editor has


def test_a_cycle_of_classes_ends() -> None:
    found = reached_expressions(
        [*SMALL, prop("ClothSettings.again", "Object"), prop("Object.self", "Object")]
    )
    assert found["Object"] == "bpy.context.object"


def test_a_node_is_reached_through_a_tree_that_takes_it() -> None:
    symbols = [
        *SMALL,
        cls("Scene", "ID"), cls("NodesModifier", "Modifier", label="Nodes Modifier"), cls("NodeTree", "ID"),
        cls("CompositorNodeTree", "NodeTree"), cls("GeometryNodeTree", "NodeTree"), cls("Node"),
        cls("GeometryNodeCube", "Node", label="Cube", trees=("GeometryNodeTree",)),
        cls("CompositorNodeBlur", "Node", label="Blur", trees=("CompositorNodeTree",)), cls("Items"),
        member("scene", "Scene"), prop("Scene.compositing_node_group", "CompositorNodeTree"),
        prop("NodesModifier.node_group", "GeometryNodeTree"), prop("NodeTree.nodes", "Node", "collection"),
        prop("GeometryNodeCube.items", "Items"),
    ]  # fmt: skip
    names = {"NodesModifier": "GeometryNodes", "GeometryNodeCube": "Cube", "CompositorNodeBlur": "Blur"}
    found = reached_expressions(symbols, names=names)
    cube = 'bpy.context.object.modifiers["GeometryNodes"].node_group.nodes["Cube"]'
    assert found["GeometryNodeCube"] == cube
    assert found["Items"] == f"{cube}.items"
    assert found["CompositorNodeBlur"] == 'bpy.context.scene.compositing_node_group.nodes["Blur"]'


def test_a_shaders_node_is_reached_where_blender_puts_it() -> None:
    symbols = [
        *SMALL, cls("Scene", "ID"), cls("World", "ID"), cls("Material", "ID"), member("scene", "Scene"),
        prop("Scene.world", "World"), prop("Object.active_material", "Material"),
        cls("Background", trees=("ShaderNodeTree",)), cls("Glossy", trees=("ShaderNodeTree",)),
    ]  # fmt: skip
    found = reached_expressions(symbols, names={"Background": "Back"}, places={"Background": "World"})
    assert found["Background"] == 'bpy.context.scene.world.node_tree.nodes["Back"]'
    assert found["Glossy"] == "bpy.context.object.active_material.node_tree.nodes[0]"


# Of Blender itself


@pytest.fixture(scope="module")
def reached(base: Path) -> dict[str, str]:
    with closing(BaseSymbols(base)) as symbols:
        return {
            row.path.removeprefix(TYPES): row.reached
            for row in symbols.members("bpy.types")
            if row.kind == "class" and row.reached
        }


@pytest.mark.parametrize(
    ("name", "expression"),
    [
        ("ClothSettings", 'bpy.context.object.modifiers["Cloth"].settings'),
        ("ClothCollisionSettings", 'bpy.context.object.modifiers["Cloth"].collision_settings'),
        ("RigidBodyObject", "bpy.context.object.rigid_body"),
        ("RigidBodyWorld", "bpy.context.scene.rigidbody_world"),
        ("CyclesRenderSettings", "bpy.context.scene.cycles"),
        ("RenderSettings", "bpy.context.scene.render"),
        ("AddonPreferences", 'bpy.context.preferences.addons["cycles"].preferences'),
        ("ViewLayer", "bpy.context.view_layer"),
        ("MeshUVLoopLayer", "bpy.context.object.data.uv_layers.active"),
        ("ShaderNodeBsdfPrincipled", 'bpy.context.object.active_material.node_tree.nodes["Principled BSDF"]'),
        ("ShaderNodeBackground", 'bpy.context.scene.world.node_tree.nodes["Background"]'),
        ("ShaderNodeEmission", 'bpy.context.object.active_material.node_tree.nodes["Emission"]'),
        ("ActionLayer", 'bpy.context.object.animation_data.action.layers["Layer"]'),
        ("ParticleSystem", 'bpy.context.object.particle_systems["ParticleSystem"]'),
        ("SoftBodyModifier", 'bpy.context.object.modifiers["Softbody"]'),
        ("GeometryNodeTree", 'bpy.context.object.modifiers["GeometryNodes"].node_group'),
        ("NodeTree", "bpy.data.node_groups[0]"),
        ("PoseBone", 'bpy.context.object.pose.bones["Bone"]'),
        ("KinematicConstraint", 'bpy.context.object.pose.bones["Bone"].constraints["IK"]'),
        ("TrackToConstraint", 'bpy.context.object.constraints["Track To"]'),
        (
            "RepeatItem",
            'bpy.context.object.modifiers["GeometryNodes"].node_group.nodes["Repeat Output"].active_item',
        ),
        (
            "NodeGeometryBakeItem",
            'bpy.context.object.modifiers["GeometryNodes"].node_group.nodes["Bake"].active_item',
        ),
        (
            "GeometryNodeMenuSwitch",
            'bpy.context.object.modifiers["GeometryNodes"].node_group.nodes["Menu Switch"]',
        ),
        ("NlaStrip", 'bpy.context.object.animation_data.nla_tracks["NlaTrack"].strips[0]'),
    ],
)
def test_blenders_classes_are_reached_as_scripts_reach_them(
    reached: dict[str, str], name: str, expression: str
) -> None:
    assert reached[name] == expression


@pytest.mark.blender
def test_blender_itself_gives_the_names_in_the_ways_to_modifiers(reached: dict[str, str]) -> None:
    bpy = pytest.importorskip("bpy")
    bpy.ops.mesh.primitive_cube_add()
    seen = 0
    for item in bpy.types.Modifier.bl_rna.properties["type"].enum_items:
        stack = bpy.context.object.modifiers
        before = {modifier.name for modifier in stack}
        try:
            bpy.ops.object.modifier_add(type=item.identifier)
        except (TypeError, RuntimeError):
            continue
        for modifier in [one for one in stack if one.name not in before]:
            assert f'["{modifier.name}"]' in reached[modifier.bl_rna.identifier], item.identifier
            seen += 1
            stack.remove(modifier)
    assert seen > 40


def test_no_way_goes_by_what_scripts_do_not_take(reached: dict[str, str]) -> None:
    assert len(reached) > 1_500
    assert not [path for path in reached.values() if "clone" in path or "drivers[" in path]


def test_every_expression_is_python_from_a_root(reached: dict[str, str]) -> None:
    assert len(reached) > 1_350
    for expression in reached.values():
        compile(expression, "reached", "eval")
        # A layout is given to what draws, an instance to a loop.
        assert expression.startswith(("bpy.context", "bpy.data", "self.layout", "object_instance"))


def test_no_node_is_placed_in_a_tree_that_refuses_it(extract: Extract, reached: dict[str, str]) -> None:
    holders = {
        "ShaderNodeTree": (".node_tree.",), "GeometryNodeTree": (".node_group.",),
        "CompositorNodeTree": (".compositing_node_group.", "scene.node_tree."), "TextureNodeTree": (".node_tree.",),
    }  # fmt: skip
    for row in extract.symbols:
        if row.trees:
            expression = reached[row.path.removeprefix(TYPES)]
            taken = [*(part for tree in row.trees for part in holders[tree]), "bpy.data.node_groups[0]."]
            assert any(part in expression for part in taken), (
                row.path,
                expression,
            )


def test_a_socket_is_reached_on_a_node_that_has_such_a_one(extract: Extract, reached: dict[str, str]) -> None:
    of_shaders = {
        row.target
        for row in extract.symbols
        if row.kind == "socket" and row.owner.startswith(f"{TYPES}ShaderNode")
        if "hidden-by-default" not in row.flags
    }
    nodes = 'bpy.context.object.modifiers["GeometryNodes"].node_group.nodes'
    for name in ("NodeSocketGeometry", "NodeSocketMatrix", "NodeSocketRotation", "NodeSocketObject"):
        assert name not in of_shaders
        assert reached[name].startswith(nodes), name
    assert "active_material.node_tree" in reached["NodeSocketShader"]


def test_a_socket_that_no_node_has_is_reached_nowhere(extract: Extract, reached: dict[str, str]) -> None:
    owned = {
        row.target if row.target.startswith("NodeSocket") else f"NodeSocket{row.type.title()}"
        for row in extract.symbols
        if row.kind == "socket"
    }
    bases = {row.base for row in extract.symbols}
    leaves = {
        row.path.removeprefix(TYPES)
        for row in extract.symbols
        if row.path.startswith(f"{TYPES}NodeSocket") and row.kind == "class" and row.path not in bases
    }
    assert "NodeSocketTexture" in leaves - owned
    assert [name for name in leaves - owned if name in reached] == []


def test_sockets_of_the_factory_material_are_there(reached: dict[str, str], tmp_path: Path) -> None:
    nodes = "bpy.context.object.active_material.node_tree.nodes"
    present = {
        name: way
        for name, way in reached.items()
        if name.startswith("NodeSocket")
        and way.startswith((f'{nodes}["Principled BSDF"].', f'{nodes}["Material Output"].'))
    }
    assert {"NodeSocketShader", "NodeSocketFloatWavelength", "NodeSocketColor"} <= present.keys()
    script = (
        "import bpy, json, sys\nways = json.load(open(sys.argv[-1]))\n"
        "found = {name: type(eval(way)).__name__ for name, way in ways.items()}\n"
        "json.dump(found, open(sys.argv[-1], 'w'))\n"
    )
    assert told_by_blender(script, tmp_path, present) == {name: name for name in present}
