"""Properties of classes that are registered are annotations: ``size: FloatProperty()``."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import ClassObject
from kb_build.symbols.api_names import TYPES
from kb_check.findings import Edit
from kb_check.migrate.change import Change
from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.place import Place

_SINCE = (2, 80)
_SOURCE = "release notes 2.80: Python API"
_REASON = "Properties of registered classes are annotations; what is assigned is not registered."
_PROPS = "bpy.props."


def _propose(place: Place) -> Iterator[Change]:
    if place.target < _SINCE:
        return
    classes = place.script.all(ast.ClassDef)
    registered = _registered(place, classes)
    calls = {row.node: row for row in place.script.resolutions("call")}
    for cls in classes:
        if cls.name not in registered:
            continue
        for statement in cls.body:
            if (
                isinstance(statement, ast.Assign)
                and len(statement.targets) == 1
                and isinstance(name := statement.targets[0], ast.Name)
                and (row := calls.get(statement.value)) is not None
                and row.symbols
                and all(symbol.startswith(_PROPS) for symbol in row.symbols)
            ):
                span, text = place.between(name, statement.value)
                if text.strip() == "=":
                    yield Change(REWRITE.id, (Edit(span, ": "),), _REASON, _SOURCE, _SINCE)


def _registered(place: Place, classes: list[ast.ClassDef]) -> set[str]:
    """The names of the classes that derive from one of Blender's, and of those that are mixed into them."""
    bases = {cls.name: cls.bases for cls in classes}
    found = {cls.name for cls in classes if any(_is_blenders(place, base) for base in cls.bases)}
    for _ in range(len(classes)):
        more = {name for name, held in bases.items() if any(_name(base) in found for base in held)}
        more |= {_name(base) for name in found | more for base in bases.get(name, ())} & set(bases)
        if more <= found:
            break
        found |= more
    return found


def _is_blenders(place: Place, base: ast.expr) -> bool:
    kind = place.script.type_of(base)
    return isinstance(kind, ClassObject) and kind.cls.startswith(TYPES)


def _name(node: ast.expr) -> str:
    return node.id if isinstance(node, ast.Name) else ""


REWRITE = Rewrite("annotated-property", _propose)
