# SPDX-License-Identifier: GPL-3.0-or-later
"""A temporary scene in which pictures of copied geometry are rendered; it is removed without a trace."""

import contextlib
import os
from pathlib import Path

import bpy
from mathutils import Matrix, Vector

from simworlds.sandbox.inside.refusal import Refused

from ..blend.temporary import without_handlers, without_render_result
from ..render.engines import CYCLES, WORKBENCH, best_engine

REACH = (
    10.0  # the diagonal that the subject is scaled to, so that clipping and shading do not depend on its size
)
_NAME = ".preview"
_NEUTRAL = Path(__file__).with_name("neutral.sl")
_SUPERSAMPLING = (
    2  # pictures are this many times as large as asked; shrinking them is cheaper than more samples
)


def drawing_engine(notes):
    """The engine for pictures; ``notes`` gets a sentence if it is not Workbench."""
    engine, fault = best_engine()
    if fault:
        notes.append(f"Drawn with Cycles, in lower quality: Workbench cannot draw on this machine ({fault}).")
    return engine


class StudioScene:
    """The temporary scene, used in ``with``: everything made for it is removed at the end, also after errors.

    ``keeps_materials``: what is copied into it keeps its own materials, instead of one colour or image for each.
    """

    keeps_materials = False

    def __init__(self, engine):
        self.engine = engine
        self.supersampling = _SUPERSAMPLING if engine == WORKBENCH else 1
        self._owned = []
        self._materials = {}
        self._here = Matrix()

    def __enter__(self):
        with contextlib.ExitStack() as undo:
            undo.enter_context(without_handlers())
            undo.enter_context(without_render_result())
            undo.callback(self._remove)
            self.scene = self.owned(bpy.data.scenes.new(_NAME))
            self.set_up()
            self._undo = undo.pop_all()
        return self

    def __exit__(self, *_error):
        self._undo.close()

    def _remove(self):
        # Objects before what they use, so that no user count stays above zero.
        bpy.data.batch_remove(self._owned[::-1])
        self._owned.clear()

    def owned(self, block):
        """Registers a data-block to be removed with the scene; returns it."""
        self._owned.append(block)
        return block

    # Content

    @property
    def scale(self):
        """Units of this scene for a metre of the open one."""
        return self._here.median_scale

    def aim(self, centre, diameter):
        """Maps a sphere of the open scene's world (metres) to the middle; call it before adding anything."""
        self._here = Matrix.Scale(REACH / diameter, 4) @ Matrix.Translation(-Vector(centre))

    def placed(self, matrix):
        """A matrix of the open scene's world as one of this scene."""
        return self._here @ matrix

    def add(self, data, matrix):
        """Adds an object for a registered data-block, at ``matrix`` of the open scene's world."""
        obj = self.owned(bpy.data.objects.new(_NAME, data))
        obj.matrix_world = self._here @ matrix
        self.scene.collection.objects.link(obj)
        return obj

    def material(self, surface):
        """The material for a PreviewMaterial; cached."""
        texture = (surface.image.name_full, surface.uv_map) if surface.image else None
        rgba = (*surface.rgb, surface.alpha)
        key = (*(round(part, 4) for part in rgba), round(surface.roughness, 2), texture)
        if key not in self._materials:
            material = self.owned(bpy.data.materials.new(_NAME))
            material.diffuse_color = rgba
            material.roughness = surface.roughness
            picture = _add_image(material, surface) if surface.image else None
            if self.engine == CYCLES:
                _make_emissive(material, surface, picture)
            self._materials[key] = material
        return self._materials[key]

    def update(self):
        """Updates the scene for ray casts; returns the dependency graph."""
        layer = self.scene.view_layers[0]
        layer.update()
        return layer.depsgraph

    # Pictures

    def render(self, camera, size, path, *, slant=1.0):
        """Renders the view of ``camera`` (an object of this scene) in ``size`` pixels. Raises Refused.

        ``slant``: how far the light comes from the side; 0 for no shadows.
        """
        render = self.scene.render
        turn = camera.matrix_world.to_3x3().normalized()
        # From over the viewer's left shoulder; in the setting, up is the second component, and backwards the third.
        x, y, z = (turn @ Vector((-0.2 * slant, 0.32 * slant, 1))).normalized()
        self.scene.display.light_direction = x, z, -y
        self.scene.camera = camera
        self.scene.display.shading.show_shadows = slant > 0
        render.resolution_x, render.resolution_y = (side * self.supersampling for side in size)
        render.filepath = path
        try:
            if os.path.lexists(path):
                os.remove(path)
            self.draw()
        except (OSError, RuntimeError) as error:
            raise Refused(f"The picture could not be rendered: {str(error).strip()[:300]}") from None
        if not os.path.isfile(path):
            raise Refused("The picture could not be rendered: the engine wrote no file.")

    def draw(self):
        """Lets the engine write the picture. Raises RuntimeError."""
        bpy.ops.render.render(write_still=True, scene=self.scene.name)

    def camera(self, data=None, matrix=None):
        """Adds a camera, of new or given camera ``data``."""
        data = data or bpy.data.cameras.new(_NAME)
        obj = self.owned(bpy.data.objects.new(_NAME, self.owned(data)))
        self.scene.collection.objects.link(obj)
        if matrix is not None:
            obj.matrix_world = (self._here @ matrix).normalized()
        return obj

    def set_up(self):
        """Sets the engine, its light and the form of the pictures."""
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
            with contextlib.suppress(TypeError):  # the user's colour configuration may lack it
                setattr(scene.view_settings, name, value)
        if self.engine == WORKBENCH:
            _light_workbench(scene)
        else:
            _light_cycles(scene)


def _light_cycles(scene):
    """Uses no lights: materials emit light themselves, see ``_make_emissive``."""
    scene.cycles.samples = 8
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.max_bounces = 0


def _light_workbench(scene):
    display, shading = scene.display, scene.display.shading
    display.render_aa = "OFF"
    shading.light = "STUDIO"
    with contextlib.suppress(TypeError, RuntimeError):
        shading.studio_light = _neutral_light()
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


def _neutral_light():
    """The name of an even light without a tint: Blender's own ones colour what looks away from them."""
    lights = bpy.context.preferences.studio_lights
    if _NEUTRAL.name not in lights:
        lights.load(path=str(_NEUTRAL), type="STUDIO")
    return _NEUTRAL.name


def tree_of(material):
    """The nodes of a material or world."""
    if not material.use_nodes:  # always on since 5.0
        material.use_nodes = True
    return material.node_tree


def _add_image(material, surface):
    """Adds the image of a PreviewMaterial to a material; returns the node."""
    tree = tree_of(material)
    picture = tree.nodes.new("ShaderNodeTexImage")
    picture.image = surface.image
    if surface.uv_map:
        layer = tree.nodes.new("ShaderNodeUVMap")
        layer.uv_map = surface.uv_map
        tree.links.new(layer.outputs["UV"], picture.inputs["Vector"])
    tree.nodes.active = picture
    return picture


def _make_emissive(material, surface, picture):
    """Makes a material emit its colour, darker where the surface turns away: it needs no light and few samples."""
    tree = tree_of(material)
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
