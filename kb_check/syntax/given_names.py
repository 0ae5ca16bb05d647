"""The names that a file gives to what is its own."""

from __future__ import annotations

import ast

from kb_build.flow.syntax.trees import walk


def given_names(tree: ast.Module) -> frozenset[str]:
    """The names that a file gives to its functions and variables, to its classes and their instances."""
    found: set[str] = set()
    for node in walk(tree):
        match node:
            case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name) | ast.ClassDef(name=name):
                found.add(name)
            case ast.Name(id=name, ctx=ast.Store()):
                found.add(name)
            case ast.Attribute(value=ast.Name(id="self"), attr=name, ctx=ast.Store()):
                found.add(name)
            case _:
                pass
    return frozenset(found)
