"""Explains what elements of a bmesh lack because it lies in a layer: ``loop.uv``."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader, SymbolEntry

_ELEMENTS = {
    "bmesh.types.BMVert": ("BMLayerAccessVert", "verts", "vert"),
    "bmesh.types.BMEdge": ("BMLayerAccessEdge", "edges", "edge"),
    "bmesh.types.BMFace": ("BMLayerAccessFace", "faces", "face"),
    "bmesh.types.BMLoop": ("BMLayerAccessLoop", "loops", "loop"),
}
_HOW = "It lies in a layer: `layer = bm.{sequence}.layers.{name}.verify()`, then `{element}[layer]{value}`."
_VALUES = {"uv": ".uv"}  # what a layer has a thing of its own for, not its value


class LayerOfElements(NamedTuple):
    """What gives the layers of a name, and how they are read."""

    path: str
    how: str


def layer_of(owner: str, name: str, reader: BaseReader) -> LayerOfElements | None:
    """The layers that hold what an element is asked for; None where there are none of the name."""
    if owner not in _ELEMENTS:
        return None
    access, sequence, element = _ELEMENTS[owner]
    entry: SymbolEntry | None = reader.entry(f"bmesh.types.{access}.{name}")
    if entry is None:
        return None
    how = _HOW.format(sequence=sequence, name=name, element=element, value=_VALUES.get(name, ""))
    return LayerOfElements(entry.path, how)
