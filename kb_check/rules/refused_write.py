"""A write to data in a function in which Blender lets nothing be written: `poll`, and what draws.

Blender asks and draws as often as it likes, and refuses to change data-blocks meanwhile: an AttributeError ends the
function, so that a `poll` says no and a panel stays empty from there on. An operator that is called there is refused
with a RuntimeError.

```python
class Grow(bpy.types.Operator):
    @classmethod
    def poll(cls, context):
        context.scene.frame_current = 7  # reported
        return True


class Tools(bpy.types.Panel):
    def draw(self, context):
        bpy.ops.object.select_all(
            action="SELECT"
        )  # reported: self.layout.operator draws a button that calls it
```

So are functions that a script appends to a panel, a menu or a header.

Not reported: writes to what belongs to no scene (window managers, screens, workspaces, preferences), which are
taken; what a function does that is called from there; what a `try` around it catches; getters, setters and updates of
properties, `execute` and `invoke`, and functions given to `popup_menu`, which may write.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import children
from kb_build.flow.values.types import ClassObject, Instance, LocalClass
from kb_build.symbols.api_names import ID, OPERATORS, STRUCT
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import callee_path
from kb_check.findings import Finding
from kb_check.registered.classes import own_classes
from kb_check.rule import Rule
from kb_check.running.tried import is_tried
from kb_check.script import once_per_script
from kb_check.syntax.bindings import bindings
from kb_check.syntax.literals import times_bound

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script
    from kb_check.syntax.definitions import FunctionDefinition

_VIEW_LAYER = f"{T}ViewLayer"
# Data-blocks that may be written to at any time.
_OF_WINDOWS = frozenset(f"{T}{name}" for name in ("Screen", "WindowManager", "WorkSpace"))
# Other functions than those that are called poll and draw in which nothing may be written: each was tried.
_OTHERS = {f"{T}UIList": frozenset({"filter_items"})}
_MAY_WRITE = f"{T}RenderEngine"  # whose functions draw pictures
_DRAWING = tuple(f"{T}{name}" for name in ("Header", "Menu", "Panel"))
_ADDING = frozenset({"append", "prepend"})
_SCOPES = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda)
_VECTORS = frozenset(f"mathutils.{name}" for name in ("Color", "Euler", "Quaternion", "Vector"))
_MOST_VALUES = 8  # that a name is bound to, to tell what something belongs to
_DOTS = 3


def _check(script: Script) -> Iterator[Finding]:
    seen: set[ast.stmt] = set()
    for function, what in (*_of_classes(script), *_appended(script)):
        if function in seen:
            continue
        seen.add(function)
        for node in _own_nodes(function):
            finding = _called(script, node, what) or _written(script, node, what)
            if finding and not is_tried(script, node):
                yield finding


def _of_classes(script: Script) -> Iterator[tuple[FunctionDefinition, str]]:
    """The functions of classes that Blender calls to ask or to draw, and what each is."""
    for own in own_classes(script):
        for symbol, function in own.callbacks(script) if own.path != _MAY_WRITE else ():
            asks = symbol.name == "poll" or symbol.name in _OTHERS.get(own.path, ())
            if asks or symbol.name.partition("_")[0] == "draw":
                yield function, f"`{symbol.name}` of {own.label}"


def _appended(script: Script) -> Iterator[tuple[FunctionDefinition, str]]:
    """The functions that are drawn with a panel, a menu or a header, and what each is."""
    functions = {node.name: node for node in script.all(ast.FunctionDef)}
    own = {one.node: one.path for one in own_classes(script)}
    times = times_bound(script)
    for node in script.all(ast.Call):
        match node:
            case ast.Call(func=ast.Attribute(value=drawn, attr=how), args=[ast.Name(id=name)]) if (
                how in _ADDING and name in functions and times[name] == 1
            ):
                match script.type_of(drawn):
                    case ClassObject(cls=path):
                        pass
                    case LocalClass(number=number):
                        path = own.get(script.analysis.classes[number], "")
                    case _:
                        continue
                if any(script.api.descends(path, cls) for cls in _DRAWING):
                    yield functions[name], f"`{name}`, which is drawn with `{ast.unparse(drawn)}`"
            case _:
                pass


def _own_nodes(function: FunctionDefinition) -> Iterator[ast.Attribute | ast.Subscript | ast.Call]:
    """What a function calls, and sets or deletes, itself; not what the functions in it do."""
    left: list[ast.AST] = [*reversed(function.body)]
    while left:
        node = left.pop()
        if isinstance(node, _SCOPES):
            continue
        if isinstance(node, ast.Call) or (
            isinstance(node, (ast.Attribute, ast.Subscript)) and not isinstance(node.ctx, ast.Load)
        ):
            yield node
        left.extend(children(node))


def _called(script: Script, node: ast.expr, what: str) -> Finding | None:
    path = callee_path(script, node) if isinstance(node, ast.Call) else ""
    if not path.startswith(OPERATORS) or path.count(".") != _DOTS:
        return None
    return Finding(
        RULE.id, "error", script.span(node),
        f"Blender refuses to call operators in {what}: `{path}` raises a RuntimeError there.", path,
    )  # fmt: skip


def _written(script: Script, node: ast.expr, what: str) -> Finding | None:
    if not isinstance(node, (ast.Attribute, ast.Subscript)) or not _is_checked(script, node):
        return None
    if not (owner := _holder(script, node.value)):
        return None
    return Finding(
        RULE.id, "error", script.span(node),
        f"Blender refuses to write to data in {what}: `{ast.unparse(node)}` belongs to a `{owner}`.", owner,
    )  # fmt: skip


def _is_checked(script: Script, node: ast.Attribute | ast.Subscript) -> bool:
    """Whether Blender checks that it may write: the items of its own arrays, and of collections, are set unseen."""
    kind = script.type_of(node.value)
    return isinstance(node, ast.Attribute) or (
        isinstance(kind, Instance) and (kind.cls in _VECTORS or script.api.descends(kind.cls, STRUCT))
    )


def _holder(script: Script, node: ast.expr) -> str:
    """The class of the data-block that something surely belongs to and that is locked; empty for none."""
    kind = script.type_of(node)
    if isinstance(kind, Instance) and kind.sure:
        if kind.cls == _VIEW_LAYER:
            return f"{T}Scene"
        if script.api.descends(kind.cls, ID):
            return "" if kind.cls == ID or kind.cls in _OF_WINDOWS else kind.cls
    match node:
        case ast.Attribute(value=owner):
            return _holder(script, owner)
        case ast.Subscript(value=owner):
            return _holder(script, owner) if _is_struct(script, node) else ""
        case ast.Name(id=name):
            return _holder_of_name(script, name)
        case _:
            return ""


def _holder_of_name(script: Script, name: str) -> str:
    """The one holder of all that a name is bound to; empty for several, for none, and for what leads to itself."""
    known = _holders_of_names(script)
    if name not in known:
        known[name] = ""  # until it is found
        values = bindings(script).get(name, [])
        held = {
            _holder(script, value) if isinstance(value, (ast.Attribute, ast.Subscript)) else ""
            for value in values[: _MOST_VALUES + 1]
        }
        known[name] = held.pop() if len(held) == 1 and len(values) <= _MOST_VALUES else ""
    return known[name]


@once_per_script
def _holders_of_names(_script: Script) -> dict[str, str]:
    """Those that were asked for."""
    return {}


def _is_struct(script: Script, node: ast.expr) -> bool:
    """Whether something is one of Blender's structures: a part of an array may be set all the same."""
    kind = script.type_of(node)
    return isinstance(kind, Instance) and kind.sure and script.api.descends(kind.cls, STRUCT)


RULE = Rule("refused-write", "error", "A write to data where Blender only asks or draws", _check)
