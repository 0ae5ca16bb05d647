"""Instances that steps work on: which are there, and what makes the others.

A call that makes something begins with an expression for what holds it (``obj.data.edit_bones.new("Bone")``). That is
written for a scene in which everything is there already; on a new one it fails, where the holder must be made first or
a pointer on the way to it is None.
"""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, NamedTuple, Protocol

from kb_build.index.analysis import key
from kb_build.symbol_lines import empty_when_new, fillers, held
from kb_serve.reader import TYPES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kb_build.records import Symbol
    from kb_serve.reader import BaseReader, Creation

_OBJECT, _MESH, _TREE = f"{TYPES}Object", f"{TYPES}Mesh", f"{TYPES}NodeTree"
# What every script has, or writes without a step that makes it.
_THERE = {
    _OBJECT: "obj",
    f"{TYPES}Scene": "scene",
    f"{TYPES}ViewLayer": "view_layer",
    f"{TYPES}BlendData": "bpy.data",
    _TREE: "tree",
}
_ROOTS = {name: cls for cls, name in _THERE.items()} | {"mesh": _MESH}
_USUAL_KIND = "MESH"
_DEEPEST = 6  # holders of holders
_FIRST_WORD = re.compile(r"^(?!bpy\b|obj\b|scene\b)[a-z_]+\.(?=\w+(?: = |\())")
_EDIT_BONES = "edit_bones"
_ACTIVATE = "bpy.context.view_layer.objects.active = obj"
_TO_EDIT_MODE = (
    f"`{_ACTIVATE}`; `bpy.ops.object.mode_set(mode='EDIT')` — edit bones are there in Edit Mode only"
)


def stays_empty(pointer: Symbol) -> bool:
    """Whether a pointer is None on new things, and nothing is known to fill it."""
    return empty_when_new(pointer) is not None and not fillers(pointer)


def filling(calls: Iterable[str], expression: str) -> str:
    """The step in which calls fill a pointer."""
    return f"{', then '.join(f'`{call}`' for call in calls)} makes `{expression}`"


class Ready(NamedTuple):
    """An expression, and the steps after which it can be evaluated."""

    steps: list[str]
    expression: str


class Makers(Protocol):
    """How those things are made that take more than a call."""

    def variable_of(self, cls: str) -> str:
        """What scripts call an instance of a class."""
        ...

    def object_of(self, cls: str) -> list[str]:
        """The steps that make an object of new object data; none for what is none."""
        ...

    def data_of(self, kind: str) -> str:
        """The class of the data of an object's type: Volume of ``VOLUME``."""
        ...

    def tree_of(self, node: str) -> list[str]:
        """The steps that make the tree that takes a node, where it is not there."""
        ...


class Instances:
    """The instances of one list of steps."""

    def __init__(self, reader: BaseReader, makers: Makers) -> None:
        self._reader = reader
        self._makers = makers
        self._maker = cache(reader.symbol)  # the same one makes all modifiers, and its record is long
        self._names: dict[str, str] = {}
        self._filled: set[str] = set()
        self._kind = _USUAL_KIND  # the type of ``obj``
        self._is_active = True  # and whether it is the active object

    def add(self, cls: str, expression: str) -> None:
        """Notes that a step has made an instance."""
        self._names[cls] = expression

    def add_object(self, kind: str) -> None:
        """Notes that ``obj`` is from now on an object of a type."""
        self.add(_OBJECT, "obj")
        self._kind, self._is_active = kind, False

    def is_taken(self, name: str, cls: str) -> bool:
        """Whether a variable of this name is another class's instance."""
        return any(own == name and made != cls for made, own in self._names.items())

    def call(self, creation: Creation) -> Ready | None:
        """The call that makes something, on a holder that is there; None where nothing is known to make the holder."""
        return self._call(creation, 0)

    def of(self, cls: str) -> Ready | None:
        """An instance of a class; None where nothing is known to make one."""
        return self._of(cls, 1)

    def filled(self, pointer: Symbol, above: str) -> list[str]:
        """The calls that fill a pointer of ``above`` which is None on new things; none if it is there or filled."""
        expression = f"{above}.{pointer.name}"
        calls = fillers(pointer) if empty_when_new(pointer) else []
        if expression in self._filled or not calls:
            return []
        self._filled.add(expression)
        calls = [_FIRST_WORD.sub(f"{above}.", call) for call in calls]
        if not self._is_active and any(call.startswith("bpy.ops.") for call in calls):
            self._is_active = True
            return [_ACTIVATE, *calls]
        return calls

    def _call(self, creation: Creation, depth: int) -> Ready | None:
        head, maker, rest = creation.call.rpartition(f".{creation.maker.rpartition('.')[2]}(")
        before, _, holder = head.rpartition(".")
        owner = self._owner(creation.maker, holder)
        if not owner or before == "bpy.data":
            return Ready([], creation.call)
        steps: list[str] = []
        if owner == _TREE and depth:
            steps += self._makers.tree_of(f"{TYPES}{creation.choice}")
        on = self._object_taking(creation, depth) if owner == _OBJECT else self._of(owner, depth + 1)
        if on is None:
            return None
        steps += on.steps
        if holder == _EDIT_BONES:
            steps.append(_TO_EDIT_MODE)
        for name, cls in self._things_given(creation):
            if (given := self._of(cls, depth + 1)) is not None:
                steps += given.steps
                rest = re.sub(rf"\b{name}\b(?!\s*=)", given.expression, rest)
        return Ready(steps, f"{on.expression}.{holder}{maker}{rest}")

    def is_on(self, name: str, creation: Creation) -> bool:
        """Whether what is made by a call can be made on the object of this name too."""
        return name not in {"obj", "other"} or self._is_taken_by(
            self._kind if name == "obj" else _USUAL_KIND, creation
        )

    def _object_taking(self, creation: Creation, depth: int) -> Ready | None:
        """An object of a type that takes what is added: most modifiers are refused by most types."""
        if self._is_taken_by(self._kind, creation):
            return Ready([], "obj")
        if self._is_taken_by(_USUAL_KIND, creation):
            return Ready([], "other")
        kinds = sorted(
            self._kinds(creation), key=lambda kind: (not key(creation.choice).startswith(key(kind)), kind)
        )
        ready = self._of(self._makers.data_of(kinds[0]), depth + 1) if kinds else None
        return Ready(ready.steps, "obj") if ready else None

    def _is_taken_by(self, kind: str, creation: Creation) -> bool:
        kinds = self._kinds(creation)
        return not kinds or kind in kinds

    def _kinds(self, creation: Creation) -> set[str]:
        """The types of the objects that take what is made; none where Blender was not seen to refuse any."""
        maker = self._maker(creation.maker)
        refusals = maker.refusals if maker else ()
        taken = (refusal.taken_by for refusal in refusals if creation.choice in refusal.values)
        return {kind.removesuffix(" object") for kind in next(taken, ())}

    def _things_given(self, creation: Creation) -> Iterator[tuple[str, str]]:
        """The arguments that a call needs and that are things themselves, as a slot is: name and class."""
        maker = self._maker(creation.maker)
        for parameter in maker.parameters if maker else ():
            cls = f"{TYPES}{parameter.type}"
            if parameter.required and self._reader.creations([cls]):
                yield parameter.name, cls

    def _owner(self, maker: str, holder: str) -> str:
        """The class that has what makes something as its property ``holder``; empty where it is no property."""
        made_by = maker.rpartition(".")[0].removeprefix(TYPES)
        owners = (
            entry.owner
            for entry in self._reader.by_name(holder)
            if made_by in {entry.collection, entry.target if entry.type == "pointer" else ""}
        )
        return next(owners, "")

    def _of(self, cls: str, depth: int) -> Ready | None:
        known = (name for made, name in self._names.items() if self._reader.descends(made, cls))
        if name := next(known, "") or _THERE.get(cls, ""):
            return Ready([], name)
        if cls == _MESH:
            self.add(cls, "mesh")
            name = "obj" if self._kind == _USUAL_KIND else "other"
            return Ready([f"`mesh = {name}.data`, of a mesh object"], "mesh")
        creation = self._reader.creations([cls]).get(cls)
        if creation is None or creation.maker.startswith("bpy.ops."):
            return self._reached(cls)
        ready = self._call(creation, depth) if depth < _DEEPEST else None
        if ready is None:
            return None
        variable = self._makers.variable_of(cls)
        self.add(cls, variable)
        made = f"`{variable} = {ready.expression}` → `{cls.removeprefix(TYPES)}`"
        return Ready([*ready.steps, made, *self._makers.object_of(cls)], variable)

    def _reached(self, cls: str) -> Ready | None:
        """The expression by which scripts mostly reach an instance, where all on its way is there or can be filled."""
        symbol = self._reader.symbol(cls)
        if symbol is None or not symbol.reached or "[" in symbol.reached or "(" in symbol.reached:
            return None
        ready = self.reach(held(symbol.reached))
        if ready is not None:
            self.add(cls, ready.expression)
        return ready

    def reach(self, expression: str) -> Ready | None:
        """An expression, and what fills pointers on its way that are None on new things; None where one stays so."""
        steps: list[str] = []
        above, *names = expression.split(".")
        owner = _ROOTS.get(above, "")
        for name in names:
            entry = self._reader.member([one.path for one in self._reader.lineage(owner)], name)
            pointer = self._reader.symbol(entry.path) if entry and entry.type == "pointer" else None
            if pointer is None:
                break  # of what a subclass has nothing is known here
            if stays_empty(pointer):
                return None
            if calls := self.filled(pointer, above):
                steps.append(filling(calls, f"{above}.{name}"))
            above, owner = f"{above}.{name}", f"{TYPES}{pointer.target}"
        return Ready(steps, expression)
