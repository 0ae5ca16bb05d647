"""Paths of symbols and of their parts, taken apart and put together.

Besides ``owner.member`` there are arguments, ``function(argument)``, items of enumerations, ``property:ITEM`` and
``function(argument):ITEM``, and the sockets of nodes, ``node.inputs["Name"]``, whose names may have any of these marks.
"""

from __future__ import annotations

import re

_PATH = re.compile(r'(.*)\.(inputs|outputs)\["(.*)"\]|([\w.]+)\(([^()]*)\)', re.DOTALL)


def split_path(path: str) -> tuple[str, str, str]:
    """Splits a path into (path above, mark, name). Marks: ``.`` member, ``(`` parameter, ``:`` enum item, ``<`` input
    and ``>`` output of a node. Enum items follow the last ``:`` of a path.
    """
    if path.endswith(('"]', ")")) and (match := _PATH.fullmatch(path)):
        if match[2]:
            return match[1], "<" if match[2] == "inputs" else ">", match[3]
        return match[4], "(", match[5]
    above, colon, item = path.partition(":")
    if colon and not above.endswith('"]') and '["' in above:
        # A colon inside a socket's name.
        above, colon, item = path.rpartition('"]:')
        return f'{above}"]', ":", item
    if colon:
        return above, ":", item
    above, _, name = path.rpartition(".")
    return above, ".", name


def joined_path(above: str, mark: str, name: str) -> str:
    """The inverse of :func:`split_path`."""
    if mark in "<>":
        return f'{above}.{"inputs" if mark == "<" else "outputs"}["{name}"]'
    return f"{above}({name})" if mark == "(" else f"{above}{mark}{name}"


def last_name(path: str) -> str:
    """What follows the last dot of a path."""
    return path.rpartition(".")[2]


def plain_path(path: str) -> str:
    """The symbol that a parameter (``f(x)``) or an enum item (``p:ITEM``) belongs to; other paths as they are."""
    if '["' in path:
        socket, closing, _ = path.partition('"]')
        return socket + closing
    return path.partition(":")[0].partition("(")[0]


def argument_of(path: str) -> str:
    """The argument that a path is of, or its item: ``x`` of ``f(x)`` and of ``f(x):ITEM``; "" for others."""
    return "" if '["' in path else path.partition("(")[2].partition(")")[0]


def item_of(path: str) -> str:
    """The item of an enumeration that a path is of; "" for other paths."""
    _, mark, name = split_path(path) if ":" in path else ("", "", "")
    return name if mark == ":" else ""


def is_socket(path: str) -> bool:
    """Whether a path, or the end of one, gives a socket, by its name or number, or something of it."""
    return "puts[" in path


def socket_node(path: str) -> str:
    """The node of a socket's path: ``bpy.types.N`` of ``bpy.types.N.inputs["A"]``; "" for other paths."""
    node, mark, _ = path.partition('puts["')
    return node.rpartition(".")[0] if mark else ""


def socket_side(path: str) -> str:
    """``inputs`` or ``outputs``, of a socket's path or its end; "" for other paths."""
    above, mark, _ = path.partition('["')
    return last_name(above) if mark else ""


def socket_name(path: str) -> str:
    """The name in a socket's path, in its end, or in that of its item; "" for other paths."""
    return path.partition('["')[2].partition('"]')[0]


def as_code(path: str) -> str:
    """A path as scripts write it: ``….engine = 'CYCLES'`` of ``….engine:CYCLES``, ``new(type='SMOKE')`` of
    ``new(type):SMOKE``, ``add(radius=…)`` of ``add(radius)``.
    """
    if is_socket(path):
        return path
    whole, argument, item = plain_path(path), argument_of(path), item_of(path)
    if argument:
        return f"{whole}({argument}={repr(item) if item else '…'})"
    return f"{whole} = {item!r}" if item else path
