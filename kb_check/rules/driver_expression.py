"""A driver's expression that Blender cannot compute: the driver is invalid, and its value stays 0.

```python
driver = cube.driver_add("location", 2).driver
driver.expression = "math.sin(frame)"  # reported: the functions of math stand there without its name
driver.expression = "sin(frame"  # reported: no expression
driver.expression = "speed * frame"  # reported, unless the script gives the driver a variable called speed
```

An expression knows its driver's variables, ``frame``, Python's ``math`` functions, ``clamp``, ``lerp``,
``smoothstep``, ``noise``, ``bpy``, and ``self`` where ``use_self`` is on.

Not reported: names of variables where the script computes any, or puts names into
``bpy.app.driver_namespace``; and drivers that the script has not added itself.
"""

from __future__ import annotations

import ast
import builtins
import math
import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import callee_path
from kb_check.findings import Edit, Finding, Fix
from kb_check.rule import Rule
from kb_check.running.out_of_sight import computes_names
from kb_check.syntax.bindings import assignments, once_bound
from kb_check.syntax.literals import written
from kb_check.syntax.words import named_words
from kb_check.values.given import given_values

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_EXPRESSION, _VARIABLE = f"{T}Driver.expression", f"{T}DriverVariable.name"
_NAMESPACE = "driver_namespace"
_MATH = frozenset(name for name in dir(math) if not name.startswith("_"))
# What an expression knows besides the functions of math and Python's own.
_KNOWN = frozenset({"frame", "self", "depsgraph", "bpy", "noise", "clamp", "lerp", "smoothstep"})
_DEFAULT = re.compile(r"var(_\d{3})?")  # what Blender calls variables that the script does not name


def _check(script: Script) -> Iterator[Finding]:
    if _NAMESPACE in named_words(script):
        return
    for given in given_values(script):
        text = written(script, given.node)
        if given.takers[0].path != _EXPRESSION or not isinstance(text, ast.Constant):
            continue
        if not isinstance(text.value, str) or not text.value.strip():
            continue
        if why := _fault(script, text.value, given.node):
            yield Finding(
                RULE.id, "warning", script.span(text),
                f"Blender cannot compute this expression, and the driver gives 0: {why}", _EXPRESSION, (),
                _without_math(script, text),
            )  # fmt: skip


def _fault(script: Script, text: str, node: ast.expr) -> str:
    """What is wrong with an expression; empty for nothing that is sure."""
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
        why = error.msg if isinstance(error, SyntaxError) else "it cannot be read"
        return f"{why}. It is one expression of Python."
    nodes = list(ast.walk(tree))
    names = {one.id for one in nodes if isinstance(one, ast.Name)}
    if found := [one.attr for one in nodes if isinstance(one, ast.Attribute) and _is_math(one.value)]:
        return f"`math` is not known there, and its functions are without it: `{found[0]}`."
    if "self" in names and "use_self" not in named_words(script):
        return "`self` is known only while `driver.use_self` is True."
    bound = {one.arg for one in nodes if isinstance(one, ast.arg)}
    bound |= {one.id for one in nodes if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)}
    variables = _variables(script)
    if variables is None or not _is_added(script, node):
        return ""
    unknown = sorted(
        name
        for name in names - bound - variables - _MATH - _KNOWN
        if not hasattr(builtins, name) and not _DEFAULT.fullmatch(name)
    )
    if not unknown:
        return ""
    return (
        f"`{unknown[0]}` is not known there. It knows the driver's variables (`driver.variables.new()`, then "
        "`.name`), `frame`, and the functions of Python's `math`."
    )


def _is_math(node: ast.expr) -> bool:
    return isinstance(node, ast.Name) and node.id == "math"


def _variables(script: Script) -> frozenset[str] | None:
    """The names that the script gives to drivers' variables; None where it computes any."""
    if computes_names(script):
        return None
    found: set[str] = set()
    for given in given_values(script):
        if _VARIABLE in {taker.path for taker in given.takers}:
            name = written(script, given.node)
            if not isinstance(name, ast.Constant) or not isinstance(name.value, str):
                return None
            found.add(name.value)
    return frozenset(found)


def _is_added(script: Script, value: ast.expr) -> bool:
    """Whether the driver that is given an expression is one that the script has added where it names it."""
    statement = assignments(script).get(value)
    if statement is None:
        return False
    owner = statement.targets[0]
    while isinstance(owner, (ast.Attribute, ast.Name)):
        inner = owner.value if isinstance(owner, ast.Attribute) else once_bound(script, owner)
        if inner is owner:
            return False
        owner = inner
    return isinstance(owner, ast.Call) and callee_path(script, owner).endswith(".driver_add")


def _without_math(script: Script, text: ast.Constant) -> Fix | None:
    """The fix that leaves ``math.`` out, where nothing else is wrong."""
    span = script.span(text)
    kept = re.sub(r"\bmath\.(?=\w)", "", script.text(span))
    try:
        is_right = kept != script.text(span) and not _fault(script, ast.literal_eval(kept), text)
    except (SyntaxError, ValueError):
        return None
    return Fix("Leave `math.` out", (Edit(span, kept),), sure=True) if is_right else None


RULE = Rule("driver-expression", "warning", "A driver's expression that Blender cannot compute", _check)
