"""When the extractor says that a node shows a socket, of nodes that make sockets as they are set."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

pytestmark = pytest.mark.blender

_SCRIPT = """
import json
import bpy
from kb_build.blender.inside.nodes import Sockets

def remade(node, context):
    node.inputs.clear()
    node.inputs.new("NodeSocketFloat", "A")
    if node.kind == "VECTOR":
        node.inputs.new("NodeSocketFloat", "B")
    if node.kind == "VECTOR" and node.way == "DOT":
        node.inputs.new("NodeSocketFloat", "C")

class Made(bpy.types.Node):
    bl_idname, bl_label = "MadeNode", "Made"
    kind: bpy.props.EnumProperty(items=[(name, name, "") for name in ("FLOAT", "VECTOR")], update=remade)
    way: bpy.props.EnumProperty(items=[(name, name, "") for name in ("ITEM", "LENGTH", "DOT")], update=remade)

    def init(self, context):
        remade(self, context)

bpy.utils.register_class(Made)
node = bpy.data.node_groups.new("g", "GeometryNodeTree").nodes.new("MadeNode")
sockets = Sockets([node])
print(json.dumps({
    "modes": {identifier: modes for (_, identifier), modes in sockets.modes.items() if modes},
    "hidden": sorted(identifier for _, identifier in sockets.hidden),
    "left": [node.kind, node.way, len(node.inputs)],
}))
"""


def test_a_socket_that_only_two_settings_together_make_is_found() -> None:
    result = subprocess.run([sys.executable, "-c", _SCRIPT], capture_output=True, text=True, check=True)
    found = json.loads(result.stdout.splitlines()[-1])
    assert found["modes"] == {"B": ["kind=VECTOR"], "C": ["kind=VECTOR", "way=DOT"]}
    assert found["hidden"] == ["B", "C"]
    assert found["left"] == ["FLOAT", "ITEM", 1]
