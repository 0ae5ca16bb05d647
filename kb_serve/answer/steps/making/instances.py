"""Instances that steps work on: which are there, and what makes the others.

A call that makes something begins with an expression for what holds it (``obj.data.edit_bones.new("Bone")``). That is
written for a scene in which everything is there already; on a new one it fails, where the holder must be made first or
a pointer on the way to it is None.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OBJECT, OPERATORS, TYPES
from kb_build.symbols.lines import held
from kb_serve.answer.facts.members_in_brief import part_given_with
from kb_serve.answer.steps.names.variable_names import MESH, TREE
from kb_serve.answer.steps.scene.pointer_fills import Ready

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from kb_serve.answer.steps.scene.new_scene import NewScene
    from kb_serve.lookups.records import Creation, SymbolEntry

_DEEPEST = 6  # holders of holders
_EDIT_BONES = "edit_bones"
_EDIT_MODE = "EDIT"


class Instances:
    """The instances of one list of steps.

    ``tree_of``: gives the steps that make the tree which takes a node, where it is not there. It is given as a function
    because what makes trees puts them on instances.
    """

    def __init__(self, scene: NewScene, tree_of: Callable[[str], list[str]]) -> None:
        self._scene = scene
        self._reader = scene.reader
        self._tree_of = tree_of

    def call(self, creation: Creation) -> Ready | None:
        """The call that makes something, on a holder that is there; None where nothing is known to make the holder."""
        return self._call(creation, 0)

    def of(self, cls: str) -> Ready | None:
        """An instance of a class; None where nothing is known to make one."""
        return self._of(cls, 1)

    def part_of(self, pointer: SymbolEntry, expression: str) -> Iterator[str]:
        """The steps that set what must be set along with a pointer of ``expression`` that has been set: the slot of an
        action.
        """
        part = part_given_with(pointer, self._reader)
        target = f"{TYPES}{part.target}" if part else ""
        if part is None or (ready := self.of(target)) is None:
            return
        self._scene.shown.add(target)
        yield from ready.steps
        yield f"`{expression}.{part.name} = {ready.expression}` — without it `{pointer.name}` does nothing"

    def parts_given(self, cls: str, call: str, expression: str) -> Iterator[str]:
        """The steps that set what must be set along with what a call has been given and keeps in a pointer, where
        ``expression`` is the new thing.
        """
        given = re.findall(r"[(,] ?(\w+)(?=[,)])", call)
        for pointer in self._reader.members(cls).values():
            if (
                pointer.type == "pointer"
                and pointer.name in given
                and self._scene.variables.there(f"{TYPES}{pointer.target}") == pointer.name
            ):
                yield from self.part_of(pointer, expression)

    def _call(self, creation: Creation, depth: int) -> Ready | None:
        head, maker, rest = creation.call.rpartition(f".{creation.maker.rpartition('.')[2]}(")
        before, _, holder = head.rpartition(".")
        owner = self._scene.makers.owner_of(creation.maker, holder)
        if not owner or before == "bpy.data":
            return Ready([], creation.call)
        steps: list[str] = []
        if owner == TREE and depth:
            steps += self._tree_of(f"{TYPES}{creation.choice}")
        on = self._object_taking(creation, depth) if owner == OBJECT else self._of(owner, depth + 1)
        if on is None:
            return None
        steps += on.steps
        if holder == _EDIT_BONES and (codes := self._scene.obj.to_mode(_EDIT_MODE)):
            entered = "; ".join(f"`{code}`" for code in codes)
            steps.append(f"{entered} — edit bones are there in Edit Mode only")
        for name, cls in self._scene.makers.things_given(creation):
            if (given := self._of(cls, depth + 1)) is not None:
                steps += given.steps
                rest = re.sub(rf"\b{name}\b(?!\s*=)", given.expression, rest)
        for name, cls in self._scene.makers.things_by_name(creation):
            kind, made = self._simplest(cls, depth)
            given = self._call(made, depth + 1) if made else None
            if given is not None:
                steps += [*given.steps, f"`{name} = {given.expression}` → `{kind.removeprefix(TYPES)}`"]
        steps += self._scene.makers.never_without(creation, self._scene.variables.there)
        return Ready(steps, f"{on.expression}.{holder}{maker}{rest}")

    def _object_taking(self, creation: Creation, depth: int) -> Ready | None:
        """An object of a type that takes what is added."""
        if name := self._scene.obj.name_taking(creation):
            return Ready([], name)
        ready = self._of(self._scene.obj.data_taking(creation), depth + 1)
        return Ready(ready.steps, "obj") if ready else None

    def _of(self, cls: str, depth: int) -> Ready | None:
        if name := self._scene.variables.there(cls):
            return Ready([], name)
        if cls == MESH:
            self._scene.variables.add(cls, "mesh")
            return Ready([f"`mesh = {self._scene.obj.mesh_object()}.data`, of a mesh object"], "mesh")
        creation = self._reader.makers.creations([cls]).get(cls)
        if creation is None or creation.maker.startswith(OPERATORS):
            return self._reached(cls) or self._of_a_kind(cls, depth)
        ready = self._call(creation, depth) if depth < _DEEPEST else None
        if ready is None:
            return None
        variable = self._scene.variables.of(cls)
        self._scene.variables.add(cls, variable)
        made = f"`{variable} = {ready.expression}` → `{cls.removeprefix(TYPES)}`"
        return Ready([*ready.steps, made, *self._scene.obj.made_of(cls)], variable)

    def _of_a_kind(self, cls: str, depth: int) -> Ready | None:
        """An instance of a class below one that is not made for itself: a strip of colour for a Strip."""
        least, _ = self._simplest(cls, depth)
        return self._of(least, depth) if least else None

    def _simplest(self, cls: str, depth: int) -> tuple[str, Creation | None]:
        """Of the classes below one that is not made for itself the one that needs the least, and what makes it."""
        below = [entry.path for entry in self._reader.descendants(cls)] if depth < _DEEPEST else []
        made = {path: one for path, one in self._reader.makers.creations(below).items() if one.choice}
        needed = {path: self._scene.makers.count_things(one) for path, one in made.items()}
        least = min(made, key=lambda path: (needed[path], len(made[path].call), path), default="")
        return least, made.get(least)

    def _reached(self, cls: str) -> Ready | None:
        """The expression by which scripts mostly reach an instance, where all on its way is there or can be filled."""
        symbol = self._reader.symbol(cls)
        if symbol is None or not symbol.reached or "(" in symbol.reached:
            return None
        ready = self._scene.pointers.reach(held(symbol.reached), adds=False)
        if ready is not None:
            self._scene.variables.add(cls, ready.expression)
        return ready
