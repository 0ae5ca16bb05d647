"""Add-on with a UIList to-do list in the scene properties, preferences and menu entry."""
bl_info = {
    "name": "Scene Tasks",
    "blender": (5, 1, 0),
    "category": "Scene",
    "version": (0, 2),
}

import bpy


class TaskItem(bpy.types.PropertyGroup):
    name: bpy.props.StringProperty(name="Task", default="New task")
    done: bpy.props.BoolProperty(default=False)


class TASKS_UL_list(bpy.types.UIList):
    def draw_item(self, context, layout, data, item, icon, active_data, active_propname, index):
        if self.layout_type in {'DEFAULT', 'COMPACT'}:
            row = layout.row(align=True)
            row.prop(item, "done", text="")
            row.prop(item, "name", text="", emboss=False, icon='BOOKMARKS')
        elif self.layout_type == 'GRID':
            layout.alignment = 'CENTER'
            layout.label(text="", icon='BOOKMARKS')


class TASKS_OT_add(bpy.types.Operator):
    bl_idname = "tasks.add"
    bl_label = "Add Task"
    text: bpy.props.StringProperty(default="New task")

    def execute(self, context):
        item = context.scene.tasks.add()
        item.name = self.text
        context.scene.tasks_index = len(context.scene.tasks) - 1
        return {'FINISHED'}


class TASKS_OT_clear_done(bpy.types.Operator):
    bl_idname = "tasks.clear_done"
    bl_label = "Clear Done"

    def execute(self, context):
        tasks = context.scene.tasks
        for i in range(len(tasks) - 1, -1, -1):
            if tasks[i].done:
                tasks.remove(i)
        return {'FINISHED'}


class SCENE_PT_tasks(bpy.types.Panel):
    bl_label = "Tasks"
    bl_space_type = 'PROPERTIES'
    bl_region_type = 'WINDOW'
    bl_context = "scene"

    def draw(self, context):
        self.layout.template_list("TASKS_UL_list", "", context.scene, "tasks", context.scene, "tasks_index")
        row = self.layout.row()
        row.operator("tasks.add", icon='ADD').text = "Another one"
        row.operator("tasks.clear_done", icon='TRASH')


def menu(self, context):
    self.layout.operator(TASKS_OT_add.bl_idname)


classes = [TaskItem, TASKS_UL_list, TASKS_OT_add, TASKS_OT_clear_done, SCENE_PT_tasks]


def register():
    for cls in classes:
        bpy.utils.register_class(cls)
    bpy.types.Scene.tasks = bpy.props.CollectionProperty(type=TaskItem)
    bpy.types.Scene.tasks_index = bpy.props.IntProperty()
    bpy.types.VIEW3D_MT_object.append(menu)


if __name__ == "__main__":
    register()
    bpy.ops.tasks.add(text="Light the scene")
    bpy.context.scene["tasks"][0]["done"] = True
    bpy.ops.tasks.clear_done()
    print("left:", len(bpy.context.scene.tasks))
