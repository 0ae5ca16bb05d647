"""Add-ons that scripts enable, or ask for, and that nobody can look into here: what they register may be anything.

Those are the ones that neither Blender brings nor the files that are checked together are. What those register that
Blender brings is known.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import ADDONS
from kb_build.flow.syntax.trees import walk
from kb_build.flow.values.types import UNKNOWN, literal_texts
from kb_build.symbols.api_names import TYPES as T

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

    from kb_build.flow.analysis import Analysis
    from kb_build.flow.blender.api import Api

# What enables an add-on → the argument that names it.
_ENABLING = {
    "addon_enable": "module",  # bpy.ops.preferences, and bpy.ops.wm before 2.80
    "package_install": "pkg_id",  # bpy.ops.extensions
    "enable": "module_name",  # addon_utils
}
_BY_PLACE = "addon_utils"
_OWN_NAMES = frozenset({"__name__", "__package__"})
# The classes that add-ons give properties to; a file's own data and Blender's settings are hardly among them.
_HOLDERS = tuple(
    f"{T}{name}"
    for name in (
        "ID",
        "Bone",
        "EditBone",
        "PoseBone",
        "ViewLayer",
        "Node",
        "NodeSocket",
        "Strip",
        "TimelineMarker",
    )
)


def may_register(api: Api, owner: str) -> bool:
    """Whether add-ons register things below a path: operators, classes, properties of a file's data."""
    return (
        owner == T.rstrip(".")
        or owner.startswith("bpy.ops")
        or any(api.descends(owner, cls) for cls in _HOLDERS)
    )


def foreign_addon(analyses: Collection[Analysis], own: Collection[str]) -> str:
    """The first foreign add-on that scripts enable or ask for; empty for none. ``own`` are the files' dotted names."""
    parts = {part for name in own for part in name.split(".")}
    for analysis in analyses:
        for name in _enabled(analysis):
            if name not in ADDONS and parts.isdisjoint(name.split(".")):
                return name
    return ""


def enables_any(analyses: Collection[Analysis]) -> bool:
    """Whether scripts enable an add-on by a name that they compute, other than their own."""
    return any(
        ast.unparse(argument) not in _OWN_NAMES
        and not any(literal_texts(analysis.types.get(argument, UNKNOWN)))
        for analysis in analyses
        for node in (walk(analysis.tree) if analysis.tree else ())
        if isinstance(node, ast.Call)
        for argument in _names_given(node)
    )


def brought_addons(analyses: Collection[Analysis]) -> frozenset[str]:
    """The add-ons that Blender brings which scripts enable, ask for, or take something from."""
    return frozenset(
        name
        for analysis in analyses
        for name in (*_enabled(analysis), *_imported(analysis))
        if name in ADDONS
    )


def _imported(analysis: Analysis) -> Iterator[str]:
    """The names of the packages that a script imports."""
    for node in walk(analysis.tree) if analysis.tree else ():
        match node:
            case ast.Import(names=aliases):
                yield from (alias.name.partition(".")[0] for alias in aliases)
            case ast.ImportFrom(module=str(module), level=0):
                yield module.partition(".")[0]
            case _:
                pass


def _enabled(analysis: Analysis) -> Iterator[str]:
    """The names of the add-ons that a script enables, or asks for, as far as they stand in it."""
    for node in walk(analysis.tree) if analysis.tree else ():
        match node:
            case (
                ast.Compare(left=asked, ops=[ast.In() | ast.NotIn()], comparators=[place])
                | ast.Call(func=ast.Attribute(value=place, attr="get" | "check"), args=[asked, *_])
            ) if _lists_addons(place):
                yield from literal_texts(analysis.types.get(asked, UNKNOWN))
            case ast.Call():
                for argument in _names_given(node):
                    yield from literal_texts(analysis.types.get(argument, UNKNOWN))
            case _:
                pass


def _names_given(call: ast.Call) -> list[ast.expr]:
    """What a call that enables an add-on is given for its name; none for other calls."""
    match call.func:
        case ast.Attribute(value=owner, attr=called) if called in _ENABLING:
            is_by_place = isinstance(owner, ast.Name) and owner.id == _BY_PLACE
        case _:
            return []
    if called == "enable" and not is_by_place:
        return []
    given = [keyword.value for keyword in call.keywords if keyword.arg == _ENABLING[called]]
    return [*given, *(call.args[:1] if is_by_place else ())]


def _lists_addons(node: ast.expr) -> bool:
    """Whether an expression is what knows the add-ons: ``preferences.addons``, its keys, or the module for them."""
    match node:
        case ast.Name(id=name):
            return name == _BY_PLACE
        case ast.Attribute(attr="addons"):
            return True
        case ast.Call(func=ast.Attribute(value=ast.Attribute(attr="addons"), attr="keys")):
            return True
        case _:
            return False
