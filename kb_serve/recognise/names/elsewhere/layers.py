"""What elements of a BMesh have in layers rather than as attributes: the UV of a loop is ``loop[layer].uv``."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.reader import BaseReader, SymbolEntry

_LAYERS = "bmesh.types.BMLayerAccess"
_SEQUENCES = {
    "bmesh.types.BMVert": "verts", "bmesh.types.BMEdge": "edges", "bmesh.types.BMFace": "faces",
    "bmesh.types.BMLoop": "loops",
}  # fmt: skip
_NOTE = "It is in a layer: `layer = bm.{sequence}.layers.{layer}.verify()` before, then `{element}[layer]{member}`."


def in_layers(owner: str, name: str, reader: BaseReader) -> Iterator[tuple[SymbolEntry, str]]:
    """(what holds it, how it is reached) of each layer of an element's class that is called by a name, or holds things
    with such a member.
    """
    sequence = _SEQUENCES.get(owner)
    if sequence is None:
        return
    element = owner.removeprefix("bmesh.types.BM")
    for layer in reader.members(f"{_LAYERS}{element}").values():
        held = layer.type.partition("[")[2].rstrip("]")
        member = reader.entry(f"{held}.{name}")
        if member is None and layer.name != name:
            continue
        written = f".{name}" if member else ""
        note = _NOTE.format(sequence=sequence, layer=layer.name, element=element.lower(), member=written)
        yield member or layer, note
