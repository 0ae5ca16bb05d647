"""A node by a name that none has: in a tree that was cleared, or in that of a new material, world or light.

```python
nodes.clear()
shader = nodes["Principled BSDF"]  # reported: nodes.new("ShaderNodeBsdfPrincipled")
material = bpy.data.materials.new("Clay")
material.node_tree.nodes["Diffuse BSDF"]  # reported: it has "Principled BSDF" and "Material Output"
```

A new node is called as its kind is in menus. Not reported: scripts that give nodes names, or make some of a kind that
is not written out, between; that compute names or import modules which may change scenes; and what stands in a ``try``.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Instance
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import callee_path, member_path
from kb_check.calls.sites import calls, calls_by_node
from kb_check.findings import Finding
from kb_check.modes.edit_bones import bound_in, names_in, surely_run
from kb_check.modes.keeping import is_harmless, run_in
from kb_check.rule import Rule
from kb_check.running.out_of_sight import computes_names, knows_all
from kb_check.running.raised import LACKS_KEY
from kb_check.running.tried import is_tried
from kb_check.scene.made_here import has_plain_operators_only, is_new
from kb_check.script import once_per_script
from kb_check.syntax.bindings import alias
from kb_check.syntax.bodies import bodies
from kb_check.syntax.literals import times_bound
from kb_check.syntax.words import texts_but_keys

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kb_check.script import Script

_NEW, _CLEAR, _REMOVE = f"{T}Nodes.new", f"{T}Nodes.clear", f"{T}Nodes.remove"
_NODES = f"{T}NodeTree.nodes"
# The nodes that the tree of a new one has, since there is the Principled BSDF.
_AT_FIRST = {
    f"{T}Material": ("Principled BSDF", "Material Output"),
    f"{T}World": ("Background", "World Output"),
    f"{T}Light": ("Emission", "Light Output"),
}
_SINCE = 2, 80
_DEEPEST = 4  # names that stand for members of each other
_MOST_CLEARED = 8  # trees that are followed at once: each statement is looked at for all of them


def _check(script: Script) -> Iterator[Finding]:
    if computes_names(script):
        return
    for body in bodies(script):
        yield from _after_clearing(script, body)
    if script.version >= _SINCE and knows_all(script) and has_plain_operators_only(script):
        yield from _of_new(script)


def _after_clearing(script: Script, body: list[ast.stmt]) -> Iterator[Finding]:
    """What is asked for behind ``nodes.clear()``."""
    # Nodes as they are written → the names that this takes, and those of the nodes that were made since.
    cleared: dict[str, tuple[set[str], set[str]]] = {}
    for statement in body:
        if cleared:
            yield from _missing(script, statement, {text: made for text, (_, made) in cleared.items()})
            cleared = _kept(script, statement, cleared)
        if nodes := _cleared(script, statement):
            cleared[_text(script, nodes)] = names_in(nodes), set()
            if len(cleared) > _MOST_CLEARED:
                del cleared[next(iter(cleared))]


def _cleared(script: Script, statement: ast.stmt) -> ast.expr | None:
    """The nodes that a statement removes, all at once or one by one."""
    match statement:
        case ast.Expr(value=ast.Call(func=ast.Attribute(value=nodes)) as call) if (
            callee_path(script, call) == _CLEAR
        ):
            return nodes
        case ast.For(
            target=ast.Name(id=node),
            iter=ast.Call(func=ast.Name(id="list" | "tuple" | "reversed"), args=[several])
            | ast.Subscript(value=several, slice=ast.Slice(lower=None, upper=None))
            | several,
            body=[
                ast.Expr(value=ast.Call(func=ast.Attribute(value=nodes), args=[ast.Name(id=removed)]) as call)
            ],
        ) if removed == node and callee_path(script, call) == _REMOVE:
            return nodes if _text(script, several) == _text(script, nodes) else None
        case _:
            return None


def _text(script: Script, node: ast.expr, depth: int = _DEEPEST) -> str:
    """An expression as it is written, with the members that names stand for in the place of those."""
    match node:
        case ast.Name(id=name):
            meant = alias(script, node)
            is_kept = depth and meant is not node and times_bound(script)[name] == 1
            return _text(script, meant, depth - 1) if is_kept and _stays(script, meant) else name
        case ast.Attribute(value=owner, attr=name):
            return f"{_text(script, owner, depth)}.{name}"
        case _:
            return ast.unparse(node)


def _stays(script: Script, node: ast.expr) -> bool:
    """Whether a member is that of one thing in the whole script."""
    return all(times_bound(script)[name] <= 1 for name in names_in(node))


def _missing(script: Script, statement: ast.stmt, cleared: Mapping[str, set[str]]) -> Iterator[Finding]:
    """What a statement asks for of nodes that were cleared; these → the names of those that were made since."""
    for node in surely_run(statement):
        match node:
            case ast.Subscript(value=nodes, slice=ast.Constant(value=str(key)), ctx=ast.Load()):
                made = cleared.get(_text(script, nodes))
                if made is not None and not _is_named(key, made) and not is_tried(script, node, LACKS_KEY):
                    told = f"There is no node {key!r} behind `{ast.unparse(nodes)}.clear()`: `nodes.new` makes one."
                    yield Finding(RULE.id, "error", script.span(node), told, _NODES)
            case _:
                pass


def _kept(
    script: Script, statement: ast.stmt, cleared: Mapping[str, tuple[set[str], set[str]]]
) -> dict[str, tuple[set[str], set[str]]]:
    """What is known behind a statement of the nodes that were cleared before it."""
    made = _made(script, statement)
    if made is None:
        return {}
    bound = set(bound_in(statement))
    return {
        text: (written, names | made)
        for text, (written, names) in cleared.items()
        if bound.isdisjoint(written)
    }


def _made(script: Script, statement: ast.stmt) -> set[str] | None:
    """The names of the nodes that a statement makes; None where that is not known, or it gives names."""
    found: set[str] = set()
    for node in run_in(statement):
        if isinstance(node, ast.Attribute) and node.attr == "name" and not isinstance(node.ctx, ast.Load):
            return None
        if isinstance(node, ast.Call):
            name = _name_of_new(script, node) if callee_path(script, node) == _NEW else ""
            if name is None or (not name and not is_harmless(script, node)):
                return None
            found.add(name)
    return found - {""}


def _name_of_new(script: Script, call: ast.Call) -> str | None:
    """What a new node is called at first; None where its kind is not known."""
    site = calls_by_node(script).get(call)
    given = site.argument("type") if site else None
    if not isinstance(given, ast.Constant):
        return None
    symbol = script.api.symbols.symbol(f"{T}{given.value}")
    return symbol.label or None if symbol else None


def _is_named(key: str, names: Iterable[str]) -> bool:
    """Whether a node may be called so: a name that is taken gets a number behind it."""
    return any(key.startswith(name) for name in names)


def _of_new(script: Script) -> Iterator[Finding]:
    for node in script.all(ast.Subscript):
        match node:
            case ast.Subscript(value=nodes, slice=ast.Constant(value=str(key)), ctx=ast.Load()):
                names = _at_first(script, nodes)
            case _:
                continue
        made = _all_made(script) if names else None
        if made is None or _is_named(key, (*names, *made)) or key in texts_but_keys(script):
            continue
        if not is_tried(script, node, LACKS_KEY):
            told = f"A new one has no node {key!r}, but {' and '.join(map(repr, names))}."
            yield Finding(RULE.id, "error", script.span(node), told, _NODES)


def _at_first(script: Script, nodes: ast.expr) -> tuple[str, ...]:
    """The nodes that were there at first, where they surely are those of something new; empty for others."""
    match alias(script, nodes):
        case ast.Attribute(attr="nodes", value=tree) as held if member_path(script, held) == _NODES:
            pass
        case _:
            return ()
    match alias(script, tree):
        case ast.Attribute(attr="node_tree", value=owner) if is_new(script, owner):
            kind = script.type_of(owner)
            if not isinstance(kind, Instance) or not kind.sure:
                return ()
            kinds = (names for cls, names in _AT_FIRST.items() if script.api.descends(kind.cls, cls))
            return next(kinds, ())
        case _:
            return ()


@once_per_script
def _all_made(script: Script) -> frozenset[str] | None:
    """The names of all nodes that the script makes; None where that is not known, or it gives names to anything."""
    if any(node.attr == "name" and not isinstance(node.ctx, ast.Load) for node in script.all(ast.Attribute)):
        return None
    names = [_name_of_new(script, call.node) for call in calls(script) if call.callee.symbol.path == _NEW]
    return None if None in names else frozenset(name for name in names if name)


RULE = Rule("missing-node", "error", "A node by a name that none has", _check)
