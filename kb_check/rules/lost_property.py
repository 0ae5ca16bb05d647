"""A property of a class that Blender drops.

Blender makes properties of a class's annotations, when it registers the class. What is assigned instead stays an
attribute that holds the declaration: there is no property to set, to draw or to pass to the operator.

```python
class Settings(bpy.types.PropertyGroup):
    count = bpy.props.IntProperty()  # reported: count: bpy.props.IntProperty()
    size: bpy.props.FloatProperty  # reported: it is not called


Settings.kind = bpy.props.StringProperty()  # reported, before the class is registered
```

Panels, menus and headers have no properties of their own: what is annotated there is dropped as well, which is a
warning, as the class works without it. A name that begins with an underscore is refused.

Not reported: scripts that change `__annotations__` themselves.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_build.flow.values.types import Function
from kb_check.calls.resolved import callee_path
from kb_check.findings import Edit, Finding, Fix, Span
from kb_check.registered.blender_types import MAKE_PROPERTIES
from kb_check.registered.classes import own_classes
from kb_check.rule import Rule
from kb_check.syntax.literals import times_bound

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.findings import Severity
    from kb_check.registered.classes import OwnClass
    from kb_check.script import Script

_PROPS = "bpy.props."
_ANNOTATIONS = "__annotations__"


def _check(script: Script) -> Iterator[Finding]:
    classes = own_classes(script)
    if not classes or _changes_annotations(script):
        return
    for own in classes:
        for statement in own.node.body:
            match statement:
                case ast.Assign(targets=[ast.Name() as name], value=ast.Call() as call) if _declares(
                    script, call
                ):
                    yield _assigned(script, own, name, call)
                case ast.AnnAssign(target=ast.Name() as name, annotation=annotation, value=value):
                    yield from _annotated(script, own, name, annotation, value)
                case _:
                    pass
    yield from _given_later(script)


def _changes_annotations(script: Script) -> bool:
    """Whether the script has the annotations of classes anywhere: as an attribute, or by the text that is its name."""
    return any(node.attr == _ANNOTATIONS for node in script.all(ast.Attribute)) or any(
        node.value == _ANNOTATIONS for node in script.all(ast.Constant)
    )


def _given_later(script: Script) -> Iterator[Finding]:
    """What is assigned to a class of the script behind its body: one that is registered by then would take it."""
    own = {one.node.name: one for one in own_classes(script)}
    for statement in _run_first(script.tree.body):
        if _may_register(statement):
            return
        match statement:
            case ast.Assign(
                targets=[ast.Attribute(value=ast.Name(id=name)) as target], value=ast.Call() as call
            ) if name in own and times_bound(script)[name] == 1 and _declares(script, call):
                told = f"`{target.attr}` of `{name}` makes no property: its class is not registered yet"
                if own[name].path in MAKE_PROPERTIES:
                    told += f". Write `{target.attr}: {ast.unparse(call.func)}(...)` in its body"
                yield Finding(RULE.id, "error", script.name_span(target), f"{told}.", own[name].path)
            case _:
                pass


def _run_first(body: list[ast.stmt]) -> Iterator[ast.stmt]:
    """The statements that run when a script is, and are no definitions: those in the bodies of classes as well."""
    for statement in body:
        if isinstance(statement, ast.ClassDef):
            yield from _run_first(statement.body)
        elif not isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef)):
            yield statement


def _may_register(statement: ast.stmt) -> bool:
    """Whether a statement calls what may register classes, by its name."""
    return any(
        isinstance(node, ast.Call) and "register" in ast.unparse(node.func).lower()
        for node in walk(statement)
    )


def _declares(script: Script, node: ast.expr | None) -> bool:
    path = callee_path(script, node) if isinstance(node, ast.Call) else ""
    return path.startswith(_PROPS) and path != f"{_PROPS}RemoveProperty"


def _annotated(
    script: Script, own: OwnClass, name: ast.Name, annotation: ast.expr, value: ast.expr | None
) -> Iterator[Finding]:
    if isinstance(value, ast.Call) and _declares(script, value) and not _declares(script, annotation):
        yield _assigned(script, own, name, value)
        return
    kind = script.type_of(annotation)
    if (
        value is None
        and isinstance(kind, Function)
        and kind.path.startswith(_PROPS)
        and own.path in MAKE_PROPERTIES
    ):
        yield _finding(
            script, own, name, f"makes no property: `{kind.path}` is not called",
            Fix("Call it", (Edit.behind(script.span(annotation), "()"),)),
        )  # fmt: skip
    elif _declares(script, annotation):
        if own.path not in MAKE_PROPERTIES:
            yield _finding(
                script, own, name,
                f"makes no property: {own.label} has none of its own. Declare it in a PropertyGroup, or on a class "
                "such as `bpy.types.Scene`", severity="warning",
            )  # fmt: skip
        elif name.id.startswith("_"):
            yield _finding(script, own, name, "is refused: a property's name cannot begin with an underscore")


def _assigned(script: Script, own: OwnClass, name: ast.Name, call: ast.Call) -> Finding:
    start, end = script.span(name), script.span(call)
    between = Span(start.end_line, start.end_column, end.line, end.column)
    can_be = own.path in MAKE_PROPERTIES and not name.id.startswith("_")
    fix = Fix("Write an annotation", (Edit(between, ": "),), sure=True) if can_be else None
    return _finding(
        script, own, name,
        "makes no property: Blender takes annotations only"
        + (f". Write `{name.id}: {ast.unparse(call.func)}(...)`" if can_be else ""),
        fix,
    )  # fmt: skip


def _finding(  # noqa: PLR0913, PLR0917 - what it says, and how it is mended
    script: Script,
    own: OwnClass,
    name: ast.Name,
    what: str,
    fix: Fix | None = None,
    severity: Severity = "error",
) -> Finding:
    return Finding(
        RULE.id, severity, script.span(name), f"`{name.id}` of `{own.node.name}` {what}.", own.path, (), fix
    )


RULE = Rule("lost-property", "error", "A property of a class that Blender drops", _check)
