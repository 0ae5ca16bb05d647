"""A function of a class that Blender calls otherwise than it is defined.

When a class is registered, Blender counts the arguments of the functions that it calls: one too few or too many, and
the class is refused. `*args` does not count. What it calls before there is an instance must be a class method.

```python
class Grow(bpy.types.Operator):
    bl_idname = "object.grow"
    bl_label = "Grow"

    def poll(self, context):  # reported: without @classmethod
        return context.object is not None

    def execute(self):  # reported: (self, context)
        return {"FINISHED"}
```

Since 4.4 `__init__` gets arguments as well, which it hands on: `super().__init__(*args, **kwargs)`. Reported for the
types of which Blender makes instances without a window.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES as T
from kb_check.findings import Edit, Finding, Fix
from kb_check.registered.blender_types import FEWEST_ARGUMENTS
from kb_check.registered.classes import own_classes
from kb_check.rule import Rule
from kb_check.syntax.definitions import FunctionDefinition
from simworlds.counting import counted

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_check.registered.classes import OwnClass
    from kb_check.script import Script

_PASSES_TO_INIT = (4, 4)
# Those of which an instance was seen to be made so, with what ends where it cannot be made.
_MADE = {
    f"{T}AddonPreferences": "no such preferences can be read",
    f"{T}Node": "no such node can be made", f"{T}NodeSocket": "no such socket can be made",
    f"{T}NodeTree": "no such tree can be made", f"{T}Operator": "no such operator can run",
    f"{T}PropertyGroup": "no such group can be read", f"{T}RenderEngine": "no such engine can render",
}  # fmt: skip


def _check(script: Script) -> Iterator[Finding]:
    seen: set[ast.stmt] = set()
    for own in own_classes(script):
        for symbol, function in own.callbacks(script):
            if function not in seen and (finding := _judged(script, own, function, symbol)):
                yield finding
            seen.add(function)
        init = own.given("__init__")
        if isinstance(init, FunctionDefinition) and init not in seen and own.path in _MADE and own.is_final:
            seen.add(init)
            if script.version >= _PASSES_TO_INIT and _takes_nothing(init):
                yield _finding(
                    script, own, init,
                    f"gets arguments from Blender since 4.4, and this one takes none: {_MADE[own.path]}. Write "
                    "`def __init__(self, *args, **kwargs)`, and `super().__init__(*args, **kwargs)` in it",
                )  # fmt: skip


def _judged(script: Script, own: OwnClass, function: FunctionDefinition, symbol: Symbol) -> Finding | None:
    decorators = [node.id if isinstance(node, ast.Name) else "" for node in function.decorator_list]
    if any(name not in {"classmethod", "staticmethod"} for name in decorators):
        return None
    of_class = not {"classmethod", "static"}.isdisjoint(symbol.flags)
    names = ("cls" if of_class else "self", *(parameter.name for parameter in symbol.parameters))
    written = [*function.args.posonlyargs, *function.args.args]
    takes = f"`({', '.join(names)})`"
    if of_class and decorators != ["classmethod"]:
        fix = None if decorators or len(written) != len(names) else _class_method(script, function)
        return _finding(script, own, function, f"must be a class method that takes {takes}", fix)
    if not of_class and decorators == ["classmethod"]:
        return _finding(
            script, own, function, f"is called on an instance: it takes {takes}, and no @classmethod"
        )
    fewest = FEWEST_ARGUMENTS.get(symbol.path, len(names))
    if not fewest <= len(written) <= len(names):
        fix = _completed(script, function, names)
        count = counted(len(written), "argument")
        return _finding(script, own, function, f"takes {takes}, and this one has {count}", fix)
    return None


def _finding(
    script: Script, own: OwnClass, function: FunctionDefinition, what: str, fix: Fix | None = None
) -> Finding:
    refused = "" if function.name == "__init__" else ": Blender refuses to register the class"
    return Finding(
        RULE.id, "error", script.name_span(function),
        f"`{function.name}` of {own.label} {what}{refused}.", f"{own.path}.{function.name}", (), fix,
    )  # fmt: skip


def _takes_nothing(function: FunctionDefinition) -> bool:
    arguments = function.args
    return not arguments.vararg and len(arguments.posonlyargs) + len(arguments.args) < 2


def _class_method(script: Script, function: FunctionDefinition) -> Fix:
    start = script.span(function)
    return Fix("Write @classmethod", (Edit.before(start, f"@classmethod\n{' ' * start.column}"),), sure=True)


def _completed(script: Script, function: FunctionDefinition, names: tuple[str, ...]) -> Fix | None:
    """Adds the arguments that lack behind those that are there, if these are plain and called as the others."""
    arguments = function.args
    plain = [argument.arg for argument in arguments.args]
    others = arguments.posonlyargs or arguments.vararg or arguments.kwonlyargs or arguments.kwarg
    if others or arguments.defaults or not plain or plain[1:] != list(names[1 : len(plain)]):
        return None
    missing = ", ".join(names[len(plain) :])
    edit = Edit.behind(script.span(arguments.args[-1]), f", {missing}")
    return Fix(f"Add {missing}", (edit,), sure=True) if missing else None


RULE = Rule("callback-signature", "error", "A function that Blender calls with other arguments", _check)
