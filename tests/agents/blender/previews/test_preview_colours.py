"""The previews: things have the colours that their materials say."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from preview_views import SIZE, Views, build, is_coloured

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender


MATERIALS = {
    "principled": "S.inputs['Base Color'].default_value = C",
    "metal": "S.inputs['Base Color'].default_value = C; S.inputs['Metallic'].default_value = 1",
    "diffuse": "n = add('BsdfDiffuse'); n.inputs[0].default_value = C; link(n.outputs[0], O.inputs[0])",
    "emission": "n = add('Emission'); n.inputs[0].default_value = C; n.inputs[1].default_value = 9\n"
    "link(n.outputs[0], O.inputs[0])",
    "glowing": "S.inputs['Base Color'].default_value = (0, 0, 0, 1); S.inputs['Emission Color'].default_value = C\n"
    "S.inputs['Emission Strength'].default_value = 4",
    "glass": "n = add('BsdfGlass'); n.inputs[0].default_value = C; link(n.outputs[0], O.inputs[0])",
    "mixed": "n = add('MixShader'); n.inputs[0].default_value = 0\n"
    "a = add('BsdfDiffuse'); a.inputs[0].default_value = C\n"
    "link(a.outputs[0], n.inputs[1]); link(S.outputs[0], n.inputs[2]); link(n.outputs[0], O.inputs[0])",
    "value": "n = add('RGB'); n.outputs[0].default_value = C; link(n.outputs[0], S.inputs[0])",
    "multiplied": "n = add('Mix'); n.data_type = 'RGBA'; n.blend_type = 'MULTIPLY'; n.inputs[0].default_value = 1\n"
    "n.inputs[6].default_value = C; n.inputs[7].default_value = (1, 1, 1, 1); link(n.outputs[2], S.inputs[0])",
    "ramp": "n = add('ValToRGB'); n.color_ramp.elements[0].color = C; n.color_ramp.elements[1].color = C\n"
    "t = add('TexNoise'); link(t.outputs[0], n.inputs[0]); link(n.outputs[0], S.inputs[0])",
    "group": "g = bpy.data.node_groups.new('G', 'ShaderNodeTree')\n"
    "g.interface.new_socket('In', in_out='INPUT', socket_type='NodeSocketColor')\n"
    "g.interface.new_socket('Out', in_out='OUTPUT', socket_type='NodeSocketColor')\n"
    "i, o = g.nodes.new('NodeGroupInput'), g.nodes.new('NodeGroupOutput'); g.links.new(i.outputs[0], o.inputs[0])\n"
    "n = add('Group'); n.node_tree = g; n.inputs[0].default_value = C; link(n.outputs[0], S.inputs[0])",
    "reroute": "n = add('RGB'); n.outputs[0].default_value = C; r = T.nodes.new('NodeReroute')\n"
    "link(n.outputs[0], r.inputs[0]); link(r.outputs[0], S.inputs[0])",
    "attribute": "n = add('VertexColor'); n.layer_name = 'Paint'; link(n.outputs[0], S.inputs[0])\n"
    "a = thing.data.color_attributes.new('Paint', 'FLOAT_COLOR', 'POINT')\n"
    "for point in a.data: point.color = C",
    "object colour": "n = add('ObjectInfo'); thing.color = C; link(n.outputs['Color'], S.inputs[0])",
    "picture": "i = bpy.data.images.new('P', 4, 4); i.pixels = list(C) * 16; n = add('TexImage'); n.image = i\n"
    "link(n.outputs[0], S.inputs[0])",
    "picture without UV": "i = bpy.data.images.new('Q', 4, 4); i.pixels = list(C) * 16\n"
    "n = add('TexImage'); n.image = i\n"
    "t = add('TexCoord'); link(t.outputs['Object'], n.inputs[0]); link(n.outputs[0], S.inputs[0])",
    "muted": "n = add('Gamma'); n.inputs[0].default_value = (1, 0, 0, 1); n.mute = True\n"
    "r = add('RGB'); r.outputs[0].default_value = C; link(r.outputs[0], n.inputs[0]); link(n.outputs[0], S.inputs[0])",
}


def test_colours_are_those_of_the_materials(session: LiveSession) -> None:
    rows = "\n".join(
        f"thing = box({name!r}, ({2 * at}, 0, 0)); M, T, S, O, add, link = fresh({name!r})\nC = {colour}\n{code}\n"
        "thing.data.materials.append(M)"
        for at, (name, code) in enumerate(MATERIALS.items())
        for colour in ((0.02, 0.02, 0.8, 1),)
    )
    build(
        session,
        "def fresh(name):\n"
        "    made = bpy.data.materials.new(name); made.use_nodes = True; tree = made.node_tree\n"
        "    return (made, tree, tree.nodes['Principled BSDF'], tree.get_output_node('ALL'),\n"
        "            lambda kind: tree.nodes.new('ShaderNode' + kind), tree.links.new)\n" + rows,
    )
    views = Views(session, "scene")
    top, metres = views.pictures["top"], views.by_name["top"]["metres_per_pixel"]
    wrong: list[str] = []
    for at, name in enumerate(MATERIALS):
        x = top.width / 2 + (2 * at - len(MATERIALS) + 1) / metres * top.width / SIZE
        box = top.getchannel("A").getbbox()
        assert box is not None
        pixel = top.getpixel((round(x), (box[1] + box[3]) // 2))
        assert isinstance(pixel, tuple)
        red, green, blue, alpha = pixel
        if blue < 1.5 * max(red, green) or not (30 < alpha < 200 if name == "glass" else alpha > 250):
            wrong.append(f"{name}: {pixel}")
    assert wrong == []


def test_a_material_of_the_object_wins_over_that_of_the_mesh(session: LiveSession) -> None:
    build(
        session,
        "o = box('Crate', rgb=(.8, 0, 0)); p = box('Other', rgb=(0, 0, .8))\n"
        "o.material_slots[0].link = 'OBJECT'; o.material_slots[0].material = p.active_material",
    )
    assert is_coloured(Views(session, "mesh", "Crate").middle("front"), "blue")


def test_textures_follow_uv_coordinates(session: LiveSession) -> None:
    build(
        session,
        "bpy.ops.mesh.primitive_plane_add(size=2); o = paint(bpy.context.object, 1, 1, 1)\n"
        "T = o.active_material.node_tree\n"
        "i = bpy.data.images.new('Halves', 8, 8)\n"
        "i.pixels = [part for at in range(64) for part in ((1, 0, 0, 1) if at % 8 < 4 else (0, 0, 1, 1))]\n"
        "n = T.nodes.new('ShaderNodeTexImage'); n.image = i; n.interpolation = 'Closest'\n"
        "T.links.new(n.outputs[0], T.nodes['Principled BSDF'].inputs[0])",
    )
    top = Views(session, "mesh", "Plane").pictures["top"]
    left, right = (top.getpixel((round(top.width * share), top.height // 2)) for share in (0.3, 0.7))
    assert isinstance(left, tuple)
    assert isinstance(right, tuple)
    assert is_coloured(left, "red")
    assert is_coloured(right, "blue")


def test_what_looks_away_from_the_light_is_darker_and_has_no_tint(session: LiveSession) -> None:
    boards = "".join(
        f"box('Board {turn}', ({turn}, 0, 0), (.2, 1, .02), turn=({turn}, 0, 0))\n" for turn in (1.4, -1.4)
    )
    build(session, f"{boards}collection('Board', 'object', *bpy.context.scene.objects)")
    for picture in Views(session, "object", "Board").pictures.values():
        data = picture.convert("RGBA").tobytes()
        shades = [data[at : at + 3] for at in range(0, len(data), 4) if data[at + 3] == 255]
        assert shades
        assert max(max(shade) - min(shade) for shade in shades) < 7
