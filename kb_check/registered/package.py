"""What the files of one add-on register, for each of them to use: operators, classes, properties of other classes."""

from __future__ import annotations

import ast
import os
from functools import cached_property
from pathlib import Path, PurePath
from typing import TYPE_CHECKING

from kb_build.flow.state.core import ANY
from kb_build.flow.state.source_files import module_name
from kb_build.flow.syntax.trees import walk
from kb_check.registered.foreign_addons import brought_addons, enables_any, foreign_addon
from kb_check.registered.package_roots import package_root
from kb_check.syntax.given_names import given_names

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_build.flow.analysis import Analysis
    from kb_build.flow.blender.api import Api


class Package:
    """What a group of files registers, for one Blender's classes."""

    def __init__(self, api: Api) -> None:
        self._api = api
        self._operators: set[str] = set()  # paths below bpy.ops, and their modules
        self._types: set[str] = set()  # names below bpy.types
        self._possible: set[str] = set()
        self._classes: dict[str, set[str]] = {}  # property → the classes that have it
        self._analyses: list[Analysis] = []
        self._modules: list[str] = []  # their dotted names; empty where there is no path

    def add(self, analysis: Analysis, possible: Iterable[str] = (), path: str = "") -> None:
        """Adds what a file registers. ``possible`` are names that a part which cannot be read may register, ``path``
        is its place, as :func:`paths_in_package` has it.
        """
        self._analyses.append(analysis)
        self._modules.append(module_name(path)[0])
        self._operators |= analysis.own_operators
        self._types |= analysis.own_types
        self._possible.update(possible)
        for cls, name in analysis.registered:
            self._classes.setdefault(name, set()).add(cls)

    def has(self, owners: Iterable[str], name: str, *, computed: bool = True) -> bool:
        """Whether a file registers that name for one of the owners, for their bases, or for what derives from them.

        ``computed``: a name that a file puts together may be any.
        """
        if name in self._operators or name in self._possible:
            return True
        holders = self._classes.get(name, set()) | (self._classes.get(ANY, set()) if computed else set())
        return any(self._gives(owner, name, holders, computed=computed) for owner in owners)

    def is_named_beside(self, name: str, tree: ast.Module) -> bool:
        """Whether another file than that of the tree names something so."""
        others = (one.tree for one in self._analyses if one.tree is not None and one.tree is not tree)
        return any(
            name in (getattr(node, "id", None), getattr(node, "attr", None), getattr(node, "name", None))
            for other in others
            for node in walk(other)
        )

    def gives(self, name: str) -> bool:
        """Whether a file gives something of its own a name. Asked once all files were added."""
        return name in self._given

    @cached_property
    def _given(self) -> frozenset[str]:
        trees = (one.tree for one in self._analyses if one.tree is not None)
        return frozenset(name for tree in trees for name in given_names(tree))

    def submodules(self, path: str, tree: ast.Module) -> frozenset[str]:
        """The modules that may be bound in a file by being imported anywhere, ``from .sub import x``: those right below
        it, if it is an ``__init__.py``. One without a path (see :meth:`add`) may be.
        """
        package, is_package = module_name(path)
        if path and not is_package:
            return frozenset()
        within = f"{package}."
        found = {
            name.removeprefix(within) for name in self._modules if is_package and name.startswith(within)
        }
        for node in walk(tree):
            if isinstance(node, ast.ImportFrom) and node.level == 1 and node.module:
                found.add(node.module)
        return frozenset(name.partition(".")[0] for name in found)

    @cached_property
    def identifiers(self) -> frozenset[str]:
        """What the classes of all files call themselves: values of the enumerations that list such classes. Asked for
        once all files were added.
        """
        trees = (one.tree for one in self._analyses if one.tree is not None)
        return frozenset(
            node.value.value
            for tree in trees
            for node in walk(tree)
            if isinstance(node, ast.Assign)
            and any(isinstance(target, ast.Name) and target.id == "bl_idname" for target in node.targets)
            and isinstance(node.value, ast.Constant)
            and isinstance(node.value.value, str)
        )

    @cached_property
    def foreign_addon(self) -> str:
        """An add-on that a file enables and that is not among what is known here; empty for none. Asked for once all
        files were added.
        """
        return foreign_addon(self._analyses, self._modules)

    @cached_property
    def enables_any_addon(self) -> bool:
        """Whether a file enables an add-on by a name that it computes. Asked for once all files were added."""
        return enables_any(self._analyses)

    @cached_property
    def brought_addons(self) -> frozenset[str]:
        """The add-ons which Blender brings that a file enables or imports. Asked for once all files were added."""
        return brought_addons(self._analyses)

    def _gives(self, owner: str, name: str, holders: Iterable[str], *, computed: bool) -> bool:
        if owner.startswith("bpy.ops"):
            return (computed and ANY in self._operators) or f"{owner}.{name}" in self._operators
        if owner == "bpy.types":
            return name in self._types or (computed and ANY in self._types)
        return any(
            cls == ANY or self._api.descends(owner, cls) or self._api.descends(cls, owner) for cls in holders
        )


def paths_in_package(names: Iterable[str]) -> dict[str, str]:
    """Name of a file → its path as other modules import it: from the folder that holds its package on; of files that
    belong to none, from the folder around all of them on.
    """
    places = {name: PurePath(os.path.realpath(name)) for name in names}
    top = PurePath(os.path.commonpath([place.parent for place in places.values()])).parent
    paths: dict[str, str] = {}
    for name, place in places.items():
        root = package_root(Path(place.parent))
        paths[name] = place.relative_to(root.parent if root else top).as_posix()
    if len(set(paths.values())) == len(paths):
        return paths
    return {name: place.relative_to(top).as_posix() for name, place in places.items()}
