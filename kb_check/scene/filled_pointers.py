"""What operators of rigid bodies fill on the active object, and which objects were that when they ran."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OBJECT
from kb_build.symbols.flags import fillers
from kb_check.calls.resolved import callee_path, member_path
from kb_check.modes.keeping import is_harmless, run_in
from kb_check.scene.held_objects import Held, HeldObjects

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

# Others of this module work on all that is selected, or hand on what one object has.
_MODULE = "bpy.ops.rigidbody."
FILLING = re.compile(rf"{re.escape(_MODULE)}(object|constraint)_add")


@dataclass(slots=True)
class FilledPointers:
    """Which objects have become rigid bodies, or joints of them, in a body of statements, one by one."""

    script: Script
    objects: HeldObjects
    _filled: dict[str, set[Held]] = field(default_factory=dict[str, set[Held]])
    _is_open: bool = False  # what is not known may have made some such

    def empty(self, statement: ast.stmt) -> Iterator[tuple[ast.expr, ast.Attribute, str]]:
        """What a statement reads from a pointer that is None on its object: the place, the pointer, and the operator
        that has filled it on others.
        """
        for node in run_in(statement):
            match node:
                case ast.Attribute(value=ast.Attribute(value=owner) as pointer):
                    path = _filling(self.script, member_path(self.script, pointer))
                    held = self.objects.thing(owner)
                    if path in self._filled and not self._is_open and held and self._lacks(held, path):
                        yield node, pointer, path
                case _:
                    pass

    def pass_by(self, statement: ast.stmt) -> None:
        """Goes on to what is known behind a statement, and behind what it makes the objects."""
        active = self.objects.active
        alone = statement.value if isinstance(statement, ast.Expr) else None
        for node in run_in(statement):
            if not isinstance(node, ast.Call):
                continue
            path = callee_path(self.script, node)
            if FILLING.fullmatch(path) and node is alone and active:
                self._filled.setdefault(path, set()).add(active)
            elif path.startswith(_MODULE) or not (path or is_harmless(self.script, node)):
                self._is_open = True
        self.objects.pass_by(statement)

    def _lacks(self, held: Held, path: str) -> bool:
        return held.is_new and not held.is_copy and held not in self._filled[path]


def _filling(script: Script, pointer: str) -> str:
    """The operator that fills a pointer of the active object; empty where no such operator does."""
    symbol = script.api.symbols.symbol(pointer) if pointer.startswith(f"{OBJECT}.") else None
    path = fillers(symbol)[-1].partition("(")[0] if symbol and fillers(symbol) else ""
    return path if FILLING.fullmatch(path) else ""
