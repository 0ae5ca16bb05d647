"""Names that the code in a query gives itself are none of Blender's."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.recognise.code.own_names import own_names

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

DENIED = ("has no", "does not exist", "never had", "is a custom property", "by place", "not an argument")


@pytest.mark.parametrize(
    "code",
    [
        "nodes = []\nnodes.append(n)",
        'text = "abc"\ntext.upper()',
        "images = set()\nimages.add(img)",
        "camera = {}\ncamera['x'] = 1",
        "path = Path(filepath)\npath.exists()",
        "from . import operators, ui\ndef register():\n    operators.register()\n    ui.register()",
        'def f(strip):\n    """Move a strip. Note that it is slow."""\n    strip.mute = True',
        "class A(bpy.types.Operator):\n    scale: bpy.props.FloatVectorProperty(size=3)\n"
        "    def execute(self, context):\n        print(self.scale.x)",
        "bpy.types.Scene.my_items = bpy.props.CollectionProperty(type=MyItem)\n"
        "item = bpy.context.scene.my_items.add()",
        'class OBJECT_OT_c(bpy.types.Operator):\n    bl_idname = "object.c"\n    bl_label = "C"\n'
        "    def execute(self, context):\n        return {'FINISHED'}\nbpy.utils.register_class(OBJECT_OT_c)\n"
        "bpy.ops.object.c()",
        "def generate(params):\n    params.tool_mouse = 1",
        "params = self.params\nparams.rotation_axis = 'x'",
        "class Node:\n    def __init__(self):\n        self.uuid = 1\nnode = Node()\nprint(node.uuid)",
        "class TextureFilter(IntEnum):\n    Nearest = 0\nx = TextureFilter.Nearest",
        "def f(node: ControlBoneNode):\n    node.uuid = 1",
        "action = input()\naction.upper()",
        "from PIL import Image\nimg = Image.open('x.png')\nimg.convert('RGB')",
        "import PIL.Image as Image\nImage.new('RGB', (8, 8))",
        "PREFERENCES_OT_addon_remove.path_from_addon(module)",
        "def f(a):\n    return create_grid(a, 2, 3)",
        "def f(a):\n    return struct.calcsize(a)",
        "class MY_PT_x(bpy.types.Panel):\n    bl_label = 'x'\n    def draw_header(self, context):\n        pass",
        "class OBJECT_OT_add_object(Operator, AddObjectHelper):\n    bl_idname = 'mesh.add_object'\n"
        "    bl_label = 'x'\n    def execute(self, context):\n        add_object(self, context)\n"
        "        return {'FINISHED'}",
    ],
)
def test_what_code_gives_itself_is_not_denied(kb: KnowledgeBase, code: str) -> None:
    assert not [note for note in kb.query(code).notes if any(words in note for words in DENIED)]


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("nodes = tree.nodes\nnodes.append(n)", "has no `append`"),
        ("nodes = []\nnodes = tree.nodes\nnodes.append(n)", "has no `append`"),
        ("f(a, material=[])\nmaterial.use_shadeless = True", "removed in 2.80"),
        ("def f(mat):\n    mat.use_shadeless = True", "removed in 2.80"),
        ("def f(mat: bpy.types.Material):\n    mat.use_shadeless = True", "removed in 2.80"),
        ("def f(ob: Optional['Object']):\n    ob.no_such_thing()", "has no `no_such_thing`"),
        ("import bgl\nbgl.glEnable(bgl.GL_BLEND)", "removed in 5.0"),
        ("from mathutils import Vector as V\nv = V((1, 2, 3))\nv.no_such_thing()", "has no `no_such_thing`"),
        ("bpy.ops.object.select_all(ctx, action='SELECT')", "A context is not an argument"),
    ],
)
def test_what_blender_gave_is_judged_as_before(kb: KnowledgeBase, code: str, said: str) -> None:
    assert any(said in note for note in kb.query(code).notes)


def test_arguments_are_no_variables() -> None:
    assert own_names("f(a, name='x', kind=[])", bool).variables == frozenset()
    assert own_names("a = [1]; b = f(c=[2]); d = None", bool).variables == {"a"}
