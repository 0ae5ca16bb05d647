"""Expressions are followed through RNA's types, to the symbol that the last step is.

Cases come from the schema: each class by the expression that reaches it, each modifier, constraint and node by the
name that Blender gives it.
"""

from __future__ import annotations

import random
from collections import Counter, defaultdict
from typing import TYPE_CHECKING

import pytest
from asking import SEED, TYPES, classes, first_id, wrong
from whole import IS_WHOLE, examples

from kb_serve.recognise.chains.chains import find_chains
from kb_serve.recognise.resolver import Resolver

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader


def lineage(reader: BaseReader, path: str) -> set[str]:
    return {entry.path for entry in reader.lineage(path)}


def below(reader: BaseReader, base: str) -> Iterator[SymbolEntry]:
    yield from reader.descendants(TYPES + base)


def default_name(entry: SymbolEntry) -> str:
    """What Blender calls a new modifier, constraint or node of a class."""
    return entry.label.removesuffix(" Modifier").removesuffix(" Constraint")


def properties(reader: BaseReader, cls: str) -> list[SymbolEntry]:
    return [entry for entry in reader.members(cls).values() if entry.kind == "property"]


def test_every_way_to_reach_a_class_leads_to_it_or_to_what_it_is(
    kb: KnowledgeBase, reader: BaseReader
) -> None:
    """``reached`` expressions are what answers show: they must be answered themselves, by one of the classes that they
    lead to.
    """
    reached: dict[str, list[str]] = defaultdict(list)
    for path in classes(reader, count=2_000):
        if (symbol := reader.symbol(path)) and symbol.reached:
            reached[symbol.reached].append(path)
    lost: list[tuple[str, str, str]] = []
    asked = sorted(reached)[:: 1 if IS_WHOLE else 3]
    for expression in asked:
        found = first_id(kb.query(expression))
        entry = reader.entry(found)
        leading = (entry.target, entry.collection) if entry else ()
        targets = {TYPES + cls for cls in leading if cls} or {found}
        if not any(targets & lineage(reader, path) for path in reached[expression]):
            lost.append((expression, reached[expression][0], found))
    assert len(asked) > examples(1_000)
    assert len(lost) <= 5, lost


@pytest.mark.parametrize(
    ("name", "cls"),
    [
        ("Subdivision", "SubsurfModifier"), ("TimeOffset", "GreasePencilTimeModifier"), ("Mirror", "MirrorModifier"),
        ("Subdivide", "GreasePencilSubdivModifier"), ("UVWarp", "UVWarpModifier"), ("Array.001", "ArrayModifier"),
    ],
)  # fmt: skip
def test_a_modifier_is_known_by_the_name_that_it_is_made_with(kb: KnowledgeBase, name: str, cls: str) -> None:
    assert first_id(kb.query(f'obj.modifiers["{name}"]')) == TYPES + cls


@pytest.mark.parametrize(
    ("family", "form"),
    [
        ("Modifier", 'bpy.context.object.modifiers["{}"].{}'),
        ("Modifier", "obj.modifiers['{}'].{}"),
        ("Modifier", 'bpy.data.objects["Cube"].modifiers["{}"].{}'),
        ("Modifier", 'C.active_object.modifiers["{}.001"].{} = 3'),
        ("Constraint", 'bpy.context.object.constraints["{}"].{}'),
        ("Constraint", 'arm.pose.bones["Bone"].constraints["{}"].{}'),
        ("ShaderNode", 'mat.node_tree.nodes["{}"].{}'),
        ("ShaderNode", 'bpy.data.materials["M"].node_tree.nodes["{}"].{}'),
        ("ShaderNode", 'bpy.context.scene.world.node_tree.nodes["{}.002"].{}'),
        ("GeometryNode", 'bpy.context.object.modifiers["GeometryNodes"].node_group.nodes["{}"].{}'),
        ("CompositorNode", 'bpy.context.scene.compositing_node_group.nodes["{}"].{}'),
    ],
)
def test_an_element_is_known_by_the_name_that_blender_gives_it(
    kb: KnowledgeBase, reader: BaseReader, family: str, form: str
) -> None:
    names = Counter(default_name(entry) for entry in below(reader, family))
    cases = [
        (form.format(default_name(entry), member.name), member.path)
        for entry in below(reader, family)
        if names[default_name(entry)] == 1
        for member in properties(reader, entry.path)
    ]
    sample = random.Random(SEED).sample(cases, min(len(cases), examples(200)))
    assert len(sample) >= examples(70)
    assert wrong(kb, sample) == []


def test_of_two_with_one_name_the_one_called_so_comes_first(kb: KnowledgeBase) -> None:
    answer = kb.query('bpy.context.object.modifiers["Shrinkwrap"].offset')
    assert answer.hits[0].id == "bpy.types.ShrinkwrapModifier.offset"


@pytest.mark.parametrize("suffix", ["", ".default_value", ".default_value = 1.0", ".hide"])
@pytest.mark.parametrize("tree", ["ShaderNodeTree", "GeometryNodeTree"])
def test_a_socket_of_a_named_node_is_that_socket(
    kb: KnowledgeBase, reader: BaseReader, tree: str, suffix: str
) -> None:
    holder = {
        "ShaderNodeTree": "material.node_tree",
        "GeometryNodeTree": 'bpy.context.object.modifiers["GeometryNodes"].node_group',
    }[tree]
    nodes: list[SymbolEntry] = []
    for entry in below(reader, "NodeInternal"):
        symbol = reader.symbol(entry.path)
        if symbol and tree in symbol.trees:
            nodes.append(entry)
    names = Counter(entry.label for entry in nodes)
    cases: list[tuple[str, str]] = []
    for node in nodes:
        for member in reader.members(node.path).values():
            valued = reader.entry(f"{TYPES}{member.target}.default_value") is not None
            if member.kind == "socket" and names[node.label] == 1 and (valued or "default" not in suffix):
                side = member.path[len(node.path) :]
                cases.append((f'{holder}.nodes["{node.label}"]{side}{suffix}', member.path))
    sample = random.Random(SEED).sample(cases, examples(200))
    assert wrong(kb, sample) == []


ROOTS = {
    "bpy.context.object": "Object", "C.object": "Object", "obj": "Object", "object": "Object", "ob": "Object",
    "context.active_object": "Object",
    "scene": "Scene", "C.scene": "Scene", "bpy.context.scene.render": "RenderSettings",
    "bpy.context.scene.cycles": "CyclesRenderSettings", "mat": "Material", "material": "Material",
    "mesh": "Mesh", "psys.settings": "ParticleSettings", "light": "Light",
    "obj.particle_systems[0].settings": "ParticleSettings", "scene.rigidbody_world": "RigidBodyWorld",
    "scene.rigidbody_world.point_cache": "PointCache", "obj.rigid_body": "RigidBodyObject",
    'obj.modifiers["Cloth"].settings': "ClothSettings",
    'obj.modifiers["Cloth"].collision_settings': "ClothCollisionSettings",
    "bpy.context.view_layer": "ViewLayer", "bpy.context.scene.world": "World",
    "bpy.context.tool_settings": "ToolSettings",
    'arm.pose.bones["Bone"]': "PoseBone", "bpy.context.scene.sequence_editor": "SequenceEditor",
    "bpy.data.objects['Cube'].data.materials[0]": "Material", "bpy.context.scene.objects['x'].parent": "Object",
    "bpy.data.scenes[0].view_layers['ViewLayer']": "ViewLayer", "bpy.context.selected_objects[0]": "Object",
    "bpy.data.meshes['m'].vertices[0]": "MeshVertex", "bpy.context.object.vertex_groups.new(name='g')": "VertexGroup",
    "bpy.data.materials.new('x')": "Material", "bpy.context.object.animation_data_create()": "AnimData",
}  # fmt: skip


@pytest.mark.parametrize("root", ROOTS)
def test_members_of_a_well_known_expression_are_found(
    kb: KnowledgeBase, reader: BaseReader, root: str
) -> None:
    members = [
        entry
        for entry in reader.members(TYPES + ROOTS[root]).values()
        if entry.kind in {"property", "function"} and not entry.name.startswith("bl_rna")
    ]
    sample = random.Random(SEED).sample(members, min(len(members), examples(40)))
    cases = [(f"{root}.{entry.name}", entry.path) for entry in sample]
    # ``mesh.reveal`` may be the operator just as well.
    assert wrong(kb, [case for case in cases if reader.entry(f"bpy.ops.{case[0]}") is None]) == []


@pytest.mark.parametrize("form", ['bpy.data.{}["X"].{}', "D.{}[0].{}", "bpy.data.{}[-1].{} = x"])
def test_data_blocks_are_found_by_name_or_number(kb: KnowledgeBase, reader: BaseReader, form: str) -> None:
    cases = [
        (form.format(entry.name, member.name), member.path)
        for entry in reader.members("bpy.types.BlendData").values()
        if entry.type == "collection"
        for member in properties(reader, TYPES + entry.target)
    ]
    assert wrong(kb, random.Random(SEED).sample(cases, examples(250))) == []


def test_a_collection_has_its_own_methods_and_those_of_every_collection(
    kb: KnowledgeBase, reader: BaseReader
) -> None:
    cases = [
        ("bpy.context.object.modifiers.foreach_get", "bpy.types.bpy_prop_collection.foreach_get"),
        ('bpy.data.collections.get("x")', "bpy.types.bpy_prop_collection.get"),
    ]
    for entry in reader.members("bpy.types.BlendData").values():
        for member in reader.members(TYPES + entry.collection).values() if entry.collection else ():
            if member.kind == "function" and not member.name.startswith("bl_rna"):
                cases.append((f"bpy.data.{entry.name}.{member.name}(name='x')", member.path))
    assert len(cases) > 80
    assert wrong(kb, cases) == []


@pytest.mark.parametrize(
    ("expression", "path"),
    [
        ("bpy.context.object.location.x", "mathutils.Vector.x"),
        ("bpy.context.cloth.settings.quality", "bpy.types.ClothSettings.quality"),
        ("bpy.context.selected_editable_fcurves[0].array_index", "bpy.types.FCurve.array_index"),
        ("obj.matrix_world.translation", "mathutils.Matrix.translation"),
        ("obj.matrix_world.inverted() @ v", "mathutils.Matrix.inverted"),
        ("obj.location.lerp(b, 0.5).normalized()", "mathutils.Vector.normalized"),
        ("obj.rotation_euler.to_matrix().to_4x4()", "mathutils.Matrix.to_4x4"),
        ("obj.evaluated_get(depsgraph).data", "bpy.types.Object.data"),
        ("obj.copy().location", "bpy.types.Object.location"),
        ("bpy.context.evaluated_depsgraph_get().update()", "bpy.types.Depsgraph.update"),
        ("obj.keyframe_insert(data_path='location')", "bpy.types.bpy_struct.keyframe_insert"),
        ("bmesh.new().verts.new((0, 0, 0)).co", "bmesh.types.BMVert.co"),
        ("bm.verts.ensure_lookup_table()", "bmesh.types.BMVertSeq.ensure_lookup_table"),
        ("bm.verts[0].co.x", "mathutils.Vector.x"),
        ("bmesh.from_edit_mesh(me).faces[0].normal", "bmesh.types.BMFace.normal"),
        ("bm.loops.layers.uv.active", "bmesh.types.BMLayerCollection.active"),
        ("vert.link_edges[0].calc_length()", "bmesh.types.BMEdge.calc_length"),
        ("f.loops[0].vert.co", "bmesh.types.BMVert.co"),
        ("kd.find_n(co, 3)", "mathutils.kdtree.KDTree.find_n"),
        ("gpu.shader.from_builtin('UNIFORM_COLOR').bind()", "gpu.types.GPUShader.bind"),
        ("aud.Sound.file('a.wav').volume(0.5)", "aud.Sound.volume"),
        ("bpy.app.handlers.frame_change_post.append(f)", "bpy.app.handlers.frame_change_post"),
        ("bpy.ops.object.mode_set.poll()", "bpy.ops.object.mode_set"),
    ],
)
def test_values_and_results_of_calls_have_types_too(kb: KnowledgeBase, expression: str, path: str) -> None:
    answer = kb.query(expression)
    assert path in {hit.id for hit in answer.hits[:1]} or path in answer.text.split("Also")[0], first_id(
        answer
    )


def test_an_unresolved_name_is_reported_with_its_owner(kb: KnowledgeBase) -> None:
    answer = kb.query("bpy.context.object.rigid_body.wobbliness")
    assert any("`bpy.types.RigidBodyObject` has no `wobbliness`" in note for note in answer.notes)


def test_a_socket_that_takes_no_value_is_that_socket_all_the_same(kb: KnowledgeBase) -> None:
    answer = kb.query('mat.node_tree.nodes["Background"].outputs["Background"].default_value')
    assert answer.hits[0].id == 'bpy.types.ShaderNodeBackground.outputs["Background"]'
    assert any("`bpy.types.NodeSocketShader` has no `default_value`" in note for note in answer.notes)


def test_what_blender_takes_in_brackets_gives_the_socket(kb: KnowledgeBase, reader: BaseReader) -> None:
    """Identifiers that always give a socket were tried on its node."""
    rows = reader.rows("SELECT path FROM symbols WHERE kind = 'socket' ORDER BY path")
    found = {}
    for (path,) in rows:
        symbol = reader.symbol(path)
        assert symbol
        for text in symbol.subscripts:
            if not text.endswith(f'["{symbol.name}"]') and text.endswith('"]'):
                found[path] = f"{symbol.owner}.{text}"
    assert len(found) > 80
    chosen = random.Random(SEED).sample(sorted(found), 12)
    asked = {path: kb.query(f"{found[path]}.default_value") for path in chosen}
    assert {path: answer.hits[0].id for path, answer in asked.items()} == {path: path for path in chosen}
    assert not [note for answer in asked.values() for note in answer.notes if "has no `inputs" in note]


@pytest.mark.parametrize(
    ("expression", "socket"),
    [
        ('color_balance.inputs["Base Lift"]', 'CompositorNodeColorBalance.inputs["Lift"]'),
        ('node.inputs["Preprocess Blur Size"]', 'CompositorNodeKeying.inputs["Blur Size"]'),
    ],
)
def test_an_identifier_gives_the_socket_of_a_variable(
    kb: KnowledgeBase, expression: str, socket: str
) -> None:
    answer = kb.query(expression)
    assert answer.hits[0].id == TYPES + socket
    assert not answer.notes


def test_a_socket_that_does_not_exist_is_answered_with_those_that_do(kb: KnowledgeBase) -> None:
    answer = kb.query('mat.node_tree.nodes["Principled BSDF"].inputs["Specular"].default_value')
    ids = [hit.id for hit in answer.hits[:4]]
    assert 'bpy.types.ShaderNodeBsdfPrincipled.inputs["Specular IOR Level"]' in ids


def test_no_chain_takes_long_or_fails(reader: BaseReader) -> None:
    resolver, chance = Resolver(reader), random.Random(SEED)
    names = [row[0] for row in reader.rows("SELECT name FROM symbols WHERE kind = 'property' ORDER BY path")]
    for _ in range(150):
        text = chance.choice(["bpy.context", "obj", "x", "bpy.data", "bpy.ops", "node"])
        for _ in range(chance.randrange(1, 12)):
            text += chance.choice([".{}", '["{}"]', "[0]", "()", "({})"]).format(chance.choice(names))
        for resolved in resolver.resolve(find_chains(text)[0]):
            assert resolved.complete or resolved.missing or not resolved.symbols
