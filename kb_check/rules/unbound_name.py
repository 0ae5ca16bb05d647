"""A name that nothing binds where it is read: Python raises NameError where it comes to it.

```python
import bpy

axis = Vector((0, 0, 1))  # reported: from mathutils import Vector
turn = math.radians(90)  # reported: import math
bpy.context.object.location = locaton  # reported


def make():
    cube = bpy.data.objects["Cube"]


def paint():
    cube.color = (1, 0, 0, 1)  # reported: `make` alone binds it
```

Not reported: scripts that import nothing, which are pieces of others; with ``from … import *``, ``exec``,
``globals()`` and the like; the names of Blender's console (``C``, ``D``); what stands in a ``try`` that catches the
NameError, or behind a condition that this Blender does not meet; annotations that Python does not read; in the
``__init__.py`` of a package its modules, whose names Python binds there when one is imported; placeholders of templates
(``__SIZE__``).
"""

from __future__ import annotations

import ast
import builtins
import re
from typing import TYPE_CHECKING

from kb_build.flow.state.source_files import keeps_annotations
from kb_build.flow.syntax.trees import walk
from kb_check.findings import Finding, Fix
from kb_check.names.usual_imports import import_of
from kb_check.rule import Rule
from kb_check.running.tried import is_tried
from kb_check.script import once_per_script
from kb_check.syntax.definitions import FUNCTIONS
from kb_check.syntax.literals import times_bound
from kb_check.syntax.scopes import read_out_of_scope
from kb_check.syntax.words import attributes
from kb_serve.recognise.likely.corrections import is_misspelling, nearest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script
    from kb_check.syntax.scopes import Holder

# What a module, a class body or the program that runs a script gives: Blender's text editor and console, IPython,
# gettext, a Python on Windows or one before 3.
_GIVEN = frozenset(dir(builtins)) | {
    "__annotations__", "__builtins__", "__cached__", "__class__", "__file__", "__module__", "__path__", "__qualname__",
    "_", "C", "D", "In", "Out", "WindowsError", "bpy", "display", "get_ipython",
    "basestring", "cmp", "execfile", "file", "long", "raw_input", "reduce", "reload", "unichr", "unicode", "xrange",
}  # fmt: skip
_PLACEHOLDER = re.compile(r"__[A-Z0-9_]+__")  # what a program fills in before a template runs
_ERROR = ("NameError",)
_ASKED = frozenset({"dir", "globals", "locals", "vars"})  # for the names that there are
# May bind names that are computed: to these, or to ``sys.modules[__name__]``.
_BINDING = frozenset({"exec", "__builtins__", *_ASKED})
_MODULES = "modules"


def _check(script: Script) -> Iterator[Finding]:
    if script.error or not _binds_openly(script):
        return
    unread: set[ast.expr] | None = None
    unbound: list[ast.Name] = []
    of_others = dict(read_out_of_scope(script.tree))
    for node in script.all(ast.Name):
        if not isinstance(node.ctx, ast.Load) or node.id in _GIVEN:
            continue
        if times_bound(script)[node.id] and node not in of_others:
            continue
        if _PLACEHOLDER.fullmatch(node.id) or node.id in _submodules(script):
            continue
        unread = _unread(script) | _asked_for(script) if unread is None else unread
        if node not in unread and script.type_of(node) is not None and not is_tried(script, node, _ERROR):
            unbound.append(node)
    yield from _findings(script, [node for node in unbound if node not in of_others])
    for node in unbound:
        if node in of_others:
            yield _bound_elsewhere(script, node, of_others[node])


def _bound_elsewhere(script: Script, node: ast.Name, holders: list[Holder]) -> Finding:
    """What is said of a name that only other functions and classes bind."""
    there = " and ".join(f"`{holder.name}`" for holder in holders[:2]) + (
        " alone" if len(holders) < 3 else " …"
    )
    way = (
        f"Read it of the class, `self.{node.id}`."
        if all(holder.is_class for holder in holders)
        else "Give it as an argument."
    )
    told = f"`{node.id}` is bound in {there}, and unknown here: NameError. {way}"
    return Finding(RULE.id, "error", script.span(node), told)


def _binds_openly(script: Script) -> bool:
    """Whether a script imports what it needs by itself, and binds no names that it computes.

    What only IPython understands is a ``pass`` among the statements of a notebook.
    """
    nodes = script.all(ast.Import, ast.ImportFrom)
    names = {alias.name for node in nodes for alias in node.names}
    if not names or names & {"*", "builtins", _MODULES} or _MODULES in attributes(script):
        return False
    asking = _asking(script)
    return not any(isinstance(statement, ast.Pass) for statement in script.tree.body) and all(
        node in asking for node in script.all(ast.Name) if node.id in _BINDING
    )


@once_per_script
def _asking(script: Script) -> dict[ast.expr, ast.expr]:
    """``locals`` in ``"name" in locals()`` → the name that is asked for."""
    found: dict[ast.expr, ast.expr] = {}
    for node in script.all(ast.Compare):
        match node:
            case ast.Compare(
                left=asked,
                ops=[ast.In() | ast.NotIn()],
                comparators=[ast.Call(func=ast.Name() as name, args=[])],
            ) if name.id in _ASKED:
                found[name] = asked
            case _:
                pass
    return found


def _asked_for(script: Script) -> set[ast.expr]:
    """The uses of names that the script asks for before."""
    asked = {node.value if isinstance(node, ast.Constant) else None for node in _asking(script).values()}
    return {node for node in script.all(ast.Name) if asked & {node.id, None}}


@once_per_script
def _submodules(script: Script) -> frozenset[str]:
    return script.package.submodules(script.path, script.tree)


def _unread(script: Script) -> set[ast.expr]:
    """The names in annotations that Python does not read: those of variables in functions, or all."""
    if keeps_annotations(script.tree):
        annotations = [node.annotation for node in script.all(ast.AnnAssign, ast.arg)]
        annotations += [node.returns for node in script.all(*FUNCTIONS)]
    else:
        inside = (part for function in script.all(*FUNCTIONS) for part in walk(function))
        annotations = [part.annotation for part in inside if isinstance(part, ast.AnnAssign)]
    return {
        part
        for node in annotations
        if node is not None
        for part in ast.walk(node)
        if isinstance(part, ast.Name)
    }


def _findings(script: Script, nodes: list[ast.Name]) -> Iterator[Finding]:
    taken = {
        name: import_of(script, name, _read_from(script).get(name, set()))
        for name in dict.fromkeys(node.id for node in nodes)
    }
    for node in nodes:
        if (found := taken[node.id]) is not None:
            beside = [name for name, other in taken.items() if other and other.module == found.module]
            told = f"`{node.id}` is not imported: NameError. Write `{found.line([node.id])}`."
            fix = _import(script, node, found.line(sorted(beside)), sure=found.is_sure)
            yield Finding(RULE.id, "error", script.span(node), told, fix=fix)
            continue
        closest = [name for name, _ in nearest(node.id, times_bound(script))]
        misspelt = [f"`{name}`" for name in closest if is_misspelling(node.id, name)]
        told = f"Nothing in this script is called `{node.id}`: NameError."
        told += f" Closest: {', '.join(misspelt)}." if misspelt else ""
        yield Finding(RULE.id, "error", script.span(node), told)


@once_per_script
def _read_from(script: Script) -> dict[str, set[str]]:
    """Name → the attributes that are read from it."""
    found: dict[str, set[str]] = {}
    for node in script.all(ast.Attribute):
        if isinstance(node.value, ast.Name):
            found.setdefault(node.value.id, set()).add(node.attr)
    return found


def _import(script: Script, node: ast.Name, line: str, *, sure: bool) -> Fix | None:
    """Writes the line before the first import of the module, if that stands before the name."""
    for statement in script.tree.body:
        if isinstance(statement, ast.Import) or (
            isinstance(statement, ast.ImportFrom) and statement.module != "__future__"
        ):
            edit = script.line_before(statement, line)
            is_before = statement.lineno < node.lineno
            return Fix("Import it", (edit,), sure) if edit and is_before else None
    return None


RULE = Rule("unbound-name", "error", "A name that nothing binds", _check)
