"""Recognises messages of what Blender cannot do the way it was started: without a window, as a Python module."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import BEGIN_DRAWING
from kb_serve.recognise import message_patterns as forms

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_NO_DRAWING = (
    "Blender runs without a window (`bpy.app.background` is True: started with `--background`, or as a Python module): "
    "shaders, batches and off-screen buffers of `gpu` work only in a Blender with a window. Images are rendered "
    "without one: `bpy.ops.render.render(write_still=True)`."
)
BAKES_FLUIDS = "bpy.ops.fluid.bake_all"
NO_FLUIDS = (
    "Mantaflow, which simulates fluids, is not set up wholly where Blender is a Python module (`import bpy` in another "
    "Python): every bake of a fluid ends the process there, and so does its exit once frames were set with a domain in "
    "the scene. Run the script with Blender itself: "
    "`blender --background scene.blend --python script.py`."
)


class WaysToRun:
    """Finds in one base what such a Blender does instead."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds what cannot be done, and how Blender is to be started for it."""
        if forms.NO_DRAWING.search(query):
            self._no_drawing(recognition)
        if forms.NO_FLUIDS.search(query):
            recognition.notes.append(NO_FLUIDS)
            recognition.add(BAKES_FLUIDS, 0.95, "error message")

    def _no_drawing(self, recognition: Recognition) -> None:
        """Blender without a window: what begins drawing there, where this version has it."""
        if self._reader.entry(BEGIN_DRAWING):
            recognition.add(BEGIN_DRAWING, 0.95, "error message")
        else:
            recognition.notes.append(_NO_DRAWING)
            recognition.add("bpy.app.background", 0.9, "error message")
