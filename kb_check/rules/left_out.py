"""An object that a pointer does not take, or the name of a part that the object does not have by then.

Blender leaves most of them out without an error.

```python
boolean = ob.modifiers.new("Cut", "BOOLEAN")
boolean.object = bpy.data.objects.new("Cutter", None)  # reported: stays None, as it takes meshes alone
curve = ob.modifiers.new("Curve", "CURVE")
curve.object = camera_object  # reported
ob.parent = ob  # reported: refused with an error
group.node_tree = tree  # reported where the node is in that tree itself
```

A text that names a vertex group or a UV map stays empty where there is none that is called so:

```python
cloth = ob.modifiers.new("Cloth", "CLOTH")
cloth.settings.vertex_group_mass = "Pin"  # reported: the group is made later, and the cloth is not pinned
pin = ob.vertex_groups.new(name="Pin")
```

Not reported: objects of which the script does not tell what data they have, and parts that the script may not have made
itself.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, NamedTuple

from kb_build.flow.values.types import Instance
from kb_build.symbols.accepted import ITSELF, TAKES, accepted, accepted_text, noun
from kb_build.symbols.api_names import OBJECT
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import NAMES_PART
from kb_build.symbols.object_data import OBJECT_DATA, data_class
from kb_check.calls.resolved import callee_path
from kb_check.findings import Finding
from kb_check.rule import Rule
from kb_check.running.out_of_sight import knows_all
from kb_check.running.raised import REFUSES
from kb_check.running.tried import is_tried
from kb_check.scene.made_here import OBJECTS_NEW, has_new_data, has_plain_operators_only
from kb_check.script import once_per_script
from kb_check.syntax.bindings import once_bound
from kb_check.syntax.bodies import places
from kb_check.syntax.words import named_words
from kb_check.values.given import assigned

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_check.script import Script

_EMPTY = "EMPTY"
_GROUP = "vertex group"
_MAKERS = frozenset({f"{T}VertexGroups.new", f"{T}UVLoopLayers.new"})
_MAKING_GROUPS = frozenset({"vertex_groups", "from_object", "bmesh"})
_HOLDERS = frozenset({"constraints", "grease_pencil_modifiers", "modifiers", "nodes", "shader_effects"})


class _Stored(NamedTuple):
    """What a statement assigns to a property that does not take everything."""

    symbol: Symbol
    target: ast.Attribute
    value: ast.expr
    statement: ast.stmt


def _check(script: Script) -> Iterator[Finding]:
    for one in _stored(script):
        if told := _of_pointer(script, one) or _of_name(script, one):
            yield Finding(RULE.id, "error", script.span(one.value), told, one.symbol.path)


@once_per_script
def _stored(script: Script) -> list[_Stored]:
    found: list[_Stored] = []
    for row in script.resolutions("store"):
        symbol = script.api.symbols.symbol(row.symbols[0]) if len(row.symbols) == 1 else None
        is_certain = row.sure and not row.missing and not row.possible and not row.is_ready_for(*REFUSES)
        if not symbol or not is_certain or not isinstance(row.node, ast.Attribute) or row.statement is None:
            continue
        value = assigned(row.statement, row.node)
        is_asked = bool(accepted(symbol) or symbol.flagged(NAMES_PART))
        if value is not None and is_asked and not is_tried(script, row.node):
            found.append(_Stored(symbol, row.node, value, row.statement))
    return found


def _of_pointer(script: Script, one: _Stored) -> str:
    """Why a pointer surely does not take an object or a tree; empty where it may."""
    symbol, kinds = one.symbol, accepted(one.symbol)
    if kinds.get(ITSELF, TAKES) != TAKES and _is_itself(script, one.target.value, one.value):
        return f"`{symbol.path}` does not take the {noun(symbol)} that it belongs to."
    given = _types(script, one.value) if kinds else []
    if given and all(kinds.get(kind, TAKES) != TAKES for kind in given):
        return f"`{symbol.path}` {accepted_text(symbol)}. This one's type is {' or '.join(given)}."
    return ""


def _of_name(script: Script, one: _Stored) -> str:
    """Why there surely is no part of that name yet; empty where there may be."""
    name = one.value.value if isinstance(one.value, ast.Constant) else None
    parts = one.symbol.flagged(NAMES_PART)
    if not parts or not isinstance(name, str) or not name:
        return ""
    stored = {other.value for other in _stored(script)}
    named = [node for node in script.all(ast.Constant) if node.value == name and node not in stored]
    if named:
        is_made = any(_makes(script, call, named) for call in script.all(ast.Call))
        is_late = is_made and all(_is_behind(script, node, one.statement) for node in named)
        instead = "Make it before." if is_late else ""
    else:
        makes_none = _MAKING_GROUPS.isdisjoint(named_words(script)) and has_plain_operators_only(script)
        makes_none = makes_none and parts == (_GROUP,)  # a mesh may come with a UV map
        holder = _holder(script, one.target.value)
        is_new_one = holder is not None and has_new_data(script, holder) and knows_all(script)
        instead = f"`obj.vertex_groups.new(name={name!r})` makes it." if makes_none and is_new_one else ""
    if not instead:
        return ""
    return (
        f"There is no {parts[0]} {name!r} yet: `{one.symbol.path}` stays empty, without an error. {instead}"
    )


def _makes(script: Script, call: ast.Call, names: list[ast.Constant]) -> bool:
    given = [*call.args, *(keyword.value for keyword in call.keywords)]
    return callee_path(script, call) in _MAKERS and any(node in names for node in given)


def _is_behind(script: Script, node: ast.Constant, statement: ast.stmt) -> bool:
    """Whether a text stands behind a statement in the same body, which is in no loop."""
    if statement not in places(script):
        return False
    body, _ = places(script)[statement]
    start, end = statement.end_lineno or 0, body[-1].end_lineno or 0
    in_loop = any(
        loop.lineno <= statement.lineno <= (loop.end_lineno or 0) for loop in script.all(ast.For, ast.While)
    )
    return start < node.lineno <= end and not in_loop


def _types(script: Script, node: ast.expr) -> list[str]:
    """The types that an object may have, by its data; none where that is not sure."""
    kind = script.type_of(node)
    if not isinstance(kind, Instance) or kind.cls != OBJECT or not kind.sure:
        return []
    made = once_bound(script, node)
    if isinstance(made, ast.Call) and callee_path(script, made) == OBJECTS_NEW:
        match [*made.args[1:2], *(one.value for one in made.keywords if one.arg == "object_data")]:
            case [ast.Constant(value=None)]:
                return [_EMPTY]
            case _:
                pass
    data = kind.trait("data")
    if not isinstance(data, Instance) or not data.sure:
        return []
    classes = {each: T + data_class(each, lambda name: script.api.is_class(T + name)) for each in OBJECT_DATA}
    # A value that is declared as a Curve may be a TextCurve; one that is a SpotLight is a Light.
    narrower = [each for each, cls in classes.items() if script.api.descends(cls, data.cls)]
    return narrower or [each for each, cls in classes.items() if script.api.descends(data.cls, cls)][-1:]


def _is_itself(script: Script, owner: ast.expr, value: ast.expr) -> bool:
    """Whether a value is what the owner of a pointer is, or belongs to: a modifier to an object, a node to a tree."""
    if not isinstance(value, ast.Name) or once_bound(script, value) is value:
        return False
    holder = _holder(script, owner)
    return value.id in {ast.unparse(one) for one in (owner, holder) if one is not None}


def _holder(script: Script, node: ast.expr) -> ast.expr | None:
    """What a modifier, a constraint or a node was made in, of what belongs to such a one; None where nothing tells."""
    while isinstance(node, ast.Attribute):
        node = node.value
    match once_bound(script, node):
        case ast.Call(func=ast.Attribute(value=ast.Attribute(value=holder, attr=attr), attr="new")):
            return holder if attr in _HOLDERS else None
        case _:
            return None


RULE = Rule("left-out", "error", "A thing or a name that Blender leaves out", _check)
