"""How types flow through a script."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from flow_reading import last_type, read, resolved, symbol, unknown

if TYPE_CHECKING:
    from kb_build.flow.blender.api import Api


@pytest.mark.parametrize(
    ("code", "cls"),
    [
        ("import bpy as B\nB.context.object", "Object"),
        ("import bpy\nD = bpy.data\nD.objects['a']", "Object"),
        ("from bpy import context as C\nC.scene.render", "RenderSettings"),
        (
            "from bpy.types import Object\ndef f(x: Object):\n    return x.location\nf(None)",
            "mathutils.Vector",
        ),
        ("import bpy\na, b = bpy.context.object, bpy.context.scene\nb", "Scene"),
        ("import bpy\na, *b = bpy.context.selected_objects\nb[0]", "Object"),
        ("import bpy\nfor ob in bpy.data.objects:\n    pass\nob", "Object"),
        ("import bpy\nfor i, ob in enumerate(bpy.data.objects):\n    pass\nob", "Object"),
        ("import bpy\nfor a, b in zip(bpy.data.objects, bpy.data.scenes):\n    pass\nb", "Scene"),
        ("import bpy\nfor name, m in bpy.data.meshes.items():\n    pass\nm", "Mesh"),
        ("import bpy\n[ob.data for ob in bpy.data.objects if ob.type == 'MESH'][0]", "Mesh"),
        ("import bpy\n{o.name: o for o in bpy.data.objects}['a']", "Object"),
        ("import bpy\nx = {'a': bpy.context.object, 'b': bpy.context.scene}\nx['b']", "Scene"),
        ("import bpy\nx = {}\nx['a'] = bpy.context.object\nx['b']", "Object"),
        ("import bpy\nx = []\nx.append(bpy.context.object)\nx[0]", "Object"),
        ("import bpy\nsorted(bpy.data.objects, key=lambda o: o.name)[0]", "Object"),
        ("import bpy\nmax(bpy.data.objects, key=lambda o: o.location.z)", "Object"),
        ("import bpy\nnext(o for o in bpy.data.objects)", "Object"),
        ("import bpy\nif (x := bpy.context.object):\n    pass\nx", "Object"),
        ("import bpy\n(bpy.context.object or bpy.context.active_object)", "Object"),
        ("import bpy\nbpy.context.object.copy()", "Object"),
        ("import bpy\nbpy.context.object.evaluated_get(None)", "Object"),
        ("import bpy\ngetattr(bpy.context, 'scene')", "Scene"),
        ("import bpy\nbpy.data.objects.get('a')", "Object"),
        ("import bpy\nbpy.data.objects[:][0]", "Object"),
        ("import bpy\nlater = None\nlater[:80]", "Unknown"),
        ("from mathutils import Vector, Matrix\nMatrix() @ Vector()", "mathutils.Vector"),
        ("from mathutils import Vector\n2 * Vector()", "mathutils.Vector"),
        ("from mathutils import Vector, Matrix\nVector() @ Matrix()", "mathutils.Vector"),
        ("from mathutils import Vector, Quaternion\nQuaternion() @ Vector()", "mathutils.Vector"),
        ("import bpy\nbpy.context.object.matrix_world.to_quaternion()", "mathutils.Quaternion"),
        ("import bpy\nbpy.context.object.matrix_world.decompose()[1]", "mathutils.Quaternion"),
    ],
)
def test_what_an_expression_is(api: Api, code: str, cls: str) -> None:
    assert last_type(api, code) == {cls}


@pytest.mark.parametrize(
    ("code", "cls"),
    [
        ("ob.modifiers.new('x', 'CLOTH')", "ClothModifier"),
        ("ob.modifiers.new(type='GREASE_PENCIL_ARRAY', name='x')", "GreasePencilArrayModifier"),
        ("ob.constraints.new('IK')", "KinematicConstraint"),
        ("ob.constraints.new(type='TRACK_TO')", "TrackToConstraint"),
        ("bpy.data.lights.new('x', type='AREA')", "AreaLight"),
        ("ob.data.layers.active", "GreasePencilLayer"),
        ("ob.data.colorspace_settings", "ColorManagedInputColorspaceSettings"),
        ("bpy.data.curves.new('x', 'FONT')", "TextCurve"),
        ("bpy.data.textures.new('x', 'CLOUDS')", "CloudsTexture"),
        ("bpy.data.objects.new('x', bpy.data.lights.new('x', 'SUN')).data", "SunLight"),
        ("nt.nodes.new('ShaderNodeBsdfPrincipled')", "ShaderNodeBsdfPrincipled"),
        ("nt.nodes.new('ShaderNodeBsdfPrincipled').inputs['Base Color']", "NodeSocketColor"),
        ("nt.nodes.new(type='ShaderNodeMath').outputs[0]", "NodeSocketFloat"),
        ("nt.nodes.new('NodeOfNoBlender').inputs['Scale']", "NodeSocket"),
        ("nt.nodes['Principled BSDF']", "ShaderNodeBsdfPrincipled"),
        ("bpy.data.node_groups.new('x', 'GeometryNodeTree')", "GeometryNodeTree"),
        ("ob.data.attributes.new('x', 'FLOAT_COLOR', 'POINT')", "FloatColorAttribute"),
        ("ob.animation_data.action.fcurves if False else ob.modifiers['Cloth'].settings", "ClothSettings"),
    ],
)
def test_literals_decide(api: Api, code: str, cls: str) -> None:
    before = "import bpy\nob = bpy.context.object\nnt = bpy.data.materials['m'].node_tree\n"
    assert last_type(api, before + code) == {cls}


def test_the_results_of_bmesh_operators_are_lists_of_elements(api: Api) -> None:
    code = """
        import bmesh
        bm = bmesh.new()
        cube = bmesh.ops.create_cube(bm, size=1)
        for v in cube["verts"]:
            v.co.z += 1
        layer = bm.loops.layers.uv.verify()
        for face in bm.faces:
            for loop in face.loops:
                loop[layer].uv.x = 3
    """
    assert symbol(api, code, "co") == "bmesh.types.BMVert.co"
    found = [row.symbols for row in resolved(api, code).values() if row.value == "uv"]
    assert found[-1] == ("bmesh.types.BMLoopUV.uv",)


def test_conditions_tell(api: Api) -> None:
    before = "import bpy\nob = bpy.context.object\n"
    assert last_type(api, before + "x = ob.data if ob.type == 'CURVE' else None\nx") == {"Curve", "NoneValue"}
    assert last_type(api, before + "assert isinstance(ob.data, bpy.types.Lattice)\nob.data") == {"Lattice"}
    assert last_type(api, before + "assert ob.type in {'MESH', 'ARMATURE'}\nob.data") == {"Mesh", "Armature"}
    assert last_type(api, before + "if ob.type != 'MESH':\n    raise SystemExit\nob.data") == {"Mesh"}
    assert last_type(api, before + "m = ob.modifiers[0]\nassert m.type == 'CLOTH'\nm.settings") == {
        "ClothSettings"
    }
    area = "for a in bpy.context.screen.areas:\n    s = a.spaces.active\n    if s.type == 'VIEW_3D':\n        break\n"
    assert last_type(api, before + area + "assert s.type == 'VIEW_3D'\ns.overlay") == {"View3DOverlay"}


def test_ways_that_part_meet_again(api: Api) -> None:
    code = (
        "import bpy\nif bpy.app.background:\n    x = bpy.context.object\nelse:\n    x = bpy.context.scene\nx"
    )
    assert last_type(api, code) == {"Object", "Scene"}
    code = "import bpy\nx = bpy.context.object\nwhile x:\n    x = x.parent\nx"
    assert last_type(api, code) == {"Object"}
    code = "import bpy\ntry:\n    x = bpy.context.object\nexcept KeyError:\n    x = bpy.context.scene\nx"
    assert last_type(api, code) == {"Object", "Scene"}


def test_functions_pass_types_on(api: Api) -> None:
    code = """
        import bpy
        def outer(ob, name="x"):
            def inner(thing):
                return thing.data
            return inner(ob)
        class Maker:
            scale = 1.0
            def __init__(self, scene):
                self.scene = scene
            @property
            def world(self):
                return self.scene.world
            @staticmethod
            def light(data):
                return data.energy
        made = Maker(bpy.context.scene)
        made.light(bpy.data.lights.new("x", 'SPOT'))
        outer(bpy.data.objects.new("x", bpy.data.meshes.new("x"))).vertices
        made.world.mist_settings.start
    """
    assert symbol(api, code, "vertices") == "Mesh.vertices"
    assert symbol(api, code, "start") == "WorldMistSettings.start"
    assert symbol(api, code, "energy") == "SpotLight.energy"


def test_operators_know_what_they_get(api: Api) -> None:
    code = """
        import bpy
        from bpy.props import FloatProperty, PointerProperty
        class Settings(bpy.types.PropertyGroup):
            target: PointerProperty(type=bpy.types.Object)
        class Run(bpy.types.Operator):
            amount: FloatProperty(default=1.0)
            def execute(self, context):
                context.scene.settings.target.hide_render = True
                self.report({'INFO'}, "done")
                return self.more(context.active_object)
            def more(self, thing):
                thing.show_name = True
                return {'FINISHED'}
        def draw(self, context):
            self.layout.row().prop(context.scene.render, "fps")
        bpy.types.Scene.settings = PointerProperty(type=Settings)
        bpy.types.VIEW3D_MT_object.append(draw)
    """
    assert symbol(api, code, "show_name") == "Object.show_name"
    assert symbol(api, code, "hide_render") == "Object.hide_render"
    assert symbol(api, code, "INFO") == "Operator.report(type)"
    assert symbol(api, code, "fps") == "RenderSettings.fps"
    assert not unknown(api, code)


def test_a_collection_that_a_script_declares_gives_what_it_holds(api: Api) -> None:
    code = """
        import bpy
        class Item(bpy.types.PropertyGroup):
            ob: bpy.props.PointerProperty(type=bpy.types.Object)
        bpy.types.Scene.items_of_mine = bpy.props.CollectionProperty(type=Item)
        item = bpy.context.scene.items_of_mine.add()
        item.ob.hide_render = True
        bpy.context.scene.items_of_mine.clear()
        bpy.context.scene.items_of_mine.no_such_method()
    """
    assert symbol(api, code, "hide_render") == "Object.hide_render"
    assert {name for _, name in unknown(api, code)} == {"no_such_method"}


def test_a_class_that_is_mixed_into_others_is_what_they_are(api: Api) -> None:
    code = """
        import bpy
        class Buttons:
            def draw(self, _context):
                self.layout.label(text="x")
        class Last(Buttons, bpy.types.Panel):
            pass
    """
    assert symbol(api, code, "layout") == "Panel.layout"
    assert symbol(api, code, "label") == "UILayout.label"


def test_a_script_may_register_what_it_uses(api: Api) -> None:
    code = """
        import bpy
        class Run(bpy.types.Operator):
            bl_idname = "my.run"
        class Tree(bpy.types.NodeTree):
            def update(self):
                self.links.clear()
        bpy.types.Object.mine = bpy.props.IntProperty()
        bpy.context.object.mine = 3
        bpy.ops.my.run('INVOKE_DEFAULT')
        bpy.types.VIEW3D_MT_object.append(lambda self, context: self.layout.operator("my.run"))
        bpy.context.button_operator
        bpy.data.node_groups["x"].nodes[0].inputs.new("MySocket", "x").value
    """
    assert not unknown(api, code)


def test_parts_of_calls_stand_for_symbols(api: Api) -> None:
    code = """
        import bpy
        bpy.ops.mesh.primitive_cube_add(size=2, align='WORLD')
        bpy.context.object.keyframe_insert("location", frame=1)
        bpy.context.scene.render.engine = 'CYCLES'
    """
    found = resolved(api, code)
    assert found["size"].symbols == ("bpy.ops.mesh.primitive_cube_add(size)",)
    assert found["WORLD"].symbols == ("bpy.ops.mesh.primitive_cube_add(align)",)
    assert found["location"].symbols == ("bpy.types.Object.location",)
    assert found["frame"].symbols == ("bpy.types.bpy_struct.keyframe_insert(frame)",)
    assert found["engine"].kind == "store"
    assert found["CYCLES"].symbols == ("bpy.types.RenderSettings.engine",)


def test_what_is_not_there_is_told_with_its_owner(api: Api) -> None:
    code = """
        import bpy
        ob = bpy.context.object
        ob.select = True
        ob.modifiers.new("x", 'CLOTH').settings.qualty = 1
        bpy.ops.mesh.primitive_cube_add(radius=2, align='WORLDS')
        bpy.ops.object.no_such_operator()
        node = bpy.data.materials["m"].node_tree.nodes.new("ShaderNodeBsdfPrincipled")
        node.inputs["Specular"].default_value = 1
        bpy.data.groups
    """
    assert unknown(api, code) == {
        ("Object", "select"),
        ("ClothSettings", "qualty"),
        ("bpy.ops.mesh.primitive_cube_add", "radius"),
        ("bpy.ops.mesh.primitive_cube_add(align)", "WORLDS"),
        ("bpy.ops.object", "no_such_operator"),
        ("ShaderNodeBsdfPrincipled", "Specular"),
        ("BlendData", "groups"),
    }


@pytest.mark.parametrize(
    ("code", "cls"),
    [
        ("ob.modifiers.new('Rim', 'BEVEL')\nob.modifiers['Rim']", {"BevelModifier"}),
        ("ob.modifiers.new(name='Rim', type='BEVEL')\nob.modifiers.get('Rim')", {"BevelModifier"}),
        ("c = ob.constraints.new('TRACK_TO')\nc.name = 'Aim'\nob.constraints['Aim']", {"TrackToConstraint"}),
        ("ob.modifiers.new('Rim', kind)\nob.modifiers['Rim']", {"Modifier"}),
        ("ob.modifiers.new('Rim', 'BEVEL')\nprint('Rim')\nob.modifiers['Rim']", {"Modifier"}),
        ("ob.vertex_groups.new(name='Rim')\nob.modifiers['Rim']", {"Modifier"}),
        (
            "ob.modifiers.new('Wave', 'BEVEL')\nob.modifiers['Wave']",
            {"BevelModifier", "WaveModifier"},
        ),
        (
            "bpy.data.node_groups.new('Own', 'GeometryNodeTree')\nbpy.data.node_groups['Own']",
            {"GeometryNodeTree"},
        ),
    ],
)
def test_what_a_name_is_given_to_is_found_by_it(api: Api, code: str, cls: set[str]) -> None:
    assert last_type(api, "import bpy\nob = bpy.context.object\n" + code) == cls


def test_what_cycles_declares_is_all_that_there_is(api: Api) -> None:
    start = "import bpy\ncycles = bpy.context.scene.cycles\n"
    assert unknown(api, f"{start}cycles.samples\ncycles.sample") == {("CyclesRenderSettings", "sample")}
    declared = "bpy.types.CyclesRenderSettings.own = bpy.props.IntProperty()\ncycles.own"
    assert unknown(api, start + declared) == set()
    assert unknown(api, "import bpy\ngroup: bpy.types.PropertyGroup\ngroup.own") == set()


def test_what_derived_classes_have_is_possible(api: Api) -> None:
    row = resolved(api, "import bpy\nbpy.context.object.modifiers['mine'].levels")["levels"]
    assert "bpy.types.SubsurfModifier.levels" in row.possible
    assert not row.symbols
    assert not row.missing


def test_a_script_that_is_ready_for_absence_is_believed(api: Api) -> None:
    code = """
        import bpy
        ob = bpy.context.object
        if hasattr(ob, "hide"):
            ob.hide = True
        try:
            ob.layers[0] = True
        except AttributeError:
            pass
        if bpy.app.version < (2, 80, 0):
            ob.select = True
        else:
            ob.select_set(True)
        getattr(ob, "dupli_type", None)
    """
    assert not unknown(api, code)
    assert symbol(api, code, "select_set") == "Object.select_set"


def test_what_only_some_calls_tell_is_not_sure(api: Api) -> None:
    code = "import bpy\ndef f(x):\n    return x.nothing\ndef g(x):\n    return x.nothing\n"
    calls = "f(bpy.context.object)\ng(bpy.context.object)\ng(numbers())"
    rows = [row for row in read(api, code + calls).resolutions.values() if row.value == "nothing"]
    assert [row.missing for row in rows] == [("bpy.types.Object",)] * 2
    assert sorted(row.sure for row in rows) == [False, True]


def test_a_container_that_only_some_calls_tell_leaves_the_rest_sure(api: Api) -> None:
    """What a list or dictionary holds is as unsure as it is itself; what does not come out of it is not."""
    code = """
        import bpy
        def draw(settings):
            settings["scene"].no_such_setting
            bpy.context.scene.no_such_scene
        draw({"scene": bpy.context.scene, "extra": {}})
        draw(read_settings())
    """
    assert unknown(api, code) == {("Scene", "no_such_scene")}


@pytest.mark.parametrize("filling", ["ob['tag'] = True", "ob.update()", "ob.append(1)"])
def test_what_is_filled_is_still_a_thing_of_the_api(api: Api, filling: str) -> None:
    code = f"import bpy\nob = bpy.context.object\ndef main():\n    {filling}\n    ob.no_such_thing\nmain()\n"
    assert ("Object", "no_such_thing") in unknown(api, code)


@pytest.mark.parametrize(
    "changing",
    [
        "def change():\n    global ob\n    ob = numbers()",
        "def change():\n    globals()['ob'] = numbers()",
        "ob = [bpy.context.object]\ndef change():\n    ob.append(numbers())",
    ],
)
def test_what_functions_change_is_not_sure(api: Api, changing: str) -> None:
    code = f"import bpy\nob = bpy.context.object\n{changing}\ndef main():\n    change()\n    ob.no_such_thing\nmain()\n"
    assert unknown(api, code) == set()


def test_conventions_are_not_sure(api: Api) -> None:
    code = "def f(context, ob):\n    context.scene.nothing\n    ob.location.x\n    ob.hide_render"
    rows = resolved(api, code)
    assert rows["scene"].symbols == ("bpy.types.Context.scene",)
    assert not rows["scene"].sure
    assert rows["hide_render"].symbols == ("bpy.types.Object.hide_render",)
    # A parameter that is used as an Object never is, is none.
    assert not resolved(api, "def f(ob):\n    ob.something_else\n    ob.location")


def test_what_a_collection_lacks_is_told(api: Api) -> None:
    assert unknown(
        api, "import bpy\nbpy.context.scene.objects.no_such()\nbpy.context.scene.objects.keys()"
    ) == {("Scene.objects", "no_such")}


def test_a_node_that_is_found_by_its_name_has_its_sockets(api: Api) -> None:
    code = "def f(tree):\n    tree.nodes.new('ShaderNodeMath').inputs['No']\n"
    code += "import bpy\nbpy.data.materials[0].node_tree.nodes['Principled BSDF'].inputs['Nor']"
    assert unknown(api, code) == {("ShaderNodeMath", "No"), ("ShaderNodeBsdfPrincipled", "Nor")}


def test_the_context_has_what_layouts_give_it(api: Api) -> None:
    code = "import bpy\nbpy.context.constraint\nbpy.context.no_such\nbpy.context.mine\n"
    assert unknown(api, code) == {("Context", "no_such"), ("Context", "mine")}
    code += "def f(layout):\n    layout.context_pointer_set('mine', bpy.context.object)"
    assert ("bpy.types.Context", "mine") in read(api, code).registered


def test_only_branches_for_other_versions_are_left_out(api: Api) -> None:
    code = "import bpy\non = False\nif on:\n    bpy.context.scene.one\nif not bpy.app.version < (4, 0):\n    pass\n"
    code += "else:\n    bpy.context.scene.two"
    assert unknown(api, code) == {("Scene", "one")}


def test_a_wrong_annotation_is_an_error_where_python_reads_it(api: Api) -> None:
    code = "def f(x: bpy.types.NoSuch): pass"
    assert unknown(api, f"import bpy\n{code}") == {("bpy.types", "NoSuch")}
    assert not unknown(api, f"from __future__ import annotations\nimport bpy\n{code}")
