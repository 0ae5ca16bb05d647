# SPDX-License-Identifier: GPL-3.0-or-later
"""An empty scene, its camera and lights, and materials, keys and parents of objects. Lengths are metres, Z is up."""

import math

import bpy
from mathutils import Vector

FPS = 24


def begin(frames):
    """Makes an empty scene of so many frames, from 1."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, frames
    scene.render.fps = FPS
    return scene


def last():
    """The last frame of the clip."""
    return bpy.context.scene.frame_end


def paint(obj, *, colour=(0.6, 0.6, 0.6), roughness=0.6, metal=0.0, clear=0.0, glow=0.0):
    """Gives an object a material of its own. ``colour``: red, green, blue; ``clear``: how much light it lets through
    (0 to 1); ``glow``: how much it emits.
    """
    material = bpy.data.materials.new(f"{obj.name} surface")
    material.diffuse_color = (*colour, 1)
    surface = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    surface.inputs["Base Color"].default_value = (*colour, 1)
    surface.inputs["Roughness"].default_value = roughness
    surface.inputs["Metallic"].default_value = metal
    surface.inputs["Transmission Weight"].default_value = clear
    surface.inputs["Emission Color"].default_value = (*colour, 1)
    surface.inputs["Emission Strength"].default_value = glow
    obj.data.materials.clear()
    obj.data.materials.append(material)
    return obj


def vapour(obj, *, colour=(0.8, 0.8, 0.8), density=5.0, fire=0.0):
    """Gives the domain of a gas a material that shows its smoke, and its flames by the light ``fire``."""
    material = bpy.data.materials.new(f"{obj.name} vapour")
    material.diffuse_color = (*colour, 1)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.remove(next(node for node in nodes if node.type == "BSDF_PRINCIPLED"))
    volume = nodes.new("ShaderNodeVolumePrincipled")
    volume.inputs["Color"].default_value = (*colour, 1)
    volume.inputs["Density"].default_value = density
    links.new(
        volume.outputs["Volume"], next(n for n in nodes if n.type == "OUTPUT_MATERIAL").inputs["Volume"]
    )
    if fire:
        flame, brightness = nodes.new("ShaderNodeAttribute"), nodes.new("ShaderNodeMath")
        flame.attribute_name = "flame"
        brightness.operation, brightness.inputs[1].default_value = "MULTIPLY", fire
        links.new(flame.outputs["Fac"], brightness.inputs[0])
        links.new(brightness.outputs["Value"], volume.inputs["Emission Strength"])
        volume.inputs["Emission Color"].default_value = (1, 0.3, 0.05, 1)
    obj.data.materials.clear()
    obj.data.materials.append(material)
    return obj


def camera(at, towards, lens=35.0):
    """Makes the scene's camera."""
    obj = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(obj)
    obj.location = at
    obj.rotation_euler = (Vector(towards) - Vector(at)).to_track_quat("-Z", "Y").to_euler()
    obj.data.lens = lens
    bpy.context.scene.camera = obj
    return obj


def light(*, sun=3.0, elevation=50.0, azimuth=-40.0, sky=(0.6, 0.7, 0.85), colour=(1, 1, 1)):
    """A sun (strength, degrees above the horizon, degrees from +Y), and a sky of one colour."""
    obj = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    bpy.context.scene.collection.objects.link(obj)
    obj.data.energy, obj.data.color, obj.data.angle = sun, colour, math.radians(2)
    obj.rotation_euler = (math.radians(90 - elevation), 0, math.radians(azimuth))
    world = bpy.data.worlds.new("World")
    bpy.context.scene.world = world
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (*sky, 1)
    return obj


def lamp(name, power, at, *, colour=(1, 1, 1), size=0.1):
    """A point light of ``power`` watts, a ball of radius ``size``."""
    obj = bpy.data.objects.new(name, bpy.data.lights.new(name, "POINT"))
    bpy.context.scene.collection.objects.link(obj)
    obj.location = at
    obj.data.energy, obj.data.color, obj.data.shadow_soft_size = power, colour, size
    return obj


def keys(obj, path, values, *, even=False):
    """Sets keys on a property: frame → value. For objects that are moved by hand: a tap that tilts, a plate that turns.

    ``even``: at constant speed from key to key, up to the last one; else it eases in and out.
    """
    owner, _, name = path.rpartition(".")
    target = obj.path_resolve(owner) if owner else obj
    for frame, value in values.items():
        setattr(target, name, value)
        target.keyframe_insert(name, frame=frame)
    if even:
        animation = obj.animation_data
        strip = animation.action.layers[0].strips[0]
        for curve in strip.channelbag(animation.action_slot).fcurves:
            for key in curve.keyframe_points if curve.data_path == path else ():
                key.interpolation = "LINEAR"


def under(parent, *objects):
    """Makes objects the children of another, and leaves them where they are."""
    bpy.context.view_layer.update()
    for obj in objects:
        obj.parent = parent
        obj.matrix_parent_inverse = parent.matrix_world.inverted()
    return parent
