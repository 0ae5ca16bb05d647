"""Which classes literals mean: ``'CLOTH'`` of a modifier, ``"Principled BSDF"`` of a node."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import CALLED, CLASS_OF_VALUE, DISCRIMINANTS
from kb_build.symbols.api_names import NODE
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import NODE_TYPE, READ_ONLY
from kb_build.symbols.paths import is_socket

if TYPE_CHECKING:
    from kb_build.flow.blender.classes import Classes
    from kb_build.flow.blender.former_names import FormerNames

_INTERFACE = f"{T}NodeTreeInterfaceSocket"
_KEY = re.compile(r'\["(?P<name>[^"]+)"\]$')
_WORD = re.compile(r"[A-Z][a-z0-9]*$")
_AROUND = re.compile(r"([A-Z][a-z0-9]*)([A-Z][a-z0-9]*)")
_SIMPLE = re.compile(r"[^a-z0-9]")
_MAKER = "new_"


class LiteralClasses:
    """Classes by the values and texts that scripts choose them with; what was found is kept."""

    def __init__(self, classes: Classes, former: FormerNames | None = None) -> None:
        self._classes = classes
        self._former = former
        self._value_classes: dict[str, dict[str, str]] = {}
        self._settable_kinds: dict[str, str] = {}
        self._labels: dict[str, dict[str, list[str]]] = {}

    def class_of_value(self, base: str, value: str) -> str:
        """The class below ``base`` that a value stands for: Modifier and ``CLOTH`` → ClothModifier; empty for none."""
        if value.isidentifier():
            cls = f"{T}{value}"
            if not self._classes.is_class(cls) and self._former:
                cls = self._former.still_works(cls)  # the name of another Blender, which this one takes
            if cls and self._classes.descends(cls, base):
                return cls
        if base == _INTERFACE and value.startswith("NodeSocket"):
            cls = f"{base}{value.removeprefix('NodeSocket')}"
            return cls if self._classes.is_class(cls) else ""
        if base not in self._value_classes:
            self._value_classes[base] = self._values_of(base)
        return self._value_classes[base].get(value, "")

    def class_of_maker(self, base: str, function: str) -> str:
        """The class below ``base`` that a function is named after: Strip and ``new_sound`` → SoundStrip; or empty."""
        kind = function.removeprefix(_MAKER)
        return "" if kind == function else self.class_of_value(base, kind.upper())

    def _values_of(self, base: str) -> dict[str, str]:
        """Value → class, for every value of the property of ``base`` that tells its classes apart."""
        symbol = next(filter(None, (self._classes.inherited(base, name) for name in DISCRIMINANTS)), None)
        short = base.removeprefix(T)
        last = _WORD.search(short)
        affixes = {short.lower(), last[0].lower() if last else ""}
        around = _AROUND.fullmatch(short)
        by_name: dict[str, str] = {}
        by_label: dict[str, str] = {}
        for path in self._classes.descendants(base):
            cls = self._classes.symbols.symbol(path)
            name = path.removeprefix(T).lower()
            by_name[name] = path
            for affix in affixes:
                by_name.setdefault(_SIMPLE.sub("", name.removesuffix(affix).removeprefix(affix)), path)
                label = _SIMPLE.sub("", cls.label.lower() if cls else "")
                by_label.setdefault(label.removesuffix(affix).removeprefix(affix), path)
            if around:  # ActionStrip and ActionKeyframeStrip
                by_name.setdefault(name.removeprefix(around[1].lower()).removesuffix(around[2].lower()), path)
        found: dict[str, str] = {}
        for item in symbol.enum_items if symbol else ():
            key, label = (_SIMPLE.sub("", text.lower()) for text in (item.identifier, item.name))
            if path := by_name.get(key) or by_label.get(key) or by_label.get(label):
                found[item.identifier] = path
        if base == NODE:
            found |= self._nodes_by_type()
        for value, name in CLASS_OF_VALUE.get(short, {}).items():
            if self._classes.is_class(T + name):
                found[value] = T + name
        return found

    def _nodes_by_type(self) -> dict[str, str]:
        """The value of ``type`` → the class of nodes, of those that nodes of one class alone have."""
        classes: dict[str, list[str]] = {}
        for path in self._classes.descendants(NODE):
            symbol = self._classes.symbols.symbol(path)
            for value in symbol.flagged(NODE_TYPE) if symbol else ():
                classes.setdefault(value, []).append(path)
        return {value: paths[0] for value, paths in classes.items() if len(paths) == 1}

    def settable_kind(self, cls: str) -> str:
        """The base of a class whose instances become one of another class below it by a setting; empty for none."""
        if cls not in self._settable_kinds:
            self._settable_kinds[cls] = self._settable_kind(cls) if self._classes.is_class(cls) else ""
        return self._settable_kinds[cls]

    def _settable_kind(self, cls: str) -> str:
        for name in DISCRIMINANTS:
            member = self._classes.inherited(cls, name)
            if member is not None and READ_ONLY not in member.flags and member.type == "enum":
                base = member.owner
                values = (item.identifier for item in member.enum_items)
                if any(self.class_of_value(base, value) for value in values):
                    return base
        return ""

    def classes_by_label(self, base: str, text: str) -> list[str]:
        """The classes below ``base`` whose instances are called ``text`` unless somebody renames them."""
        if base not in self._labels:
            labels: dict[str, list[str]] = {}
            for path in self._classes.descendants(base):
                symbol = self._classes.symbols.symbol(path)
                label = symbol.label if symbol else ""
                texts = {label.removesuffix(suffix) for suffix in ("", " Modifier", " Constraint")}
                texts.add(CALLED.get(path.removeprefix(T), ""))
                # The name that Blender gives; what nodes call their sockets tells no class of sockets.
                if symbol and not is_socket(symbol.reached) and (key := _KEY.search(symbol.reached)):
                    texts.add(key["name"])
                for own in texts - {""}:
                    labels.setdefault(own, []).append(path)
            self._labels[base] = labels
        name, dot, number = text.rpartition(".")
        return self._labels[base].get(name if dot and number.isdigit() else text, [])
