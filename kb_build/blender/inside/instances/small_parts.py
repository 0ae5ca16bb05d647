# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the small things that larger ones hold: elements of meshes, points of curves, links, targets, proxies.

Each is made by a function that fails where a Blender has no such thing.
"""

import bpy

from .making import add_object, all_strips, mesh_object, new_modifier

MISSING = (AttributeError, IndexError, RuntimeError, TypeError)


def mesh_of_one_face():
    """A mesh of one triangle, as scripts build one element by element."""
    mesh = bpy.data.meshes.new("new")
    mesh.vertices.add(3)
    mesh.edges.add(1)
    mesh.loops.add(3)
    mesh.polygons.add(1)
    return mesh


def skin_vertex():
    """What a skin modifier gives each vertex."""
    obj = mesh_object()
    new_modifier(obj, "SKIN")
    return obj.data.skin_vertices[0].data[0]


def shape_key_point(kind):
    """A point of a shape key of a curve."""
    curve = bpy.data.curves.new("new", "CURVE")
    curve.splines.new(kind)
    bpy.data.objects.new("new", curve).shape_key_add(name="new")
    return curve.shape_keys.key_blocks[0].data[0]


def curve_node(tree):
    """A node with a curve that can be edited."""
    return tree.nodes.new("ShaderNodeRGBCurve")


def node_link():
    """A link of two nodes."""
    tree = bpy.data.node_groups.new("new", "ShaderNodeTree")
    return tree.links.new(curve_node(tree).outputs[0], curve_node(tree).inputs[1])


def curve_map_point():
    """A point added to a curve of a node."""
    tree = bpy.data.node_groups.new("new", "ShaderNodeTree")
    return curve_node(tree).mapping.curves[0].points.new(0.5, 0.5)


def f_curve():
    """An F-curve, of a driver."""
    obj = add_object(None)
    return obj.driver_add("location", 0)


def sampled_point():
    """A point of an F-curve that was baked into samples."""
    curve = f_curve()
    curve.keyframe_points.add(2)
    curve.convert_to_samples(1, 3)
    return curve.sampled_points[0]


def strip_proxy():
    """The proxies of a strip that uses some."""
    strip = all_strips(bpy.context.scene.sequence_editor_create()).new_image("new", "none.png", 1, 1)
    strip.use_proxy = True
    return strip.proxy


def mask_parent():
    """What a point of a mask may follow."""
    spline = bpy.data.masks.new("new").layers.new().splines.new()
    spline.points.add(1)
    return spline.points[0].parent


def cloud_point():
    """A point of a point cloud."""
    cloud = bpy.data.pointclouds.new("new")
    cloud.resize(1)
    return cloud.points[0]


def hair_point():
    """A point of curves as hair has them."""
    curves = bpy.data.hair_curves.new("new")
    curves.add_curves([2])
    return curves.points[0]


def linked_light():
    """How a light that is linked to a collection treats an object of it."""
    collection = bpy.data.collections.new("new")
    add_object(None).light_linking.receiver_collection = collection
    collection.objects.link(add_object(None))
    return collection.collection_objects[0].light_linking


def profile_point():
    """A point added to the profile of a bevel."""
    return new_modifier(mesh_object(), "BEVEL").custom_profile.points.add(0.5, 0.5)  # pyright: ignore[reportOptionalMemberAccess, reportAttributeAccessIssue]


def constraint_target():
    """A target of an armature constraint."""
    return add_object(None).constraints.new("ARMATURE").targets.new()


def style_texture_slot():
    """A texture slot of a line style."""
    return bpy.data.linestyles.new("new").texture_slots.add()


PARTS = (
    ("mesh vertex", lambda: mesh_of_one_face().vertices[0]), ("mesh edge", lambda: mesh_of_one_face().edges[0]),
    ("mesh loop", lambda: mesh_of_one_face().loops[0]), ("mesh polygon", lambda: mesh_of_one_face().polygons[0]),
    ("skin vertex", skin_vertex), ("bezier point of a shape key", lambda: shape_key_point("BEZIER")),
    ("point of a shape key", lambda: shape_key_point("POLY")), ("node link", node_link),
    ("curve map point of points.new()", curve_map_point), ("curve profile point of points.add()", profile_point),
    ("control point of an envelope modifier", lambda: f_curve().modifiers.new("ENVELOPE").control_points.add(1.0)),
    ("sampled point of an f-curve", sampled_point), ("strip proxy", strip_proxy), ("mask parent", mask_parent),
    ("point of a point cloud", cloud_point),
    ("point of hair curves", hair_point), ("target of an armature constraint", constraint_target),
    ("texture slot of a line style", style_texture_slot),
    ("light linking of a collection's object", linked_light),
    ("stereo 3d display", lambda: bpy.context.window.stereo_3d_display),
    ("vr session settings", lambda: bpy.context.window_manager.xr_session_settings),
)  # fmt: skip


def small_parts():
    """Each of them that this Blender has."""
    for label, make in PARTS:
        try:
            thing = make()
        except MISSING:
            continue
        yield label, thing
