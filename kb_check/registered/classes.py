"""The classes of a script that Blender registers: what each derives from, and what its body gives it."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_build.flow.values.types import ClassObject
from kb_check.registered.blender_types import TYPES, callbacks, needs
from kb_check.running.computing import NAMESPACES, RUNNING, STORING, computing
from kb_check.script import once_per_script
from kb_check.syntax.definitions import FunctionDefinition
from kb_check.syntax.literals import bound_names, times_bound

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from kb_build.symbols.records import Symbol
    from kb_check.script import Script

# Name → the one statement of a body that gives it; None where several do, or one that may not be run.
Body = dict[str, ast.stmt | None]

_DEEPEST = 20
_REGISTERING = frozenset({"register_class", "register_classes_factory"})
# The nodes that tell what a script registers.
_TELLING = (ast.Call, ast.For, ast.Attribute, ast.FunctionDef, ast.Assign)
# Classes are Python's: what holds names gives attributes to them as well.
_COMPUTING = RUNNING | STORING | NAMESPACES
# Bases in Python that give what their reference lists, and nothing more.
_HELPERS = "bpy_extras."


@dataclass(frozen=True, slots=True)
class OwnClass:
    """A class of the script that derives from a type which Blender registers.

    ``path`` is that type. ``bodies`` are its own body and those that it inherits from, in the order in which Python
    looks, ``family`` the script's classes that they are of; ``is_closed`` says that there are no others. ``is_final``:
    the script derives no class from it, or registers it all the same; ``is_registered``: the script surely does.
    """

    node: ast.ClassDef
    path: str
    bodies: tuple[Body, ...]
    family: tuple[ast.ClassDef, ...]
    is_closed: bool
    is_final: bool
    is_registered: bool

    def given(self, name: str) -> ast.stmt | None:
        """The statement that surely gives an attribute or a function; None for none, and where that is not known."""
        for body in self.bodies if self.is_closed else self.bodies[:1]:
            if name in body:
                return body[name]
        return None

    def lacks(self, name: str) -> bool:
        """Whether nothing gives an attribute or a function."""
        return self.is_closed and not any(name in body for body in self.bodies)

    def callbacks(self, script: Script) -> Iterator[tuple[Symbol, FunctionDefinition]]:
        """The functions that Blender calls, as it knows them and as they are surely defined."""
        for symbol in callbacks(self.path, script.api) if self.is_final else ():
            if isinstance(function := self.given(symbol.name), FunctionDefinition):
                yield symbol, function

    def attributes(self) -> Iterator[tuple[str, ast.expr]]:
        """The attributes that are surely given, each with its value."""
        for name in self.names():
            if (value := self.value(name)) is not None:
                yield name, value

    def value(self, name: str) -> ast.expr | None:
        """The value that an attribute is surely given."""
        statement = self.given(name)
        return statement.value if isinstance(statement, (ast.Assign, ast.AnnAssign)) else None

    def names(self) -> list[str]:
        """The names of all that the bodies give, first those of its own."""
        return list({name: None for body in self.bodies for name in body})

    @property
    def label(self) -> str:
        """The type in words: ``an Operator``."""
        name = self.path.rpartition(".")[2]
        return f"{'an' if name[0] in 'AEIO' else 'a'} `{name}`"


@once_per_script
def own_classes(script: Script) -> list[OwnClass]:
    """The classes that derive from a type which Blender registers, where nothing changes them out of sight."""
    nodes = script.all(ast.ClassDef)
    if not nodes:
        return []
    names = _class_names(script, nodes)
    parents = {base.id for node in nodes for base in node.bases if isinstance(base, ast.Name)}
    registered = _registered_names(script)
    found: list[OwnClass] = []
    for node in nodes:
        if node.decorator_list or node.keywords:
            continue
        family = _Family(script, names)
        family.add(node)
        is_registered = node.name in registered and names.get(node.name) is node
        if family.path:
            found.append(
                OwnClass(
                    node, family.path, tuple(reversed(family.bodies)), tuple(reversed(family.nodes)), family.is_closed,
                    is_registered or node.name not in parents, is_registered,
                )
            )  # fmt: skip
    return found


@once_per_script
def plain_classes(script: Script) -> frozenset[str]:
    """The names of the script's classes that derive from nothing but each other, and are bound once."""
    names = _class_names(script, script.all(ast.ClassDef))
    plain: set[str] = set()
    for name, node in names.items():  # in the order in which they stand, as they are made
        bases = {base.id if isinstance(base, ast.Name) else "" for base in node.bases}
        if bases <= {"object", *plain} and not node.decorator_list and not node.keywords:
            plain.add(name)
    return frozenset(plain)


class _Family:
    """A class and what it derives from. ``bodies`` begin with the last one in which Python looks."""

    def __init__(self, script: Script, names: Mapping[str, ast.ClassDef]) -> None:
        self._script = script
        self._names = names
        self._seen: set[ast.ClassDef] = set()
        self.path = ""
        self.bodies: list[Body] = []
        self.nodes: list[ast.ClassDef] = []
        self.is_closed = True

    def add(self, node: ast.ClassDef, depth: int = 0) -> None:
        """Adds a class behind its bases. Of several types the first is the one that counts."""
        self._seen.add(node)
        for base in reversed(node.bases):
            kind = self._script.type_of(base)
            parent = self._names.get(base.id) if isinstance(base, ast.Name) else None
            if isinstance(kind, ClassObject):
                self._add_api_class(kind.cls)
            elif parent is None or depth > _DEEPEST or parent.keywords or parent.decorator_list:
                self.is_closed = self.is_closed and isinstance(base, ast.Name) and base.id == "object"
            elif parent not in self._seen:
                self.add(parent, depth + 1)
        self.nodes.append(node)
        self.bodies.append(members_of(node))

    def _add_api_class(self, cls: str) -> None:
        api = self._script.api
        if cls.startswith(_HELPERS):
            self.bodies.append(dict.fromkeys(api.own(cls)))
            return
        self.path = next((path for path in api.lineage(cls) if path in TYPES), self.path)
        self.is_closed = self.is_closed and cls in TYPES


def members_of(node: ast.ClassDef) -> Body:
    """What the body of a class gives it."""
    found: Body = {}
    for statement in node.body:
        match statement:
            case ast.Expr():
                continue
            case (
                ast.Assign(targets=[ast.Name(id=name)])
                | ast.AnnAssign(target=ast.Name(id=name), value=ast.expr())
            ):
                one: ast.stmt | None = statement
            case ast.AnnAssign():
                continue
            case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name):
                one = statement
            case _:
                found.update((name, None) for part in walk(statement) for name in bound_names(part))
                continue
        found[name] = None if name in found else one
    return found


def _class_names(script: Script, nodes: list[ast.ClassDef]) -> dict[str, ast.ClassDef]:
    """Name → class, of those that are bound nowhere else in the script."""
    names = {node.name: node for node in nodes}
    times = times_bound(script)
    return {name: node for name, node in names.items() if times[name] == 1}


def _registered_names(script: Script) -> frozenset[str]:
    """The names of the classes that the script registers, one by one or out of a list that it goes through.

    What attributes a script sets afterwards, or by names that it computes, is out of sight: then it registers none.
    """
    if not _COMPUTING.isdisjoint(computing(script)):
        return frozenset()
    demanded = {name for path in TYPES for name in needs(path, script.api)}
    lists: dict[str, ast.expr] = {}
    given: list[ast.expr] = []
    loops: list[ast.For] = []
    for node in script.all(*_TELLING):
        match node:
            case ast.Call(func=ast.Name(id=called) | ast.Attribute(attr=called), args=[one]) if (
                called in _REGISTERING
            ):
                given.append(one)
            case ast.For():
                loops.append(node)
            case ast.Attribute(attr=name, ctx=ast.Store()) if name in demanded:
                return frozenset()
            case ast.FunctionDef(name="__init_subclass__"):
                return frozenset()
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Tuple() | ast.List() as value):
                lists[name] = value
            case _:
                pass
    names = {one.id for one in given if isinstance(one, ast.Name)}
    given += [loop.iter for loop in loops if isinstance(loop.target, ast.Name) and loop.target.id in names]
    for one in given:
        whole = lists.get(one.id) if isinstance(one, ast.Name) else one
        if isinstance(whole, (ast.Tuple, ast.List)):
            names.update(part.id for part in whole.elts if isinstance(part, ast.Name))
    return frozenset(names)
