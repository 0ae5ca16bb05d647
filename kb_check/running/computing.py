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
    found = {node.id for node in script.all(ast.Name)} | {node.name for node in script.all(ast.alias)}
    for node in script.all(ast.Attribute):
        if node.attr.startswith("__") or (isinstance(node.value, ast.Name) and node.value.id in _BUILTINS):
            found.add(node.attr)
    return frozenset(found & (RUNNING | STORING | NAMESPACES | CALLING))
