"""Messages of rendering and baking that name nothing of the API."""

from __future__ import annotations

from kb_build.symbols.api_names import TYPES as T
from kb_serve.recognise.messages.nameless.message import NamelessMessage

_O = "bpy.ops.object."
OF_32_BITS = (
    "`foreach_get()` and `foreach_set()` of a property take arrays of 32-bit floats alone, of one with whole numbers "
    "32-bit integers: `numpy.empty(len(image.pixels), dtype=numpy.float32)`, `array.astype(numpy.float32)`."
)
RENDERING = (
    NamelessMessage(
        ("enum identifier: '", "'POST_PIXEL'"),
        (f"{T}Space.draw_handler_add",),
        "The last argument says when to draw: 'POST_PIXEL' over the editor, in pixels of the region; 'POST_VIEW' with "
        "the scene, in its coordinates; 'PRE_VIEW' before it; 'BACKDROP' in the node editor.",
    ),
    NamelessMessage(
        ("enum identifier: '", "'WINDOW', 'HEADER'"),
        (f"{T}Space.draw_handler_add", f"{T}Region.type"),
        "The third argument is the type of the region that is drawn in, mostly 'WINDOW': "
        "`draw_handler_add(function, (), 'WINDOW', 'POST_PIXEL')`.",
    ),
    NamelessMessage(
        ("draw_handler_add() argument 3 must be tuple",),
        (f"{T}Space.draw_handler_add",),
        "What the function is to be given is a tuple, empty for nothing: "
        "`draw_handler_add(function, (), 'WINDOW', 'POST_PIXEL')`.",
    ),
    NamelessMessage(
        ("callback_remove(handler): ", "invalid or already removed"),
        (f"{T}Space.draw_handler_remove", f"{T}Space.draw_handler_add"),
        "Keep what `draw_handler_add()` returns, remove it once, with the same region type, and forget it: "
        "`draw_handler_remove(handle, 'WINDOW')`, `handle = None`.",
    ),
    NamelessMessage(
        ('enum "', "\" not found in ('NONE', 'CUDA'"),
        (f"{T}CyclesPreferences.compute_device_type", f"{T}CyclesRenderSettings.device"),
        "`compute_device_type` of the add-on's preferences takes the kind of device that the message lists; 'NONE' is "
        "the CPU alone. 'GPU' and 'CPU' are values of `scene.cycles.device`.",
    ),
    NamelessMessage(
        ("incorrect sequence item type: ",),
        (f"{T}bpy_prop_array.foreach_get", f"{T}bpy_prop_array.foreach_set", f"{T}Image.pixels"),
        OF_32_BITS,
    ),
    NamelessMessage(
        ("expected sequence size ", ", got "),
        (f"{T}bpy_prop_array.foreach_set", f"{T}bpy_prop_array.foreach_get", f"{T}Image.pixels"),
        "It wants one flat row of as many numbers as `len(image.pixels)`, which is width × height × channels: "
        "`array.ravel()`.",
    ),
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
        ("Uninitialized image ", " from object "),
        (f"{_O}bake", f"{T}BlendDataImages.new"),
        "The image to bake into has no pixels, as where its file is missing: give the node one that has, "
        '`node.image = bpy.data.images.new("Bake", 1024, 1024)`.',
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
    NamelessMessage(
        ("Image '", "does not have any image data"),
        (f"{T}Image.save_render", f"{T}Image.save", f"{T}Image.has_data"),
        "The image is empty: its file was not found, or, of 'Render Result', nothing was rendered yet. "
        "`bpy.ops.render.render()`, then `image.save_render(path)`.",
    ),
    NamelessMessage(
        ("Strips.new_effect: effect takes ", " input strip"),
        (f"{T}StripsTopLevel.new_effect",),
        "Give the strips that it works on: `strips.new_effect(…, input1=first, input2=second)`; one that takes one "
        "strip needs `input1` alone.",
    ),
    NamelessMessage(
        ("bpy_prop_array[index]: index ", " out of range"),
        (f"{T}Image.pixels", f"{T}Image.has_data", f"{T}bpy_prop_array.foreach_get"),
        "The array has fewer numbers, `len(array)`: `image.pixels` has none where the image has no data (`image.size` "
        "is 0 × 0), as that called 'Render Result'.",
    ),
)
