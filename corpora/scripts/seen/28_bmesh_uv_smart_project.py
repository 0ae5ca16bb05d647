"""Scale and offset the UV islands of each face with bmesh after a smart UV project, and export nothing."""
import bpy
import bmesh
from math import radians
from mathutils import Vector


def smart_unwrap(ob):
    bpy.context.view_layer.objects.active = ob
    ob.select_set(True)
    bpy.ops.object.mode_set(mode='EDIT')
    bpy.ops.mesh.select_all(action='SELECT')
    bpy.ops.uv.smart_project(angle_limit=radians(66), island_margin=0.02,
                             area_weight=0.0, correct_aspect=True, scale_to_bounds=False)
    bpy.ops.object.mode_set(mode='OBJECT')


def shrink_faces(ob, factor=0.9):
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    bm.faces.ensure_lookup_table()
    uv = bm.loops.layers.uv.verify()
    pin_count = 0
    for face in bm.faces:
        center = Vector((0, 0))
        for loop in face.loops:
            center += loop[uv].uv
        center /= len(face.loops)
        for loop in face.loops:
            luv = loop[uv]
            luv.uv = center + (luv.uv - center) * factor
            luv.pin_uv = True
            luv.select = False
            pin_count += 1
    bm.to_mesh(ob.data)
    bm.free()
    ob.data.update()
    return pin_count


def checker_image(name="UVChecker", size=512):
    img = bpy.data.images.new(name, width=size, height=size)
    img.generated_type = 'COLOR_GRID'
    return img


bpy.ops.mesh.primitive_monkey_add()
ob = bpy.context.active_object
smart_unwrap(ob)
print("pinned loops:", shrink_faces(ob))

mat = bpy.data.materials.new("Checker")
mat.use_nodes = True
tex = mat.node_tree.nodes.new('ShaderNodeTexImage')
tex.image = checker_image()
tex.interpolation = 'Closest'
uvnode = mat.node_tree.nodes.new('ShaderNodeUVMap')
uvnode.uv_map = ob.data.uv_layers.active.name
mat.node_tree.links.new(uvnode.outputs['UV'], tex.inputs['Vector'])
mat.node_tree.links.new(tex.outputs['Color'], mat.node_tree.nodes['Principled BSDF'].inputs['Base Color'])
ob.data.materials.append(mat)
