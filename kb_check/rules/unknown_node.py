"""A node or a socket type that does not exist, given by its name, or a node that its tree does not take.

Looked at where a literal, or a name that surely holds one, is given to ``nodes.new`` or to ``interface.new_socket``. A
name that only an add-on's node could have is left alone, as is a former one that this Blender still takes: reported is
what another Blender had, and what begins as Blender's own nodes do.

```python
nodes.new("ShaderNodeTexMusgrave")  # reported since 4.1: ShaderNodeTexNoise
nodes.new("ShaderNodeTexNoise")
for kind in ("ShaderNodeMix", "ShaderNodeTexMusgrave"):
    nodes.new(kind)  # reported: the second
nodes.new("Noise Texture")  # reported: that is its label
material.node_tree.nodes.new("BSDF_PRINCIPLED")  # reported: the words of ShaderNodeBsdfPrincipled
tree = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
tree.nodes.new("ShaderNodeBsdfPrincipled")  # reported: geometry node trees take none
tree.nodes.new("GeometryNode")  # reported: the class that the others derive from
tree.interface.new_socket("Height", in_out="INPUT", socket_type="FLOAT")  # reported: NodeSocketFloat
```
"""

from __future__ import annotations

import ast
import re
from itertools import chain
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import CLASS_NAMES
from kb_build.flow.values.types import Instance
from kb_build.index.analysis import key, words
from kb_build.symbols.api_names import NODE
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flags import NODE_FAMILIES
from kb_build.symbols.paths import last_name
from kb_check.calls.sites import CallSite, calls_not_ready_for
from kb_check.findings import Finding, Fix
from kb_check.modes.keeping import own_names
from kb_check.nodes.trees import tree_added_to
from kb_check.rule import Rule
from kb_check.running.raised import refusing_class
from kb_check.script import once_for_each, once_per_script
from kb_serve.recognise.named.node_names import same_in_tree, tree_of_family

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_check.names.known import Lacking
    from kb_check.script import Script

_SOCKET = "NodeSocket"
_NEW = f"{T}Nodes.new"
_LABEL = "{name} is what menus call {names}: `nodes.new` takes that."
_ALIKE = "No node is called {name}: `nodes.new` takes {names}."
_BLENDERS_OWN = re.compile(rf"({'|'.join(NODE_FAMILIES)}|NodeSocket)[A-Z]\w+")


def _check(script: Script) -> Iterator[Finding]:
    for call in _asking(script):
        wanted = CLASS_NAMES[call.callee.symbol.path]
        for parameter, node in call.arguments():
            if (
                parameter.name != wanted
                or not isinstance(node, ast.Constant)
                or not isinstance(node.value, str)
            ):
                continue
            name = node.value
            if name in script.package.identifiers:
                continue
            is_label = wanted == "type" and not script.api.descends(f"{T}{name}", NODE)
            if script.api.is_class(f"{T}{name}") and not (is_label and _labelled(script, call, name)):
                yield from _refused(script, call, node, name)
                continue
            if _is_taken(script, name):
                continue
            if (
                wanted == "type"
                and name not in own_names(script)
                and (called := _labelled(script, call, name))
            ):
                yield _named_finding(script, node, called, _LABEL, sure=True)
                continue
            if wanted != "type" and (cls := _socket_class(script, name)):
                yield _socket_finding(script, call, node, cls)
                continue
            if wanted == "type" and (alike := _of_the_same_words(script, call, name)):
                yield _named_finding(script, node, alike, _ALIKE, sure=False)
                continue
            yield from _unknown(script, node, name)
    yield from _of_guessed(script)
    for row in script.missing("class"):
        if not _is_taken(script, row.value):
            yield from _unknown(script, row.node, row.value)


def _of_guessed(script: Script) -> Iterator[Finding]:
    """Former nodes, given to the ``new`` of what is only likely a tree's nodes: a parameter of that name."""
    for call in script.all(ast.Call):
        match call:
            case ast.Call(func=ast.Attribute(value=receiver, attr="new") as function):
                kind = script.type_of(receiver)
            case _:
                continue
        if not isinstance(kind, Instance) or kind.sure or kind.cls != f"{T}Nodes":
            continue
        row = script.analysis.resolutions.get(function)
        given = [*call.args[:1], *(word.value for word in call.keywords if word.arg == "type")]
        for node in given if row and not row.is_ready_for(*refusing_class(_NEW)) else ():
            if isinstance(node, ast.Constant) and _is_former_node(script, node.value):
                yield from _unknown(script, node, str(node.value))


def _is_former_node(script: Script, name: object) -> bool:
    """Whether something is the name of a node that another Blender has, and that nothing here is called by."""
    if not isinstance(name, str) or not script.names.was("bpy.types", name):
        return False
    return not _is_taken(script, name) and not script.api.is_class(f"{T}{name}")


def _is_taken(script: Script, name: str) -> bool:
    """Whether a name is of a class of the script's or its package's, or a former one that this Blender still takes."""
    is_own = name in script.package.identifiers or script.package.has(("bpy.types",), name)
    return is_own or bool(script.names.still_works(f"{T}{name}"))


def _socket_class(script: Script, name: str) -> str:
    """The class of sockets that a type stands for: ``NodeSocketFloat`` of FLOAT, as zones call it; or empty."""
    cls = f"{_SOCKET}{name.title()}"
    if not name.isidentifier() or name.startswith(_SOCKET):
        return ""
    return last_name(
        cls if script.api.is_class(f"{T}{cls}") else script.api.literals.class_of_value(f"{T}{_SOCKET}", name)
    )


def _socket_finding(script: Script, call: CallSite, node: ast.Constant, cls: str) -> Finding:
    edit = script.renamed(node, cls)
    path = call.callee.symbol.path
    return Finding(
        RULE.id, "error", script.span(node),
        f"`{path}` takes the name of a socket's class, {cls!r}, not {node.value!r}.", path,
        (f"{T}{cls}",), Fix(f"Write {cls}", (edit,)) if edit else None,
    )  # fmt: skip


def _asking(script: Script) -> Iterator[CallSite]:
    """The calls that name a class."""
    for path in CLASS_NAMES:
        for call in calls_not_ready_for(script, refusing_class(path)):
            if call.callee.symbol.path == path:
                yield call


def _unknown(script: Script, node: ast.AST, name: str) -> Iterator[Finding]:
    """A name that another Blender had, or that is like those of Blender's own nodes."""
    if script.names.was("bpy.types", name) or _BLENDERS_OWN.fullmatch(name):
        lacking = _lacking(script, name)
        yield Finding(
            RULE.id, "error", script.span(node), lacking.message, lacking.symbol,
            tuple(path for path in lacking.instead if script.api.is_class(path)),
        )  # fmt: skip


@once_for_each
def _lacking(script: Script, name: str) -> Lacking:
    return script.names.member("bpy.types", name)


def _labelled(script: Script, call: CallSite, name: str) -> list[Symbol]:
    """The nodes that are called so in Blender's menus: those of the tree, where it is known."""
    tree = tree_added_to(script, call)
    found = _by_label(script).get(name.casefold(), [])
    return [symbol for symbol in found if not tree or tree in symbol.trees]


@once_per_script
def _by_label(script: Script) -> dict[str, list[Symbol]]:
    found: dict[str, list[Symbol]] = {}
    for cls in script.api.descendants(NODE):
        symbol = script.api.symbols.symbol(cls)
        if symbol is not None and symbol.trees and symbol.label:
            found.setdefault(symbol.label.casefold(), []).append(symbol)
    return found


def _of_the_same_words(script: Script, call: CallSite, name: str) -> list[Symbol]:
    """The nodes of the tree whose name, with or without its family, or whose label has the words of a name that begins
    as none of Blender's own do: of ``BSDF_PRINCIPLED``, ``NodeEmission``, ``VALTORGB``. In a tree that is not known an
    add-on's node may be called so.
    """
    tree = tree_added_to(script, call)
    if not tree or _BLENDERS_OWN.fullmatch(name) or name in own_names(script):
        return []
    return [symbol for symbol in _by_words(script).get(_words_of(name), []) if tree in symbol.trees]


@once_per_script
def _by_words(script: Script) -> dict[frozenset[str], list[Symbol]]:
    found: dict[frozenset[str], list[Symbol]] = {}
    for symbol in chain.from_iterable(_by_label(script).values()):
        name = last_name(symbol.path)
        family = next((one for one in NODE_FAMILIES if name.startswith(one)), "")
        behind = name.removeprefix(family)
        spoken = {_words_of(called) for called in (name, behind, symbol.label)}
        for called in {*spoken, frozenset({key(behind)}), frozenset({key(symbol.label)})}:
            found.setdefault(called, []).append(symbol)
    return found


def _words_of(name: str) -> frozenset[str]:
    return frozenset(words(name.removeprefix(T))) - {"node"}


def _named_finding(
    script: Script, node: ast.Constant, meant: list[Symbol], told: str, *, sure: bool
) -> Finding:
    """A name for which others are to be written: ``told`` says so, with ``{name}`` and ``{names}`` for both."""
    names = [last_name(symbol.path) for symbol in meant]
    edit = script.renamed(node, names[0]) if len(names) == 1 else None
    fix = Fix(f"Write {names[0]}", (edit,), sure=sure) if edit else None
    paths = tuple(symbol.path for symbol in meant)
    message = told.format(name=repr(node.value), names=" or ".join(f"`{name}`" for name in names))
    return Finding(RULE.id, "error", script.span(node), message, paths[0], paths, fix)


def _refused(script: Script, call: CallSite, node: ast.expr, name: str) -> Iterator[Finding]:
    """A class of nodes that no tree takes, or not the one that it is given to."""
    symbol = script.api.symbols.symbol(f"{T}{name}")
    if symbol is None or not script.api.descends(symbol.path, NODE):
        return
    tree = tree_added_to(script, call)
    if not symbol.trees:
        said = f"`{symbol.path}` is a class of nodes that no tree takes: `nodes.new` refuses it"
    elif tree and tree not in symbol.trees:
        said = f"`{symbol.path}` is a node of {' and '.join(symbol.trees)}: a `{tree}` refuses it"
    else:
        return
    others = same_in_tree(name, tree or tree_of_family(name), script.api.symbols.symbol)
    instead = f" Use {' or '.join(f'`{other}`' for other in others)}." if others else ""
    yield Finding(RULE.id, "error", script.span(node), f"{said}.{instead}", symbol.path, others)


RULE = Rule("unknown-node", "error", "A node or socket type that does not exist, or not in that tree", _check)
