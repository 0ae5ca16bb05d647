"""The object that steps work on: its type, whether it is active, and what can be made on it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_build.symbols.api_names import OBJECT, OPERATORS, TYPES
from kb_build.symbols.flags import operator_active
from kb_serve.answer.pages import passage_block
from kb_serve.answer.steps.names.variable_names import OBJ

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kb_build.symbols.records import Symbol
    from kb_serve.answer.steps.names.variable_names import VariableNames
    from kb_serve.answer.steps.scene.makers import Makers
    from kb_serve.lookups.records import Creation
    from kb_serve.reader import BaseReader

ACTIVATE = "bpy.context.view_layer.objects.active = obj"
_SCENE = f"{TYPES}Scene"
OTHER = "other"  # what a second object is called
_MESH = "MESH"
_OBJECT_MODE, _EDIT_MODE = "OBJECT", "EDIT"
_UPDATE = "bpy.context.view_layer.update()"
_BY = " by "
_WORKS_ON_SELECTED = re.compile(r"\bselected\b", re.I)
_ADDED_TYPE = re.compile(r"object\.add\(type='(\w+)'\)")
_NEW_NAME = re.compile(r'\bnew\("[^"]*"')


class WorkingObject:
    """The ``obj`` of one list of steps: a mesh object until another is made."""

    def __init__(self, reader: BaseReader, makers: Makers, variables: VariableNames) -> None:
        self._reader = reader
        self._makers = makers
        self._variables = variables
        self._kind = _MESH
        self._is_active = True
        self._mode = _OBJECT_MODE
        self._parts: list[str] = []

    @property
    def parts(self) -> tuple[str, ...]:
        """The classes of what was made on it, such as modifiers, the first first."""
        return tuple(self._parts)

    def hold(self, cls: str) -> None:
        """Notes that an instance of a class was made on it."""
        self._parts.append(cls)

    def made_of(self, data: str) -> list[str]:
        """The steps that make an object of new data, given by its class; none for what is no object's data."""
        creation = (
            self._reader.makers.creations([OBJECT]).get(OBJECT) if self._reader.is_object_data(data) else None
        )
        if creation is None:
            return []
        self._replace(self._reader.object_type(data))
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

    def restoring(self) -> Callable[[], None]:
        """What makes undone all that happens to it from now on."""
        before = self._kind, self._is_active, self._mode, list(self._parts)

        def restore() -> None:
            self._kind, self._is_active, self._mode, self._parts = before

        return restore

    def data_class(self) -> str:
        """The class of its data."""
        return self._reader.object_data.get(self._kind, "")

    def filling(self, ways: Sequence[str]) -> list[str]:
        """What gives it something that only objects of some ways have: ``object by object.armature_add()``; nothing if
        none is known. One of the same type as such an object has it once the view layer is updated.
        """
        calls = [call for way in ways for kind, _, call in [way.partition(_BY)] if kind == "object"]
        if any(f"'{self._kind}'" in call for call in calls):
            return [_UPDATE]
        kinds = [kind for kind in (_ADDED_TYPE.fullmatch(call) for call in calls) if kind]
        if not kinds:
            return []
        self._replace(kinds[0][1])
        self._is_active = True
        return [f"bpy.ops.{calls[0]}", "obj = bpy.context.object"]

    def to_mode(self, mode: str) -> list[str]:
        """What puts it into a mode; nothing where it is in that."""
        steps = self.activation()
        if mode != self._mode:
            self._mode = mode
            steps.append(f"bpy.ops.object.mode_set(mode='{mode}')")
        return steps

    def ready_for(self, operator: Symbol) -> list[str]:
        """What makes it the active object in a mode that an operator runs in; nothing where it is none that the
        operator takes.
        """
        types, modes = operator_active(operator)
        if (types is None and modes is None) or self._variables.is_made(_SCENE):  # which it is not in
            return []
        if types is not None and not types.takes(self._kind):
            return []
        if modes is None or modes.takes(self._mode):
            return self.activation()
        entered = self.to_mode(_OBJECT_MODE if modes.is_others else modes.names[0])
        return [*entered, *self._selecting(operator)] if entered else []

    def _selecting(self, operator: Symbol) -> list[str]:
        """What selects all of it in Edit Mode, for an operator on what is selected; nothing for another."""
        if self._mode != _EDIT_MODE or not _WORKS_ON_SELECTED.search(self._said_of(operator)):
            return []
        select = self._reader.symbol(f"{OPERATORS}{self._kind.lower()}.select_all")
        takes_action = select is not None and any(one.name == "action" for one in select.parameters)
        return [f"{select.path}(action='SELECT')"] if select and takes_action else []

    def _said_of(self, operator: Symbol) -> str:
        blocks = passage_block(operator.path, self._reader)
        return " ".join((operator.description, *(block.text for block in blocks)))

    def is_refused_by(self, operator: Symbol) -> bool:
        """Whether an operator works on objects of other types than the one that steps have made."""
        types, _ = operator_active(operator)
        return types is not None and self._variables.is_made(OBJECT) and not types.takes(self._kind)

    def mesh_object(self) -> str:
        """What a mesh object is called."""
        return OBJ if self._kind == _MESH else OTHER

    def name_taking(self, creation: Creation) -> str:
        """What the object is called that takes what is made; empty if neither this one nor a mesh object does."""
        names = ((OBJ, self._kind), (OTHER, _MESH))
        return next((name for name, kind in names if self._takes(kind, creation)), "")

    def data_taking(self, creation: Creation) -> str:
        """The class of the data of a further object that takes what is made: most modifiers are refused by most types.

        Of several types the one that the choice is called after; empty for a type without data.
        """
        choice, kinds = key(creation.choice), self._makers.kinds_taken(creation)
        likeliest = min(kinds, key=lambda kind: (not choice.startswith(key(kind)), kind), default="")
        return self._reader.object_data.get(likeliest, "")

    def is_made_on(self, name: str, creation: Creation) -> bool:
        """Whether what a call makes can be made on the object of this name; anything can on what is no object."""
        return name not in {OBJ, OTHER} or self._takes(self._kind if name == OBJ else _MESH, creation)

    def _takes(self, kind: str, creation: Creation) -> bool:
        kinds = self._makers.kinds_taken(creation)
        return not kinds or kind in kinds

    def _replace(self, kind: str) -> None:
        self._variables.add(OBJECT, OBJ)
        self._kind, self._is_active, self._mode, self._parts = kind, False, _OBJECT_MODE, []
