"""UV maps as pictures and numbers: a good one has neither stretch nor overlap, and what is wrong is said and seen."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import pytest
from PIL import Image
from preview_views import build

from agents.blender.tools import uv_preview
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

BOXES = """
def mapped(name, corners, x):
    thing = box(name, (x, 0, 0))
    layer = thing.data.uv_layers.active
    for face in thing.data.polygons:
        for corner, loop in enumerate(face.loop_indices):
            layer.data[loop].uv = corners(face.index, corner)
    return thing
SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
def own_cell(face, corner): return (SQUARE[corner][0] / 4 + face % 3 * .3, SQUARE[corner][1] / 4 + face // 3 * .3)
mapped('Good', own_cell, 0)
mapped('Heap', lambda face, corner: SQUARE[corner], 3)
mapped('Long', lambda face, corner: (own_cell(face, corner)[0], own_cell(face, corner)[1] * 5), 6)
mapped('Flat', lambda face, corner: (.5, .5), 9)
twin = bpy.data.objects['Good'].copy(); twin.data = twin.data.copy(); twin.name = 'Twin'; twin.location.x = 12
bpy.context.scene.collection.objects.link(twin)
bare = box('Bare', (15, 0, 0)); bare.data.uv_layers.remove(bare.data.uv_layers[0])
"""


def test_measures_maps_and_shows_what_is_wrong_with_them(session: LiveSession) -> None:
    build(session, BOXES)
    result = session.use(uv_preview.TOOL)
    meshes: dict[str, dict[str, Any]] = {mesh["name"]: mesh for mesh in result.data["meshes"]}
    assert meshes.keys() == {"Good", "Heap", "Long", "Flat"}
    good, heap, long, flat = (meshes[name] for name in ("Good", "Heap", "Long", "Flat"))
    assert good["overlap"] == good["stretched"] == good["outside"] == good["collapsed"] == 0
    assert good["low"] == (0, 0)
    assert good["high"] == pytest.approx([0.85, 0.55])
    assert good["scale"] == pytest.approx([0.25, 0.25])
    assert good["alike"] == ["Twin"]
    assert heap["overlap"] > 0.98
    assert heap["stretched"] == 0
    assert long["stretched"] == pytest.approx(1)
    assert long["outside"] == pytest.approx(1)
    assert long["overlap"] == 0
    assert flat["collapsed"] == pytest.approx(1)
    assert result.data["without"] == ["Bare"]
    assert "100 % of the map overlapping" in result.text
    assert "Without a UV map: Bare" in result.text


def test_an_overlap_is_red_and_a_good_map_is_not(session: LiveSession) -> None:
    build(session, BOXES)

    def red(name: str) -> int:
        (image,) = session.use(uv_preview.TOOL, objects=[name]).pictures
        picture = Image.open(io.BytesIO(image.png)).convert("RGB")
        return sum(count for count, pixel in picture.getcolors(1 << 24) or () if pixel == (205, 45, 45))

    assert red("Heap") > 20_000
    assert red("Good") < 200  # as many as the checker may have


def test_a_scene_without_meshes_is_refused_and_unknown_names_are_told(session: LiveSession) -> None:
    with pytest.raises(Refusal, match="no geometry"):
        session.use(uv_preview.TOOL)
    build(session, BOXES)
    with pytest.raises(Refusal, match="Nearest: 'Heap'"):
        session.use(uv_preview.TOOL, objects=["Heep"])


def test_coordinates_that_are_not_finite_are_said_to_be_unusable(session: LiveSession) -> None:
    build(session, BOXES + "bpy.data.objects['Good'].data.uv_layers.active.data[0].uv = (float('nan'), 0)")
    result = session.use(uv_preview.TOOL, objects=["Good"])
    assert "no usable coordinates" in result.text
