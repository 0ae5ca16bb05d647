"""Reads assignments: what names, attributes and items hold from there on."""

from __future__ import annotations

import ast

from kb_build.flow.blender.api import ARRAY
from kb_build.flow.blender.facts import AREA, AREA_TYPES, DISCRIMINANTS, SPACE
from kb_build.flow.evaluation.annotations import Annotations
from kb_build.flow.evaluation.guards import Guards
from kb_build.flow.evaluation.operations import is_math
from kb_build.flow.state.scopes import chain_text, item_text
from kb_build.flow.values.types import (
    NONE,
    UNKNOWN,
    ClassObject,
    Instance,
    LocalClass,
    LocalFunction,
    LocalInstance,
    Mapping,
    Module,
    Sequence,
    Tuple,
    Type,
    general,
    is_empty,
    join,
    members,
    union,
)
from kb_build.symbols.api_names import STRUCT

_TYPES = Module("bpy.types")
_GROUP = "idprop.types.IDPropertyGroup"
_OWN_GROUP = "bpy.types.PropertyGroup"
_CHOOSING = frozenset(
    {"active", "scene", "view_layer", "workspace"}
)  # which decide what the active object is


class Assignments(Guards, Annotations):
    """Reads assignments; each reader tells whether the next statement can be reached."""

    def read_assignment(self, node: ast.Assign) -> bool:
        """Reads ``name = value``."""
        kind = self.evaluate(node.value)
        if len(node.targets) > 1 or isinstance(node.value, (ast.Name, ast.Attribute)):
            kind = self.give_away(node.value, kind)
        for target in node.targets:
            self.bind_target(target, kind, node.value)
            if isinstance(target, ast.Name):
                self._note_asked(target.id, node.value)
        return True

    def _note_asked(self, name: str, value: ast.expr) -> None:
        """Notes ``name = hasattr(owner, "member")`` and ``name = getattr(owner, "member", default)``."""
        self.here.scope.asked.pop(name, None)
        match value:
            case (
                ast.Call(func=ast.Name(id="hasattr"), args=[_, _])
                | ast.Call(func=ast.Name(id="getattr"), args=[_, _, _])
            ):
                self.here.scope.asked[name] = value
            case _:
                pass

    def read_annotated_assignment(self, node: ast.AnnAssign) -> bool:
        """Reads ``name: type = value``, also without a value."""
        kind = self.evaluate(node.value) if node.value is not None else UNKNOWN
        if isinstance(node.annotation, ast.Call):  # ``size: FloatProperty(...)``
            declared = self.evaluate(node.annotation)
        elif self.here.function is not None and not self.here.scope.is_class:
            with self.ready_for():  # Python does not evaluate those of a function's own names
                declared = self.annotated(node.annotation)
        else:
            declared = self.annotated(node.annotation)
        if kind is UNKNOWN or kind is NONE or (isinstance(kind, Sequence) and kind.element is UNKNOWN):
            kind = declared
        self.bind_target(node.target, kind, node.value)
        return True

    def read_augmented_assignment(self, node: ast.AugAssign) -> bool:
        """Reads ``name += value``."""
        right = self.evaluate(node.value)
        before = self.evaluate(node.target)
        is_list = isinstance(before, (Sequence, Tuple))  # which takes in the components
        if (is_math(before) or is_math(right)) and not is_list:
            before = self.operation(node, before, right)
        if is_list:
            held = () if is_empty(before) else (self.iterated(before),)
            before = Sequence("list", union((*held, self.iterated(right))))
        if isinstance(node.target, ast.Name):
            self.bind(node.target.id, general(before))
        elif isinstance(node.target, ast.Attribute):
            self._store(node.target, general(before), None)
        return True

    def bind_target(self, target: ast.expr, kind: Type, value: ast.expr | None = None) -> None:
        """See :class:`core.Core`."""
        kind = self.told(kind, value)
        match target:
            case ast.Name():
                self.bind(target.id, kind)
                self.here.types[target] = kind
            case ast.Attribute():
                self._store(target, kind, value)
            case ast.Tuple() | ast.List():
                self._unpack(target, kind)
            case ast.Subscript():
                owner = self.evaluate(target.value)
                key = self.evaluate(target.slice)
                if owner is not UNKNOWN:
                    self.item(owner, key, target)
                self._fill(target, owner, key, kind)
                self._keep_group(target, owner, kind)
            case ast.Starred():
                self.bind_target(target.value, Sequence("list", UNKNOWN))
            case _:
                pass

    def _unpack(self, target: ast.Tuple | ast.List, kind: Type) -> None:
        starred = next((at for at, item in enumerate(target.elts) if isinstance(item, ast.Starred)), None)
        if starred is None:
            for item, one in zip(target.elts, self.unpacked(kind, len(target.elts)), strict=True):
                self.bind_target(item, one)
            return
        element = self.iterated(kind)
        for item in target.elts:
            if isinstance(item, ast.Starred):
                self.bind_target(item.value, Sequence("list", element))
            else:
                self.bind_target(item, element)

    def _fill(self, target: ast.Subscript, owner: Type, key: Type, kind: Type) -> None:
        """A dictionary or a list that a name or an attribute holds learns what it is filled with."""
        filled: Type
        match owner:
            case Mapping():
                value = kind if owner.is_empty else union((owner.value, kind))
                known = key if owner.is_empty else union((owner.key, key))
                filled = Mapping(general(known), value)
            case Tuple() | Sequence(kind="list"):
                held = self.iterated(kind) if isinstance(target.slice, ast.Slice) else kind
                filled = Sequence("list", union((self.iterated(owner), held)))
            case _:
                return
        self.fill(target.value, filled)

    def _keep_group(self, target: ast.Subscript, owner: Type, kind: Type) -> None:
        """A dictionary that is given to one of Blender's structures is a group of custom properties from then on."""
        if not (isinstance(owner, Instance) and self.api.descends(owner.cls, STRUCT)):
            return
        text, key = item_text(target)
        self.here.scope.forget(text)
        if key and isinstance(kind, Mapping) and self.api.is_class(_GROUP):
            self.here.scope.state.chains[text] = Instance(_GROUP)

    def _store(  # noqa: PLR0912 - one case an owner
        self, target: ast.Attribute, kind: Type, value: ast.expr | None
    ) -> None:
        owner = self.evaluate(target.value)
        if target.attr in _CHOOSING:
            self.here.scope.state.active = None
        text = chain_text(target)
        if isinstance(owner, LocalInstance):
            if isinstance(target.value, ast.Name) or not self._is_group(owner):
                self._store_on_instance(owner, target.attr, kind)
        elif isinstance(owner, LocalClass):
            self.classes[owner.number].bind(target.attr, kind)
        elif owner == _TYPES:
            # Whatever is assigned to the module is there, as the server that an add-on keeps.
            self.own_types[target.attr] = join(self.own_types.get(target.attr, kind), kind)
            self.here.resolutions.pop(target, None)
            return
        else:
            self.register(owner, target.attr, kind, declared=self.is_declared(value))
            if all(isinstance(member, ClassObject) for member in members(owner)):
                self.here.resolutions.pop(target, None)
                return
        is_expected = text in self.here.scope.state.chains
        if text and self.here.scope.state.chains:
            self.spend(len(self.here.scope.state.chains))
            self.here.scope.forget(text)
        self.here.resolutions.pop(target, None)
        if owner is UNKNOWN:
            return
        found = self.attribute(owner, target.attr)
        if found.symbols or found.missing or found.possible:
            missing = () if is_expected else found.missing
            use = "store" if found.use == "attribute" else found.use
            self.resolve(
                target, use, target.attr, found.symbols, missing, found.possible,
                sure=found.sure, guarded=self.here.scope.state.doubts_members_of(target.value),
            )  # fmt: skip
        if target.attr in DISCRIMINANTS or target.attr in AREA_TYPES:
            self._forget_kinds(owner)
        if found.symbols and value is not None:
            self.check_value(found.type, value)
        elif found.possible and found.sure and not found.missing and value is not None:
            self.check_possible(owner, target.attr, found.possible, value)
        # A vector, given to a colour, becomes a colour; either takes the numbers of an array in, which takes theirs.
        converts = _is_row(kind) and _is_row(found.type)
        holds = (
            isinstance(kind, (Instance, LocalInstance)) and isinstance(found.type, Instance) and not converts
        )
        if text and holds:
            self.here.scope.state.chains[text] = kind

    def _forget_kinds(self, owner: Type) -> None:
        """Something becomes of another class: what is read anew from a chain may be that."""
        classes = [kind.cls for kind in members(owner) if isinstance(kind, Instance)]
        bases = {SPACE if cls == AREA else self.api.literals.settable_kind(cls) for cls in classes} - {""}
        chains = self.here.scope.state.chains
        self.spend(len(chains))
        for text, kind in [*chains.items()] if bases else ():
            if any(self.api.descends(one.cls, base) for one in members(kind) for base in bases
                   if isinstance(one, Instance)):  # fmt: skip
                del chains[text]

    def _is_group(self, owner: LocalInstance) -> bool:
        """Whether it is a property group, which is another instance each time that it is read from its owner."""
        return any(self.api.descends(base, _OWN_GROUP) for base in self.api_bases(owner.number)[0])

    def _store_on_instance(self, owner: LocalInstance, name: str, kind: Type) -> None:
        if self.is_declared_in(owner.number, name):
            return
        found = self.class_attribute(owner.number, name)
        held = found[0] if found else UNKNOWN
        if isinstance(held, LocalFunction) and self.functions[held.number].is_property:
            return  # its setter takes the value
        if found is None and self.has_by_api(owner.number, name):
            return
        self.classes[found[1] if found else owner.number].bind(name, general(kind))


def _is_row(kind: Type) -> bool:
    """Whether a value is a vector or its like, or an array."""
    return is_math(kind) or (isinstance(kind, Instance) and kind.cls == ARRAY)
