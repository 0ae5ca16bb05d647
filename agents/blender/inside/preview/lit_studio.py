# SPDX-License-Identifier: GPL-3.0-or-later
"""A studio whose pictures show materials as they are: Cycles, the file's own shaders, light of its own."""

import contextlib

import bpy
from mathutils import Matrix

from ..render.engines import CYCLES
from .studio_scene import StudioScene, tree_of

SAMPLES = 12
_UNDENOISED_SAMPLES = 64  # of a Blender that has no denoiser
_SUN = 1.4  # W/m²
_ABOVE, _BELOW = 0.85, 0.3  # radiance of the surroundings, straight up and straight down
_MAP = 64  # pixels across
_NEAR = (
    0.6  # of what is framed: light from the surroundings reaches a place unless something nearer hides them
)
_NAME = ".preview"


class LitStudio(StudioScene):
    """A studio scene with a sun behind the viewer's shoulder, and bright surroundings that also reach into rooms.

    ``frame`` is the frame at which animated materials are shown.
    """

    keeps_materials = True

    def __init__(self, frame):
        super().__init__(CYCLES)
        self._frame = frame

    def set_up(self):
        """Sets Cycles and the light."""
        super().set_up()
        scene = self.scene
        scene.frame_current = self._frame
        _set(
            scene.cycles,
            samples=SAMPLES,
            use_adaptive_sampling=True,
            adaptive_threshold=0.08,
            adaptive_min_samples=4,
            use_denoising=True,
            denoiser="OPENIMAGEDENOISE",
            denoising_quality="BALANCED",  # the highest takes as long as all else of a picture
            max_bounces=6,
            diffuse_bounces=2,
            glossy_bounces=3,
            transmission_bounces=6,
            transparent_max_bounces=8,
            caustics_reflective=False,
            # Light bounces once; from there on the surroundings count as seen unless something near hides them. So the
            # inside of a closed room is bright, too.
            use_fast_gi=True,
            fast_gi_method="REPLACE",
            ao_bounces_render=1,
            device="CPU",
        )
        scene.world = self.owned(bpy.data.worlds.new(_NAME))
        _make_gradient(tree_of(scene.world))
        # Cycles looks for bright places in a map of the surroundings that it makes for each still. By itself it makes
        # one as for a photograph of them, which takes most of the time; a gradient needs no more than this.
        _set(scene.world.cycles, sampling_method="MANUAL", sample_map_resolution=_MAP)
        lamp = self.owned(bpy.data.lights.new(_NAME, "SUN"))
        lamp.energy, lamp.angle = _SUN, 0.3
        self._lamp = self.owned(bpy.data.objects.new(_NAME, lamp))
        scene.collection.objects.link(self._lamp)

    def aim(self, centre, diameter):
        """As of any studio."""
        super().aim(centre, diameter)
        _set(self.scene.world.light_settings, distance=_NEAR * diameter)

    def render(self, camera, size, path, *, slant=1.0):
        """Renders; ``slant`` 0: the sun throws no shadows, which would fill a room."""
        turn = camera.matrix_world.to_quaternion().to_matrix().to_4x4()
        self._lamp.matrix_world = turn @ Matrix.Rotation(-0.6, 4, "X") @ Matrix.Rotation(-0.5, 4, "Y")
        lamp = self._lamp.data
        _set(lamp, use_shadow=slant > 0)
        _set(lamp.cycles, cast_shadow=slant > 0)
        super().render(camera, size, path, slant=slant)

    def draw(self):
        """Renders at the world's own scale and place: textures, bumps and the depth of glass depend on it."""
        back = self._here.inverted()
        camera = self.scene.camera
        lens = camera.data
        studio = {
            obj: obj.matrix_world.copy() for obj in self.scene.collection.objects if obj is not self._lamp
        }
        clip = lens.clip_start, lens.clip_end, lens.ortho_scale
        try:
            for obj, matrix in studio.items():
                obj.matrix_world = back @ matrix
            camera.matrix_world = camera.matrix_world.normalized()
            lens.clip_start, lens.clip_end, lens.ortho_scale = (part / self.scale for part in clip)
            self._draw()
        finally:
            lens.clip_start, lens.clip_end, lens.ortho_scale = clip
            for obj, matrix in studio.items():
                obj.matrix_world = matrix

    def _draw(self):
        try:
            super().draw()
        except RuntimeError:
            if not self.scene.cycles.use_denoising:
                raise
            self.scene.cycles.use_denoising = False
            self.scene.cycles.samples = _UNDENOISED_SAMPLES
            super().draw()


def _set(owner, **values):
    """Sets what this version has of these settings."""
    for name, value in values.items():
        with contextlib.suppress(AttributeError, TypeError):
            setattr(owner, name, value)


def _make_gradient(tree):
    """Surroundings that are brighter above, so that glass and metal have something to show."""
    tree.nodes.clear()
    output, background, place, parts, shade = (
        tree.nodes.new(f"ShaderNode{kind}")
        for kind in ("OutputWorld", "Background", "TexCoord", "SeparateXYZ", "MapRange")
    )
    for at, value in enumerate((-1.0, 1.0, _BELOW, _ABOVE), start=1):
        shade.inputs[at].default_value = value
    links = [(place.outputs["Generated"], parts.inputs[0]), (parts.outputs["Z"], shade.inputs[0])]
    links += [(shade.outputs[0], background.inputs["Strength"]), (background.outputs[0], output.inputs[0])]
    for out, into in links:
        tree.links.new(out, into)
