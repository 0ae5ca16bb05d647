"""Where a script gives the setting that would fill a pointer another value, or gives it to another thing.

```python
fluid.fluid_type = "FLOW"  # fluid.domain_settings stays None
domain.fluid_type = "DOMAIN"  # and so it does for this, if both are new
```
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_check.calls.resolved import callee_path
from kb_check.calls.sites import calls
from kb_check.syntax.bindings import bindings
from kb_check.syntax.words import attributes

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script


def set_otherwise(script: Script, filler: str, owner: ast.expr) -> frozenset[ast.AST]:
    """The parts of a script that name what fills a pointer of an owner, and surely do not fill it."""
    match ast.parse(filler).body[0]:
        case ast.Assign(targets=[ast.Attribute(attr=setting)], value=ast.Constant(value=wanted)):
            return frozenset(_set_otherwise(script, setting, wanted, owner))
        case ast.Expr(
            value=ast.Call(keywords=[ast.keyword(arg=str(name), value=ast.Constant(value=wanted))]) as call
        ):
            return frozenset(_called_otherwise(script, ast.unparse(call.func), name, wanted))
        case _:
            return frozenset()


def _set_otherwise(script: Script, setting: str, wanted: object, owner: ast.expr) -> Iterator[ast.AST]:
    targets = {node.targets[0]: node.value for node in script.all(ast.Assign) if len(node.targets) == 1}
    for node in attributes(script).get(setting, ()):
        match targets.get(node):
            case ast.Constant(value=value) if value != wanted or _is_another(script, node.value, owner):
                yield node
            case _:
                pass


def _called_otherwise(script: Script, path: str, name: str, wanted: object) -> Iterator[ast.AST]:
    for call in calls(script):
        given = call.argument(name) if call.callee.symbol.path == path else None
        if isinstance(given, ast.Constant) and given.value != wanted:
            yield from walk(call.node)


def _is_another(script: Script, thing: ast.expr, owner: ast.expr) -> bool:
    """Whether two names hold two things, each made anew for it alone."""
    if not isinstance(thing, ast.Name) or not isinstance(owner, ast.Name) or thing.id == owner.id:
        return False
    return all(_is_made_once(script, name.id) for name in (thing, owner))


def _is_made_once(script: Script, name: str) -> bool:
    match bindings(script).get(name):
        case [ast.Call() as made]:
            return callee_path(script, made).endswith(".new")
        case _:
            return False
