"""Add-on with an operator, N-panel and property group: creates a circle of cubes."""
bl_info = {
    "name": "Circle of Cubes",
    "author": "Example",
    "version": (1, 0, 0),
    "blender": (5, 1, 0),
    "location": "View3D > Sidebar > Create",
    "description": "Adds cubes in a circle",
    "category": "Object",
}

import bpy
from bpy.props import IntProperty, FloatProperty, BoolProperty, PointerProperty, EnumProperty
from math import cos, sin, tau


class CircleSettings(bpy.types.PropertyGroup):
    count: IntProperty(name="Count", default=12, min=1, max=200)
    radius: FloatProperty(name="Radius", default=4.0, min=0.1, subtype='DISTANCE', unit='LENGTH')
    face_center: BoolProperty(name="Face Center", default=True)
    shape: EnumProperty(name="Shape", items=[
        ('CUBE', "Cube", "Use cubes", 'MESH_CUBE', 0),
        ('CONE', "Cone", "Use cones", 'MESH_CONE', 1),
    ], default='CUBE')


class OBJECT_OT_circle_of_cubes(bpy.types.Operator):
    """Create a ring of primitives around the 3D cursor"""
    bl_idname = "object.circle_of_cubes"
    bl_label = "Create Circle"
    bl_options = {'REGISTER', 'UNDO'}

    @classmethod
    def poll(cls, context):
        return context.mode == 'OBJECT'

    def execute(self, context):
        s = context.scene.circle_settings
        origin = context.scene.cursor.location
        add = bpy.ops.mesh.primitive_cube_add if s.shape == 'CUBE' else bpy.ops.mesh.primitive_cone_add
        for i in range(s.count):
            a = tau * i / s.count
            loc = (origin.x + cos(a) * s.radius, origin.y + sin(a) * s.radius, origin.z)
            add(location=loc, rotation=(0, 0, a if s.face_center else 0))
            context.object.scale = (0.4, 0.4, 0.4)
        self.report({'INFO'}, f"Created {s.count} objects")
        return {'FINISHED'}


class VIEW3D_PT_circle_panel(bpy.types.Panel):
    bl_label = "Circle of Cubes"
    bl_space_type = 'VIEW_3D'
    bl_region_type = 'UI'
    bl_category = "Create"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        s = context.scene.circle_settings
        for name in ("shape", "count", "radius", "face_center"):
            layout.prop(s, name)
        layout.operator(OBJECT_OT_circle_of_cubes.bl_idname, icon='MESH_CIRCLE')


classes = (CircleSettings, OBJECT_OT_circle_of_cubes, VIEW3D_PT_circle_panel)


def register():
    for c in classes:
        bpy.utils.register_class(c)
    bpy.types.Scene.circle_settings = PointerProperty(type=CircleSettings)


def unregister():
    del bpy.types.Scene.circle_settings
    for c in reversed(classes):
        bpy.utils.unregister_class(c)


if __name__ == "__main__":
    register()
    bpy.ops.object.circle_of_cubes()
