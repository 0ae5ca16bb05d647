# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults of a file that can be told before it is imported: it is cut off, claims absurd counts, or names files outside.

Only the formats whose importers would follow such names, or trust such counts, are looked at: glTF, OBJ and STL.
"""

import json
import os
import re
import struct
import urllib.parse

from simworlds.sandbox.inside.refusal import Refused

_MOST_JSON = 200_000_000  # bytes
_MOST_ELEMENTS = 500_000_000  # of all accessors of a glTF file
_MOST_LIBRARIES = 100  # .mtl files of an OBJ
_LONGEST_MTL = 20_000_000  # bytes
_LONGEST_NAME = 4000  # letters, with a texture's options
_LISTED = 3
_DRIVE = re.compile(
    r"[a-zA-Z]:/"
)  # of another machine: the importer then looks for the name without its folders
# The importers take any control character for a blank.
_LIBRARY = re.compile(rb"[\x00-\x20]*mtllib[\x00-\x20]+(.*)", re.DOTALL)
_IMAGE = re.compile(
    rb"[\x00-\x20]*(?:map_\w+|bump|disp|decal|refl|norm)[\x00-\x20]+(.*)", re.DOTALL | re.IGNORECASE
)


def check_file(kind, path, root):
    """Raises Refused if a file is damaged as far as can be told, or names files that are not below ``root``."""
    check = {"gltf": _check_gltf, "obj": _check_obj, "stl": _check_stl}.get(kind)
    try:
        named = check(path, root) if check is not None else []
    except (OSError, ValueError, RecursionError, struct.error) as error:
        raise Refused(f"{os.path.basename(path)} is damaged: {str(error)[:200]}.") from None
    outside = sorted({name for folder, name in named if not is_inside(os.path.join(folder, name), root)})
    if outside:
        listed = ", ".join(repr(name[:120]) for name in outside[:_LISTED])
        more = f" and {len(outside) - _LISTED} more" if len(outside) > _LISTED else ""
        raise Refused(
            f"{os.path.basename(path)} names files outside of the folder that may be read: {listed}{more}. "
            "Nothing was imported. Put what it needs beside it, and correct the names in it."
        )


def is_inside(path, root):
    """Whether a path, links followed, leads to something in the folder ``root``. Nothing is opened.

    A sandbox may hide where a link leads to: what is behind such a link is outside.
    """
    real, top = os.path.realpath(path), os.path.realpath(root)
    while real.startswith(top + os.sep):
        if os.path.islink(real):
            return False
        real = os.path.dirname(real)
    return real == top


# glTF


def _check_gltf(path, _root):
    """Returns (folder, name) of what a .gltf or .glb refers to. Raises ValueError."""
    content = json.loads(_json_of(path))
    if not isinstance(content, dict):
        raise ValueError("it is not a glTF file")
    elements = 0
    for accessor in _dicts(content, "accessors"):
        count = accessor.get("count")
        elements += count if isinstance(count, int) and count > 0 else 0
    if elements > _MOST_ELEMENTS:
        raise ValueError(f"it claims {elements:,} values, more than {_MOST_ELEMENTS:,}")
    _check_tree(content)
    uris = [entry.get("uri") for kind in ("buffers", "images") for entry in _dicts(content, kind)]
    return [
        (os.path.dirname(path), urllib.parse.unquote(uri))
        for uri in uris
        if isinstance(uri, str) and not uri.startswith("data:")
    ]


def _json_of(path):
    size = os.path.getsize(path)
    if size > _MOST_JSON and not path.lower().endswith(".glb"):
        raise ValueError(f"its JSON has {size / 1e6:.0f} MB, more than {_MOST_JSON / 1e6:.0f}")
    with open(path, "rb") as file:
        head = file.read(20)
        if head[:4] != b"glTF":
            return head + file.read(_MOST_JSON)
        _magic, _version, length, chunk, _kind = struct.unpack("<5I", head)
        if length > size or chunk > size - 20:
            raise ValueError(
                f"it is cut off: it has {size:,} bytes and should have {max(length, chunk + 20):,}"
            )
        return file.read(min(chunk, _MOST_JSON))


def _check_tree(content):
    """A node has one parent: else a small file stands for more objects than any memory holds."""
    seen = set()
    for node in _dicts(content, "nodes"):
        children = node.get("children", [])
        for child in children if isinstance(children, list) else ():
            if not isinstance(child, int) or child in seen:
                raise ValueError("its nodes do not form a tree: one has several parents")
            seen.add(child)
    for scene in _dicts(content, "scenes"):
        if any(root in seen for root in scene.get("nodes", []) if isinstance(root, int)):
            raise ValueError("its nodes do not form a tree: one is both a root and a child")


def _dicts(content, key):
    entries = content.get(key, [])
    return [entry for entry in entries if isinstance(entry, dict)] if isinstance(entries, list) else []


# OBJ


def _check_obj(path, root):
    """Returns (folder, name) of the material libraries of an .obj, and of the images in them. Raises ValueError."""
    folder = os.path.dirname(path)
    # The importer also looks for a library that is called as the file is, whether it is named or not.
    libraries = {os.path.splitext(os.path.basename(path))[0] + ".mtl", *_libraries_of(path)}
    named = [(folder, name) for name in libraries]
    for name in libraries:
        library = os.path.join(folder, name)
        if is_inside(library, root) and os.path.isfile(library):
            named += [(os.path.dirname(library), image) for image in _images_of(library)]
    return named


def _libraries_of(path):
    """The material libraries that an .obj names. Raises ValueError for names that cannot be followed."""
    libraries = set()
    with open(path, "rb") as file:
        for line in file:
            if (named := _LIBRARY.match(line)) is None:
                continue
            if line.rstrip().endswith(b"\\"):
                raise ValueError("the name of a material library goes on in another line")
            libraries.add(_text(named[1]))
            if len(libraries) > _MOST_LIBRARIES:
                raise ValueError(f"it names more than {_MOST_LIBRARIES} material libraries")
    return libraries


def _images_of(library):
    """The files that an .mtl may name as images, as the importer tries to find them. Raises ValueError."""
    size = os.path.getsize(library)
    if size > _LONGEST_MTL:
        raise ValueError(f"its material library has {size / 1e6:.0f} MB, more than {_LONGEST_MTL / 1e6:.0f}")
    images = set()
    with open(library, "rb") as file:
        for named in filter(None, map(_IMAGE.match, file)):
            text = _text(named[1])
            if len(text) > _LONGEST_NAME:
                raise ValueError(f"its material library has a name of {len(text):,} letters")
            # Options may come first. What is none of them belongs to the name: any word may begin it.
            begins = [word.start() for word in re.finditer(r"\S+", text)] if text.startswith("-") else [0]
            for name in (text[begin:] for begin in begins):
                last = name.rpartition("/")[2]
                images |= {last} if _DRIVE.match(name) else {name, last, name.replace("_", " ")}
    return images


def _text(name):
    return name.decode("utf-8", "replace").strip().replace("\\", "/").replace("\0", "").replace('"', "")


# STL


def _check_stl(path, _root):
    """A binary STL has as many bytes as its count of triangles says. Raises ValueError."""
    size = os.path.getsize(path)
    with open(path, "rb") as file:
        head = file.read(84)
        text = head[:5].lower() == b"solid" and b"facet" in head + file.read(2048)
    if text:
        return []
    if len(head) < 84:
        raise ValueError("it is too short for an STL file")
    (count,) = struct.unpack("<I", head[80:])
    if 84 + 50 * count > size:
        raise ValueError(
            f"it is cut off, or no STL file: it claims {count:,} triangles, and has bytes for {(size - 84) // 50:,}"
        )
    return []
