"""A spline that has one point more than it is given: a new spline has one already.

```python
spline = curve.splines.new("POLY")
spline.points.add(len(path))  # reported: spline.points.add(len(path) - 1)
for i, (x, y, z) in enumerate(path):
    spline.points[i].co = (x, y, z, 1)
```

The point that is left over stays at the origin, and the curve runs there.

Not reported: splines that the script does anything else with.
"""

from __future__ import annotations

import ast
from itertools import takewhile
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import callee_path
from kb_check.findings import Edit, Finding, Fix
from kb_check.modes.edit_bones import bound_in
from kb_check.rule import Rule
from kb_check.syntax.bodies import bodies

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_check.script import Script

_NEW = f"{T}CurveSplines.new"
_ADDS = {"points": f"{T}SplinePoints.add", "bezier_points": f"{T}SplineBezierPoints.add"}


def _check(script: Script) -> Iterator[Finding]:
    for body in bodies(script):
        for at, statement in enumerate(body):
            match statement:
                case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call() as call) if (
                    callee_path(script, call) == _NEW
                ):
                    behind = takewhile(lambda one, name=name: name not in bound_in(one), body[at + 1 :])
                    yield from _judged(script, name, [*behind])
                case _:
                    pass


def _judged(script: Script, spline: str, behind: Sequence[ast.stmt]) -> Iterator[Finding]:
    """Findings on a new spline, by the statements behind it."""
    for statement in behind:
        if not (added := _added(script, spline, statement)):
            continue
        call, kind, given = added
        nodes = [node for other in behind if other is not statement for node in walk(other)]
        points = [node for node in nodes if isinstance(node, ast.Attribute) and _is_of(node, spline) == kind]
        filled = _filled(nodes, given, points)
        if points and all(point in filled for point in points) and not _is_handed_on(nodes, spline):
            count = call.args[0]
            yield Finding(
                RULE.id, "warning", script.span(call),
                f"A new spline has one point: with `len({given})` more, the last one stays at the origin.",
                _ADDS[kind], (), Fix("Add one less", (Edit.behind(script.span(count), " - 1"),)),
            )  # fmt: skip
        return


def _added(script: Script, spline: str, statement: ast.stmt) -> tuple[ast.Call, str, str] | None:
    """What a statement adds to a spline: the call, the collection, and the name of what it counts."""
    match statement:
        case ast.Expr(
            value=ast.Call(
                func=ast.Attribute(value=ast.Attribute() as owner, attr="add"),
                args=[ast.Call(func=ast.Name(id="len"), args=[ast.Name(id=given)])],
                keywords=[],
            ) as call
        ) if (kind := _is_of(owner, spline)) and callee_path(script, call) == _ADDS[kind]:
            return call, kind, given
        case _:
            return None


def _is_of(node: ast.Attribute, spline: str) -> str:
    """The collection of a spline's points that an attribute is; empty for none."""
    is_owner = isinstance(node.value, ast.Name) and node.value.id == spline
    return node.attr if is_owner and node.attr in _ADDS else ""


def _filled(nodes: Sequence[ast.AST], given: str, points: Sequence[ast.Attribute]) -> set[ast.Attribute]:
    """The places of the points that a loop over what is counted goes through, one by one."""
    found: set[ast.Attribute] = set()
    for loop in (node for node in nodes if isinstance(node, ast.For)):
        match loop.iter, loop.target:
            case (
                ast.Call(func=ast.Name(id="enumerate"), args=[ast.Name(id=counted)]),
                ast.Tuple(elts=[ast.Name(id=index), _]),
            ) if counted == given:
                found |= _at(loop, index, points)
            case (
                ast.Call(
                    func=ast.Name(id="range"),
                    args=[ast.Call(func=ast.Name(id="len"), args=[ast.Name(id=counted)])],
                ),
                ast.Name(id=index),
            ) if counted == given:
                found |= _at(loop, index, points)
            case ast.Call(func=ast.Name(id="zip"), args=[first, second]), _:
                pair = {first, second}
                if any(isinstance(one, ast.Name) and one.id == given for one in pair):
                    found |= {point for point in points if point in pair}
            case _:
                pass
    return found


def _at(loop: ast.For, index: str, points: Sequence[ast.Attribute]) -> set[ast.Attribute]:
    return {
        node.value
        for node in walk(loop)
        if isinstance(node, ast.Subscript)
        and isinstance(node.slice, ast.Name)
        and node.slice.id == index
        and isinstance(node.value, ast.Attribute)
        and node.value in points
    }


def _is_handed_on(nodes: Sequence[ast.AST], spline: str) -> bool:
    """Whether a spline is used, or bound, otherwise than by its attributes."""
    read = {node.value for node in nodes if isinstance(node, ast.Attribute)}
    return any(isinstance(node, ast.Name) and node.id == spline and node not in read for node in nodes)


RULE = Rule("extra-point", "warning", "A new spline with one point too many", _check)
