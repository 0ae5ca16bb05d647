"""What calls give, and what Blender does with it: libraries, an object's own mesh, groups' inputs, hidden sockets."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

_OWN_DATA = """\
import bpy
ob = bpy.data.objects["Cube"]
mesh = ob.to_mesh()
bpy.data.meshes.remove(mesh)
ob.to_mesh_clear()
copy = bpy.data.meshes.new_from_object(ob)
bpy.data.meshes.remove(copy)
text = bpy.data.objects.new("text", bpy.data.curves.new("text", 'FONT'))
curve = text.to_curve(bpy.context.evaluated_depsgraph_get())
bpy.data.curves.remove(curve)
text.to_curve_clear()
bpy.data.curves.remove(text.data)
""".splitlines()
_CALLED = """\
import bmesh, gpu, idprop, imbuf, mathutils
from gpu.types import GPUShader as Shader
gpu.types.GPUShader("void main() {}", "void main() {}")
Shader(vertexcode="void main() {}", fragcode="void main() {}")
bmesh.types.BMesh()
bmesh.types.BMVert()
imbuf.types.ImBuf()
idprop.types.IDPropertyGroup()
bmesh.new()
mathutils.Vector()
gpu.types.GPUShaderCreateInfo()
gpu.types.GPUStageInterfaceInfo("stage")
isinstance(0, gpu.types.GPUShader)
""".splitlines()


@pytest.mark.parametrize("lines", [_OWN_DATA, _CALLED], ids=["an object's own data", "classes"])
def test_what_is_refused_is_found_and_nothing_else(check: Check, tmp_path: Path, lines: list[str]) -> None:
    answers = run_statements(tmp_path, lines)
    refused = [place for place, (error, *_) in enumerate(answers, 1) if error]
    assert [finding.span.line for finding in check("refused-call", "\n".join(lines))] == refused
    assert refused


def test_classes_that_only_functions_make_have_no_signature(check: Check, tmp_path: Path) -> None:
    """Blender's own mark of such a class, by all classes of the modules: the rule goes by what the base has of it."""
    lines = [
        "import bmesh, gpu, idprop, imbuf",
        "modules = (bmesh.types, gpu.types, idprop.types, imbuf.types)",
        "classes = [(one, cls) for one in modules for cls in vars(one).values() if isinstance(cls, type)]",
        "made = {f'{one.__name__}.{cls.__name__}': bool(cls.__flags__ & 1 << 7) for one, cls in classes}",
        "pass",
    ]
    told = eval(run_statements(tmp_path, lines, {4: "made"})[-1][2])
    code = ["import bmesh, gpu, idprop, imbuf", *(f"{path}()" for path in told)]
    found = {code[finding.span.line - 1][:-2] for finding in check("refused-call", "\n".join(code))}
    known = {path for path in told if not check("unknown-name", f"import {path.partition('.')[0]}\n{path}")}
    assert found == {path for path, is_marked in told.items() if is_marked and path in known}
    assert {"gpu.types.GPUShader", "bmesh.types.BMVert"} <= found
    assert known > found


_LIBRARY = """\
import bpy
bpy.ops.wm.save_as_mainfile(filepath=PATH, copy=True)
with bpy.data.libraries.load(PATH) as (a, b): a.objects
with bpy.data.libraries.load(PATH) as (a, b): a.groups
with bpy.data.libraries.load(PATH) as (a, b): a.version
with bpy.data.libraries.load(PATH) as (a, b): b.lamps.append("x")
with bpy.data.libraries.load(PATH) as (a, b): b.meshes = a.meshes
b.meshes
b.groups
"""


def test_libraries_lack_what_blenders_data_have_lost(check: Check, tmp_path: Path) -> None:
    lines = _LIBRARY.replace("PATH", repr(str(tmp_path / "library.blend"))).splitlines()
    answers = run_statements(tmp_path, lines)
    refused = [place for place, (error, *_) in enumerate(answers, 1) if error]
    assert len(refused) > 2
    found = check("unknown-attribute", "\n".join(lines))
    assert [finding.span.line for finding in found] == refused
    assert {finding.severity for finding in found} == {"error"}


def test_what_is_assigned_to_a_lost_name_of_a_library_is_a_warning(check: Check) -> None:
    code = "import bpy\nwith bpy.data.libraries.load('x.blend') as (source, target):\n    target.groups = ['x']\n"
    found = check("unknown-attribute", code)
    assert [(one.severity, one.fix and one.fix.edits[0].text) for one in found] == [
        ("warning", "collections")
    ]
    for other in ("def f(source, target):\n    return target.groups", "target = source = 1\ntarget.groups"):
        assert not check(
            "unknown-attribute", code.replace("['x']", "1").replace("target.groups", "pass #") + other
        )


_GROUP = """\
import bpy
group = bpy.data.node_groups.new("x", "GeometryNodeTree")
item = group.interface.new_socket("x", in_out="INPUT", socket_type="NodeSocketFloat")
modifier = bpy.data.objects["Cube"].modifiers.new("x", "NODES")
modifier.node_group = group
"""


def test_identifiers_of_before_are_no_inputs_of_new_groups(check: Check, tmp_path: Path) -> None:
    made = _GROUP.splitlines()
    lines = ["modifier['Input_0'] = 1.0", "modifier['Socket_0'] = 2.0"]
    watched = {len(made) + place: "item.identifier, modifier.get('Socket_0')" for place in range(2)}
    answers = run_statements(tmp_path, [*made, *lines], watched)[len(made) :]
    changing = [before != after for _, before, after in answers]
    found = [finding.span.line for finding in check("unknown-socket", "\n".join([*made, *lines]))]
    assert changing == [len(made) + place not in found for place in (1, 2)] == [False, True]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('modifiers.new("x", "NODES")', 'modifiers["x"]'),
        ('bpy.data.node_groups.new("x", "GeometryNodeTree")', 'bpy.data.node_groups["x"]'),
        ("import bpy\n", "import bpy\nbpy.ops.wm.append(filename='x')\n"),
        ("import bpy\n", "import bpy\nbpy.ops.wm.revert_mainfile()\n"),
        ("import bpy\n", "import bpy\nbpy.ops.wm.recover_last_session()\n"),
        ("import bpy\n", "import bpy\nbpy.ops.wm.recover_auto_save(filepath='x')\n"),
        ("node_group = group", "node_group = bpy.context.object.modifiers['x'].node_group"),
        ("node_group = group", "node_group = bpy.context.object.modifiers['x'].node_group.copy()"),
        ("node_group = group", "node_group = bpy.context.space_data.edit_tree"),
        ("import bpy\n", "import bpy\nfrom addon import group\n"),
        ('"NODES"', '"ARRAY"'),
    ],
)
def test_groups_of_files_may_have_them(check: Check, old: str, new: str) -> None:
    assert old in _GROUP
    code = _GROUP.replace(old, new, 1) + "modifier['Input_0'] = 1.0\n"
    assert not check("unknown-socket", code)


def test_a_key_that_is_no_input_is_one_mistake(rule_checker: Checker) -> None:
    for name in ("x", "Input_0"):
        code = _GROUP.replace('new_socket("x"', f'new_socket("{name}"') + f"modifier['{name}'] = 1.0\n"
        assert [finding.rule for finding in rule_checker.check(code)] == ["input-by-name"]


_LINKS = """\
import bpy
tree = bpy.data.node_groups.new("x", "ShaderNodeTree")
noise = tree.nodes.new("ShaderNodeTexNoise")
mix = tree.nodes.new("ShaderNodeMix")
mix.blend_type = "ADD"
mix.data_type = "RGBA"
plain = tree.nodes.new("ShaderNodeMix")
end = tree.nodes.new("ShaderNodeBsdfDiffuse")
""".splitlines()


def test_links_to_sockets_that_are_hidden_are_warned_of(check: Check, tmp_path: Path) -> None:
    pairs = [("noise.outputs[0]", f"{node}.inputs[{at}]") for node in ("mix", "plain") for at in range(10)]
    pairs += [(f"{node}.outputs[{at}]", "end.inputs[0]") for node in ("mix", "plain") for at in range(4)]
    lines = [f"link = tree.links.new({first}, {second})" for first, second in pairs]
    at = len(_LINKS)
    answers = run_statements(
        tmp_path, [*_LINKS, *lines], {at + n: "link.is_valid" for n in range(len(lines))}
    )[at:]
    lost = [line for line, (*_, after) in zip(lines, answers, strict=True) if after == "False"]
    found = check("hidden-socket", "\n".join([*_LINKS, *lines]))
    told = [lines[finding.span.line - at - 1] for finding in found]
    # Two settings show that socket, and the script sets a third one.
    assert sorted(told) == sorted(line for line in lost if "inputs[1]" not in line)
    assert 15 < len(lost) < len(lines)
    assert {finding.severity for finding in found} == {"warning"}
    by_line = {finding.span.line - at - 1: finding.message for finding in found}
    assert (
        "`outputs[2]` is the one to link"
        in by_line[lines.index("link = tree.links.new(mix.outputs[0], end.inputs[0])")]
    )


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('mix.data_type = "RGBA"', 'setattr(mix, "data_type", "RGBA")'),
        ('mix.data_type = "RGBA"', "mix.data_type = kind"),
        ('mix.data_type = "RGBA"', 'if kind:\n    mix.data_type = "RGBA"'),
        ('mix.data_type = "RGBA"', 'for node in tree.nodes:\n    node.data_type = "RGBA"'),
        ('mix = tree.nodes.new("ShaderNodeMix")', 'mix = tree.nodes["Mix"]'),
        ('mix.data_type = "RGBA"', 'mix.data_type = "RGBA"\nmix.data_type = "FLOAT"'),
        ('mix.data_type = "RGBA"', 'mix.data_type = "RGBA"\nsame = mix\nsame.data_type = "FLOAT"'),
        (
            'mix.data_type = "RGBA"',
            'mix.data_type = "RGBA"\nlast = tree.nodes.active\nlast.data_type = "FLOAT"',
        ),
        (
            'mix.data_type = "RGBA"',
            'mix.data_type = "RGBA"\nsame = mix\nput = setattr\nput(same, "data_" + "type", "FLOAT")',
        ),
        (
            'mix.data_type = "RGBA"',
            'mix.data_type = "RGBA"\nsame = mix\nsame.__setattr__("data_" + "type", "FLOAT")',
        ),
    ],
)
def test_modes_that_are_not_certain_hide_nothing(check: Check, old: str, new: str) -> None:
    code = "\n".join([*_LINKS, "tree.links.new(mix.outputs[0], end.inputs[0])"])
    assert check("hidden-socket", code)
    assert not check("hidden-socket", code.replace(old, new))
