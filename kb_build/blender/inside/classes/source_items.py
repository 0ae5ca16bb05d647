# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds all items that an enumeration of a class in Python may have, where a function puts them together.

RNA tells those that the function gives here and now: which graphics card there is decides, say. The source of the
function has them all, if it lists them.
"""

import ast
import inspect
import sys
import textwrap

import bpy

ADDING = frozenset({"append", "extend", "insert"})


class NotListedError(Exception):
    """Of items that are not written out."""


def classes():
    """The classes of settings that are registered from Python."""
    left = [bpy.types.PropertyGroup, bpy.types.AddonPreferences]
    while left:
        derived = left.pop().__subclasses__()
        yield from derived
        left += derived


def declared(cls):
    """(name, function that gives the items) of the enumerations that a class declares, as values or as texts."""
    names = getattr(sys.modules.get(cls.__module__), "__dict__", {})
    for name, value in inspect.get_annotations(cls).items():
        if isinstance(value, str):
            call = ast.parse(value, mode="eval").body
            keywords = call.keywords if isinstance(call, ast.Call) else ()
            items = next((keyword.value for keyword in keywords if keyword.arg == "items"), None)
            given = names.get(items.id) if isinstance(items, ast.Name) else None
        else:
            given = getattr(value, "keywords", {}).get("items")
        if inspect.isfunction(given):
            yield name, given


class Source:
    """The source of a function that gives items."""

    def __init__(self, function, outer=()):
        self.function = function
        self.outer = (*outer, function)
        self.tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
        self.seen = set()

    def items(self):
        """Identifier → name, of all that the function may return. Raises NotListedError."""
        found = {}
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Return) and node.value is not None:
                found |= self.of(node.value)
        return found

    def of(self, node):
        """The same of an expression that is a list of items."""
        match node:
            case ast.List(elts=parts) | ast.Tuple(elts=parts):
                return {key: name for part in parts for key, name in [self.item(part)]}
            case ast.BinOp(left=left, op=ast.Add(), right=right):
                return self.of(left) | self.of(right)
            case ast.IfExp(body=body, orelse=other):
                return self.of(body) | self.of(other)
            case ast.Name(id=name):
                return self.held(name)
            case ast.Call(func=ast.Name(id=name)):
                called = self.function.__globals__.get(name)
                if inspect.isfunction(called) and called not in self.outer:
                    return Source(called, self.outer).items()
        raise NotListedError

    def item(self, node):
        """(identifier, name) of an item that is written out."""
        match node:
            # A name may be marked for translators.
            case ast.Tuple(
                elts=[
                    ast.Constant(value=str(key)),
                    ast.Constant(value=name) | ast.Call(args=[ast.Constant(value=name)]),
                    _,
                    *_,
                ]
            ):
                return key, name
        raise NotListedError

    def held(self, name):
        """The items that a name of the function holds, whatever is put into it."""
        if name in self.seen:
            return {}
        self.seen.add(name)
        found, is_own = {}, False
        for node in ast.walk(self.tree):
            match node:
                case (
                    ast.Assign(targets=[ast.Name(id=own)], value=value)
                    | ast.AugAssign(target=ast.Name(id=own), value=value)
                ) if own == name:
                    is_own = True
                    found |= self.of(value)
                case ast.Call(func=ast.Attribute(value=ast.Name(id=own), attr=how), args=[*_, value]) if (
                    own == name and how in ADDING
                ):
                    found |= self.of(value) if how == "extend" else dict([self.item(value)])
                case ast.Name(id=own, ctx=ast.Store()) if own == name:
                    is_own = True
        if not is_own:
            raise NotListedError
        return found


def find_all(write):
    """One ``source_items`` record for each enumeration of which the source lists all items."""
    for cls in classes():
        for name, function in declared(cls):
            try:
                items = Source(function).items()
            except (NotListedError, OSError, SyntaxError):
                continue
            rows = [{"identifier": key, "name": text} for key, text in items.items()]
            write("source_items", path=f"bpy.types.{cls.bl_rna.identifier}.{name}", items=rows)
