"""What one has to know of a few symbols that neither Blender's API nor its manual says."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.recognise.products import CLASSES, WITH_AT
from kb_serve.recognise.subscripts import NODES_MODIFIER, CustomProperties

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.reader import BaseReader

_HANDLERS = "bpy.app.handlers."
_PERSISTENT = f"{_HANDLERS}persistent"
_STAYING = f"Loading a file removes a handler, before `load_post` runs it too, unless it has `@{_PERSISTENT}` above it."


class Practice:
    """Sentences for the answers from one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._custom = CustomProperties(reader)

    def of(self, identifier: str) -> Iterator[str]:
        """Sentences on a symbol, or on what the page with that slug explains."""
        if identifier.startswith(_HANDLERS) and identifier != _PERSISTENT and self._reader.entry(_PERSISTENT):
            yield _STAYING
        if identifier in CLASSES:
            yield WITH_AT
        if identifier == NODES_MODIFIER or identifier in self._explaining(NODES_MODIFIER):
            yield self._custom.on_inputs()

    def _explaining(self, path: str) -> set[str]:
        return {target.partition("#")[0] for target in self._reader.manual_links(path)}
