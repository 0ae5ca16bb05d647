"""The step that makes one thing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OBJECT, OPERATORS, TYPES
from kb_serve.answer.steps.operators import asked

if TYPE_CHECKING:
    from kb_serve.answer.steps.new_scene import NewScene


def made_line(cls: str, call: str, scene: NewScene) -> str:
    """The step that makes an instance of a class by a call, after which it is there."""
    scene.shown.add(cls)
    name = cls.removeprefix(TYPES)
    if call.startswith(OPERATORS):
        symbol = scene.reader.symbol(call.partition("(")[0])
        needed = asked(symbol, scene.reader) if symbol else ""
        return f"`{call}` → `{name}`" + (f" ({needed})" if needed else "")
    if cls == OBJECT:
        call = scene.obj.new_mesh_object()
    return f"`{scene.variables.of(cls)} = {call}` → `{name}`"
