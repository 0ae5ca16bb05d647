"""Drivers: rotate a wheel from its X location, and drive a material colour from a custom property."""
import bpy

bpy.ops.mesh.primitive_cylinder_add(radius=0.5, depth=0.2, rotation=(1.5708, 0, 0), location=(0, 0, 0.5))
wheel = bpy.context.object
wheel.name = "Wheel"
wheel.rotation_mode = 'XYZ'

fcu = wheel.driver_add("rotation_euler", 1)
drv = fcu.driver
drv.type = 'SCRIPTED'
var = drv.variables.new()
var.name = "x"
var.type = 'TRANSFORMS'
var.targets[0].id = wheel
var.targets[0].transform_type = 'LOC_X'
var.targets[0].transform_space = 'WORLD_SPACE'
radius = drv.variables.new()
radius.name = "r"
radius.type = 'SINGLE_PROP'
wheel["radius"] = 0.5
radius.targets[0].id_type = 'OBJECT'
radius.targets[0].id = wheel
radius.targets[0].data_path = '["radius"]'
drv.expression = "x / r"

ctrl = bpy.data.objects.new("Control", None)
bpy.context.collection.objects.link(ctrl)
ctrl["heat"] = 0.0
ui = ctrl.id_properties_ui("heat")
ui.update(min=0.0, max=1.0, soft_min=0.0, soft_max=1.0, description="How hot it is", default=0.0)

mat = bpy.data.materials.new("Hot")
mat.use_nodes = True
wheel.data.materials.append(mat)
emission = mat.node_tree.nodes["Principled BSDF"].inputs["Emission Strength"]
d = emission.driver_add("default_value").driver
d.type = 'AVERAGE'
v = d.variables.new()
v.name = "heat"
v.targets[0].id = ctrl
v.targets[0].data_path = '["heat"]'


def ease(t):
    return t * t * (3 - 2 * t)


bpy.app.driver_namespace["ease"] = ease
fz = wheel.driver_add("scale", 2).driver
fz.use_self = False
v2 = fz.variables.new()
v2.name = "h"
v2.targets[0].id = ctrl
v2.targets[0].data_path = '["heat"]'
fz.expression = "1 + 0.3 * ease(h)"

ctrl["heat"] = 0.5
ctrl.update_tag()
bpy.context.view_layer.update()
wheel.location.x = 2.0
bpy.context.view_layer.update()
print("rotation:", wheel.rotation_euler.y, "scale z:", wheel.scale.z)
