"""Small scenes for proofs: cloth, bodies and particles in motion; the same not baked; a liquid; a still room."""

import bpy
from making import FRAMES, add, bake, body, cloth_on, empty, finish, get, into, new, save


def drape():
    new()
    body(add("plane", "Floor", size=12), "PASSIVE")
    table = add("cube", "Table", (0, 0, 0.5), size=1)
    table.modifiers.new("Collision", "COLLISION")
    cloth = add("grid", "Tablecloth", (0, 0, 1.2), size=2, x_subdivisions=8, y_subdivisions=8)
    pins = cloth.vertex_groups.new(name="Pins")
    pins.add([40], 1.0, "REPLACE")
    cloth_on(cloth).settings.vertex_group_mass = "Pins"
    for number in (1, 2):
        body(add("cube", f"Domino.{number:03d}", (2 + number, 2, 1), size=0.4))
    brazier = add("cube", "Brazier", (-2, -2, 0.3), size=0.6)
    brazier.modifiers.new("Sparks", "PARTICLE_SYSTEM")
    spark = add("ico_sphere", "Spark", (9, 9, -3), subdivisions=1, radius=1)
    system = brazier.particle_systems[0]
    system.settings.count, system.settings.frame_end, system.settings.lifetime = 12, 6, 20
    system.settings.render_type, system.settings.instance_object = "OBJECT", spark
    system.settings.particle_size = 0.1
    system.point_cache.frame_end = FRAMES
    lamp()
    view()
    bpy.context.scene.collection.objects.unlink(spark)
    into("Shown only", spark)


def lamp():
    stand = empty("Lamp", (-2, 2, 0))
    add("cylinder", "Stand", (-2, 2, 0.5), radius=0.1, depth=1)
    add("cone", "Shade", (-2, 2, 1.2), radius1=0.3, depth=0.4)
    bpy.context.view_layer.update()
    for name in ("Stand", "Shade"):
        get(name).parent = stand
        get(name).matrix_parent_inverse = stand.matrix_world.inverted()


def view():
    bpy.ops.object.camera_add(location=(7, -7, 5), rotation=(1.1, 0, 0.785))
    bpy.context.scene.camera = bpy.context.object


def pour():
    new(8)
    tap = add("ico_sphere", "Tap", (0, 0, 0.5), radius=0.3)
    flow = tap.modifiers.new("Fluid", "FLUID")
    flow.fluid_type = "FLOW"
    flow.flow_settings.flow_type, flow.flow_settings.flow_behavior = "LIQUID", "INFLOW"
    water = add("cube", "Water", size=2)
    modifier = water.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    domain = modifier.domain_settings
    domain.domain_type, domain.resolution_max, domain.use_mesh = "LIQUID", 24, True
    domain.cache_type, domain.cache_frame_end = "ALL", 8
    view()
    save("pour")
    bpy.context.view_layer.objects.active = water
    domain.cache_directory = "//water"
    bpy.ops.fluid.bake_all()
    save("pour")


def room():
    new(1)
    add("plane", "Floor", size=6)
    lamp()
    for number in range(3):
        add("cube", f"Book.{number:03d}", (-1.4, 2, 0.05 + 0.1 * number), size=0.1)
    into("Books", *(get(f"Book.{number:03d}") for number in range(3)))
    view()
    save("room")


def main():
    drape()
    save("slack")
    bake()
    save("drape")
    pour()
    room()
    finish({})


main()
