"""Sockets of nodes that Blender keeps for old files, and what they are on the node that it makes instead."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.paths import socket_name, socket_node, socket_side

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_SURE = 0.9
_MIX = "bpy.types.ShaderNodeMix"
_HOW = (
    'The node may be a `{node}`, which Blender makes instead since 3.4, and which has no `{side}["{name}"]`: with '
    '`{setting}` it is `{side}["{new}"]`, or `{place}` at any time.'
)
_OLD_MIX = "bpy.types.ShaderNodeMixRGB"
_NEWER = (
    "Blender keeps `{old}` for old files; since 3.4 its menus make a `{new}`, which mixes colours with "
    "`data_type = 'RGBA'`."
)
# The name of a socket → the socket in its place, on the node made instead.
INSTEAD = {"Color1": f'{_MIX}.inputs["A_Color"]', "Color2": f'{_MIX}.inputs["B_Color"]'}
_OLD = ("bpy.types.ShaderNodeMixRGB", "bpy.types.CompositorNodeMixRGB", "bpy.types.TextureNodeMixRGB")


def tell_of_the_newer_node(name: str, reader: BaseReader, recognition: Recognition) -> None:
    """Notes what a socket of such a name is on the newer node, where this version has that."""
    path = INSTEAD.get(name, "")
    socket = reader.symbol(path) if path else None
    if socket is not None and socket.modes and socket.subscripts:
        setting, _, value = socket.modes[0].partition("=")
        said = _HOW.format(
            node=socket.owner, side="inputs", name=name, setting=f"{setting} = {value!r}", new=socket.label,
            place=socket.subscripts[0],
        )  # fmt: skip
        recognition.notes.append(said)
        recognition.add(path, _SURE, "newer node")


def tell_of_the_newer_mix(path: str, reader: BaseReader, recognition: Recognition) -> None:
    """Notes which node takes the place of Mix (Legacy), where a query names that and this version has both."""
    if path == _OLD_MIX and reader.entry(_MIX) and reader.entry(_OLD_MIX):
        recognition.notes.append(_NEWER.format(old=_OLD_MIX, new=_MIX))
        recognition.add(_MIX, _SURE, "newer node")


def name_on_an_old_node(path: str) -> str:
    """The name of an old node's socket that is called otherwise on the newer node; "" for other paths."""
    name = socket_name(path) if socket_side(path) == "inputs" else ""
    return name if name in INSTEAD and socket_node(path) in _OLD else ""
