"""Finds the sockets that nodes had by a name in other versions, where a message names no node."""

from __future__ import annotations

from collections import Counter
from itertools import islice
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, terms
from kb_build.symbols.api_names import SIDES, TYPES
from kb_build.symbols.paths import socket_name, socket_node
from kb_serve.recognise import message_patterns as forms

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbolLookup

_FEW = 3
_MOST_LISTED = 8
_USUAL_NODE = f"{TYPES}ShaderNodeBsdfPrincipled."  # whose sockets scripts set most


class FormerSockets:
    """Finds in one base what became of sockets."""

    def __init__(self, reader: BaseReader, removed: RemovedSymbolLookup) -> None:
        self._reader = reader
        self._removed = removed

    def explain(self, name: str, query: str, recognition: Recognition) -> bool:
        """Adds the likeliest socket that a node had by that name; tells whether most still take it."""
        around = set(terms(forms.prose_of(query))) - set(terms(f"{name} node"))
        paths = [
            path
            for side in SIDES
            for path in self._reader.history.removed_by_key(key(f'{side}["{name}"]'))
            if path.endswith(f'["{name}"]')  # keys tell small letters from capitals
        ]
        taken = {path: new for path in paths if (new := self._reader.history.still_works(path))}
        if len(taken) * 2 > len(paths):
            self._tell_still_taken(name, taken, recognition)
            return True
        fit = {path: len(around & set(terms(socket_node(path).removeprefix(TYPES)))) for path in paths}
        # What a node got later is meant of that node alone.
        paths = [path for path in paths if fit[path] or self._is_gone(path)]
        lost = [path for path in paths if path not in taken]
        if not any(fit.values()):
            said = len(recognition.notes)
            paths = self._lost_by_nobody_else(name, paths, recognition)
            if not paths and said == len(recognition.notes):
                return False  # so many have one that nothing tells which is meant
        paths.sort(key=lambda path: (-fit[path], not path.startswith(_USUAL_NODE)))
        for removed in islice(filter(None, map(self._removed.of_path, paths)), 1):
            recognition.add_removed(removed)
        told = {socket_node(one.path) for one in recognition.removed}
        others = [path for path in lost if socket_node(path) not in told]
        recognition.notes += self._of_other_nodes(name, others)
        return False

    def _of_other_nodes(self, name: str, lost: Sequence[str]) -> Iterator[str]:
        """Sentences on the other nodes that had such a socket, those first that are still there, and on the few that
        have one.
        """
        nodes: dict[str, str] = {}
        for path in sorted(lost, key=lambda path: (self._reader.entry(socket_node(path)) is None, path)):
            span = self._reader.history.removed(path)
            if span is not None and span[2]:  # not of later versions alone
                nodes.setdefault(socket_node(path), self._name_now(path))
        if nodes:
            named = [
                f"`{node.removeprefix(TYPES)}`{now}" for node, now in islice(nodes.items(), _MOST_LISTED)
            ]
            more = f", and {len(nodes) - _MOST_LISTED} more" if len(nodes) > _MOST_LISTED else ""
            yield f"Other versions had a socket `{name}` on {', '.join(named)}{more}."
        sockets = [entry for entry in self._reader.names.by_name(name) if entry.kind == "socket"]
        having = sorted({entry.owner.removeprefix(TYPES) for entry in sockets})
        if 0 < len(having) <= _FEW:
            yield f"Nodes that have one: {', '.join(f'`{node}`' for node in having)}."

    def _name_now(self, path: str) -> str:
        """What the node calls the socket now, or what takes the node's place, in brackets; empty for neither."""
        target = next((successor.target for successor in self._reader.history.successors(path)), "")
        if target and socket_node(target) == socket_node(path):
            return f" (now `{socket_name(target)}`)"
        if self._reader.entry(node := socket_node(path)):
            return ""
        others = (successor.target for successor in self._reader.history.successors(node))
        instead = next(filter(None, others), "") or socket_node(target)
        return f" (now `{instead.removeprefix(TYPES)}`)" if instead else ""

    def _tell_still_taken(self, name: str, taken: dict[str, str], recognition: Recognition) -> None:
        """A former name that most of the nodes which had it still take: where it fails."""
        new = Counter(map(socket_name, taken.values())).most_common(1)[0][0]
        taking = {socket_node(path) for path in taken}
        sockets = [entry for entry in self._reader.names.by_name(new) if entry.kind == "socket"]
        having = {entry.owner: entry.path for entry in sockets if entry.owner not in taking}
        weights = self._reader.usage.weights(list(having))
        lacking = sorted(having, key=lambda node: (-weights.get(node, 0.0), node))
        listed = ", ".join(f"`{node}`" for node in lacking[:_MOST_LISTED])
        others = f", and {len(lacking) - _MOST_LISTED} more" if len(lacking) > _MOST_LISTED else ""
        fails = f" Nodes whose `{new}` was never called so refuse it: {listed}{others}." if lacking else ""
        recognition.notes.append(
            f"`{name}` is the former name of `{new}`, and still works on the {len(taken)} nodes that had it."
            f"{fails} So does a group, whose sockets have the names that it gives them."
        )
        for node in lacking[:1]:
            recognition.add(having[node], 0.9, "error message")

    def _is_gone(self, path: str) -> bool:
        removed = self._removed.of_path(path)
        return removed is not None and bool(removed.gone)

    def _lost_by_nobody_else(self, name: str, paths: Sequence[str], recognition: Recognition) -> list[str]:
        """Of the sockets of a name that nodes lost, where no node is named: that of the node which scripts use most,
        or else all, if hardly any other node has such a socket; of many that were renamed alike, their name is noted.
        """
        if usual := [path for path in paths if path.startswith(_USUAL_NODE)]:
            return usual
        having = sum(entry.kind == "socket" for entry in self._reader.names.by_name(name))
        if having * _FEW > len(paths):
            return []
        targets = [
            targets[0].target for path in paths if (targets := list(self._reader.history.successors(path)))
        ]
        names = Counter(map(socket_name, targets))
        new, count = names.most_common(1)[0] if names else ("", 0)
        if len(paths) < _FEW or not new or count * 2 < len(paths):
            return list(paths)
        recognition.notes.append(
            f"The sockets `{name}` of {len(paths)} nodes are gone; most are called `{new}` now."
        )
        return []
