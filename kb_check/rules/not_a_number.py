"""A vector, or another value of several numbers or none, where Python takes one number.

```python
math.radians((90, 0, 45))  # reported: tuple(map(math.radians, (90, 0, 45)))
round(ob.location, 2)  # reported: ob.location.to_tuple(2)
abs(vector)  # reported: vector.length, or the size of each component
vector**2  # reported: vector.length_squared, or vector * vector
float(bpy.context.scene)  # reported
```

Not reported: texts, which `int` and `float` read, and what stands in a ``try``.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import UNKNOWN, Collection, Instance, Plain, Sequence, Tuple, members
from kb_build.symbols.api_names import STRUCT
from kb_check.calls.resolved import builtin_called
from kb_check.findings import Finding
from kb_check.rule import Rule
from kb_check.running.raised import REFUSES
from kb_check.running.tried import is_tried
from kb_check.script import once_per_script
from kb_check.syntax.literals import times_bound
from kb_check.values.mathutils_sizes import VECTOR
from kb_check.values.misfits import describe

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.values.types import Type
    from kb_check.script import Script

_MATH = "math"
_FUNCTIONS = frozenset(
    {
        "acos", "asin", "atan", "atan2", "ceil", "copysign", "cos", "cosh", "degrees", "exp", "fabs", "floor", "fmod",
        "hypot", "isclose", "isfinite", "isinf", "isnan", "log", "log10", "log2", "pow", "radians", "sin", "sinh",
        "sqrt", "tan", "tanh", "trunc",
    }
)  # fmt: skip
_ANGLES = frozenset({"degrees", "radians"})
_BUILTINS = frozenset({"abs", "divmod", "float", "int", "pow", "round"})
_OF_SEVERAL = frozenset({"divmod", "pow"})  # that take two numbers; of the others the first argument is one
_SIGNS: dict[type[ast.operator], str] = {ast.Pow: "**", ast.FloorDiv: "//", ast.Mod: "%"}
_ROWS = frozenset(f"mathutils.{name}" for name in ("Color", "Euler", "Matrix", "Quaternion", "Vector"))
# What is meant by what a vector does not take.
_OF_VECTOR = {
    "abs": "Its size is `vector.length`; of each component, `Vector(map(abs, vector))`.",
    "round": "`vector.to_tuple(2)` rounds its components.",
    "**": "Its square is `vector.length_squared`; of each component, `vector * vector`.",
    "sqrt": "Its size is `vector.length`.",
}


def _check(script: Script) -> Iterator[Finding]:
    for function, node in _numbers_wanted(script):
        kind = _no_number(script, node, texts=function.startswith(_MATH))
        if kind is not None and not is_tried(script, node, REFUSES):
            yield Finding(
                RULE.id, "error", script.span(node),
                f"`{function}` takes a number, not {describe(kind)}.{_advice(script, function, kind, node)}", function,
            )  # fmt: skip
    for node in script.all(ast.BinOp):
        sign, left = _SIGNS.get(type(node.op), ""), script.class_of(node.left)
        is_math = sign and left in _ROWS and _is_number_or_row(script, node.right)
        if is_math and not is_tried(script, node, REFUSES):
            told = f" {_OF_VECTOR[sign]}" if left == VECTOR and sign in _OF_VECTOR else ""
            yield Finding(
                RULE.id, "error", script.span(node), f"`{left} {sign}` is refused: it takes `*` and `/`.{told}", left
            )  # fmt: skip


def _numbers_wanted(script: Script) -> Iterator[tuple[str, ast.expr]]:
    """(function, argument) of each that must be one number."""
    for call in script.all(ast.Call):
        if call.keywords or not call.args:
            continue
        name = builtin_called(script, call)
        if name in _BUILTINS:
            yield from ((name, node) for node in call.args[: None if name in _OF_SEVERAL else 1])
        elif function := _math_called(script, call):
            yield from ((function, node) for node in call.args)


def _math_called(script: Script, call: ast.Call) -> str:
    """``math.sin`` where the module's function is called, by the module's name or its own."""
    match call.func:
        case ast.Attribute(value=ast.Name(id=module), attr=name) if _imported(script).get(module) == _MATH:
            return f"{_MATH}.{name}" if name in _FUNCTIONS else ""
        case ast.Name(id=name):
            path = _imported(script).get(name, "")
            return path if path != _MATH else ""
        case _:
            return ""


@once_per_script
def _imported(script: Script) -> dict[str, str]:
    """The names that stand for the module, or for a function of it, and for nothing else in the script."""
    found: dict[str, str] = {}
    for node in script.all(ast.Import):
        found |= {alias.asname or alias.name: _MATH for alias in node.names if alias.name == _MATH}
    for node in script.all(ast.ImportFrom):
        if node.module == _MATH:
            names = (alias for alias in node.names if alias.name in _FUNCTIONS)
            found |= {alias.asname or alias.name: f"{_MATH}.{alias.name}" for alias in names}
    return {name: path for name, path in found.items() if times_bound(script)[name] == 1}


def _no_number(script: Script, node: ast.expr, *, texts: bool) -> Type | None:
    """The type of a value that surely is not one number; None for others. ``texts`` are none either."""
    if isinstance(node, ast.Starred):
        return None
    kinds = members(script.type_of(node) or UNKNOWN)
    found = [kind for kind in kinds if _is_no_number(script, kind, texts=texts)]
    return found[0] if len(found) == len(kinds) else None


def _is_no_number(script: Script, kind: Type, *, texts: bool) -> bool:
    match kind:
        case Instance(cls=cls, sure=True):
            return cls in _ROWS or script.api.descends(cls, STRUCT)
        case Tuple() | Sequence() | Collection():
            return True
        case Plain(kind="str"):
            return texts
        case _:
            return False


def _is_number_or_row(script: Script, node: ast.expr) -> bool:
    kinds = members(script.type_of(node) or UNKNOWN)
    return all(
        (isinstance(kind, Plain) and kind.kind != "str") or (isinstance(kind, Instance) and kind.cls in _ROWS)
        for kind in kinds
    )


def _advice(script: Script, function: str, kind: Type, node: ast.expr) -> str:
    name = function.removeprefix(f"{_MATH}.")
    if name in _ANGLES and not isinstance(kind, Plain):
        text = script.text(script.span(node))
        return f" Of each angle: `[{function}(angle) for angle in {text}]`." if "\n" not in text else ""
    is_vector = isinstance(kind, Instance) and kind.cls == VECTOR
    return f" {_OF_VECTOR[name]}" if is_vector and name in _OF_VECTOR else ""


RULE = Rule("not-a-number", "error", "A value of several numbers, or none, where Python takes one", _check)
