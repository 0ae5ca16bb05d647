"""Scripts that ask what there is and are ready for each answer run in every Blender: nothing is wrong with them."""

from __future__ import annotations

from textwrap import dedent
from typing import TYPE_CHECKING

import pytest
from other_versions import base_of, errors_in

from kb_check.checker import Checker

if TYPE_CHECKING:
    from pathlib import Path

INSTALLED = "5.1"
VERSIONS = ["3.4", "4.2", "4.5", "5.0", INSTALLED, "5.2", "5.3"]
AROUND = """
import bpy
material = bpy.data.materials.new("x")
material.use_nodes = True
node = material.node_tree.nodes.new("ShaderNodeBsdfPrincipled")
scene = bpy.context.scene
engines = [item.identifier for item in scene.render.bl_rna.properties['engine'].enum_items]
modifier = bpy.context.object.modifiers.new("b", 'BOOLEAN')
solvers = modifier.bl_rna.properties['solver'].enum_items.keys()
"""
READY = {
    "a socket or another": 'node.inputs.get("Specular") or node.inputs.get("Specular IOR Level")',
    "a socket with another as default": 'node.inputs.get("Specular", node.inputs.get("Specular IOR Level"))',
    "a socket that is asked for": """
        socket = node.inputs.get("Emission Color")
        if socket is None:
            socket = node.inputs.get("Emission")
        socket.default_value = (1, 1, 1, 1)
    """,
    "a socket where it is listed": """
        if "Specular" in node.inputs:
            node.inputs["Specular"].default_value = 1
        else:
            node.inputs["Specular IOR Level"].default_value = 1
    """,
    "a socket of several words where it is listed": """
        if "Specular IOR Level" in node.inputs:
            node.inputs["Specular IOR Level"].default_value = 1
        else:
            node.inputs["Specular"].default_value = 1
    """,
    "a value that a choice gives": """
        modifier.solver = 'FLOAT' if 'FLOAT' in solvers else 'FAST'
    """,
    "a value that a name holds": """
        engine = 'BLENDER_EEVEE' if 'BLENDER_EEVEE' in set(engines) else 'BLENDER_EEVEE_NEXT'
        scene.render.engine = engine
    """,
    "a value behind a condition": """
        if 'FLOAT' not in solvers:
            modifier.solver = 'FAST'
        else:
            modifier.solver = 'FLOAT'
    """,
    "a value where it is the present one": """
        if scene.render.engine == 'BLENDER_EEVEE':
            scene.render.engine = 'BLENDER_EEVEE'
        elif scene.render.engine == 'BLENDER_EEVEE_NEXT':
            scene.render.engine = 'BLENDER_EEVEE_NEXT'
    """,
    "a value where it is one of some": """
        if scene.render.engine in {'BLENDER_EEVEE_NEXT'} and scene:
            scene.render.engine = 'BLENDER_EEVEE_NEXT'
    """,
    "an operator whose class is asked for": """
        if hasattr(bpy.types, "WM_OT_stl_export"):
            export = bpy.ops.wm.stl_export
        else:
            export = bpy.ops.export_mesh.stl
    """,
    "an operator of some builds": """
        if bpy.app.build_options.usd:
            print(bpy.ops.wm.usd_export)
    """,
    "a member of another class than the one that is asked for": """
        action = bpy.data.actions.new("x")
        animated = bpy.context.object.animation_data_create()
        animated.action = action
        if hasattr(action, "slots"):
            animated.action_slot = action.slots.new(id_type='OBJECT', name="x")
    """,
    "what goes with a member that a parameter lacks": """
        def nodes(scene):
            if not hasattr(scene, "compositing_node_group"):
                return scene.node_tree
        nodes(scene)
    """,
    "what goes with a class": """
        if hasattr(bpy.types, "CompositorNodeComposite"):
            print(scene.node_tree)
    """,
    "what follows a reading that may fail": """
        def curves(action):
            try:
                return action.fcurves
            except AttributeError:
                pass
            return action.layers
        curves(bpy.data.actions.new("x"))
    """,
    "what follows a reading after which all is done": """
        def group():
            try:
                found = scene.compositing_node_group
            except Exception:
                pass
            else:
                return found
            return scene.node_tree
        group()
    """,
    "operators beside one that is listed": """
        if "addon_disable" in dir(bpy.ops.wm):
            bpy.ops.wm.addon_refresh()
    """,
    "numbers of the version's text": """
        major, minor = map(int, bpy.app.version_string.split(".")[:2])
        print(scene.node_tree if major < 5 else scene.compositing_node_group)
    """,
    "parts of the version's text": """
        parts = bpy.app.version_string.split(".")
        if int(parts[0]) < 5:
            print(scene.node_tree)
    """,
    "the version of the package": """
        from importlib.metadata import version
        try:
            IS_OLD = version("bpy").split(".")[0] == "4"
        except Exception:
            IS_OLD = False
        if IS_OLD:
            print(scene.node_tree)
    """,
    "numbers of the version in a list": """
        numbers = [int(part) for part in bpy.app.version]
        if numbers[0] < 5:
            print(scene.node_tree)
    """,
    "a function of the version whose results are kept": """
        import functools
        @functools.lru_cache
        def is_new():
            return bpy.app.version >= (5, 0)
        if not is_new():
            print(scene.node_tree)
    """,
    "parts of a text that is passed": """
        def call(thing, text):
            thing.name = text[:63]
        call(scene, bpy.context.object.name)
    """,
    "sequences of a mesh's elements": """
        import bmesh
        bm = bmesh.new()
        verts = [bm.verts.new((x, x * x, 0)) for x in range(4)]
        one, other = bm.faces.new(verts[:3]), bm.faces.new([verts[0], verts[2], verts[3]])
        bm.faces.get(verts[:3])
        bm.edges.get(verts[:2])
        bmesh.utils.face_join([one, other])
        bmesh.utils.vert_separate(verts[0], verts[0].link_edges[:])
    """,
}
# What refuses in every Blender, though something is asked.
WRONG = {
    "a part of a list": "scene.frame_end = [1, 2][:1]",
    "a name beside one that each class has": """
        if hasattr(scene, "render"):
            scene.no_such_name
    """,
    "what follows a call that may fail": """
        def made():
            try:
                return bpy.data.objects["No such object"]
            except KeyError:
                pass
            return bpy.data.no_such_name
        made()
    """,
    "a socket that is used at once": 'node.inputs.get("Specula").default_value = 1',
    "a socket that nothing asks for": """
        socket = node.inputs.get("Specula")
        socket.default_value = 1
    """,
    "a value behind a question about something else": """
        modifier.solver = 'FIRST' if 'Cube' in bpy.data.objects else 'SECOND'
    """,
}


@pytest.mark.parametrize("version", VERSIONS)
def test_what_runs_has_no_error_and_what_does_not_has(version: str, base: Path, tmp_path: Path) -> None:
    looked_into = base if version == INSTALLED else base_of(version)
    scripts = {name: AROUND + dedent(lines) for name, lines in {**READY, **WRONG}.items()}
    raised = dict(zip(scripts, errors_in(version, tmp_path, list(scripts.values())), strict=True))
    assert {name for name, error in raised.items() if error} == set(WRONG)
    with Checker(looked_into) as checker:
        told = {
            name: [one.message for one in checker.check(script) if one.severity == "error"]
            for name, script in scripts.items()
        }
    assert {name: messages for name, messages in told.items() if messages and name in READY} == {}
    assert all(told[name] for name in WRONG)


_NAMED_GROUPS = """
import bpy
Item = type("Item", (bpy.types.PropertyGroup,), {})
bpy.utils.register_class(Item)
bpy.types.Scene.things = bpy.props.CollectionProperty(type=Item)
thing: bpy.types.PropertyGroup = bpy.context.scene.things.add()
thing.name = "first"
assert bpy.context.scene.things["first"] == thing
"""


@pytest.mark.blender
@pytest.mark.parametrize("version", VERSIONS)
def test_the_name_of_a_property_group_can_be_set(version: str, tmp_path: Path) -> None:
    """RNA says of the class that it cannot, since 5.3."""
    with Checker(base_of(version)) as checker:
        assert checker.check(_NAMED_GROUPS) == []
    assert not any(errors_in(version, tmp_path, _NAMED_GROUPS.splitlines()))
