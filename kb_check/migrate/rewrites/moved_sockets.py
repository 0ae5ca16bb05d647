"""``principled.inputs[9]`` of 3.4 is ``principled.inputs["Roughness"]``: sockets that were put before it moved it on.

Only where it is said which Blender the script was written for: a number tells nothing of that.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.paths import socket_name
from kb_check.migrate.place import version_of
from kb_check.migrate.rewrite import Rewrite
from kb_check.nodes.socket_at import by_name, sockets_by_place

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place


def _propose(place: Place) -> Iterator[Change]:
    source, history = place.source, place.script.names.reader.history
    if source is None:
        return
    for node, asked in sockets_by_place(place.script):
        before = next(
            (name for version, name in history.moved_socket(asked.place) if version_of(version) == source),
            "",
        )
        meant = _called(place, asked.socket.owner, asked.socket.side, before) if before else None
        if meant is None or not by_name(meant):
            continue
        _, _, key = by_name(meant).partition("[")
        told = f"{asked.subscript} is {before!r} in {source[0]}.{source[1]}"
        yield place.change(
            REWRITE.id, meant.path, [place.write(node.slice, key.removesuffix("]"))],
            reason=f"{told}, and {asked.socket.label!r} now.", targets=[meant.path],
        )  # fmt: skip


def _called(place: Place, cls: str, side: str, name: str) -> Symbol | None:
    """The socket of a node that has a name, or the one that alone took the place of that; None for none, or several."""
    successors = place.script.names.reader.history.successors(f'{cls}.{side}["{name}"]')
    names = (
        {socket_name(row.target) for row in successors if not row.how} if len(successors) == 1 else set[str]()
    )
    found = [socket for socket in place.script.api.sockets(cls, side) if socket.label in {name, *names}]
    return found[0] if len(found) == 1 else None


REWRITE = Rewrite("socket-place", _propose)
