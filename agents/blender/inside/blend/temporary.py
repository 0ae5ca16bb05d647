# SPDX-License-Identifier: GPL-3.0-or-later
"""Contexts that change something about the open file and undo it at their end."""

import contextlib

import bpy


@contextlib.contextmanager
def temporary_settings(changes):
    """Makes ``changes``, (owner, name, value), and restores them in the same order, since some limit others."""
    changes = list(changes)
    before = [(owner, name, getattr(owner, name)) for owner, name, _ in changes]
    try:
        for owner, name, value in changes:
            setattr(owner, name, value)
        yield
    finally:
        for owner, name, value in before:
            setattr(owner, name, value)


@contextlib.contextmanager
def without_handlers(names=None):
    """Runs none of the file's own handlers: those of these names in bpy.app.handlers, or all."""
    lists = [getattr(bpy.app.handlers, name, None) for name in names or dir(bpy.app.handlers)]
    kept = [(handlers, list(handlers)) for handlers in lists if isinstance(handlers, list) and handlers]
    for handlers, _ in kept:
        handlers.clear()
    try:
        yield
    finally:
        for handlers, before in kept:
            handlers[:] = before


@contextlib.contextmanager
def without_render_result():
    """Removes the image that rendering leaves in the file, unless there was one before."""
    had_result = "Render Result" in bpy.data.images
    try:
        yield
    finally:
        result = bpy.data.images.get("Render Result")
        if result is not None and not had_result:
            bpy.data.images.remove(result)
