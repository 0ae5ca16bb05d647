"""Paths of the history taken apart."""

from __future__ import annotations

import re

_PATH = re.compile(r'(.*)\.(inputs|outputs)\["(.*)"\]|(.*)\(([^()]*)\)', re.DOTALL)


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
