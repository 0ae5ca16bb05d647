"""Add drivers so that the wheels of a car rotate when the body moves along Y."""
import bpy
import math

wheel_radius = 0.4

bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 0.9))
body = bpy.context.object
body.name = "CarBody"
body.scale = (1.6, 3.6, 0.8)
body["wheel_radius"] = wheel_radius
ui = body.id_properties_ui("wheel_radius")
ui.update(min=0.05, max=2.0, description="Radius of the wheels", default=0.4)

wheels = []
for x in (-0.9, 0.9):
    for y in (-1.2, 1.2):
        bpy.ops.mesh.primitive_cylinder_add(radius=wheel_radius, depth=0.25, location=(x, y, wheel_radius))
        w = bpy.context.object
        w.rotation_euler = (0, math.radians(90), 0)
        bpy.ops.object.transform_apply(rotation=True, location=False, scale=False)
        w.name = "Wheel"
        w.parent = body
        w.matrix_parent_inverse = body.matrix_world.inverted()
        wheels.append(w)

for w in wheels:
    fcurve = w.driver_add("rotation_euler", 0)
    drv = fcurve.driver
    drv.type = 'SCRIPTED'

    var = drv.variables.new()
    var.name = "dist"
    var.type = 'TRANSFORMS'
    var.targets[0].id = body
    var.targets[0].transform_type = 'LOC_Y'
    var.targets[0].transform_space = 'WORLD_SPACE'

    var2 = drv.variables.new()
    var2.name = "radius"
    var2.type = 'SINGLE_PROP'
    var2.targets[0].id = body
    var2.targets[0].data_path = '["wheel_radius"]'

    drv.expression = "-dist / max(radius, 0.001)"
    if fcurve.modifiers:
        fcurve.modifiers.remove(fcurve.modifiers[0])

body.keyframe_insert("location", frame=1)
body.location.y = 10
body.keyframe_insert("location", frame=100)

for f in (1, 50, 100):
    bpy.context.scene.frame_set(f)
    print(f, [round(w.rotation_euler.x, 2) for w in wheels])
