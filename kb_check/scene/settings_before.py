"""What a script has surely given to a setting when it comes to a statement of the same body.

```python
images.media_type = "VIDEO"
scene.frame_end = 20
images.file_format = "FFMPEG"  # media_type is "VIDEO" here
```
"""

from __future__ import annotations

import ast
from bisect import bisect_left
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_build.symbols.api_names import OPERATORS
from kb_check.calls.resolved import called_operators, callee_path
from kb_check.calls.sites import calls_by_node
from kb_check.scene.active_object import making_operator, reads_active
from kb_check.script import once_for_each
from kb_check.syntax.bindings import bindings
from kb_check.syntax.bodies import places
from kb_check.syntax.words import attributes

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_build.symbols.records import Symbol
    from kb_check.script import Script


_SCENE = "bpy.context.scene"
_OF_SCENES = ("bpy.ops.scene.", "bpy.ops.wm.")  # may lead to another scene
_DEEPEST = 4


@dataclass(frozen=True, slots=True)
class _Body:
    """Places in a body of statements, in order: of what may change anything, and of what is written to.

    ``by_name`` are those of attributes by name, ``by_text`` those of expressions as they are written.
    """

    changing: list[int] = field(default_factory=list[int])
    by_name: defaultdict[str, list[int]] = field(default_factory=lambda: defaultdict[str, list[int]](list))
    by_text: defaultdict[str, list[int]] = field(default_factory=lambda: defaultdict[str, list[int]](list))

    def last_before(self, place: int, name: str, owner: ast.expr) -> int:
        """The last place before one at which a setting of an owner, or the owner, may become another; -1 for none."""
        written = (self.by_text[text] for text in _beginnings(owner) if text in self.by_text)
        found = (self.changing, self.by_name.get(name, ()), *written)
        return max(_last_below(places_of, place) for places_of in found)


def set_before(script: Script, statement: ast.stmt, owner: ast.expr, setting: Symbol) -> ast.expr | None:
    """What is assigned to a setting before a statement, in the same body, with nothing between that may matter."""
    if statement not in places(script):
        return None
    statements, place = places(script)[statement]
    last = _body(script, statements[0]).last_before(place, setting.name, owner)
    match statements[last] if last >= 0 else None:
        case ast.Assign(targets=[ast.Attribute(attr=name) as target], value=value) if name == setting.name:
            return value if _written_out(script, target.value) == _written_out(script, owner) else None
        case ast.Expr(value=ast.Call() as call) if callee_path(script, call).startswith(OPERATORS):
            return _given_to_maker(script, call, owner, setting)
        case _:
            return None


def made_just_before(script: Script, statement: ast.stmt, owner: ast.expr, setting: Symbol) -> str:
    """What has made the owner of a setting before a statement of the same body, with nothing between that may matter.

    That is the ``new`` that a name is bound to, or the operator of whose new object the owner is the data; empty for
    none.
    """
    if statement not in places(script):
        return ""
    statements, place = places(script)[statement]
    body = _body(script, statements[0])
    place = body.last_before(place, setting.name, owner)
    last = statements[place] if place >= 0 else None
    holder = owner.value if isinstance(owner, ast.Attribute) and owner.attr == "data" else None
    match last:
        case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call() as call) if (
            isinstance(owner, ast.Name) and name == owner.id
        ):
            path = callee_path(script, call)
            return path if path.endswith(".new") else ""
        case ast.Assign(targets=[ast.Name(id=name)], value=value) if (
            isinstance(holder, ast.Name) and name == holder.id
        ):
            holder = value
            place = body.last_before(place, setting.name, value)
        case _:
            pass
    if place < 0 or not reads_active(script, holder):
        return ""
    return making_operator(script, statements[place])


def _given_to_maker(script: Script, call: ast.Call, owner: ast.expr, setting: Symbol) -> ast.expr | None:
    """What an operator that makes the active object is given for a setting of what belongs to that."""
    site = calls_by_node(script).get(call)
    if not isinstance(owner, ast.Attribute) or not reads_active(script, owner.value):
        return None
    if site is None or not site.callee.symbol.name.endswith("_add"):
        return None
    items = {item.identifier for item in setting.enum_items}
    for parameter, given in site.arguments():
        own = {item.identifier for item in parameter.enum_items}
        # A few values are called otherwise there.
        if parameter.name == setting.name and len(own & items) > len(own) / 2:
            return given
    return None


@once_for_each
def _body(script: Script, first: ast.stmt) -> _Body:
    """The places in the body that begins with a statement."""
    statements, _ = places(script)[first]
    body = _Body()
    for place, statement in enumerate(statements):
        if not isinstance(statement, (ast.Assign, ast.AugAssign, ast.Expr)):
            body.changing.append(place)
            continue
        for node in walk(statement):
            match node:
                case ast.Call() if (callee_path(script, node) or OPERATORS).startswith(OPERATORS):
                    body.changing.append(place)
                case ast.Attribute(attr=name, ctx=ast.Store()):
                    body.by_name[name].append(place)
                    body.by_text[ast.unparse(node)].append(place)
                case ast.Name(id=name, ctx=ast.Store()):
                    body.by_text[name].append(place)
                case _:
                    pass
    return body


def _written_out(script: Script, node: ast.expr, depth: int = 0) -> str:
    """An expression as it is written, a name that is bound once, to a part of the scene, by what it is bound to:
    ``bpy.context.scene.render.engine`` for ``r.engine``.
    """
    text, root = ast.unparse(node), node
    while isinstance(root, ast.Attribute):
        root = root.value
    values = bindings(script).get(root.id, []) if isinstance(root, ast.Name) else []
    value = values[0] if len(values) == 1 else None
    if not isinstance(root, ast.Name) or value is None or depth > _DEEPEST:
        return text
    whole = _written_out(script, value, depth + 1)
    is_kept = whole == _SCENE or (whole.startswith(f"{_SCENE}.") and _is_kept(script, whole))
    return whole + text.removeprefix(root.id) if is_kept and _is_kept(script, _SCENE) else text


@once_for_each
def _is_kept(script: Script, text: str) -> bool:
    """Whether nothing in a script changes what a part of the scene is, or which scene it is of."""
    if not all(part.isidentifier() for part in text.split(".")):
        return False
    stored = any(
        not isinstance(node.ctx, ast.Load)
        for name in text.split(".")
        for node in attributes(script).get(name, ())
    )
    return not stored and not any(path.startswith(_OF_SCENES) for path in called_operators(script))


def _last_below(places_of: Sequence[int], place: int) -> int:
    at = bisect_left(places_of, place)
    return places_of[at - 1] if at else -1


def _beginnings(node: ast.expr) -> Iterator[str]:
    """An expression as it is written, and what it begins with: ``a.b[0]``, ``a.b``, ``a``."""
    inner: ast.expr | None = node
    while inner is not None:
        yield ast.unparse(inner)
        match inner:
            case ast.Attribute(value=value) | ast.Subscript(value=value) | ast.Call(func=value):
                inner = value
            case _:
                inner = None
