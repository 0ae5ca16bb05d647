# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads what asset files have, and writes small pictures of it. Meant for a Blender that ends afterwards."""

import os

import bpy
import numpy

from simworlds.sandbox.inside.refusal import Refused

from ..blend.file_io import reason

_SIDE = 128  # pixels of a picture
_KINDS = {
    "object": "objects",
    "collection": "collections",
    "material": "materials",
    "world": "worlds",
    "node_group": "node_groups",
}
_MOST = 2000  # assets of one file


def read_assets(arguments, report):
    """What ``path`` has: a .blend's marked assets, or an image's size. Pictures go to ``folder``, numbered from 0.

    Returns ``assets``, ``size``, ``picture`` and ``fault``.
    """
    path, folder = arguments["path"], arguments["folder"]
    report(0, None, f"reading {os.path.basename(path)}")
    os.makedirs(folder, exist_ok=True)
    found = {"assets": [], "size": None, "picture": "", "fault": ""}
    try:
        if path.lower().endswith(".blend"):
            found["assets"] = list(_marked(path, folder))
        else:
            found["size"], found["picture"] = _image(path, folder)
    except (RuntimeError, OSError) as error:
        found["fault"] = reason(error)[:300]
    return found


def load_marked(path, wanted=None, *, link):
    """{kind: data-blocks} of a .blend that are marked as assets; ``wanted``: (kind, name) of a single one."""
    with bpy.data.libraries.load(path, link=link, assets_only=True) as (source, target):
        for kind, attribute in _KINDS.items():
            names = getattr(source, attribute)
            if wanted is not None:
                names = [name for name in names if (kind, name) == wanted]
            setattr(target, attribute, names[:_MOST])
    return {
        kind: [block for block in getattr(target, attribute) if block is not None]
        for kind, attribute in _KINDS.items()
    }


def _marked(path, folder):
    number = 0
    for kind, blocks in load_marked(path, link=True).items():
        for block in blocks:
            data = block.asset_data
            picture = _preview(block, folder, number)
            number += bool(picture)
            yield {
                "kind": kind,
                "name": block.name,
                "description": _text(data, "description"),
                "tags": [tag.name[:200] for tag in data.tags][:100] if data is not None else [],
                "author": _text(data, "author"),
                "license": _text(data, "license"),
                "picture": picture,
            }
            if number > _MOST:
                raise Refused(f"It has more than {_MOST} assets.")


def _text(data, name):
    return (getattr(data, name, "") or "")[:900]


def _preview(block, folder, number):
    preview = block.preview
    if preview is None or not all(preview.image_size):
        return ""
    width, height = preview.image_size
    pixels = numpy.array(preview.image_pixels_float[:], dtype=numpy.float32)
    return _write(pixels, width, height, folder, number)


def _image(path, folder):
    image = bpy.data.images.load(path)
    width, height = image.size
    if not width or not height:
        raise RuntimeError("it is not an image that Blender reads")
    factor = _SIDE / max(width, height)
    if factor < 1:
        image.scale(max(1, round(width * factor)), max(1, round(height * factor)))
    pixels = _pixels(image)
    if image.is_float:  # light without an upper end, made a picture
        light = numpy.maximum(numpy.nan_to_num(pixels, posinf=0.0), 0.0)
        pixels = (light / (1.0 + light)) ** (1 / 2.2)
        pixels[3::4] = 1.0
    small = tuple(image.size)
    name = _write(pixels, small[0], small[1], folder, 0) if image.channels == 4 else ""
    bpy.data.images.remove(image)
    return [width, height], name


def _pixels(image):
    values = numpy.empty(len(image.pixels), dtype=numpy.float32)
    image.pixels.foreach_get(values)
    return values


def _set_pixels(image, values):
    image.pixels.foreach_set(values)


def _write(pixels, width, height, folder, number):
    """The name of a new PNG."""
    picture = bpy.data.images.new("picture", width, height, alpha=True)
    _set_pixels(picture, pixels)
    picture.file_format = "PNG"
    name = f"{number}.png"
    picture.save(filepath=os.path.join(folder, name))
    bpy.data.images.remove(picture)
    return name
