"""Messages beside the line that failed: what a message names decides what is told, not what the line is like."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

_NO_INT = "expected an int type, not float"
_PROPERTY = "TypeError: bpy_struct: item.attr = val: "
_OPERATOR = "TypeError: Converting py args to operator properties"


@pytest.mark.parametrize(
    ("line", "message", "said", "unsaid"),
    [
        (
            "mod.render_levels = 2.0",
            f"{_PROPERTY}SubsurfModifier.render_levels {_NO_INT}",
            "`bpy.types.SubsurfModifier.render_levels` takes an int, not 2.0. Write `mod.render_levels = 2`.",
            "MultiresModifier",
        ),
        (
            "count.default_value = 10.0",
            f"{_PROPERTY}NodeTreeInterfaceSocketInt.default_value {_NO_INT}",
            "Write `count.default_value = 10`.",
            "may also stand for",
        ),
        ("disc.pass_index = 1.0", f"{_PROPERTY}Object.pass_index {_NO_INT}", "`disc.pass_index = 1`", "Material"),
        (
            "text = strips.new_effect(name='T', type='TEXT', channel=1, frame_start=1, frame_end=9)",
            "TypeError: StripsTopLevel.new_effect(): was called with invalid keyword argument(s) (frame_end), expected "
            "(name, type, channel, frame_start, length, input1, input2)",
            "Use `bpy.types.StripsTopLevel.new_effect(length=…)`",
            "StripsMeta",
        ),
        (
            "var.type = 'DISTANCE'",
            f"{_PROPERTY}enum \"DISTANCE\" not found in ('SINGLE_PROP', 'TRANSFORMS', 'ROTATION_DIFF', 'LOC_DIFF', "
            "'CONTEXT_PROP')",
            "of that label: `LOC_DIFF`",
            "'MESH'",
        ),
        (
            "space.ui_mode = 'UV'",
            f"{_PROPERTY}enum \"UV\" not found in ('VIEW', 'PAINT', 'MASK')",
            "which has `VIEW`, `PAINT`, `MASK`",
            "DOPESHEET",
        ),
        (
            "bpy.ops.wm.obj_export(filepath='a.obj', forward_axis='-Z')",
            f"{_OPERATOR}: enum \"-Z\" not found in ('X', 'Y', 'Z', 'NEGATIVE_X', 'NEGATIVE_Y', 'NEGATIVE_Z')",
            "closest: `NEGATIVE_Z`",
            "closest: `Z`",
        ),
        (
            "bpy.ops.object.my_scatter(seed=2, amount=3)",
            f'{_OPERATOR}:: keyword "amount" unrecognized',
            "`bpy.ops.object.my_scatter` is none of Blender's operators",
            "KeyConfigurations",
        ),
        (
            "bpy.ops.mesh.extrude_region_move(TRANSFORM_OT_translate={'value': (0, 0, 1), 'proportional': 'DISABLED'})",
            f'{_OPERATOR}:: keyword "proportional" unrecognized',
            "`bpy.ops.transform.translate(use_proportional_edit=…)`",
            "It takes `MESH_OT_extrude_region`",
        ),
        (
            "print(slot.name)",
            "AttributeError: 'ActionSlot' object has no attribute 'name'",
            "Closest: `bpy.types.ActionSlot.name_display`",
            "id_data",
        ),
        (
            "print(edge.calc_length(), edge.length)",
            "AttributeError: 'BMEdge' object has no attribute 'length'",
            "Closest: `bmesh.types.BMEdge.calc_length`",
            "layer",
        ),
        (
            "print(slot.name, slot.name_display)",
            "AttributeError: 'ActionSlot' object has no attribute 'name'",
            "Closest: `bpy.types.ActionSlot.name_display`",
            "id_data",
        ),
        (
            "keys.key_blocks.new('Smile')",
            'AttributeError: bpy_prop_collection: attribute "new" not found',
            "`obj.shape_key_add(name=",
            "idprop",
        ),
        (
            "e.crease = 1.0",
            "AttributeError: 'BMEdge' object has no attribute 'crease' and no __dict__ for setting new attributes",
            'layers.float.get("crease_edge")',
            "copy_from",
        ),
        (
            "group.weight = '0.5'",
            f"{_PROPERTY}VertexGroupElement.weight expected a float type, not str",
            "`float(value)`",
            "whole number",
        ),
        (
            "layer.frames.remove(frame)",
            'TypeError: GreasePencilFrames.remove(): error with argument 1, "frame_number" -  Function.frame_number '
            "expected an int type, not GreasePencilFrame",
            "`frame.frame_number`",
            "whole number",
        ),
        (
            "print(bag.fcurves)",
            "AttributeError: 'NoneType' object has no attribute 'fcurves'",
            "`strip.channelbag(slot, ensure=True)`",
            "new object",
        ),
        (
            "print(bpy.context.curve)",
            "AttributeError: 'Context' object has no attribute 'curve'",
            "an area of type PROPERTIES",
            "has no `curve`",
        ),
        (
            'tree.links.new(group_input.outputs["Radius"], circle.inputs["Radius"])',
            "KeyError: 'bpy_prop_collection[key]: key \"Radius\" not found'",
            "those of the tree's interface",
            "no modifier",
        ),
        (
            "bpy.ops.extensions.package_install(repo_index=0, pkg_id='x')",
            "RuntimeError: Operator bpy.ops.extensions.package_install.poll() Online access required to install or "
            "update. Enable online access in System preferences",
            "use_online_access = True",
            "took nothing",
        ),
    ],
)  # fmt: skip
def test_what_a_message_names_decides(
    kb: KnowledgeBase, line: str, message: str, said: str, unsaid: str
) -> None:
    notes = "\n".join(kb.query(f"{line}\n{message}").notes)
    assert said in notes
    assert unsaid not in notes


def test_what_only_a_newer_blender_has_leads_to_what_this_one_has(kb: KnowledgeBase) -> None:
    notes = "\n".join(kb.query("AttributeError: 'NodesModifier' object has no attribute 'properties'").notes)
    assert 'modifier["Socket_2"]' in notes
