"""Recognises messages of products that are written with ``*`` instead of ``@``, or of values of another mathutils."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.code.products import CLASSES, WITH_AT

if TYPE_CHECKING:
    from kb_serve.recognise.recognition import Recognition


# What a Matrix is multiplied by.
_MULTIPLIED = frozenset({"mathutils.Matrix", "mathutils.Vector"})
_TWO_MODULES = (
    "Blender's own mathutils multiplies these: one of them is of another one, as of the `mathutils` that pip installs "
    "beside `bpy`. Uninstall that, and import `bpy` before `mathutils`."
)


def recognise_multiplications(query: str, recognition: Recognition) -> None:
    """Adds the classes that are multiplied, and how it is written."""
    for match in forms.first_matches(forms.PRODUCT, query):
        factors = [f"mathutils.{match[side]}" for side in ("left", "right")]
        if all(factor in CLASSES for factor in factors):
            recognition.notes.append(WITH_AT)
            for rank, factor in enumerate(dict.fromkeys(factors)):
                recognition.add(factor, 0.95 - 0.02 * rank, "error message")
    for match in forms.first_matches(forms.MATRIX_PRODUCT, query):
        if match["left"] == "Matrix" and f"mathutils.{match['right']}" in _MULTIPLIED:
            recognition.notes.append(_TWO_MODULES)
            recognition.add("mathutils.Matrix", 0.95, "error message")
