"""Pages of the guides that explain a kind of message; named where the base has them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

ON_OPERATORS = "info_gotchas_operators"
ON_FREED = "info_gotchas_crashes"
ON_EXTENSIONS = "advanced/extensions/getting_started"
ON_TAGS = "advanced/extensions/tags"
ON_WHEELS = "advanced/extensions/python_wheels"
EXTENSIONS = "bpy.utils.extension_path_user"  # there since add-ons may be extensions


def add_guide(slug: str, reader: BaseReader, recognition: Recognition, sure: float = 0.86) -> None:
    """Adds a guide that the base has."""
    if reader.manual.is_page(slug):
        recognition.add(slug, sure, "error message")
