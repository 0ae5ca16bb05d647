"""The new scene that the steps of a list are done in."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OBJECT, OPERATORS, TYPES
from kb_serve.answer.steps.names.variable_names import VariableNames
from kb_serve.answer.steps.scene.makers import Makers
from kb_serve.answer.steps.scene.pointer_fills import PointerFills
from kb_serve.answer.steps.scene.working_object import WorkingObject
from kb_serve.answer.ways.operator_needs import needs_text

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.reader import BaseReader

_SCENE = f"{TYPES}Scene"


class NewScene:
    """What the steps told so far have changed in a scene, and what makes more; all parts of a list share it."""

    def __init__(self, reader: BaseReader) -> None:
        self.reader = reader
        self.shown: set[str] = set()  # classes of which a step has made, set or used an instance
        self.makers = Makers(reader)
        self.variables = VariableNames(reader)
        self.obj = WorkingObject(reader, self.makers, self.variables)
        self.pointers = PointerFills(reader, self.obj, self.variables)

    def lacking(self) -> Iterator[tuple[str, str]]:
        """What a scene has one of, and a new one has not: the class of the data of an object that it points to, and the
        expression for that object, as for the camera.
        """
        for pointer in self.reader.members(_SCENE).values():
            cls = f"{TYPES}{pointer.name.title()}"
            is_object = pointer.type == "pointer" and f"{TYPES}{pointer.target}" == OBJECT
            if is_object and not pointer.is_read_only and self.reader.is_object_data(cls):
                yield cls, f"scene.{pointer.name}"

    def making(self, cls: str, call: str) -> str:
        """The step that makes an instance of a class by a call, after which it is there."""
        self.shown.add(cls)
        name = cls.removeprefix(TYPES)
        if call.startswith(OPERATORS):
            operator = self.reader.symbol(call.partition("(")[0])
            needed = needs_text(operator, self.reader) if operator else ""
            return f"`{call}` → `{name}`" + (f" ({needed})" if needed else "")
        if cls == OBJECT:
            call = self.obj.new_mesh_object()
        return f"`{self.variables.of(cls)} = {call}` → `{name}`"
