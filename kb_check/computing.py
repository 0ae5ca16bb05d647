"""The names by which Python does what the text of a script does not show."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.script import once_per_script

if TYPE_CHECKING:
    from kb_check.script import Script

# Run code that is a text, or that is somewhere else.
RUNNING = frozenset({"exec", "eval", "__import__"})
# Set what is called as a text says.
STORING = frozenset({"setattr", "__setattr__"})
# Hold the names of Python's own objects, and of no data of Blender's.
NAMESPACES = frozenset({"vars", "locals", "globals", "__dict__"})
# Run a function, or get a thing, that is not seen where they stand.
CALLING = frozenset({"compile", "getattr", "next", "map", "filter"})

_BUILTINS = frozenset({"builtins", "__builtins__"})


@once_per_script
def computing(script: Script) -> frozenset[str]:
    """Those of the names that the script has anywhere: to call them, or under another name."""
    found: set[str] = set()
    for node in script.all(ast.Name, ast.Attribute, ast.alias):
        match node:
            case ast.Name(id=name) | ast.alias(name=name):
                found.add(name)
            case ast.Attribute(value=ast.Name(id=owner), attr=name) if owner in _BUILTINS:
                found.add(name)
            case ast.Attribute(attr=name) if name.startswith("__"):
                found.add(name)
            case _:
                pass
    return frozenset(found & (RUNNING | STORING | NAMESPACES | CALLING))
