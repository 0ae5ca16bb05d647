"""Add-on with a UIList of render presets stored in the scene, add, remove and apply operators."""
import bpy


class RenderPreset(bpy.types.PropertyGroup):
    name: bpy.props.StringProperty(default="Preset")
    engine: bpy.props.EnumProperty(items=[
        ('BLENDER_EEVEE', "Eevee", ""),
        ('CYCLES', "Cycles", ""),
        ('BLENDER_WORKBENCH', "Workbench", "")])
    res: bpy.props.IntVectorProperty(size=2, default=(1920, 1080), min=4)
    samples: bpy.props.IntProperty(default=64, min=1)


class SCENE_UL_presets(bpy.types.UIList):
    def draw_item(self, context, layout, data, item, icon, active_data, active_propname, index):
        if self.layout_type in {'DEFAULT', 'COMPACT'}:
            row = layout.row()
            row.prop(item, "name", text="", emboss=False, icon='RENDER_STILL')
            row.label(text="%dx%d" % tuple(item.res))
        elif self.layout_type == 'GRID':
            layout.label(text="", icon='RENDER_STILL')


class PRESET_OT_edit(bpy.types.Operator):
    bl_idname = "scene.preset_edit"
    bl_label = "Edit Presets"
    bl_options = {'REGISTER', 'UNDO'}
    action: bpy.props.EnumProperty(items=[('ADD', "Add", ""), ('REMOVE', "Remove", ""), ('APPLY', "Apply", "")])

    def execute(self, context):
        sc = context.scene
        if self.action == 'ADD':
            p = sc.render_presets.add()
            p.name = "Preset %d" % len(sc.render_presets)
            sc.render_presets_index = len(sc.render_presets) - 1
        elif not sc.render_presets:
            return {'CANCELLED'}
        elif self.action == 'REMOVE':
            sc.render_presets.remove(sc.render_presets_index)
            sc.render_presets_index = max(0, sc.render_presets_index - 1)
        else:
            p = sc.render_presets[sc.render_presets_index]
            sc.render.engine = p.engine
            sc.render.resolution_x, sc.render.resolution_y = p.res
            if p.engine == 'CYCLES':
                sc.cycles.samples = p.samples
            else:
                sc.eevee.taa_render_samples = p.samples
        return {'FINISHED'}


class RENDER_PT_presets(bpy.types.Panel):
    bl_label = "Render Presets"
    bl_space_type = 'PROPERTIES'
    bl_region_type = 'WINDOW'
    bl_context = "render"

    def draw(self, context):
        sc = context.scene
        row = self.layout.row()
        row.template_list("SCENE_UL_presets", "", sc, "render_presets", sc, "render_presets_index", rows=3)
        col = row.column(align=True)
        col.operator("scene.preset_edit", text="", icon='ADD').action = 'ADD'
        col.operator("scene.preset_edit", text="", icon='REMOVE').action = 'REMOVE'
        self.layout.operator("scene.preset_edit", text="Apply", icon='FILE_TICK').action = 'APPLY'


classes = (RenderPreset, SCENE_UL_presets, PRESET_OT_edit, RENDER_PT_presets)


def register():
    for c in classes:
        bpy.utils.register_class(c)
    bpy.types.Scene.render_presets = bpy.props.CollectionProperty(type=RenderPreset)
    bpy.types.Scene.render_presets_index = bpy.props.IntProperty()


register()
bpy.ops.scene.preset_edit(action='ADD')
bpy.ops.scene.preset_edit(action='APPLY')
print(bpy.context.scene.render.engine)
