"""What the script's own functions return to single calls."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from flow_reading import last_type, read, unknown

from kb_build.flow.analysis import analyse
from kb_build.flow.execution import functions

if TYPE_CHECKING:
    from kb_build.flow.blender.api import Api

_CUBES = """
import bpy
def cube(name, loc, **more):
    bpy.ops.mesh.primitive_cube_add(location=loc)
    return bpy.context.object
"""
_NODES = """
import bpy
tree = bpy.data.materials.new("m").node_tree
def node(kind, loc=(0, 0)):
    n = tree.nodes.new(kind)
    n.location = loc
    return n
"""


@pytest.mark.parametrize("count", [1, 3, 4, 60])
def test_a_result_is_known_however_many_calls_there_are(api: Api, count: int) -> None:
    calls = "".join(f'cube("a{at}", ({at}, 0, 0.5))\n' for at in range(count))
    assert last_type(api, f"{_CUBES}{calls}cube('last', (0, 0, 0))") == {"Object"}
    assert unknown(api, f"{_CUBES}{calls}cube('last', (0, 0, 0)).select") == {("Object", "select")}


def test_beyond_the_bound_the_texts_of_calls_are_left_out(api: Api) -> None:
    api_types = ["ShaderNodeMath", "ShaderNodeMix"]
    many = "".join(f'node("ShaderNodeMath", "{at}")\n' for at in range(functions._MOST_CALLS))
    for kind in api_types:
        assert last_type(api, f'{_NODES}node("{kind}")') == {kind}
        assert last_type(api, f'{_NODES}{many}node("{kind}")') == {"Node"}


@pytest.mark.parametrize(
    ("code", "cls"),
    [
        (_NODES + "node('ShaderNodeMath')\nnode('ShaderNodeMix')\nnode('ShaderNodeMath')", "ShaderNodeMath"),
        (_NODES + "node('ShaderNodeMix')\nnode(loc=(1, 2), kind='ShaderNodeMath')", "ShaderNodeMath"),
        (
            _NODES
            + "def math(x):\n    return node('ShaderNodeMath', x)\nnode('ShaderNodeMix')\nmath((1, 1))",
            "ShaderNodeMath",
        ),
        (
            "import bpy\ndef add(ob, kind: str = 'BEVEL'):\n    return ob.modifiers.new(kind, kind)\n"
            "ob = bpy.context.object\nadd(ob, 'SUBSURF')\nadd(ob)",
            "BevelModifier",
        ),
        (
            "import bpy\ndef first(things):\n    return things[0]\n"
            "first(bpy.data.meshes)\nfirst(bpy.data.scenes)",
            "Scene",
        ),
        (
            "import bpy\nclass B:\n    def add(self, kind):\n"
            "        return bpy.context.object.modifiers.new('', kind)\nb = B()\nb.add('BEVEL')\nb.add('SUBSURF')",
            "SubsurfModifier",
        ),
        (
            "import bpy\ndef made(name) -> bpy.types.Object:\n    return make(name)\n"
            "made('a')\nmade('b')\nmade('c')\nmade('d')\nmade('e')",
            "Object",
        ),
    ],
)
def test_what_a_call_returns_depends_on_what_it_passes(api: Api, code: str, cls: str) -> None:
    assert last_type(api, code) == {cls}


def test_what_is_missing_of_each_result_is_told(api: Api) -> None:
    calls = "a = node('ShaderNodeTexNoise')\nb = node('ShaderNodeBsdfPrincipled')\n"
    assert unknown(api, f"{_NODES}{calls}a.inputs['No']\nb.inputs['Emission']") == {
        ("ShaderNodeTexNoise", "No"),
        ("ShaderNodeBsdfPrincipled", "Emission"),
    }


def test_what_a_body_lacks_is_found_once(api: Api) -> None:
    body = "import bpy\ndef f(name):\n    bpy.context.object.draw_type = name\n"
    rows = [
        row for row in read(api, body + "f('a')\nf('b')\nf('c')\nf('d')").resolutions.values() if row.missing
    ]
    assert [row.value for row in rows] == ["draw_type"]
    assert not read(api, body + "f('a')\nf('b')").carried


def test_a_result_that_later_code_changes_is_not_sure(api: Api) -> None:
    code = """
        import bpy
        class Other:
            foo = 1
        held = bpy.context.object
        def get(name):
            return held
        get("a").foo
        held = Other()
        get("a").foo
    """
    assert unknown(api, code) == set()


@pytest.mark.parametrize(
    "code",
    [
        "def f(a):\n    return f(a)\nf('a')\nf('b')",
        "def f(a):\n    return g(a + 'x')\ndef g(a):\n    return f(a + 'y')\nf('a')\ng('b')",
        "def f(a):\n    return f([a])\nf('a')\nf(1)",
        "\n".join(
            f"def f{at}(a):\n    return (f{at + 1}(a + 'a'), f{at + 1}('b'), f{at + 1}('c{at}'), f{at + 1}([a]))"
            for at in range(40)
        )
        + "\ndef f40(a):\n    return a\nf0('a')\nf0('b')",
        "for a in ('a', 'b', 'c', 'd'):\n"
        + "".join(f"{' ' * 4 * depth}for x{depth} in ('a', 'b', 'c', a):\n" for depth in range(1, 15))
        + " " * 60
        + "x14",
    ],
)
def test_calls_of_calls_are_read_to_their_end(api: Api, code: str) -> None:
    assert analyse(code, api).complete


@pytest.mark.parametrize(
    "body",
    [
        "return {ob.name: [f(c) for c in ob.children]}",
        "return {'loc': list(ob.location), 'kids': [f(c) for c in ob.children]}",
        "rows = [(ob.name, ob)]\n    rows.append(f(ob.children[0]))\n    return rows",
        "return (ob, f(ob.parent)) if ob.parent else ob",
        "kids = []\n    for c in ob.children:\n        if k := f(c):\n            kids.append(k)\n"
        "    return {'name': ob.name, 'kids': kids} if kids else None",
    ],
)
def test_what_a_function_builds_of_its_own_results_leaves_the_rest_known(api: Api, body: str) -> None:
    code = f"import bpy\ndef f(ob):\n    {body}\nf(bpy.context.object)\nbpy.context.object.no_such"
    assert unknown(api, code) == {("Object", "no_such")}
