"""The places of nodes at which a Blender has another socket than older ones had."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from kb_build.symbols.paths import is_socket, socket_name
from kb_build.versions.socket_places import places_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_build.symbols.records import Symbol
    from kb_build.versions.socket_places import SocketPlaces


def find_moved_sockets(
    symbols: Sequence[Symbol],
    places: SocketPlaces,
    version: str,
    successors: Iterable[tuple[str, int, str, str, str, str]],
) -> Iterator[tuple[str, str, str]]:
    """(``class.inputs[7]``, older version, name of its socket there) where ``symbols``, those of a minor version, have
    another one. One that was only given another name is the same; ``successors`` (see schema.DDL) say some of these.
    """
    renamed: defaultdict[str, set[str]] = defaultdict(set)
    for path, _, target, *_ in successors:
        if is_socket(path) and is_socket(target):
            renamed[path].add(socket_name(target))
    for (node, side), now in sorted(places_of(symbols).items()):
        for older in places.before(version):
            before = places.names(older, node, side) or ()
            for at, (had, has) in enumerate(zip(before, now, strict=False)):
                called = renamed.get(f'{node}.{side}["{had}"]', set[str]())
                is_elsewhere = had in now or has in before or not called.isdisjoint(now)
                if had and has and had != has and has not in called and is_elsewhere:
                    yield f"{node}.{side}[{at}]", older, had
