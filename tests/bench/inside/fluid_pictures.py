"""Scenes for the pictures of what is checked of fluids. A dark frame shows where the domain is."""

import os

import bpy
from making import PLACE
from picture_parts import DARK, WATER, Shot, ball, box

LAST = 20
TANK = (1.3, 0.8, 0.9)


def part(thing, kind, **settings):
    """A fluid modifier of that type."""
    modifier = thing.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = kind
    for name, value in settings.items():
        setattr(getattr(modifier, f"{kind.lower()}_settings"), name, value)
    return thing


def tank(name, *, mesh):
    """A domain of liquid, and the frame around it."""
    frame = box("Frame", (0, 0, 0), TANK, DARK)
    frame.modifiers.new("Wire", "WIREFRAME").thickness = 0.02
    return part(
        box(name, (0, 0, 0), TANK, WATER),
        "DOMAIN",
        domain_type="LIQUID",
        resolution_max=24,
        use_mesh=mesh,
        cache_type="ALL",
        cache_frame_end=LAST,
    )


def run(domain):
    """Simulates the fluid, into a folder of its own."""
    folders = sum(name.startswith("fluid") for name in os.listdir(PLACE))
    domain.modifiers["Fluid"].domain_settings.cache_directory = os.path.join(PLACE, f"fluid{folders}")
    bpy.context.view_layer.objects.active = domain
    bpy.ops.fluid.bake_all()


def fluid_mesh(holds):
    domain = tank("A", mesh=holds)
    part(ball("Tap", (-0.3, 0, 0.7), 0.1, DARK), "FLOW", flow_type="LIQUID", flow_behavior="INFLOW")
    run(domain)


SHOTS = {"fluid_mesh": Shot(fluid_mesh, (LAST,))}
