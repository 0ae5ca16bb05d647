"""A property that the script declares itself, used for what it is not.

```python
class Settings(bpy.types.PropertyGroup):
    mode: bpy.props.EnumProperty(items=[("FAST", "Fast", ""), ("GOOD", "Good", "")])
    parts: bpy.props.CollectionProperty(type=Part)


context.scene.settings.mode = "BEST"  # reported: one of the items
context.scene.settings.parts = []  # reported: read-only
context.scene.settings.modes  # reported: mode
layout.prop(context.scene.settings, "modes")  # reported
context.scene.settings.last = 3  # reported: lost as soon as the settings are read again
bpy.ops.object.grow(cuont=3)  # reported: a keyword that the script's operator lacks
layout.operator("object.grow").cuont = 3  # reported
```

Not reported: classes that derive from what is not seen, or that are not surely registered; enumerations whose items are
computed; what a script sets, or asks for, by a name in quotes.
"""

from __future__ import annotations

import ast
from difflib import get_close_matches
from typing import TYPE_CHECKING

from kb_build.flow.state.core import ANY
from kb_build.flow.values.types import UNKNOWN, Instance, LocalInstance, literal_texts, members
from kb_check.findings import Finding, Fix
from kb_check.names.known import listed
from kb_check.registered.properties import LAYOUT, own_properties, uses
from kb_check.rule import Rule
from kb_check.running.tried import is_tried
from kb_check.script import once_per_script
from kb_check.syntax.words import attributes

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.findings import Severity
    from kb_check.registered.declarations import OwnProperty
    from kb_check.registered.properties import OwnProperties, Use
    from kb_check.script import Script

_GROUP = "bpy.types.PropertyGroup"
_NEAR = 0.75  # of difflib
# What RNA does not tell of every class that has it: preferences are drawn with a layout.
_EVERYWHERE = frozenset({"bl_rna", "rna_type", "id_data", "name", "layout"})
# What is done to a property that nothing is assigned to, by its kind.
_INSTEAD = {"collection": "`add`, `remove` and `clear` change it", "pointer": "set its own properties"}
_COMPUTED = "it has `get`, and no `set`"


def _check(script: Script) -> Iterator[Finding]:
    yield from _lost_operators(script)
    compared = _compared(script)
    for use in uses(script):
        if is_tried(script, use.node.value if isinstance(use.node, ast.keyword) else use.node):
            continue
        if use.found is None:
            if use.of and _lacks(script, use, use.of):
                yield from _absent(script, use, use.of)
        elif use.found.is_fixed and use.value is not None and not use.is_called:
            told = f"`{use.found.path}` is read-only: {_INSTEAD.get(use.found.kind, _COMPUTED)}."
            yield Finding(RULE.id, "error", script.name_span(use.node), told, use.found.path)
        elif use.found.items is not None:
            if use.value is not None:
                yield from _values(script, use.found, use.value, use.found.items)
            elif (other := compared.get(use.node)) is not None:
                yield from _values(script, use.found, other, use.found.items, is_compared=True)


def _lost_operators(script: Script) -> Iterator[Finding]:
    """Operators that are named below a module which the script's own operators alone make."""
    own = own_properties(script).operators
    modules = {path.rpartition(".")[0] for path in own}
    modules = {path for path in modules if script.api.symbols.symbol(path) is None}
    for node in script.all(ast.Attribute) if modules and ANY not in script.analysis.own_operators else ():
        owner = ast.unparse(node.value) if isinstance(node.value, ast.Attribute) else ""
        if owner in modules and not script.package.has((owner,), node.attr) and not is_tried(script, node):
            made = [path for path in own if path.startswith(f"{owner}.")]
            told = f"`{owner}` has no `{node.attr}`: this script makes {listed(made)}."
            yield Finding(RULE.id, "error", script.name_span(node), told, f"{owner}.{node.attr}")


def _lacks(script: Script, use: Use, of: OwnProperties) -> bool:
    """Whether nothing gives an attribute, or a keyword, to what the script declares."""
    is_by_key = use.name.startswith("[")  # of a custom property
    if not of.is_whole or is_by_key or use.name.startswith("__") or use.name in _EVERYWHERE:
        return False
    if isinstance(use.node, ast.keyword):
        return True
    if script.api.member(of.own.path, use.name) or use.name in _asked(script):
        return False
    return use.is_called or use.is_stored or not _may_be_set(script, use.name, of)


def _may_be_set(script: Script, name: str, of: OwnProperties) -> bool:
    """Whether the script sets an attribute of that name on what may be an instance of the class."""
    for node in attributes(script).get(name, ()):
        if not isinstance(node.ctx, ast.Load):
            for kind in members(script.type_of(node.value) or UNKNOWN):
                is_own = (
                    isinstance(kind, LocalInstance) and script.analysis.classes[kind.number] in of.own.family
                )
                if is_own or not isinstance(kind, (LocalInstance, Instance)):
                    return True
    return False


def _absent(script: Script, use: Use, of: OwnProperties) -> Iterator[Finding]:
    near = get_close_matches(use.name, of.properties, 1, _NEAR)
    names = [name for name, one in of.properties.items() if one.kind]
    told = f"Closest: `{near[0]}`." if near else f"It declares {listed(names)}." if names else ""
    edit = script.renamed(use.node, near[0]) if near else None
    fix = Fix(f"Write {near[0]}", (edit,)) if edit else None
    severity: Severity = "error"
    if use.is_called:
        what = f"`{of.operator}`, which this script makes, takes no `{use.name}`."
    elif not use.is_stored:
        what = f"`{of.own.node.name}` has no `{use.name}`."
        if script.api.member(LAYOUT, use.name) and script.api.member(of.own.path, "layout"):
            told = f"The layout has it: `layout.{use.name}`."
    elif of.own.path == _GROUP and not _is_read_beside(script, use.node):
        what = f"`{of.own.node.name}` declares no `{use.name}`: what is set is lost when it is read again."
        severity = "warning"
    else:
        return
    message = f"{what} {told}".rstrip()
    yield Finding(RULE.id, severity, script.name_span(use.node), message, of.own.path, (), fix)


def _is_read_beside(script: Script, node: ast.AST) -> bool:
    """Whether the very thing that an attribute is set on is asked for it, as long as its name holds it."""
    if not isinstance(node, ast.Attribute) or not isinstance(node.value, ast.Name):
        return False
    return any(
        isinstance(other.ctx, ast.Load)
        and isinstance(other.value, ast.Name)
        and other.value.id == node.value.id
        for other in attributes(script).get(node.attr, ())
    )


def _values(
    script: Script, found: OwnProperty, node: ast.expr, items: tuple[str, ...], *, is_compared: bool = False
) -> Iterator[Finding]:
    parts = node.elts if isinstance(node, ast.Set) else [node]
    for part in parts:
        kind = script.type_of(part)
        texts = [*literal_texts(kind)] if kind is not None else []
        if not texts or any(text in items for text in texts) or (is_compared and "" in texts):
            continue  # an empty text is what Blender gives for what it does not know
        ends = " The comparison never matches it." if is_compared else ""
        near = get_close_matches(texts[0], items, 1, _NEAR)
        edit = script.renamed(part, near[0]) if near and isinstance(part, ast.Constant) else None
        yield Finding(
            RULE.id, "warning" if is_compared else "error", script.span(part),
            f"{texts[0]!r} is none of the items of `{found.path}`: it takes {listed(items)}.{ends}", found.path, (),
            Fix(f"Write {near[0]}", (edit,)) if near and edit else None,
        )  # fmt: skip


@once_per_script
def _compared(script: Script) -> dict[ast.AST, ast.expr]:
    """What is compared with a text, or looked up among several → that."""
    found: dict[ast.AST, ast.expr] = {}
    for node in script.all(ast.Compare):
        match node:
            case (
                ast.Compare(left=part, ops=[ast.Eq() | ast.NotEq()], comparators=[ast.Constant() as other])
                | ast.Compare(left=ast.Constant() as other, ops=[ast.Eq() | ast.NotEq()], comparators=[part])
            ):
                found[part] = other
            case ast.Compare(
                ops=[ast.In() | ast.NotIn()], comparators=[ast.Set() | ast.Tuple() | ast.List() as several]
            ):
                found[node.left] = ast.Set(several.elts)
            case _:
                pass
    return found


@once_per_script
def _asked(script: Script) -> frozenset[str]:
    """The names for which the script asks by a text whether they are there."""
    found: list[ast.expr] = []
    for node in script.all(ast.Call, ast.Compare):
        match node:
            case (
                ast.Call(func=ast.Name(id="hasattr" | "getattr"), args=[_, name, *_])
                | ast.Compare(left=name, ops=[ast.In() | ast.NotIn()])
            ):
                found.append(name)
            case _:
                pass
    return frozenset(
        name.value for name in found if isinstance(name, ast.Constant) and isinstance(name.value, str)
    )


RULE = Rule("own-property", "error", "A property that the script declares, used for what it is not", _check)
