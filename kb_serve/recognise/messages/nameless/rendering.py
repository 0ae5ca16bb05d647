"""Messages of rendering and baking that name nothing of the API."""

from __future__ import annotations

from kb_build.symbols.api_names import TYPES as T
from kb_serve.recognise.messages.nameless.message import NamelessMessage

_O = "bpy.ops.object."
RENDERING = (
    NamelessMessage(
        ("Cannot render, no camera",),
        (f"{T}Scene.camera", f"{T}BlendDataCameras.new"),
        "`scene.camera = obj`, an object with a camera as data.",
    ),
    NamelessMessage(
        ("Cannot write a single file with an animation format selected",),
        (
            "bpy.ops.render.render",
            f"{T}ImageFormatSettings.media_type",
            f"{T}ImageFormatSettings.file_format",
        ),
        "A video is rendered by `bpy.ops.render.render(animation=True)`. For one image choose a format of images: "
        "`settings = scene.render.image_settings`, `settings.media_type = 'IMAGE'` (since 5.0), "
        "`settings.file_format = 'PNG'`.",
    ),
    NamelessMessage(
        ("Combined bake pass requires Emission",),
        (f"{_O}bake",),
        "`pass_filter` lacks what the pass is made of: it needs `'EMIT'`, or `'DIRECT'` or `'INDIRECT'` together "
        "with one of `'DIFFUSE'`, `'GLOSSY'`, `'TRANSMISSION'`: "
        "`bpy.ops.object.bake(type='COMBINED', pass_filter={'DIRECT', 'INDIRECT', 'DIFFUSE'})`.",
    ),
    NamelessMessage(
        ("Current render engine does not support baking",),
        (f"{_O}bake", f"{T}RenderSettings.engine"),
        "Cycles does: `scene.render.engine = 'CYCLES'`.",
    ),
    NamelessMessage(
        ("No active ", "image ", "found in material "),
        (f"{_O}bake", f"{T}Nodes.active"),
        "A bake writes into the image of each material's active node, which must be selected, too: add one "
        "(`node = nodes.new('ShaderNodeTexImage')`), give it an image, then `nodes.active = node` and "
        "`node.select = True`.",
    ),
    NamelessMessage(
        ("No active image found, add a material",),
        (f"{_O}bake", f"{T}Nodes.active"),
        "The object has no material with an image to bake into: give it one whose active node is an image texture, or "
        "bake with `target='VERTEX_COLORS'` or `save_mode='EXTERNAL'`.",
    ),
    NamelessMessage(
        ("No valid selected objects",),
        (f"{_O}bake", f"{T}Object.select_set"),
        "Select the objects first (`obj.select_set(True)`), and make one active.",
    ),
    NamelessMessage(
        (" not found in ('CPU', 'GPU')",),
        ("bpy.types.CyclesRenderSettings.device", "bpy.types.CyclesPreferences.compute_device_type"),
        "The scene is told that a graphics card computes, the preferences by what: `scene.cycles.device = 'GPU'`; "
        "`prefs = bpy.context.preferences.addons['cycles'].preferences`; `prefs.compute_device_type = 'CUDA'` (or "
        "OPTIX, HIP, METAL, ONEAPI); `prefs.get_devices()`; `for device in prefs.devices: device.use = True`.",
    ),
    NamelessMessage(
        ("Bake failed: no Fluid modifier found",),
        ("bpy.ops.fluid.bake_all",),
        "The active object must be the fluid's domain: `view_layer.objects.active = domain`.",
    ),
    NamelessMessage(
        ("Bake failed: invalid domain",),
        ("bpy.ops.fluid.bake_all", f"{T}FluidModifier.fluid_type"),
        "The active object must be the fluid's domain, of `fluid_type = 'DOMAIN'`.",
    ),
    NamelessMessage(
        ("Strips.new_effect: invalid length",),
        (f"{T}StripsTopLevel.new_effect",),
        "Effects without input strips (TEXT, COLOR, ADJUSTMENT, MULTICAM) need a length: "
        "`strips.new_effect(name=\"Title\", type='TEXT', channel=2, frame_start=1, length=50)`.",
    ),
)
