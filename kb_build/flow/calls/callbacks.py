"""Passes to functions of the script what Blender calls them with, where they are given to it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.flow.calls.script_calls import ScriptCalls
from kb_build.flow.values.types import (
    UNKNOWN,
    ClassObject,
    Instance,
    LocalClass,
    LocalFunction,
    LocalInstance,
    Tuple,
    Type,
    instance_of,
)
from kb_build.symbols.api_names import HANDLERS
from kb_build.symbols.api_names import TYPES as T

if TYPE_CHECKING:
    import ast
    from collections.abc import Sequence as Rows

    from kb_build.flow.calls.read_calls import Keywords, ReadCall

_CONTEXT = Instance(f"{T}Context")
# Method → which argument draws, by its place and its name, and the class of what it draws.
_DRAWING = {
    f"{T}WindowManager.popup_menu": (0, "draw_func", f"{T}UIPopupMenu"),
    f"{T}WindowManager.popup_menu_pie": (1, "draw_func", f"{T}UIPieMenu"),
    f"{T}WindowManager.popover": (0, "draw_func", f"{T}UIPopover"),
}
_DRAW_HANDLER = ".draw_handler_add"
_OF_SCENE = ("depsgraph_update_", "frame_change_", "render_")
_WITH_GRAPH = frozenset({"depsgraph_update_post", "frame_change_post"})  # others are given None in its place
_OF_TEXT = frozenset({"render_stats"})


class Callbacks(ScriptCalls):
    """Knows what callbacks receive."""

    def given_to_method(self, path: str, call: ReadCall) -> None:
        """A function that a method of Blender's calls: to draw a menu, or a region."""
        if path in _DRAWING:
            place, name, cls = _DRAWING[path]
            self._called_with(call.keywords.get(name, call.argument(place)), (Instance(cls), _CONTEXT))
        elif path.endswith(_DRAW_HANDLER) and isinstance(given := call.argument(1), Tuple):
            self._called_with(call.argument(0), given.items)

    def given_to_handlers(self, holder: ast.expr, function: Type) -> None:
        """A function that is added to one of Blender's lists of handlers."""
        row = self.here.resolutions.get(holder) if isinstance(function, LocalFunction) else None
        path = row.symbols[0] if row and row.sure and len(row.symbols) == 1 else ""
        name = path.removeprefix(HANDLERS)
        if not path.startswith(HANDLERS) or not name.startswith(_OF_SCENE) or name in _OF_TEXT:
            return
        graph = Instance(f"{T}Depsgraph") if name in _WITH_GRAPH else UNKNOWN
        self._called_with(function, (Instance(f"{T}Scene"), graph), fewest=1)

    def given_to_property(self, keywords: Keywords) -> None:
        """The functions that a property is declared with: ``self`` is of the class that it is declared in."""
        scope = self.here.scope
        owner = LocalInstance(scope.cls) if scope.is_class and scope.cls is not None else UNKNOWN
        for name in ("update", "items"):
            self._called_with(keywords.get(name, UNKNOWN), (owner, _CONTEXT))
        of = keywords.get("type", UNKNOWN)
        if isinstance(of, (ClassObject, LocalClass)):
            self._called_with(keywords.get("poll", UNKNOWN), (owner, instance_of(of)))

    def _called_with(self, function: Type, values: Rows[Type], fewest: int | None = None) -> None:
        """Passes on what a function gets: all of it, or the first ``fewest`` at least where Blender looks how many it
        takes. What takes another number is never called, and which of its parameters was forgotten is not known.
        """
        if not isinstance(function, LocalFunction):
            return
        bound = () if function.receiver is None else (function.receiver,)
        given = (*bound, *values)
        arguments = self.functions[function.number].node.args
        most = len(arguments.posonlyargs) + len(arguments.args)
        least = len(given) if fewest is None else len(bound) + fewest
        if arguments.vararg or (most >= least and most - len(arguments.defaults) <= len(given)):
            self.pass_to(function.number, given, {})
