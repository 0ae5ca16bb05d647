"""Recognises messages of products that are written with ``*`` instead of ``@``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.code.products import CLASSES, WITH_AT

if TYPE_CHECKING:
    from kb_serve.recognise.recognition import Recognition


def recognise_multiplications(query: str, recognition: Recognition) -> None:
    """Adds the classes that are multiplied, and how it is written."""
    for match in forms.first_matches(forms.PRODUCT, query):
        factors = [f"mathutils.{match[side]}" for side in ("left", "right")]
        if all(factor in CLASSES for factor in factors):
            recognition.notes.append(WITH_AT)
            for rank, factor in enumerate(dict.fromkeys(factors)):
                recognition.add(factor, 0.95 - 0.02 * rank, "error message")
