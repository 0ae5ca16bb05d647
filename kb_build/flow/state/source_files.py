"""The files that are analysed together, and the names by which they import each other."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import API_MODULES, DISCRIMINANTS
from kb_build.flow.state.scopes import Scope
from kb_build.flow.syntax.shared_names import SharedNames, shared_names
from kb_build.flow.syntax.trees import walk
from kb_build.flow.values.types import Carried, Readings, Uses

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from kb_build.flow.values.types import Resolution, Type

# The part of a file's steps that may be spent on reading parts of it again, and no more than so many.
_OF_ALL_STEPS, _MOST_AGAIN = 8, 10_000


@dataclass
class SourceFile:
    """One file: its module's dotted name, its text as a tree (None with an ``error``), and what was found in it.

    ``keeps_annotations``: Python leaves its annotations unread. ``steps_left`` is what may still be spent on reading
    it, ``complete`` whether that was enough, ``readings`` what its module took from definitions, ``doubted`` the
    statements and parts of them that may all be for another Blender, ``left_out`` those that a run of this one does not
    come to, ``unread`` what was too deep inside to be read at some time. ``quoted`` are its
    quoted annotations with what they say.

    ``trial_steps`` is what may be spent on reading parts of it again, for one call or one turn of a loop alone;
    ``uses`` and ``carried`` are those of its module (see :class:`definitions.FunctionDefinition`), ``carried_rows``
    all that was found in it so, and that surely is.
    """

    name: str
    is_package: bool
    tree: ast.Module | None
    steps_left: int
    error: SyntaxError | None = None
    keeps_annotations: bool = False
    module: Scope = field(default_factory=Scope)
    types: dict[ast.expr, Type] = field(default_factory=dict["ast.expr", "Type"])
    resolutions: dict[ast.AST, Resolution] = field(default_factory=dict["ast.AST", "Resolution"])
    readings: Readings = field(default_factory=Readings)
    doubted: set[ast.stmt | ast.expr] = field(default_factory=set["ast.stmt | ast.expr"])
    left_out: set[ast.stmt | ast.expr] = field(default_factory=set["ast.stmt | ast.expr"])
    unread: set[ast.AST] = field(default_factory=set["ast.AST"])
    quoted: dict[ast.Constant, ast.expr | None] = field(
        default_factory=dict["ast.Constant", "ast.expr | None"]
    )
    uses: Uses = field(default_factory=Uses)
    carried: Carried = field(default_factory=Carried)
    carried_rows: list[Resolution] = field(default_factory=list["Resolution"])
    trial_steps: int = field(init=False)
    started: bool = False
    complete: bool = True

    def __post_init__(self) -> None:
        self.trial_steps = min(self.steps_left // _OF_ALL_STEPS, _MOST_AGAIN)

    @cached_property
    def nodes(self) -> Sequence[ast.AST]:
        """All nodes of its tree."""
        return [*walk(self.tree)] if self.tree else []

    @cached_property
    def shared_names(self) -> Mapping[ast.AST, SharedNames]:
        """Module, function or lambda → the names there that functions share."""
        return shared_names(self.tree) if self.tree else {}

    @cached_property
    def computes_attributes(self) -> bool:
        """Whether it may set attributes of its own things whose names it does not write down."""
        return any(map(_computes_attributes, self.nodes))

    @cached_property
    def is_without_blender(self) -> bool:
        """Whether it imports something, and no module that Blender brings: what it calls a scene may be any. A star may
        bring one.
        """
        imported: set[str] = set()
        for node in self.nodes:
            if isinstance(node, ast.Import):
                imported.update(alias.name.partition(".")[0] for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                if any(alias.name == "*" for alias in node.names):
                    return False
                imported.add("." if node.level else (node.module or "").partition(".")[0])
        return bool(imported) and imported.isdisjoint(API_MODULES)

    @cached_property
    def moves_imports(self) -> bool:
        """Whether it may change where modules are found: it names ``sys.path``, or ``sys.modules``."""
        return any(
            isinstance(node, ast.Attribute)
            and node.attr in {"path", "modules"}
            and isinstance(node.value, ast.Name)
            and node.value.id == "sys"
            for node in self.nodes
        )

    @property
    def is_read(self) -> bool:
        """Whether all of it was read that a run may come to."""
        return self.complete and self.unread <= self.types.keys()

    @cached_property
    def given_names(self) -> Mapping[str, Sequence[ast.expr | None]]:
        """The texts that it may give as names, all that it has for more than to look an item up: with the expressions
        for the things that are given them, None for what is unknown.
        """
        sought = {key for node in self.nodes for key in _sought(node)}
        things = {name: thing for node in self.nodes for name, thing in _naming(node)}
        found: dict[str, list[ast.expr | None]] = {}
        for node in self.nodes:
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and node not in sought:
                found.setdefault(node.value, []).append(things.get(node))
        return found

    @cached_property
    def sets_types(self) -> bool:
        """Whether it may set what a thing is of: an attribute that tells classes apart, or a computed one."""
        return any(map(_sets_type, self.nodes))

    def imported(self, level: int, module: str) -> str:
        """The dotted name of what ``from ..module import`` means here, with ``level`` dots; empty for nothing."""
        if not level:
            return module
        parts = self.name.split(".")
        parts = parts[: len(parts) - level + self.is_package]
        return ".".join([*parts, module] if module else parts) if parts else ""


def _computes_attributes(node: ast.AST) -> bool:
    match node:
        case ast.Attribute(attr="__dict__") | ast.Name(id="vars" | "globals" | "locals"):
            return True
        case ast.Call(func=ast.Name(id="setattr"), args=[_, name, _]):
            return not isinstance(name, ast.Constant)
        case _:
            return False


def _sought(node: ast.AST) -> list[ast.expr]:
    """The keys by which an expression looks items up."""
    match node:
        case ast.Subscript():
            return [node.slice]
        case ast.Call(func=ast.Attribute(attr="get" | "find")):
            return node.args[:1]
        case ast.Compare(ops=[ast.In() | ast.NotIn()]):
            return [node.left]
        case _:
            return []


def _naming(node: ast.AST) -> Iterator[tuple[ast.expr, ast.expr]]:
    """(name, thing) where a statement or a call gives a thing its name."""
    match node:
        case ast.Call(func=ast.Attribute(attr="new")):
            yield from ((name, node) for name in node.args[:1])
            yield from ((keyword.value, node) for keyword in node.keywords if keyword.arg == "name")
        case ast.Assign(targets=[ast.Attribute(attr="name", value=thing)], value=name):
            yield name, thing
        case _:
            pass


def _sets_type(node: ast.AST) -> bool:
    match node:
        case ast.Attribute(attr=name, ctx=ast.Store()):
            return name in DISCRIMINANTS
        case ast.Call(func=ast.Name(id="setattr"), args=[_, name, _]):
            return not isinstance(name, ast.Constant) or name.value in DISCRIMINANTS
        case _:
            return False


def keeps_annotations(tree: ast.Module) -> bool:
    """Whether a file begins with ``from __future__ import annotations``."""
    return any(
        isinstance(statement, ast.ImportFrom)
        and statement.module == "__future__"
        and any(alias.name == "annotations" for alias in statement.names)
        for statement in tree.body
    )


def module_name(path: str) -> tuple[str, bool]:
    """``addon/ui/__init__.py`` → (``addon.ui``, True): a file's dotted name, and whether it is a package's."""
    parts = PurePosixPath(path.removesuffix(".py")).parts
    is_package = bool(parts) and parts[-1] == "__init__"
    return ".".join(parts[:-1] if is_package else parts), is_package
