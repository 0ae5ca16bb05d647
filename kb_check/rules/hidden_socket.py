"""A socket that a new node does not show, asked for by name or identifier while nothing in the script sets the mode.

Blender finds sockets by these only while the node shows them.

```python
points = tree.nodes.new("GeometryNodeDistributePointsOnFaces")
points.inputs["Density Max"]  # reported: distribute_method must be 'POISSON'
zone = tree.nodes.new("GeometryNodeSimulationInput")
zone.inputs["Geometry"]  # reported: zone.pair_with_output(…) comes first
```

Not reported: nodes that the script did not make itself, and scripts that name a property of the mode anywhere, compute
names or import modules which may change scenes.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.records import WHEN_PAIRED
from kb_check.findings import Finding
from kb_check.made_here import is_new, knows_all, named_words, statement_of
from kb_check.rule import Rule
from kb_check.script import once_per_script

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.types import Resolution
    from kb_build.records import Symbol
    from kb_check.script import Script

_PAIRING = "pair_with_output"


def _check(script: Script) -> Iterator[Finding]:
    if not knows_all(script):
        return
    for row in script.resolutions("item"):
        node = row.node
        certain = bool(row.symbols) and row.sure and not row.guarded and not row.missing
        if not certain or not isinstance(node, ast.Subscript) or not isinstance(node.value, ast.Attribute):
            continue
        sockets = [symbol for path in row.symbols if (symbol := script.api.symbols.symbol(path))]
        if row.value in _asked(script):
            continue
        told = _unpaired(script, sockets, node) or _hidden(script, sockets, row)
        if told and is_new(script, node.value.value):
            yield Finding(RULE.id, "error", script.span(node), told, sockets[0].path)


@once_per_script
def _asked(script: Script) -> frozenset[str]:
    """The texts of which the script asks whether something has them."""
    return frozenset(
        node.left.value
        for node in script.all(ast.Compare)
        if isinstance(node.left, ast.Constant)
        and isinstance(node.left.value, str)
        and isinstance(node.ops[0], (ast.In, ast.NotIn))
    )


def _hidden(script: Script, sockets: list[Symbol], row: Resolution) -> str:
    """What is wrong with asking for sockets of one name, none of which a new node shows; empty if nothing surely is."""
    if not _deciding(script, sockets).isdisjoint(named_words(script)):
        return ""
    for socket in sockets:
        side = socket.path[len(socket.owner) + 1 :].partition("[")[0]
        is_name = row.value in socket.socket_names
        needed = {"hidden-by-default", "name-when-shown" if is_name else "identifier-when-shown"}
        if (
            not (is_name or row.value == socket.identifier)
            or f'{side}["{row.value}"]' in socket.subscripts
            or not socket.modes
            or not needed.issubset(socket.flags)
        ):
            return ""
    first = sockets[0]
    wanted = " and ".join(first.modes)
    return (
        f"A new `{first.owner}` shows no socket {row.value!r}, and finds only what it shows: it is there "
        f"with {wanted}."
    )


def _deciding(script: Script, sockets: list[Symbol]) -> set[str]:
    """The properties that may show sockets: all of their node's, where more than one of them has a say."""
    names = [{mode.partition("=")[0] for mode in socket.modes} for socket in sockets]
    if all(len(of_one) == 1 for of_one in names):
        return set[str]().union(*names)
    return {symbol.name for symbol in script.api.own(sockets[0].owner).values() if symbol.type == "enum"}


def _unpaired(script: Script, sockets: list[Symbol], node: ast.Subscript) -> str:
    if not all(WHEN_PAIRED in socket.flags for socket in sockets) or any(
        "zone" in w for w in named_words(script)
    ):
        return ""
    is_place = isinstance(node.slice, ast.Constant) and isinstance(node.slice.value, int)
    if is_place or (_PAIRING in named_words(script) and not _is_paired_later(script, node)):
        return ""  # another socket is in its place before
    return f"`{sockets[0].path}` is there once `{_PAIRING}` has been called, which comes before."


def _is_paired_later(script: Script, node: ast.Subscript) -> bool:
    """Whether every pairing stands further down, all of them in the body of the module itself."""
    own = list(script.tree.body)
    plain = (ast.Expr, ast.Assign, ast.AnnAssign)
    here = statement_of(own, node)
    calls = [part for part in script.all(ast.Attribute) if part.attr == _PAIRING]
    places = [statement_of(own, call) for call in calls]
    return (
        here >= 0
        and isinstance(own[here], plain)
        and all(place > here and isinstance(own[place], plain) for place in places)
    )


RULE = Rule("hidden-socket", "error", "A socket that the node's mode does not have", _check)
