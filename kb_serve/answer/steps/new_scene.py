"""The new scene that the steps of a list are done in."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.answer.steps.makers import Makers
from kb_serve.answer.steps.pointer_fills import PointerFills
from kb_serve.answer.steps.variable_names import VariableNames
from kb_serve.answer.steps.working_object import WorkingObject

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader


class NewScene:
    """What the steps told so far have changed in a scene, and what makes more; all parts of a list share it."""

    def __init__(self, reader: BaseReader) -> None:
        self.reader = reader
        self.shown: set[str] = set()  # classes of which a step has made, set or used an instance
        self.makers = Makers(reader)
        self.variables = VariableNames(reader)
        self.obj = WorkingObject(reader, self.makers, self.variables)
        self.pointers = PointerFills(reader, self.obj, self.variables)
