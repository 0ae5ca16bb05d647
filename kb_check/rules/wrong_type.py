"""A value of a type that a property or a parameter does not take.

Blender refuses it with a TypeError, or with a ValueError for a sequence of the wrong length. It makes floats of ints
and takes any sequence of numbers for a vector; it takes no float for an int, no number for a name and no text for a
pointer, and a colour has as many parts as its property says.

```python
scene.frame_end = 250.0  # reported
material.diffuse_color = (1, 0, 0)  # reported: 4 floats
scene.camera = bpy.data.cameras.new("Camera")  # reported: an Object that has it
```

Not reported: values whose type is not sure, and what may be None only at times.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.types import Instance
from kb_check.conversions import misfit
from kb_check.findings import Edit, Finding, Fix
from kb_check.given import given_values
from kb_check.literals import items
from kb_check.rule import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.conversions import Misfit
    from kb_check.given import Taker
    from kb_check.script import Script

_COLORS = frozenset({"COLOR", "COLOR_GAMMA"})
_OBJECT = "bpy.types.Object"


def _check(script: Script) -> Iterator[Finding]:
    for given in given_values(script):
        found = [misfit(script, taker, given.node) for taker in given.takers]
        if not found or not all(found):
            continue
        wrong, taker = found[0], given.takers[0]
        assert wrong is not None
        yield Finding(
            RULE.id, "error", script.span(given.node),
            f"`{taker.path}` takes {wrong.takes}, not {wrong.given}.{_advice(script, taker, given.node)}",
            taker.path, (), _fix(script, taker, wrong, given.node) if len(given.takers) == 1 else None,
        )  # fmt: skip


def _advice(script: Script, taker: Taker, node: ast.expr) -> str:
    """What may be meant where data are given in the place of an object, or a name in the place of what it names."""
    kind = script.type_of(node)
    if (
        taker.target == _OBJECT
        and isinstance(kind, Instance)
        and script.api.descends(kind.cls, "bpy.types.ID")
    ):
        data = script.api.member(_OBJECT, "data")
        if data is not None and kind.cls.rpartition(".")[2] in {"Mesh", "Camera", "Armature", "Light", "PointLight",
                                                                "SunLight", "SpotLight", "AreaLight", "Curve"}:  # fmt: skip
            return " Give the object that has it: `bpy.data.objects.new(name, data)` makes one."
    return ""


def _fix(script: Script, taker: Taker, wrong: Misfit, node: ast.expr) -> Fix | None:
    """The edit that leaves no doubt: a whole number without its point, a colour with or without alpha, a set of one."""
    span = script.span(node)
    text = script.text(span)
    parts = items(script, node)
    if taker.kind == "int" and isinstance(node, ast.Constant) and isinstance(node.value, float):
        whole = node.value.is_integer() and abs(node.value) < 2**31
        return Fix("Write an int", (Edit(span, str(int(node.value))),), sure=True) if whole else None
    if taker.kind == "set" and isinstance(node, ast.Constant) and isinstance(node.value, str):
        return Fix("Write a set", (Edit(span, f"{{{text}}}"),), sure=True)
    if parts is None or not isinstance(node, (ast.Tuple, ast.List)):
        return None
    if taker.kind == "boolean" and not wrong.length:
        if all(isinstance(part, ast.Constant) and part.value in {0, 1} for part in parts):
            edits = tuple(Edit(script.span(part), str(bool(part.value))) for part in parts
                          if isinstance(part, ast.Constant))  # fmt: skip
            return Fix("Write truth values", edits, sure=True)
        return None
    if taker.subtype in _COLORS and taker.kind == "float" and _is_color(script, parts):
        if (wrong.length, taker.sizes) == (3, (4,)):
            end = script.span(parts[-1])
            where = type(end)(end.end_line, end.end_column, end.end_line, end.end_column)
            return Fix("Add alpha", (Edit(where, ", 1.0"),), sure=True)
        if (wrong.length, taker.sizes) == (4, (3,)):
            before, last = script.span(parts[2]), script.span(parts[3])
            cut = type(last)(before.end_line, before.end_column, last.end_line, last.end_column)
            return Fix("Leave out alpha", (Edit(cut, ""),), sure=True)
    return None


def _is_color(script: Script, parts: list[ast.expr]) -> bool:
    return all(
        script.type_of(part) is not None and not isinstance(part, (ast.Tuple, ast.List)) for part in parts
    )


RULE = Rule("wrong-type", "error", "A value of a type that is not taken", _check)
