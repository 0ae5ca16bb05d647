# SPDX-License-Identifier: GPL-3.0-or-later
"""Which pixel of the camera's picture shows which object: a picture in which each has a flat colour of its own."""

import contextlib

import bpy

from ..blend.protocol_tags import object_collections
from ..blend.see_through import has_see_through
from ..render.engines import WORKBENCH
from .fixed_views import studio_camera
from .scene_copy import SceneCopy
from .studio_scene import StudioScene, drawing_engine, tree_of

_LEVELS = (
    0,
    51,
    102,
    153,
    204,
    255,
)  # of a channel: far apart, so that rounding does not confuse two colours
_COLOURS = [(red, green, blue) for red in _LEVELS for green in _LEVELS for blue in _LEVELS]
_REST = _COLOURS[-1]  # white: belongs to no object that is listed
_MOST = len(_COLOURS) - 2  # black is what nothing covers
_FILE = ".preview-{}.png"


def subject_mask(arguments, report):
    """Renders the mask of the current frame through ``camera`` (a name) in ``size`` pixels into ``folder``.

    Returns the ``file``'s name and the ``subjects``: [name, its colour (0 to 255)] of the protocol's objects (lacking
    those, of Blender's), also of those that the camera does not see. ``clear``: those that one sees through, in part.
    """
    del report
    scene = bpy.context.scene
    with _MaskStudio(drawing_engine([])) as studio:
        subject = SceneCopy(studio, bpy.context.evaluated_depsgraph_get(), None)
        # The scale stays 1: only the camera's view is drawn, and what is far away is to be in it, too.
        studio.aim((0, 0, 0), 10.0)
        groups = _groups(scene, {piece.owner for piece in subject.pieces})
        colours = dict(zip(groups, _COLOURS[1:], strict=False))
        colour_of = {owner: colours[name] for name, owners in groups.items() for owner in owners}
        for piece in subject.pieces:
            studio.paint(studio.add(piece.data, piece.matrix), colour_of.get(piece.owner, _REST))
        camera = studio_camera(studio, scene.objects[arguments["camera"]])
        file = _FILE.format(0)
        if camera is None:
            return {"file": None, "subjects": [], "clear": []}
        studio.render(camera, arguments["size"], f"{arguments['folder']}/{file}", slant=0.0)
    clear = [
        name for name in colours if any(has_see_through(bpy.data.objects[owner]) for owner in groups[name])
    ]
    return {
        "file": file,
        "subjects": [[name, list(colour)] for name, colour in colours.items()],
        "clear": clear,
    }


def _groups(scene, drawn):
    """{name: the drawn objects of it}, at most as many as there are colours."""
    groups = {}
    for collection in object_collections(scene):
        owners = {obj.name for obj in collection.all_objects} & drawn
        if owners:
            groups[collection.name] = owners
    groups = groups or {name: {name} for name in sorted(drawn)}
    return dict(list(groups.items())[:_MOST])


class _MaskStudio(StudioScene):
    """Draws each object in its own colour, without light, edges or smoothing."""

    keeps_materials = True

    def set_up(self):
        """Sets up the drawing."""
        super().set_up()
        self.supersampling = 1
        scene = self.scene
        scene.render.dither_intensity = 0.0
        scene.render.film_transparent = False
        scene.render.filter_size = 0.01
        scene.world = self.owned(bpy.data.worlds.new(".mask"))
        scene.world.color = (0, 0, 0)
        if self.engine == WORKBENCH:
            shading = scene.display.shading
            shading.light, shading.color_type = "FLAT", "OBJECT"
            shading.show_shadows = shading.show_cavity = shading.show_object_outline = False
            shading.show_specular_highlight = False
            return
        scene.cycles.samples = 1
        with contextlib.suppress(AttributeError):
            scene.cycles.pixel_filter_type = "BOX"
        tree_of(scene.world).nodes.clear()
        self._flat = _flat_material(self.owned(bpy.data.materials.new(".mask")))

    def paint(self, obj, colour):
        """Gives an object of the studio its colour."""
        obj.color = (*map(_linear, colour), 1.0)
        if self.engine == WORKBENCH:
            return
        if not obj.material_slots and hasattr(obj.data, "materials"):
            obj.data.materials.append(None)
        for slot in obj.material_slots:
            slot.link = "OBJECT"
            slot.material = self._flat


def _flat_material(material):
    """A material that emits its object's colour."""
    tree = tree_of(material)
    tree.nodes.clear()
    output, light, info = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("OutputMaterial", "Emission", "ObjectInfo")
    )
    tree.links.new(info.outputs["Color"], light.inputs["Color"])
    tree.links.new(light.outputs[0], output.inputs["Surface"])
    return material


def _linear(level):
    """The linear value of which a display shows this level (0 to 255)."""
    share = level / 255
    return share / 12.92 if share <= 0.04045 else ((share + 0.055) / 1.055) ** 2.4
