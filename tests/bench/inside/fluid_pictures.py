"""Scenes for the pictures of what is checked of fluids. A dark frame shows where the domain is."""

import os

import bpy
from making import PLACE, keys
from picture_parts import DARK, WATER, A, B, Shot, ball, box

LAST = 20
TANK = (1.3, 0.8, 0.9)


def part(thing, kind, **settings):
    """A fluid modifier of that type."""
    modifier = thing.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = kind
    for name, value in settings.items():
        setattr(getattr(modifier, f"{kind.lower()}_settings"), name, value)
    return thing


def tank(name="Tank", kind="LIQUID", resolution=24, *, mesh=True):
    """A domain, and the frame around it."""
    frame = box("Frame", (0, 0, 0), TANK, DARK)
    frame.modifiers.new("Wire", "WIREFRAME").thickness = 0.02
    return part(
        box(name, (0, 0, 0), TANK, WATER),
        "DOMAIN",
        domain_type=kind,
        resolution_max=resolution,
        use_mesh=mesh,
        cache_type="ALL",
        cache_frame_end=LAST,
    )


def tap(name="Tap", place=(-0.3, 0, 0.7), colour=DARK, kind="LIQUID"):
    return part(ball(name, place, 0.1, colour), "FLOW", flow_type=kind, flow_behavior="INFLOW")


def pool(depth):
    """Water at the bottom of the tank."""
    initially(box("Pool", (0, 0, 0.02), (TANK[0] - 0.04, TANK[1] - 0.04, depth), WATER))


def initially(thing):
    """Water is in its shape at first; the thing itself is not seen."""
    part(thing, "FLOW", flow_type="LIQUID", flow_behavior="GEOMETRY").hide_render = True


def run(domain):
    """Simulates the fluid, into a folder of its own. What is guided is baked in steps."""
    folders = sum(name.startswith("fluid") for name in os.listdir(PLACE))
    settings = domain.modifiers["Fluid"].domain_settings
    settings.cache_directory = os.path.join(PLACE, f"fluid{folders}")
    bpy.context.view_layer.objects.active = domain
    if settings.cache_type == "ALL":
        bpy.ops.fluid.bake_all()
        return
    if settings.use_guide:
        bpy.ops.fluid.bake_guides()
    bpy.ops.fluid.bake_data()


def fluid_modifier(holds):
    domain = tank()
    tap()
    shelf = box("A", (-0.2, 0, 0.35), (0.6, 0.5, 0.08), A)
    if holds:
        part(shelf, "EFFECTOR")
    run(domain)


def fluid_type(holds):
    domain = tank(kind="LIQUID" if holds else "GAS", mesh=holds)
    if holds:
        tap("A", colour=A)
    else:
        tap("A", (-0.3, 0, 0.12), A, "SMOKE")
        smoke(domain)
    run(domain)


def smoke(domain):
    """Its material is a volume."""
    nodes = domain.data.materials[0].node_tree
    volume = nodes.nodes.new("ShaderNodeVolumePrincipled")
    volume.inputs["Density"].default_value = 20
    output = nodes.nodes["Material Output"]
    nodes.links.remove(output.inputs["Surface"].links[0])
    nodes.links.new(volume.outputs["Volume"], output.inputs["Volume"])


def fluid_domain_exists(holds):
    domain = tank()
    pool(0.08)
    tap("A", (-0.3 if holds else -0.95, 0, 0.7), A)
    run(domain)


def fluid_flow_count(holds):
    domain = tank()
    tap("A", (-0.35, 0, 0.7), A)
    tap("B", (0.35, 0, 0.7), B).modifiers["Fluid"].flow_settings.use_inflow = holds
    run(domain)


def fluid_cache_baked(holds):
    bpy.context.scene.frame_end = LAST
    domain = tank("A")
    tap()
    if not holds:
        domain.modifiers["Fluid"].domain_settings.cache_frame_end = 8
    run(domain)


def fluid_dynamic_effector(holds):
    domain = tank()
    pool(0.22)
    paddle = box("A", (-0.5, 0, 0.03), (0.08, 0.7, 0.75), A)
    if holds:
        part(paddle, "EFFECTOR")
    height = paddle.location.z
    keys(paddle, "location", [(-0.5, 0, height), (0.2, 0, height)], [1, 14])
    run(domain)


def fluid_guiding(holds):
    domain = tank("A", "GAS", mesh=False)
    smoke(domain)
    tap(place=(-0.3, 0, 0.12), kind="SMOKE")
    plate = part(
        box("B", (-0.6, 0, 0.3), (0.2, 0.6, 0.5), B),
        "EFFECTOR",
        effector_type="GUIDE",
        velocity_factor=3,
        guide_mode="OVERRIDE",
    )
    height = plate.location.z
    keys(plate, "location", [(-0.6, 0, height), (0.5, 0, height)], [1, LAST])
    settings = domain.modifiers["Fluid"].domain_settings
    settings.cache_type = "MODULAR"
    settings.use_guide, settings.guide_source = holds, "EFFECTOR"
    settings.guide_alpha, settings.guide_beta = 0.5, 3
    run(domain)


def fluid_resolution(holds):
    domain = tank("A", resolution=64 if holds else 12)
    for x in (-0.36, -0.12, 0.12, 0.36):
        for y in (-0.14, 0.14):
            initially(ball("Drop", (x, y, 0.5), 0.085, WATER))
    run(domain)


def fluid_mesh(holds):
    domain = tank("A", mesh=holds)
    tap()
    run(domain)


SHOTS = {
    "fluid_modifier": Shot(fluid_modifier, (LAST,)),
    "fluid_type": Shot(fluid_type, (LAST,)),
    "fluid_domain_exists": Shot(fluid_domain_exists, (LAST,)),
    "fluid_flow_count": Shot(fluid_flow_count, (LAST,)),
    "fluid_cache_baked": Shot(fluid_cache_baked, (8, LAST)),
    "fluid_dynamic_effector": Shot(fluid_dynamic_effector, (1, 12)),
    "fluid_guiding": Shot(fluid_guiding, (1, LAST)),
    "fluid_resolution": Shot(fluid_resolution, (10,), look=(0, 0, 0.3), away=(1.6, -2.6, 1.45)),
    "fluid_mesh": Shot(fluid_mesh, (LAST,)),
}
