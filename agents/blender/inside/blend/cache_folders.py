# SPDX-License-Identifier: GPL-3.0-or-later
"""The folders on disk that fluids and bakes of geometry nodes keep their frames in."""

import os
import re
import shutil

import bpy

CACHES = "caches"  # in the workspace: where fluids are baked to


class CacheFolder:
    """The folder of one fluid, or of one bake of geometry nodes. ``name`` is unique in the file."""

    def __init__(self, holder, attribute, name):
        self._holder = holder
        self._attribute = attribute
        self.name = name
        self.real = absolute(self.path)

    @property
    def path(self):
        """The path as Blender stores it; setting it keeps the bake valid."""
        return getattr(self._holder, self._attribute)

    @path.setter
    def path(self, path):
        setattr(self._holder, self._attribute, path)


def cache_folders():
    """The folders of the open file's own objects."""
    folders, taken = [], set()
    for obj in bpy.data.objects:
        if obj.library is not None:
            continue
        stem = re.sub(r"[^\w.-]+", "_", obj.name).strip(".") or "cache"
        for modifier in obj.modifiers:
            if modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN":
                holder, attribute = modifier.domain_settings, "cache_directory"
            elif modifier.type == "NODES" and getattr(modifier, "bake_directory", ""):
                holder, attribute = modifier, "bake_directory"
            else:
                continue
            name = unused_name(stem, lambda name: name.lower() in taken)
            taken.add(name.lower())
            folders.append(CacheFolder(holder, attribute, name))
    return folders


def keep_fluids(workspace):
    """Moves the frames of fluids from Blender's temporary folder, which ends with it, into the workspace."""
    own = os.path.join(workspace, CACHES)
    for folder in cache_folders():
        if not is_temporary(folder.real) or not os.path.isdir(folder.real):
            continue
        name = unused_name(folder.name, lambda name: os.path.lexists(os.path.join(own, name)))
        os.makedirs(own, exist_ok=True)
        shutil.move(folder.real, os.path.join(own, name))
        folder.path = f"//{CACHES}/{name}"


def unused_name(name, is_taken):
    """The name, with a number behind it if it ``is_taken``."""
    found, number = name, 1
    while is_taken(found):
        number += 1
        found = f"{name}-{number}"
    return found


def is_temporary(path):
    """Whether it is in this Blender's temporary folder, where fluids are simulated to unless they are told."""
    return relative_to(path, bpy.app.tempdir) is not None


def absolute(path):
    """The absolute path of one that Blender stores."""
    return os.path.normpath(bpy.path.abspath(path))


def relative_to(path, folder):
    """The path within the folder; None for one outside."""
    real, root = os.path.realpath(path), os.path.realpath(folder)
    return os.path.relpath(real, root) if real == root or real.startswith(root + os.sep) else None
