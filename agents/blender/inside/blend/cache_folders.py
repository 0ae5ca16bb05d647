# SPDX-License-Identifier: GPL-3.0-or-later
"""The folders on disk that fluids and bakes of geometry nodes keep their frames in."""

import os
import re
import shutil

import bpy

from simworlds.sandbox.inside.refusal import Refused

from .stored_texts import UnknownForm, replace_texts

CACHES = "caches"  # in the workspace: where fluids are baked to


class CacheFolder:
    """The folder of one fluid, or of one bake of geometry nodes. ``name`` is unique in the file."""

    def __init__(self, holder, attribute, name):
        self._holder = holder
        self._attribute = attribute
        self.is_fluid = attribute == "cache_directory"
        self.name = name
        self.real = absolute(self.path)

    @property
    def path(self):
        """The path as Blender stores it; setting it keeps a bake valid, and loses what a fluid was stepped to."""
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
    """Moves what is in Blender's temporary folder, which ends with it, into the workspace.

    A link stays in the place of a fluid: to set a domain's path would make Blender drop frames that are not baked.
    Returns {path as the open file has it: path as a copy of it should have it}, for ``write_paths``.
    """
    own, renamed = os.path.join(workspace, CACHES), {}
    for folder in cache_folders():
        if is_temporary(folder.real) and os.path.isdir(folder.real):
            name = unused_name(folder.name, lambda name: os.path.lexists(os.path.join(own, name)))
            os.makedirs(own, exist_ok=True)
            shutil.move(folder.real, os.path.join(own, name))
            if folder.is_fluid:
                os.symlink(os.path.join(own, name), folder.real)
            else:
                folder.path = f"//{CACHES}/{name}"
        inside = relative_to(folder.real, workspace)
        if folder.is_fluid and inside is not None:
            renamed[folder.path] = f"//{inside}"
    return renamed


def write_paths(file, renamed):
    """Gives the fluids in a .blend file other folders: {path in it: path wanted}. Raises Refused."""
    changed = {old: new for old, new in renamed.items() if old != new}
    try:
        if changed:
            replace_texts(file, "FluidDomainSettings", "cache_directory", changed)
    except UnknownForm as error:
        raise Refused(f"The folders of fluids cannot be written into the file: {error}") from None


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
