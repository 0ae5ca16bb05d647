"""Pages of the API's own guides that explain a kind of message; named where the base has them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

ON_OPERATORS = "info_gotchas_operators"
ON_FREED = "info_gotchas_crashes"


def add_guide(slug: str, reader: BaseReader, recognition: Recognition) -> None:
    """Adds a guide that the base has."""
    if reader.is_page(slug):
        recognition.add(slug, 0.86, "error message")
