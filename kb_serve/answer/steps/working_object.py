"""The object that steps work on: its type, whether it is active, and what can be made on it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_serve.answer.steps.variable_names import OBJ, OBJECT
from kb_serve.reader import TYPES

if TYPE_CHECKING:
    from kb_serve.answer.steps.makers import Makers
    from kb_serve.answer.steps.object_kinds import ObjectKinds
    from kb_serve.answer.steps.variable_names import VariableNames
    from kb_serve.reader import BaseReader, Creation

ACTIVATE = "bpy.context.view_layer.objects.active = obj"
_OTHER = "other"  # what a second object is called
_MESH = "MESH"
_NEW_NAME = re.compile(r'\bnew\("[^"]*"')


class WorkingObject:
    """The ``obj`` of one list of steps: a mesh object until another is made."""

    def __init__(
        self, reader: BaseReader, kinds: ObjectKinds, makers: Makers, variables: VariableNames
    ) -> None:
        self._reader = reader
        self._kinds = kinds
        self._makers = makers
        self._variables = variables
        self._kind = _MESH
        self._is_active = True

    def made_of(self, data: str) -> list[str]:
        """The steps that make an object of new data, given by its class; none for what is no object's data."""
        creation = self._reader.creations([OBJECT]).get(OBJECT) if self._kinds.is_data(data) else None
        if creation is None:
            return []
        self._replace(self._kinds.of_data(data))
        call = _NEW_NAME.sub(f'new("{data.removeprefix(TYPES)}"', creation.call)
        return [f"`obj = {call}`; `bpy.context.collection.objects.link(obj)`"]

    def new_mesh_object(self) -> str:
        """The call that makes a mesh object, which is ``obj`` from now on."""
        self._replace(_MESH)
        return 'bpy.data.objects.new("Object", bpy.data.meshes.new("Mesh"))'

    def activation(self) -> list[str]:
        """What makes it the active object; nothing where it is."""
        if self._is_active:
            return []
        self._is_active = True
        return [ACTIVATE]

    def mesh_object(self) -> str:
        """What a mesh object is called."""
        return OBJ if self._kind == _MESH else _OTHER

    def name_taking(self, creation: Creation) -> str:
        """What the object is called that takes what is made; empty if neither this one nor a mesh object does."""
        names = ((OBJ, self._kind), (_OTHER, _MESH))
        return next((name for name, kind in names if self._takes(kind, creation)), "")

    def data_taking(self, creation: Creation) -> str:
        """The class of the data of a further object that takes what is made: most modifiers are refused by most types.

        Of several types the one that the choice is called after; empty for a type without data.
        """
        choice, kinds = key(creation.choice), self._makers.kinds_taken(creation)
        return self._kinds.data_of(
            min(kinds, key=lambda kind: (not choice.startswith(key(kind)), kind), default="")
        )

    def is_made_on(self, name: str, creation: Creation) -> bool:
        """Whether what a call makes can be made on the object of this name; anything can on what is no object."""
        return name not in {OBJ, _OTHER} or self._takes(self._kind if name == OBJ else _MESH, creation)

    def _takes(self, kind: str, creation: Creation) -> bool:
        kinds = self._makers.kinds_taken(creation)
        return not kinds or kind in kinds

    def _replace(self, kind: str) -> None:
        self._variables.add(OBJECT, OBJ)
        self._kind, self._is_active = kind, False
