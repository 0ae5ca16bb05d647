# SPDX-License-Identifier: GPL-3.0-or-later
"""What is set for operators that want more than an active object or an area, as the statements that are told.

They are tried one after the other, and the first that is enough is told (see operator_wants): those that say least come
first.
"""

from collections import defaultdict

import bpy

from ..instances.making import SEQUENCER_SCENE, choices, remove
from .active_objects import collection_calls, typed_object

SPACE = "area.spaces.active"
TRIED = (AttributeError, TypeError, RuntimeError, ValueError, KeyError, IndexError, OSError)
ANIMATION = ("DOPESHEET", "TIMELINE", "FCURVES", "DRIVERS", "NLA_EDITOR")
TREES = ("ShaderNodeTree", "CompositorNodeTree", "GeometryNodeTree", "TextureNodeTree")
IMAGES = ("IMAGE_EDITOR", "UV")
CLIPS = ("CLIP_EDITOR",)
VIEWS = ("VIEW_3D",)
SEQUENCERS = ("SEQUENCE_EDITOR",)
CAMERA = 'scene.camera = bpy.data.objects.new("name", bpy.data.cameras.new("name"))'
KEYED = 'obj.keyframe_insert("location")'
ANNOTATION = "annotation" if hasattr(bpy.types.Scene, "annotation") else "grease_pencil"


class Setting:
    """Statements on ``bpy``, ``scene``, the active object ``obj`` and an ``area``.

    ``editors`` in which they are tried, besides in no area; ``kinds`` of objects, which are tried in ``modes``, or in
    all that they have where there are none.
    """

    def __init__(self, *statements, editors=(), kinds=("MESH",), modes=("OBJECT",)):
        first = next((at for at, text in enumerate(statements) if "area." in text), len(statements))
        self.statements = statements
        self.of_scene, self.of_area = statements[:first], statements[first:]
        self.editors = editors
        self.kinds = kinds
        self.modes = modes


def new(collection):
    """Source of a new data-block."""
    return f'bpy.data.{collection}.new("name")'


def shown():
    """What editors show."""
    mask = (f"{SPACE}.mode = 'MASK'", f"{SPACE}.mask = {new('masks')}")
    clip = f"{SPACE}.clip = bpy.data.movieclips.load(image_path)"
    image = f'{SPACE}.image = bpy.data.images.new("name", 8, 8)'
    yield Setting(f"{SPACE}.text = {new('texts')}", editors=("TEXT_EDITOR",))
    # What is not pinned, Blender replaces by what the active object has.
    tree = f'{SPACE}.node_tree = bpy.data.node_groups.new("name", area.ui_type)'
    yield Setting(f"{SPACE}.pin = True", tree, editors=TREES)
    node = f"{SPACE}.node_tree.nodes"
    yield Setting(f"{SPACE}.pin = True", tree, f'{node}.active = {node}.new("NodeReroute")', editors=TREES)
    yield Setting(image, editors=IMAGES)
    yield Setting(image, f"{SPACE}.image.source = 'TILED'", editors=IMAGES)
    yield Setting(*mask, editors=IMAGES)
    yield Setting(clip, editors=CLIPS)
    yield Setting(clip, f'{SPACE}.clip.tracking.tracks.new(name="name", frame=1)', editors=CLIPS)
    for view in choices("SpaceClipEditor", "view"):
        yield Setting(clip, f"{SPACE}.view = {view!r}", editors=CLIPS)
    yield Setting(*mask, editors=CLIPS)
    yield Setting(clip, mask[0], editors=CLIPS)
    yield Setting(clip, *mask, editors=CLIPS)
    yield Setting(CAMERA, f"{SPACE}.region_3d.view_perspective = 'CAMERA'", editors=VIEWS)


def made():
    """What scenes and objects have, and modes of editors."""
    for name in ("use_paint_mask", "use_paint_mask_vertex"):
        yield Setting(f"obj.data.{name} = True", editors=VIEWS, modes=())
    hair = "obj.modifiers.new(\"name\", 'PARTICLE_SYSTEM').particle_system.settings.type = 'HAIR'"
    yield Setting(hair, editors=VIEWS, modes=())
    yield Setting(CAMERA, editors=VIEWS)
    layer = "bpy.context.view_layer"
    yield Setting(
        f"scene.collection.children.link({new('collections')})",
        f"{layer}.active_layer_collection = {layer}.layer_collection.children[0]",
    )
    yield from strips()
    yield Setting("obj.data.uv_layers.new()", editors=IMAGES, modes=())
    yield Setting('scene.timeline_markers.new("name")', editors=ANIMATION)
    for statement in (KEYED, "obj.animation_data_create().nla_tracks.new()", 'obj.driver_add("location", 0)'):
        yield Setting(statement, editors=ANIMATION)
    for mode in choices("SpaceDopeSheetEditor", "mode"):
        yield Setting(KEYED, f"{SPACE}.mode = {mode!r}", editors=ANIMATION[:1])
    notes = "annotations" if hasattr(bpy.data, "annotations") else "grease_pencils"
    layer = (f"scene.{ANNOTATION} = {new(notes)}", f'layer = scene.{ANNOTATION}.layers.new("name")')
    yield Setting(*layer, editors=VIEWS)
    yield Setting(*layer, "layer.frames.new(1)", editors=VIEWS)
    freestyle = "bpy.context.view_layer.freestyle_settings"
    yield Setting(f'{freestyle}.linesets.new("name")')
    yield Setting(f"{freestyle}.mode = 'SCRIPT'", f"{freestyle}.modules.new()")
    yield from added()


def strips():
    """Strips that are active, in the sequencer and without."""
    scene = [f"{SEQUENCER_SCENE} = scene"] if hasattr(bpy.context.workspace, "sequencer_scene") else []
    name = "strips" if "strips" in bpy.types.SequenceEditor.bl_rna.properties else "sequences"
    functions = bpy.types.SequenceEditor.bl_rna.properties[name].srna.functions
    is_new = "length" in functions["new_effect"].parameters
    rest, inputs = ("length=20", "input1=a, input2=b") if is_new else ("frame_end=20", "seq1=a, seq2=b")
    strips = f"strips = scene.sequence_editor_create().{name}"
    active = "scene.sequence_editor.active_strip = strips.{}"
    calls = [f'new_effect("name", {kind!r}, 1, 1, {rest})' for kind in ("COLOR", "TEXT", "MULTICAM")]
    calls += ['new_sound("name", sound_path, 1, 1)', 'new_image("name", image_path, 1, 1)']
    calls.append('new_scene("name", scene, 1, 1)')
    if scene:
        yield Setting(*scene, editors=(*SEQUENCERS, *ANIMATION))
    for call in calls:
        yield Setting(strips, active.format(call), *scene, editors=SEQUENCERS)
    two = [
        f"{name} = strips.new_effect({name!r}, 'COLOR', {channel}, 1, {rest})"
        for channel, name in enumerate("ab", 1)
    ]
    cross = f"new_effect(\"name\", 'CROSS', 3, 1, {rest}, {inputs})"
    yield Setting(strips, *two, active.format(cross), *scene, editors=SEQUENCERS)
    for call in calls[:2]:
        preview = f"{SPACE}.view_type = 'PREVIEW'"
        yield Setting(strips, active.format(call), *scene, preview, editors=SEQUENCERS)


def added():
    """What calls add to objects of other types than meshes; what they add to these, other steps find."""
    kinds = defaultdict(list)
    for kind in choices("Object", "type"):
        try:
            obj = typed_object(kind) if kind != "MESH" else None
        except TRIED:
            obj = None
        if obj is None:
            continue
        calls = [*collection_calls(obj, "obj")]
        if obj.data is not None:
            calls += collection_calls(obj.data, "obj.data")
        if hasattr(obj.data, "materials"):
            calls.append(f"obj.data.materials.append({new('materials')})")
        remove(obj)
        for call in calls:
            kinds[call].append(kind)
    for call, of_call in kinds.items():
        yield Setting(call, kinds=of_call, modes=())
