# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene beside the open one, to take pictures of copied geometry in; it goes without a trace."""

import contextlib
import os

import bpy
from mathutils import Matrix, Vector

from simworlds.sandbox.inside.refusal import Refused

from ..render.engines import CYCLES, WORKBENCH

REACH = (
    10.0  # what is looked at is scaled to this diameter: clipping and shading are then alike for all sizes
)
_NAME = ".preview"
_SOFTER = (
    2  # pictures are rendered so many times as large, for the caller to shrink: cheaper than more samples
)


class StudioScene:
    """The scene. Use it in ``with``: whatever happens, what was made for it is removed at the end."""

    def __init__(self, engine):
        self.engine = engine
        self.finer = _SOFTER if engine == WORKBENCH else 1
        self._owned = []
        self._materials = {}
        self._here = Matrix()

    def __enter__(self):
        self._handlers = _muted_handlers()
        self._had_result = "Render Result" in bpy.data.images
        try:
            self.scene = self.owned(bpy.data.scenes.new(_NAME))
            self._set_up()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_error):
        # Objects before what they use, so that no user count is left above zero.
        bpy.data.batch_remove(self._owned[::-1])
        self._owned.clear()
        result = bpy.data.images.get("Render Result")
        if result is not None and not self._had_result:
            bpy.data.images.remove(result)
        for handlers, kept in self._handlers:
            handlers[:] = kept

    def owned(self, block):
        """Takes a data-block in, to be removed with the stage."""
        self._owned.append(block)
        return block

    # What stands on it

    @property
    def scale(self):
        """Units of the stage for a metre."""
        return self._here.median_scale

    def aim(self, centre, diameter):
        """Puts a ball of the open scene's world (metres) into the middle of the stage; before anything is added."""
        self._here = Matrix.Scale(REACH / diameter, 4) @ Matrix.Translation(-Vector(centre))

    def placed(self, matrix):
        """A matrix of the open scene's world, on the stage."""
        return self._here @ matrix

    def add(self, data, matrix):
        """An object on the stage, of a data-block that belongs to it, where ``matrix`` has it in the open scene."""
        obj = self.owned(bpy.data.objects.new(_NAME, data))
        obj.matrix_world = self._here @ matrix
        self.scene.collection.objects.link(obj)
        return obj

    def material(self, surface):
        """A material that looks like a surface; the same for the same."""
        texture = (surface.image.name_full, surface.uv_map) if surface.image else None
        rgba = (*surface.rgb, surface.alpha)
        key = (*(round(part, 4) for part in rgba), round(surface.roughness, 2), texture)
        if key not in self._materials:
            material = self.owned(bpy.data.materials.new(_NAME))
            material.diffuse_color = rgba
            material.roughness = surface.roughness
            picture = _lay_on(material, surface) if surface.image else None
            if self.engine == CYCLES:
                _shine(material, surface, picture)
            self._materials[key] = material
        return self._materials[key]

    def update(self):
        """Lets what was added be found by rays; returns the dependency graph."""
        layer = self.scene.view_layers[0]
        layer.update()
        return layer.depsgraph

    # Pictures

    def render(self, camera, size, path, *, slant=1.0):
        """Renders what ``camera`` (an object of the stage) sees, ``size`` pixels. Raises Refused.

        ``slant``: how far the light comes from aside, 0 for no shadows at all.
        """
        render = self.scene.render
        turn = camera.matrix_world.to_3x3().normalized()
        # From over the viewer's left shoulder; the setting counts up as its second part, and backwards as its third.
        x, y, z = (turn @ Vector((-0.2 * slant, 0.32 * slant, 1))).normalized()
        self.scene.display.light_direction = x, z, -y
        self.scene.camera = camera
        self.scene.display.shading.show_shadows = slant > 0
        render.resolution_x, render.resolution_y = (side * self.finer for side in size)
        render.filepath = path
        try:
            if os.path.lexists(path):
                os.remove(path)
            bpy.ops.render.render(write_still=True, scene=self.scene.name)
        except (OSError, RuntimeError) as error:
            raise Refused(f"The picture could not be rendered: {str(error).strip()[:300]}") from None
        if not os.path.isfile(path):
            raise Refused("The picture could not be rendered: the engine left no file.")

    def camera(self, data=None, matrix=None):
        """A camera on the stage; of its own unless ``data`` is given, which then belongs to the stage."""
        data = data or bpy.data.cameras.new(_NAME)
        obj = self.owned(bpy.data.objects.new(_NAME, self.owned(data)))
        self.scene.collection.objects.link(obj)
        if matrix is not None:
            obj.matrix_world = (self._here @ matrix).normalized()
        return obj

    def _set_up(self):
        scene = self.scene
        render = scene.render
        render.engine = self.engine
        render.film_transparent = True
        render.resolution_percentage = 100
        render.use_compositing = render.use_sequencer = False
        render.use_file_extension = False
        render.image_settings.file_format = "PNG"
        render.image_settings.color_mode = "RGBA"
        render.image_settings.color_depth = "8"
        render.image_settings.compression = 10
        for name, value in (("view_transform", "Standard"), ("look", "None")):
            with contextlib.suppress(TypeError):  # the user's colour configuration may not know it
                setattr(scene.view_settings, name, value)
        if self.engine == WORKBENCH:
            _light_workbench(scene)
        else:
            _light_cycles(scene)


def _light_cycles(scene):
    """No light at all: materials shine by themselves, see ``_shine``."""
    scene.cycles.samples = 8
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.max_bounces = 0


def _light_workbench(scene):
    display, shading = scene.display, scene.display.shading
    display.render_aa = "OFF"
    shading.light = "STUDIO"
    with contextlib.suppress(TypeError):
        shading.studio_light = "paint.sl"  # even, so that colours stay what they are
    shading.color_type = "TEXTURE"  # a material without a picture shows its colour
    shading.show_shadows = True
    shading.shadow_intensity = 0.3
    shading.show_cavity = True
    shading.cavity_type = "BOTH"
    shading.cavity_ridge_factor = 0.6
    shading.cavity_valley_factor = 1.0
    shading.curvature_ridge_factor = 0.6
    shading.curvature_valley_factor = 0.6
    display.matcap_ssao_distance = REACH / 25
    shading.show_object_outline = True
    shading.object_outline_color = (0.05, 0.05, 0.06)
    shading.show_specular_highlight = True
    shading.show_backface_culling = False
    shading.show_xray = False


def _tree_of(material):
    if not material.use_nodes:  # always on since 5.0
        material.use_nodes = True
    return material.node_tree


def _lay_on(material, surface):
    """Gives a material its picture; returns that node."""
    tree = _tree_of(material)
    picture = tree.nodes.new("ShaderNodeTexImage")
    picture.image = surface.image
    if surface.uv_map:
        layer = tree.nodes.new("ShaderNodeUVMap")
        layer.uv_map = surface.uv_map
        tree.links.new(layer.outputs["UV"], picture.inputs["Vector"])
    tree.nodes.active = picture
    return picture


def _shine(material, surface, picture):
    """Nodes for an engine that runs them: the bare colour, darker where the surface turns away. It needs no light,
    and few samples."""
    tree = _tree_of(material)
    output = tree.get_output_node("ALL")
    light, clear, mix = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("Emission", "BsdfTransparent", "MixShader")
    )
    light.inputs["Color"].default_value = (*surface.rgb, 1)
    mix.inputs[0].default_value = surface.alpha
    aside, shade = tree.nodes.new("ShaderNodeLayerWeight"), tree.nodes.new("ShaderNodeMath")
    shade.operation = "MULTIPLY_ADD"
    shade.inputs[1].default_value, shade.inputs[2].default_value = -0.6, 1.0
    links = [(aside.outputs["Facing"], shade.inputs[0]), (shade.outputs[0], light.inputs["Strength"])]
    links += [(clear.outputs[0], mix.inputs[1]), (light.outputs[0], mix.inputs[2])]
    links.append((mix.outputs[0], output.inputs["Surface"]))
    if picture is not None:
        links.append((picture.outputs["Color"], light.inputs["Color"]))
    for out, into in links:
        tree.links.new(out, into)


def _muted_handlers():
    """Takes the file's own handlers off, so that a picture runs none of them; returns what to put back."""
    muted = []
    for name in dir(bpy.app.handlers):
        handlers = getattr(bpy.app.handlers, name)
        if isinstance(handlers, list) and handlers:
            muted.append((handlers, list(handlers)))
            handlers.clear()
    return muted
