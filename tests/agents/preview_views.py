"""Scenes for previews, and the pictures of them as they are before anything is drawn on them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from PIL import Image

from simworlds.sandbox.replies import unread

if TYPE_CHECKING:
    from live_session import LiveSession

SIZE = 192
SET = """
import math, os, random
from mathutils import Vector
def paint(thing, *rgb, **more):
    made = bpy.data.materials.new(thing.name)
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*rgb, 1)
    for name, value in more.items():
        shader.inputs[name.replace("_", " ")].default_value = value
    thing.data.materials.append(made)
    return thing
def box(name, place=(0, 0, 0), size=(1, 1, 1), rgb=None, turn=(0, 0, 0)):
    bpy.ops.mesh.primitive_cube_add(size=1, location=place, rotation=turn)
    thing = bpy.context.object
    thing.name, thing.scale = name, size
    return paint(thing, *rgb) if rgb else thing
def collection(name, role, *things):
    made = bpy.data.collections.new(name)
    made["protocol_role"] = role
    bpy.context.scene.collection.children.link(made)
    for thing in things:
        for old in list(thing.users_collection):
            old.objects.unlink(thing)
        made.objects.link(thing)
    return made
"""


def build(session: LiveSession, code: str) -> None:
    session.run(SET + code)


class Views:
    """What Blender answers, with the pictures as they are before anything is drawn on them."""

    def __init__(self, session: LiveSession, kind: str, name: str | None = None, **more: Any) -> None:
        folder = session.blender.folder
        given = {"kind": kind, "name": name, "frame": None, "everything": False, "size": SIZE, "subjects": []}
        given |= {"folder": str(folder.workspace.mount), **more}
        self.data: dict[str, Any] = session.blender.call("preview", given, unread, timeout=120).value
        self.by_name: dict[str, dict[str, Any]] = {}
        self.pictures: dict[str, Image.Image] = {}
        for view in self.data["views"]:
            self.by_name[view["name"]] = view
            with folder.workspace.open(view["file"]) as file:
                self.pictures[view["name"]] = Image.open(file).convert("RGBA")
            (folder.workspace.mount / view["file"]).unlink()

    @property
    def extent(self) -> list[float]:
        return [high - low for low, high in zip(self.data["low"], self.data["high"], strict=True)]

    def seen(self, view: str) -> tuple[float, float]:
        """Width and height, in metres, of what is not transparent."""
        picture = self.pictures[view]
        box = picture.getchannel("A").point(lambda alpha: 255 * (alpha > 20)).getbbox()
        assert box is not None, "an empty picture"
        metres = self.by_name[view]["metres_per_pixel"] * SIZE / picture.width
        return (box[2] - box[0]) * metres, (box[3] - box[1]) * metres

    def share(self, view: str, colour: str) -> float:
        """The share of a picture that has a colour: red, green or blue."""
        return sum(is_coloured(pixel, colour) for pixel in pixels(self.pictures[view])) / area(
            self.pictures[view]
        )

    def middle(self, view: str) -> tuple[int, int, int, int]:
        picture = self.pictures[view]
        found = picture.getpixel((picture.width // 2, picture.height // 2))
        assert isinstance(found, tuple)
        return found  # type: ignore[return-value]


def pixels(picture: Image.Image) -> list[tuple[int, ...]]:
    data = picture.tobytes()
    return [tuple(data[at : at + 4]) for at in range(0, len(data), 4)]


def area(picture: Image.Image) -> int:
    return picture.width * picture.height


def is_coloured(pixel: tuple[int, ...], colour: str) -> bool:
    at = ("red", "green", "blue").index(colour)
    others = [part for place, part in enumerate(pixel[:3]) if place != at]
    return pixel[3] > 128 and pixel[at] > 60 and pixel[at] > 1.6 * max(others)
