# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens a .blend that may mean harm: no script in it runs, and nothing is evaluated before its estimate is known."""

import contextlib
import os

import bpy
from bpy.app.handlers import persistent

from .refusal import Refused
from .scene_estimate import check_scene

_LONGEST_REASON = 300


def open_blend(path):
    """Opens ``path``. Raises Refused if it cannot be opened, or is too heavy; then an empty scene is shown instead.

    Blender evaluates the scene as the last step of opening, after it has called ``load_post``: there it is estimated.
    """
    faults = []

    @persistent
    def estimate(*_):
        faults.append(_fault())
        if faults[-1]:
            _show_nothing()

    bpy.app.handlers.load_post.append(estimate)
    try:
        bpy.ops.wm.open_mainfile(filepath=path, load_ui=False, use_scripts=False)
    except RuntimeError as error:
        name = os.path.basename(path)
        said = " ".join(str(error).replace(path, name).split()).removeprefix("Error: ")
        raise Refused(f"{name} cannot be opened: {said[:_LONGEST_REASON]}") from None
    finally:
        with contextlib.suppress(ValueError):
            bpy.app.handlers.load_post.remove(estimate)
    if fault := (faults or ["It could not be estimated"])[0]:
        raise Refused(fault)


def _fault():
    """Why the open file must not be evaluated; "" if it may be."""
    scene = bpy.context.scene
    try:
        if scene is not None:
            check_scene(scene)
    except Refused as error:
        return str(error)
    except Exception as error:  # whatever the file does to the estimate, it must not be evaluated without one
        return f"It could not be estimated ({type(error).__name__}: {error})"
    return ""


def _show_nothing():
    """Makes an empty scene the shown one, so that nothing of the file is evaluated."""
    empty = bpy.data.scenes.new("Empty")
    for manager in bpy.data.window_managers:
        for window in manager.windows:
            window.scene = empty
