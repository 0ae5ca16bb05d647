"""What elements of a BMesh have in layers rather than as attributes: the UV of a loop is ``loop[layer].uv``."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

_OF_BMESH = "bmesh.types."
_LAYERS = "bmesh.types.BMLayerAccess"
_SEQUENCES = {
    "bmesh.types.BMVert": "verts", "bmesh.types.BMEdge": "edges", "bmesh.types.BMFace": "faces",
    "bmesh.types.BMLoop": "loops",
}  # fmt: skip
_ELEMENT = "bmesh.types.BM"
_NOTE = "It is in a layer: `layer = bm.{sequence}.layers.{layer}.verify()` before, then `{element}[layer]{member}`."


def in_layers(owner: str, name: str, reader: BaseReader) -> Iterator[tuple[SymbolEntry, str]]:
    """(what holds it, how it is reached) of each layer of an element's class that is called by a name, or holds things
    with such a member.
    """
    sequence = _SEQUENCES.get(owner)
    if sequence is None:
        return
    element = owner.removeprefix(_ELEMENT)
    for layer in reader.members(f"{_LAYERS}{element}").values():
        held = layer.type.partition("[")[2].rstrip("]")
        # A vector's length is nothing that the layer is asked for.
        member = reader.entry(f"{held}.{name}") if held.startswith(_OF_BMESH) else None
        if member is None and layer.name != name:
            continue
        written = f".{name}" if member else ""
        note = _NOTE.format(sequence=sequence, layer=layer.name, element=element.lower(), member=written)
        yield member or layer, note


def former_layer(owner: str, name: str) -> str:
    """The path of the layer of an element's class that a name may mean, which another Blender has."""
    return f"{_LAYERS}{owner.removeprefix(_ELEMENT)}.{name}" if owner in _SEQUENCES else ""
