"""The settings of a node that decide which of its sockets it shows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import ID
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import HIDDEN, SHOWN_WHEN
from kb_build.symbols.lines import shown_when

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kb_build.flow.blender.api import Api
    from kb_build.symbols.records import Symbol
    from kb_check.script import Script


def deciding(script: Script, sockets: list[Symbol]) -> set[str]:
    """The properties that may show sockets: all of their node's, where more than one of them has a say."""
    names = [showing(socket) for socket in sockets]
    if all(len(of_socket) == 1 for of_socket in names):
        return set[str]().union(*names)
    return {symbol.name for symbol in script.api.own(sockets[0].owner).values() if symbol.type == "enum"}


def showing(socket: Symbol) -> set[str]:
    """The properties with whose values a socket is shown."""
    return {mode.partition("=")[0] for mode in socket.modes}


def ways_of_showing(socket: Symbol) -> list[tuple[str, ...]]:
    """The sets of modes of its node with each of which a socket is shown: one that is empty where it always is."""
    if socket.modes or not (told := socket.flagged(SHOWN_WHEN)):
        return [socket.modes]
    return [tuple(way.split(" and ")) for way in told[0].split(", or ")]


def is_shown(socket: Symbol, settings: Mapping[str, str]) -> bool:
    """Whether one of some settings shows a socket."""
    modes = (mode.partition("=") for mode in socket.modes)
    return any(settings.get(name) in values.split("|") for name, _, values in modes)


def is_internal(api: Api, socket: Symbol, key: str = "") -> bool:
    """Whether its node never shows a socket, so that nothing but its index gives it: no ``key`` either.

    What a node shows of a data-block that it points to, as the passes of a scene, is not its own to decide.
    """
    is_hidden = HIDDEN in socket.flags and not shown_when(socket)
    is_given = any(f'"{key or socket.label}"' in subscript for subscript in socket.subscripts)
    return is_hidden and not is_given and not _is_of_data(api, socket.owner)


def _is_of_data(api: Api, node: str) -> bool:
    """Whether a node points to a data-block."""
    return any(
        symbol.type == "pointer" and api.descends(f"{T}{symbol.target}", ID)
        for symbol in api.own(node).values()
    )


def is_by_others(socket: Symbol) -> bool:
    """Whether settings of other things than its node show a socket: those of the view layer whose passes it reads."""
    first = shown_when(socket).partition("=")[0]
    return not socket.modes and "." in first
