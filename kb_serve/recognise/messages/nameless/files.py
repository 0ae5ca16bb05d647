"""Messages of files and add-ons that name nothing of the API."""

from __future__ import annotations

from kb_build.symbols.api_names import TYPES as T
from kb_serve.recognise.messages.guides import EXTENSIONS
from kb_serve.recognise.messages.nameless.message import NamelessMessage

# Of the two ways to read from another file.
_OPEN_FILE = (
    'What the open file holds is in `bpy.data` already: `bpy.data.objects["Cube"].copy()` makes another one.'
)

NO_SUCH_ADDON = "The add-on is not installed under that name; extensions are called `bl_ext.repository.name`."
FILES = (
    NamelessMessage(
        ("Selected data-blocks are already assets",),
        ("bpy.ops.asset.mark", f"{T}ID.asset_mark", f"{T}ID.asset_data"),
        "All of them are assets already (their `asset_data` is not None), or of a type that cannot be one. "
        "`ob.asset_mark()` marks one data-block, needs no context, and raises nothing if it is marked.",
    ),
    NamelessMessage(
        ("Cannot read '", "No such file or directory"),
        (f"{T}BlendDataImages.load", "bpy.path.abspath"),
        "There is no such file where Blender looks: `//` begins a path beside the saved .blend; any other relative "
        "path begins where Blender was started.",
    ),
    NamelessMessage(
        ("Image '", "could not be saved to ''"),
        (f"{T}Image.save", f"{T}Image.filepath_raw", f"{T}Image.file_format"),
        "The image has no path: `image.filepath_raw = \"/folder/name.png\"`, `image.file_format = 'PNG'`, then "
        "`image.save()`.",
    ),
    NamelessMessage(
        ("No such file or directory: '//",),
        ("bpy.path.abspath",),
        "Only Blender knows where a path that begins with `//` leads: `open(bpy.path.abspath(path))`.",
    ),
    NamelessMessage(
        ("failed to open blend file",),
        (f"{T}BlendDataLibraries.load", "bpy.path.abspath"),
        "There is no such .blend where Blender looks: `//` begins a path beside the saved one.",
    ),
    NamelessMessage(
        ("Cannot open file", "for writing: No such file or directory"),
        ("bpy.ops.wm.save_as_mainfile",),
        "The folder does not exist: make it first (`os.makedirs(folder, exist_ok=True)`).",
    ),
    NamelessMessage(
        ('Cannot read file "', "No such file or directory"),
        ("bpy.ops.wm.open_mainfile",),
        "There is no such .blend where Blender looks: a relative path begins where Blender was started.",
    ),
    NamelessMessage(
        ("Unable to save an unsaved file",),
        ("bpy.ops.wm.save_as_mainfile", "bpy.ops.wm.save_mainfile"),
        'A file that was never saved has no path: `bpy.ops.wm.save_as_mainfile(filepath="/folder/name.blend")`.',
    ),
    NamelessMessage(
        ("Please select a file",),
        ("bpy.ops.import_scene.gltf",),
        "There is no file of that path.",
    ),
    NamelessMessage(
        ("OBJ Import: Cannot open file",),
        ("bpy.ops.wm.obj_import",),
        "There is no such file where Blender looks.",
    ),
    NamelessMessage(
        ("cause: module loaded with no associated file",),
        ("bpy.ops.preferences.addon_enable", "bpy.utils.refresh_script_paths"),
        "The add-on's folder has no `__init__.py` at its top: it may lie one folder further down.",
    ),
    NamelessMessage(
        (" is incompatible (This Blender version (", "than the maximum version ("),
        ("bpy.ops.preferences.addon_enable", EXTENSIONS),
        "`blender_version_max` in the extension's `blender_manifest.toml` is the first Blender that it is not meant "
        "for: raise it or leave it out, or install a newer one.",
    ),
    NamelessMessage(
        ("Add-on not loaded:", "No module named"),
        ("bpy.ops.preferences.addon_enable", "bpy.utils.refresh_script_paths"),
        NO_SUCH_ADDON,
    ),
    NamelessMessage(
        ("Cannot load from the current blend file",),
        (f"{T}BlendDataLibraries.load", f"{T}ID.copy"),
        _OPEN_FILE,
    ),
    NamelessMessage(
        ("cannot use current file as library",),
        ("bpy.ops.wm.append", "bpy.ops.wm.link", f"{T}ID.copy"),
        _OPEN_FILE,
    ),
    NamelessMessage(
        ("': nothing indicated",),
        ("bpy.ops.wm.append", "bpy.ops.wm.link", f"{T}BlendDataLibraries.load"),
        "There is no such .blend, or the path lacks the kind of data, and `filepath` alone is not read: "
        '`bpy.ops.wm.append(directory="/folder/name.blend/Object/", filename="Cube")`.',
    ),
    NamelessMessage(
        ("STL Import: Cannot open file",),
        ("bpy.ops.wm.stl_import",),
        "There is no such file where Blender looks.",
    ),
    NamelessMessage(
        ("USD Import: unable to open stage to read",),
        ("bpy.ops.wm.usd_import",),
        "There is no such file where Blender looks, or it is no USD file.",
    ),
    NamelessMessage(
        ("Couldn't open file '", "No such file or directory"),
        ("bpy.ops.import_scene.fbx", "bpy.path.abspath"),
        "There is no such file where Blender looks: a relative path begins where Blender was started.",
    ),
)
