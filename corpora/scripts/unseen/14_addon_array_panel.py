"""Small add-on with a sidebar panel, a property group and an operator that makes a circular array of the active object."""
import bpy
import math
from bpy.props import IntProperty, FloatProperty, BoolProperty, PointerProperty

bl_info = {
    "name": "Circular Array",
    "author": "me",
    "version": (1, 0, 0),
    "blender": (5, 1, 0),
    "location": "View3D > Sidebar > Tools",
    "category": "Object",
}


class CircArrayProps(bpy.types.PropertyGroup):
    count: IntProperty(name="Count", default=8, min=2, max=200)
    radius: FloatProperty(name="Radius", default=3.0, min=0.0, unit='LENGTH')
    linked: BoolProperty(name="Linked Data", default=True)


class OBJECT_OT_circular_array(bpy.types.Operator):
    """Place copies of the active object on a circle"""
    bl_idname = "object.circular_array"
    bl_label = "Circular Array"
    bl_options = {'REGISTER', 'UNDO'}

    @classmethod
    def poll(cls, context):
        return context.active_object is not None and context.mode == 'OBJECT'

    def execute(self, context):
        p = context.scene.circ_array
        src = context.active_object
        for i in range(p.count):
            a = 2 * math.pi * i / p.count
            ob = src.copy()
            if not p.linked and src.data:
                ob.data = src.data.copy()
            ob.location = (math.cos(a) * p.radius, math.sin(a) * p.radius, src.location.z)
            ob.rotation_euler.z = a
            context.collection.objects.link(ob)
        self.report({'INFO'}, "Created %d copies" % p.count)
        return {'FINISHED'}


class VIEW3D_PT_circular_array(bpy.types.Panel):
    bl_label = "Circular Array"
    bl_space_type = 'VIEW_3D'
    bl_region_type = 'UI'
    bl_category = "Tools"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        p = context.scene.circ_array
        col = layout.column(align=True)
        col.prop(p, "count")
        col.prop(p, "radius")
        layout.prop(p, "linked")
        layout.operator("object.circular_array", icon='MOD_ARRAY')


classes = (CircArrayProps, OBJECT_OT_circular_array, VIEW3D_PT_circular_array)


def register():
    for c in classes:
        bpy.utils.register_class(c)
    bpy.types.Scene.circ_array = PointerProperty(type=CircArrayProps)


def unregister():
    del bpy.types.Scene.circ_array
    for c in reversed(classes):
        bpy.utils.unregister_class(c)


if __name__ == "__main__":
    register()
