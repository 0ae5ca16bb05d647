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


def tap(name="Tap", place=(-0.3, 0, 0.7), colour=DARK, *, kind="LIQUID"):
    return part(ball(name, place, 0.1, colour), "FLOW", flow_type=kind, flow_behavior="INFLOW")


def water(name, place, size):
    """What is water at first. It is not seen itself."""
    thing = part(box(name, place, size, WATER), "FLOW", flow_type="LIQUID", flow_behavior="GEOMETRY")
    thing.hide_render = True


def run(domain):
    """Simulates the fluid, into a folder of its own."""
    folders = sum(name.startswith("fluid") for name in os.listdir(PLACE))
    domain.modifiers["Fluid"].domain_settings.cache_directory = os.path.join(PLACE, f"fluid{folders}")
    bpy.context.view_layer.objects.active = domain
    settings = domain.modifiers["Fluid"].domain_settings
    if settings.use_guide:
        bpy.ops.fluid.bake_guides()
    if settings.cache_type == "MODULAR":
        bpy.ops.fluid.bake_data()
    else:
        bpy.ops.fluid.bake_all()


def fluid_modifier(holds):
    domain = tank()
    if holds:
        tap("A", colour=A)
    else:
        ball("A", (-0.3, 0, 0.7), 0.1, A)
    run(domain)


def fluid_type(holds):
    domain = tank("A", "LIQUID" if holds else "GAS", mesh=holds)
    if holds:
        tap()
    else:
        tap(place=(-0.3, 0, 0.15), kind="SMOKE")
        smoke(domain)
    run(domain)


def smoke(domain):
    """Its material is a volume."""
    nodes = domain.data.materials[0].node_tree
    volume = nodes.nodes.new("ShaderNodeVolumePrincipled")
    volume.inputs["Density"].default_value = 12
    output = nodes.nodes["Material Output"]
    nodes.links.remove(output.inputs["Surface"].links[0])
    nodes.links.new(volume.outputs["Volume"], output.inputs["Volume"])


def fluid_domain_exists(holds):
    domain = tank()
    tap("A", (-0.3 if holds else -0.95, 0, 0.7), A)
    run(domain)


def fluid_flow_count(holds):
    domain = tank()
    tap("A", (-0.35, 0, 0.7), A)
    flow = tap("B", (0.35, 0, 0.7), B)
    flow.modifiers["Fluid"].flow_settings.use_inflow = holds
    run(domain)


def fluid_dynamic_effector(holds):
    domain = tank()
    water("Pool", (0, 0, 0.02), (1.26, 0.76, 0.25))
    paddle = part(box("A", (-0.5, 0, 0.03), (0.08, 0.7, 0.75), A), "EFFECTOR")
    if holds:
        height = paddle.location.z
        keys(paddle, "location", [(-0.5, 0, height), (0.25, 0, height)], [1, 16])
    run(domain)


def fluid_guiding(holds):
    domain = tank("A", "GAS", mesh=False)
    smoke(domain)
    tap(place=(-0.35, 0, 0.12), kind="SMOKE")
    guide = part(box("B", (-0.3, 0, 0.2), (0.5, 0.7, 0.6), B), "EFFECTOR", effector_type="GUIDE", velocity_factor=2)
    guide.modifiers.new("Wire", "WIREFRAME").thickness = 0.02
    keys(guide, "location", [(-0.3, 0, 0.5), (0.3, 0, 0.5)], [1, LAST])
    settings = domain.modifiers["Fluid"].domain_settings
    settings.cache_type, settings.use_guide, settings.guide_source = "MODULAR", holds, "EFFECTOR"
    run(domain)


def fluid_resolution(holds):
    domain = tank("A", resolution=40 if holds else 10)
    tap()
    run(domain)


def fluid_mesh(holds):
    domain = tank("A", mesh=holds)
    tap()
    run(domain)


SHOTS = {
    build.__name__: Shot(build, (LAST,))
    for build in (
        fluid_modifier,
        fluid_type,
        fluid_domain_exists,
        fluid_flow_count,
        fluid_dynamic_effector,
        fluid_guiding,
        fluid_resolution,
        fluid_mesh,
    )
}
