"""Text in brackets behind what is no collection: custom properties, and the inputs of a geometry-nodes modifier."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.index.analysis import stem, words
from kb_build.symbols.api_names import NEW_SOCKET, TYPES

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader

NODES_MODIFIER = f"{TYPES}NodesModifier"
MODIFIER_PROPERTIES = f"{TYPES}NodesModifierProperties"
OF_NODES_MODIFIER = (NODES_MODIFIER, MODIFIER_PROPERTIES)  # what the inputs were, or are, asked of
PROPERTIES_OF_OPERATORS = f"{TYPES}OperatorProperties"
# How Blender identifies the inputs and outputs of a group, as keys of its modifier: by itself no other key looks so.
INPUT_KEY = re.compile(r"((?:Socket|Input|Output)_\d+)(_use_attribute|_attribute_name)?")
# The classes whose instances, and whose subclasses' instances, take custom properties. (Of the modifier, whose inputs
# are properties since Blender 5.2, the same keys are asked, and :meth:`CustomProperties.note` tells what takes them.)
_TAKING = frozenset(
    {
        "AssetMetaData",
        "Bone",
        "BoneCollection",
        "EditBone",
        "ID",
        "Node",
        "NodesModifier",
        "NodesModifierProperties",
        "OperatorProperties",
        "PoseBone",
        "PropertyGroup",
        "Strip",
        "ViewLayer",
    }
)
_TAKING_ONCE = frozenset({"AddonPreferences"})  # … before Blender kept registered properties apart
# There since Blender 5.0, which keeps the properties that are registered apart from the custom ones.
_APART = f"{TYPES}ID.bl_system_properties_get"
_REGISTERED = (
    "A property that is registered by `bpy.props` is not found in brackets since Blender 5.0: it is the attribute "
    '`.{name}`, and what is stored of it `.bl_system_properties_get()["{name}"]`, once it was set.'
)
_LIMITED = (
    '`["_RNA_UI"]` sets no limits since Blender 3.0: `owner.id_properties_ui("name").update(min=0.0, max=2.0)` does, '
    'once `owner["name"]` was set.'
)
PROPERTIES_OF_MODIFIER = f"{NODES_MODIFIER}.properties"  # since Blender 5.2
_AS_PROPERTIES = (
    "Inputs of a geometry-nodes modifier are attributes of `modifier.properties.inputs` since Blender 5.2, by the "
    "identifier of the group's input: `modifier.properties.inputs.Socket_2.value = 5.0`, or "
    '`getattr(modifier.properties.inputs, modifier.node_group.interface.items_tree["Size"].identifier).value = 5.0`, '
    'then `obj.update_tag()`; `.keyframe_insert("value", frame=1)` of the same keys it. An attribute is used '
    "instead of a value by `.type = 'ATTRIBUTE'` and `.attribute_name = \"name\"`; a menu takes the name of an entry. "
    "Brackets on the modifier, or on its "
    f"`properties`, raise TypeError. `{PROPERTIES_OF_MODIFIER}` is None until the modifier has a `node_group`."
)
_ATTRIBUTES = (
    'An attribute is used instead of a value by `modifier[identifier + "_use_attribute"] = True` and '
    '`modifier[identifier + "_attribute_name"] = "name"`.'
)
_ITEMS = f"{TYPES}NodeTreeInterface.items_tree"
_MENU = f"{TYPES}NodeTreeInterfaceSocketMenu"
# How people say in plain words that they want to set an input: of a modifier it may be called anything, of geometry
# nodes alone it is one where no node is meant.
_SAID = frozenset(map(stem, ("geometry", "nodes")))
_INPUT = frozenset(map(stem, ("input", "value", "property", "socket", "slider", "attribute", "setting")))
_OUTSIDE = frozenset(map(stem, ("parameter", "exposed")))
_PARTS = frozenset(map(stem, ("input", "socket", "slider", "parameter")))
_MODIFIER = stem("modifier")
_NEW = frozenset(map(stem, ("add", "new", "create")))
_MAKING = _NEW | frozenset(map(stem, ("remove", "delete", "interface", "field")))


def asked_of_inputs(query: str) -> str:
    """What a query in plain words asks for that is about the inputs of a geometry-nodes modifier: the modifier, or what
    makes an input, which is one of its group; empty for neither.
    """
    stems = set(map(stem, words(query)))
    if not stems >= _SAID:
        return ""
    is_of_modifier = _MODIFIER in stems
    if stems.isdisjoint(_MAKING):
        return "" if stems.isdisjoint(_OUTSIDE | _INPUT if is_of_modifier else _OUTSIDE) else NODES_MODIFIER
    is_new = is_of_modifier and not stems.isdisjoint(_PARTS) and not stems.isdisjoint(_NEW)
    return NEW_SOCKET if is_new else ""


class CustomProperties:
    """Which classes of one base take custom properties, and what is said of one."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def taken_by(self, cls: str) -> list[str]:
        """The class, if it takes them; else those below it that do."""
        taking = _TAKING if self._are_apart else _TAKING | _TAKING_ONCE
        if any(entry.name in taking for entry in self._reader.lineage(cls)):
            return [cls]
        return [entry.path for entry in self._reader.descendants(cls) if entry.name in taking]

    @property
    def inputs_are_properties(self) -> bool:
        """Whether the inputs of a geometry-nodes modifier are properties, and the modifier takes no keys."""
        return self._reader.entry(PROPERTIES_OF_MODIFIER) is not None

    @property
    def _are_apart(self) -> bool:
        return self._reader.entry(_APART) is not None

    def on_registered(self, name: str) -> str:
        """A sentence on a registered property that is not found in brackets; empty where it is."""
        return _REGISTERED.format(name=name) if self._are_apart and name.isidentifier() else ""

    def note(self, cls: str, name: str, *, assigned: bool = False) -> str:
        """A sentence on ``x["name"]``, read or ``assigned``, where ``x`` is of a class that takes custom properties."""
        if cls in OF_NODES_MODIFIER:
            return self.on_inputs()
        if name == "_RNA_UI":
            return _LIMITED
        said = f'`["{name}"]` is a custom property of `{cls}`, not one of its attributes: assigning makes it'
        said += (
            "."
            if assigned
            else f', reading raises KeyError until then; `.get("{name}")` returns None instead.'
        )
        return f"{said} {self.on_registered(name)}".rstrip()

    def on_operators(self, function: Symbol, name: str) -> str:
        """A sentence on what is read or set of the properties of an operator that a function gives; "" for others."""
        if not any(f"{TYPES}{given.type}" == PROPERTIES_OF_OPERATORS for given in function.returns):
            return ""
        return (
            f"`{function.path}` gives the properties of the operator that it names: `.{name}` is one of those that the "
            "operator's own class defines."
        )

    def on_attributes(self) -> str:
        """How an attribute is used as an input of such a modifier; empty where inputs are no custom properties."""
        return "" if self.inputs_are_properties else _ATTRIBUTES

    def on_inputs(self) -> str:
        """How the inputs of a geometry-nodes modifier are set."""
        if self.inputs_are_properties:
            return _AS_PROPERTIES
        items = "interface.items_tree" if self._reader.entry(_ITEMS) else "inputs"
        told = [
            "Inputs of a geometry-nodes modifier are set by the identifier of the group's input, not by its name: "
            f'`modifier[modifier.node_group.{items}["Size"].identifier] = 5.0`, then `obj.update_tag()`. '
            "Another key makes a custom property that changes nothing. "
            "`modifier.keyframe_insert(f'[\"{identifier}\"]', frame=1)` keys it."
        ]
        told.append(_ATTRIBUTES)
        if items.startswith("interface"):
            told.append("Where an output has the same name, take the item whose `in_out` is 'INPUT'.")
        if self._reader.entry(_MENU):
            told.append(
                "A menu takes the number of an entry, which is not its index: the last in the entry's row of "
                '`modifier.id_properties_ui(identifier).as_dict()["items"]`.'
            )
        return " ".join(told)
