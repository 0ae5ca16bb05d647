"""``register_module`` registered all the classes of a file; now they are listed."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import ClassObject
from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place

_REGISTER = "bpy.utils.register_module"
_UNREGISTER = "bpy.utils.unregister_module"


def _propose(place: Place) -> Iterator[Change]:
    classes = [
        node.name for node in place.script.tree.body
        if isinstance(node, ast.ClassDef) and any(_is_registered(place, base) for base in node.bases)
    ]  # fmt: skip
    relative = any(node.level for node in place.script.all(ast.ImportFrom))
    if not classes or relative:  # files beside it have classes, too
        return
    for row, symbol in place.gone(_REGISTER, _UNREGISTER):
        call = place.parent(row.node)
        if not isinstance(call, ast.Call) or not isinstance(row.node, ast.Attribute):
            continue
        statement = place.thrown_away(call)
        if statement is None or not place.has_line(statement):
            continue
        names = classes if symbol == _REGISTER else classes[::-1]
        listed = f"({', '.join(names)},)" if len(names) == 1 else f"({', '.join(names)})"
        function = f"{place.text(row.node.value)}.{row.node.attr.replace('_module', '_class')}"
        text = f"for cls in {listed}:\n{place.margin(statement)}    {function}(cls)"
        target = symbol.replace("_module", "_class")
        yield place.change(REWRITE.id, symbol, [place.write(statement, text)], targets=[target])


def _is_registered(place: Place, base: ast.expr) -> bool:
    kind = place.script.type_of(base)
    return isinstance(kind, ClassObject) and any(
        place.script.api.descends(kind.cls, f"bpy.types.{name}") for name in _REGISTERED
    )


_REGISTERED = ("Operator", "Panel", "Menu", "Header", "PropertyGroup", "AddonPreferences", "UIList", "Node", "NodeTree",
               "NodeSocket", "RenderEngine", "KeyingSetInfo", "Macro", "Gizmo", "GizmoGroup")  # fmt: skip
REWRITE = Rewrite("registered-module", _propose)
