"""Finds the functions of a script that draw, and the polls under which Blender calls them."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import children
from kb_build.panels.drawing import Drawing
from kb_build.panels.expressions import Script
from kb_build.panels.formulas import all_of
from kb_build.panels.layout_calls import OFFERS, SHOWS

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from kb_build.flow.analysis import Analysis
    from kb_build.flow.blender.symbols import Symbols
    from kb_build.panels.drawing import Place
    from kb_build.panels.formulas import Formula


def places_in(analysis: Analysis, symbols: Symbols) -> list[Place]:
    """Where a script shows properties."""
    tree = analysis.tree
    if tree is None:
        return []
    functions = _showing(tree)
    if not functions:
        return []
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    script = Script(
        analysis,
        symbols,
        {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)},
        {name: _methods(name, classes) for name in classes},
    )
    inherited = {base for cls in classes.values() for base in _bases(cls)}
    places: list[Place] = []
    for function, cls in functions:
        name = cls.name if cls is not None and cls.name in classes else ""
        # A class that others derive from may be drawn under their polls.
        is_panel = name and function.name.startswith("draw") and name not in inherited
        polls = _polls(name, script, classes) if is_panel else ()
        try:
            places += Drawing(script, name).read(function, all_of(*polls))
        except RecursionError:
            continue  # nobody writes panels like that by hand
    return places


def _showing(tree: ast.Module) -> list[tuple[ast.FunctionDef, ast.ClassDef | None]]:
    """The functions that show properties, with the classes whose methods they are."""
    found: dict[ast.FunctionDef, ast.ClassDef | None] = {}
    queue: list[tuple[ast.AST, ast.FunctionDef | None, ast.ClassDef | None]] = [(tree, None, None)]
    while queue:
        node, function, cls = queue.pop()
        if isinstance(node, ast.Call):
            if (
                function is not None
                and isinstance(node.func, ast.Attribute)
                and node.func.attr in SHOWS | OFFERS
            ):
                found.setdefault(function, cls)
        elif isinstance(node, ast.FunctionDef):
            function, cls = node, cls if function is None else None
        elif isinstance(node, ast.ClassDef):
            function, cls = None, node
        queue += [(child, function, cls) for child in children(node)]
    return [*found.items()]


def _bases(cls: ast.ClassDef) -> list[str]:
    return [base.id for base in cls.bases if isinstance(base, ast.Name)]


def _methods(name: str, classes: Mapping[str, ast.ClassDef], depth: int = 8) -> dict[str, ast.FunctionDef]:
    """A class's functions by name, those of its bases in the script included."""
    if name not in classes or not depth:
        return {}
    found: dict[str, ast.FunctionDef] = {}
    for base in reversed(_bases(classes[name])):
        found |= _methods(base, classes, depth - 1)
    return found | {node.name: node for node in classes[name].body if isinstance(node, ast.FunctionDef)}


def _polls(
    name: str, script: Script, classes: Mapping[str, ast.ClassDef], depth: int = 4
) -> Iterator[Formula]:
    """The conditions under which Blender draws a panel: its own, and those of the panels that it lies in."""
    if poll := script.methods[name].get("poll"):
        yield Drawing(script, name).returned(poll, {})
    for node in classes[name].body:
        match node:
            case ast.Assign(targets=[ast.Name(id="bl_parent_id")], value=ast.Constant(value=str(parent))):
                if parent in classes and depth:
                    yield from _polls(parent, script, classes, depth - 1)
            case _:
                pass
