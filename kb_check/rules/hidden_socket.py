"""A socket that a new node does not show, asked for by name or identifier while nothing in the script sets the mode.

Blender finds sockets by these only while the node shows them.

```python
points = tree.nodes.new("GeometryNodeDistributePointsOnFaces")
points.inputs["Density Max"]  # reported: distribute_method must be 'POISSON'
zone = tree.nodes.new("GeometryNodeSimulationInput")
zone.inputs["Geometry"]  # reported: zone.pair_with_output(…) comes first
```

By index it finds the others as well. A link to one of them has no effect, and is a warning:

```python
mix = tree.nodes.new("ShaderNodeMix")
mix.data_type = "RGBA"
tree.links.new(mix.outputs[0], emission.inputs[0])  # a warning: mix.outputs[2] is the one of colours
```

Not reported: nodes that the script did not make itself, and scripts that name a property of the mode anywhere, compute
names or import modules which may change scenes.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.records import WHEN_PAIRED
from kb_build.symbol_lines import usual_default
from kb_check.findings import Finding
from kb_check.made_here import (
    bindings,
    callee_path,
    is_new,
    knows_all,
    named_words,
    places,
    statement_of,
    words_of,
)
from kb_check.rule import Rule
from kb_check.script import once_per_script

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from kb_build.flow.types import Resolution
    from kb_build.records import Symbol
    from kb_check.script import Script

_LINKS_NEW = "bpy.types.NodeLinks.new"
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
        elif len(sockets) == 1 and node in _linked(script):
            yield from _link_to_hidden(script, sockets[0], node.value.value, node)


@once_per_script
def _linked(script: Script) -> frozenset[ast.AST]:
    """The sockets that are linked by index."""
    return frozenset(
        part
        for node in script.all(ast.Call)
        if callee_path(script, node) == _LINKS_NEW
        for part in (*node.args, *(keyword.value for keyword in node.keywords))
        if isinstance(part, ast.Subscript)
        and isinstance(part.slice, ast.Constant)
        and isinstance(part.slice.value, int)
    )


def _link_to_hidden(
    script: Script, socket: Symbol, owner: ast.expr, node: ast.Subscript
) -> Iterator[Finding]:
    """A link to a socket that no setting of its node shows as the script leaves them."""
    if not socket.modes or not isinstance(owner, ast.Name) or not is_new(script, owner):
        return
    names = {mode.partition("=")[0] for mode in socket.modes}
    if len(names) > 1 and not (_deciding(script, [socket]) - names).isdisjoint(named_words(script)):
        return
    settings = {name: _setting(script, owner, f"{socket.owner}.{name}", node) for name in names}
    if any(value is None or _is_shown(socket, {name: value}) for name, value in settings.items()):
        return
    known = {name: value for name, value in settings.items() if value is not None}
    side = socket.path[len(socket.owner) + 1 :].partition("[")[0]
    alike = [
        subscript
        for other in script.api.sockets(socket.owner, side)
        if other.label == socket.label
        and other.path != socket.path
        and other.modes
        and _is_shown(other, known)
        for subscript in other.subscripts[-1:]
    ]
    wanted = f" `{alike[0]}` is the one to link." if len(alike) == 1 else ""
    so = " and ".join(f"`{name}` is {value!r}" for name, value in sorted(known.items()))
    yield Finding(
        RULE.id, "warning", script.span(node),
        f"`{script.text(script.span(node))}`, {socket.identifier!r} of the node, is hidden while {so}: a link to it "
        f"has no effect.{wanted}",
        socket.path,
    )  # fmt: skip


def _is_shown(socket: Symbol, settings: Mapping[str, str]) -> bool:
    """Whether one of some settings shows a socket."""
    modes = (mode.partition("=") for mode in socket.modes)
    return any(settings.get(name) in values.split("|") for name, _, values in modes)


def _setting(script: Script, owner: ast.Name, path: str, before: ast.expr) -> str | None:
    """What a setting of a new node surely is where the script comes to a place; None where that is not known."""
    name, symbol = path.rpartition(".")[2], script.api.symbols.symbol(path)
    mentions = [node for node in script.all(ast.Attribute) if node.attr == name]
    set_by = {
        target: node
        for node in script.all(ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Attribute) and isinstance(target.value, ast.Name) and len(node.targets) == 1
    }
    made = bindings(script).get(owner.id, [])
    told_elsewhere = name in words_of(script.all(ast.keyword, ast.Constant))
    if symbol is None or len(made) != 1 or told_elsewhere or not set_by.keys() >= set(mentions):
        return None
    mine = [node for target, node in set_by.items() if target in mentions and _name(target) == owner.id]
    others = [target for target in mentions if _name(target) != owner.id]
    if len(mine) > 1 or not all(is_new(script, target.value) for target in others):
        return None
    if not mine:
        usual = usual_default(symbol)
        return usual if isinstance(usual, str) else None
    making = next((node for node in script.all(ast.Assign) if node.value is made[0]), None)
    body, value = places(script)[mine[0]][0], mine[0].value
    is_sure = making is not None and places(script)[making][0] is body and mine[0].lineno < before.lineno
    given = value.value if isinstance(value, ast.Constant) and is_sure else None
    return given if isinstance(given, str) else None


def _name(target: ast.Attribute) -> str:
    return target.value.id if isinstance(target.value, ast.Name) else ""


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
