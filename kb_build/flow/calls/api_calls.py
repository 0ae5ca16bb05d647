"""Evaluates calls of the API's functions, operators and classes: what they are given, and what they return."""

from __future__ import annotations

import ast
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

from kb_build.flow.blender.api import ARRAY, operator_path, part_of_macro
from kb_build.flow.blender.facts import (
    BMESH_RESULTS,
    CLASS_NAMES,
    DERIVED_BY_SCRIPTS,
    ELEMENT,
    NAME_OF_PROPERTY,
    OF_OPERATOR,
    OPEN_CALLS,
    OPERATOR_PROPERTIES,
)
from kb_build.flow.calls.callbacks import Callbacks
from kb_build.flow.evaluation.given_values import CARRYING, constants
from kb_build.flow.state.core import ANY
from kb_build.flow.values.types import (
    BOOL,
    FLOAT,
    INT,
    NONE,
    STR,
    UNKNOWN,
    ClassObject,
    Collection,
    Function,
    Instance,
    LocalClass,
    LocalFunction,
    LocalInstance,
    Mapping,
    Operator,
    Sequence,
    Tuple,
    Type,
    instance_of,
    join,
    literal,
    literal_text,
    literal_texts,
    union,
    without_none,
)
from kb_build.symbols.api_names import OBJECT
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.math_classes import math_class_of

if TYPE_CHECKING:
    from kb_build.flow.calls.read_calls import Keywords, ReadCall
    from kb_build.symbols.records import Parameter, Symbol

# Arguments that name a property of another argument or of the receiver: function → (text, owner; -1 the receiver).
_NAMES_PROPERTY = {
    "keyframe_insert": (0, "data_path", -1), "keyframe_delete": (0, "data_path", -1),
    "driver_add": (0, "path", -1), "driver_remove": (0, "path", -1), "property_unset": (0, "property", -1),
    "is_property_set": (0, "property", -1), "property_overridable_library_set": (0, "property", -1),
    "path_from_id": (0, "property", -1), "foreach_get": (0, "attr", -1), "foreach_set": (0, "attr", -1),
    "prop": (1, "property", 0), "prop_search": (1, "property", 0), "prop_enum": (1, "property", 0),
    "prop_menu_enum": (1, "property", 0), "props_enum": (1, "property", 0), "template_ID": (1, "property", 0),
    "prop_tabs_enum": (1, "property", 0), "prop_with_popover": (1, "property", 0),
}  # fmt: skip
_PROPERTIES: dict[str, Type] = {
    "FloatProperty": FLOAT, "IntProperty": INT, "BoolProperty": BOOL, "StringProperty": STR, "EnumProperty": STR,
    **{
        f"{name}VectorProperty": Instance(ARRAY, ((ELEMENT, number),))
        for name, number in (("Float", FLOAT), ("Int", INT), ("Bool", BOOL))
    },
}  # fmt: skip
_USUAL_VECTOR = (3,)  # the size of one that is declared without
_CONVERTING = "bpy.ops.object.convert"
_KEY = f"{T}KeyMapItem"
_LAYOUT = f"{T}UILayout"
_ANY_STRUCT = "AnyType"  # of a parameter that takes any struct
_OPERATOR_RESULT = Sequence("set", STR)


class ApiCalls(Callbacks):
    """Evaluates calls of the API."""

    def call_operator(self, callee: Operator, call: ReadCall) -> Type:
        """What an operator returns; the keywords that it is given are recorded."""
        symbol = self.api.symbols.symbol(callee.path)
        self.resolve(call.node, "call", callee.path, (callee.path,))
        if symbol:
            self._keywords(symbol, call.node)
        if callee.path == _CONVERTING:
            self._forget_data()
        return _OPERATOR_RESULT

    def _forget_data(self) -> None:
        """Objects have got data of another kind: a mesh has become a curve."""
        state = self.here.scope.state
        self.spend(len(state.names) + len(state.chains))
        for chain in [chain for chain in state.chains if chain.endswith(".data")]:
            del state.chains[chain]
        for held in (state.names, state.chains):
            for text, kind in held.items():
                if isinstance(kind, Instance) and kind.cls == OBJECT and kind.traits:
                    held[text] = replace(kind, traits=())

    def call_function(self, callee: Function, call: ReadCall) -> Type:
        """What a function or a method of the API returns; what it is given is recorded."""
        path = callee.path
        symbol = self.api.symbols.symbol(path)
        if symbol is None:
            return UNKNOWN
        sure = not isinstance(callee.receiver, Instance) or callee.receiver.sure
        self.resolve(call.node, "call", path, (path,), sure=sure)
        self._keywords(symbol, call.node)
        self._values(symbol, call.node)
        name = symbol.name
        if symbol.owner == "bpy.props":
            return self._property(name, call.keywords)
        if symbol.owner == "bmesh.ops":
            return self._bmesh_result()
        if name in {"append", "prepend"} and isinstance(callee.receiver, ClassObject):
            for kind in call.arguments:
                if isinstance(kind, LocalFunction):
                    self.pass_to(kind.number, [Instance(callee.receiver.cls), Instance(f"{T}Context")], {})
        self.given_to_method(path, call)
        self._names(callee, name, call)
        if symbol.owner == _LAYOUT:
            self._names_beside(symbol, call)
        if name == "context_pointer_set" and call.arguments:
            self.registered[f"{T}Context", literal_text(call.argument(0)) or ANY] = call.argument(1)
        if isinstance(callee.receiver, Collection) and name == "get":
            node = call.node.args[0] if call.node.args else call.node
            found = self.collection_item(callee.receiver, call.argument(0), node)
            return found if len(call.arguments) < 2 else join(found, call.argument(1))
        if name == "driver_add":
            return self._added_drivers(call)
        result = self.api.returned(path, callee.receiver)
        if result is UNKNOWN and _raises_instead(symbol, call.node):
            result = self.api.read_type(symbol.returns[0].type.removesuffix(" | Any"), path)
        return self._decided(result, symbol, call)

    def _added_drivers(self, call: ReadCall) -> Type:
        """One curve, or a list of them where the property has several values and no index is given."""
        curve = self.api.instance(f"{T}FCurve")
        is_path_alone = len(call.arguments) == 1 and not call.keywords
        named = self.here.resolutions.get(call.node.args[0]) if is_path_alone else None
        paths = named.symbols if named else ()
        symbols = [symbol for path in paths if (symbol := self.api.symbols.symbol(path))]
        if symbols and all(symbol.array for symbol in symbols):
            return Sequence("list", curve)
        index = literal(call.argument(1))
        is_one = (isinstance(index, int) and index >= 0) or (symbols and not any(s.array for s in symbols))
        return curve if is_one else union((curve, Sequence("list", curve)))

    def _keywords(self, symbol: Symbol, node: ast.Call) -> None:
        parameters = {parameter.name: parameter for parameter in symbol.parameters}
        is_open = symbol.path in OPEN_CALLS or any(_is_open(parameter) for parameter in symbol.parameters)
        takes_nothing = symbol.owner.startswith(T) and symbol.has_empty_signature
        for keyword in node.keywords:
            name = keyword.arg
            if name is None or (name == NAME_OF_PROPERTY and symbol.owner == "bpy.props"):
                continue
            if parameter := parameters.get(name):
                self.resolve(keyword, "keyword", name, (f"{symbol.path}({name})",))
                self._value(symbol, parameter, keyword.value)
            elif not is_open and (symbol.parameters or symbol.kind == "operator" or takes_nothing):
                self.resolve(keyword, "keyword", name, missing=(symbol.path,))

    def _values(self, symbol: Symbol, node: ast.Call) -> None:
        for parameter, argument in zip(symbol.positional, node.args, strict=False):
            if isinstance(argument, ast.Starred):
                return
            self._value(symbol, parameter, argument)

    def _macro_part(self, path: str, node: ast.Dict) -> None:
        """What a macro calls one of its operators with: ``TRANSFORM_OT_translate={"value": (1, 0, 0)}``."""
        symbol = self.api.symbols.symbol(path)
        for key, value in zip(node.keys, node.values, strict=True):
            if symbol is None or not isinstance(key, ast.Constant) or not isinstance(key.value, str):
                continue
            if parameter := symbol.parameter(key.value):
                self.resolve(key, "keyword", key.value, (f"{path}({key.value})",))
                self._value(symbol, parameter, value)
            else:
                self.resolve(key, "keyword", key.value, missing=(path,))

    def _value(self, symbol: Symbol, parameter: Parameter, node: ast.expr) -> None:
        sources = (f"{symbol.path}({parameter.name})",)
        if isinstance(node, ast.Dict) and (part := part_of_macro(parameter)):
            self._macro_part(part, node)
        if parameter.enum_items:
            nodes = node.elts if isinstance(node, ast.Set) else [node]
            for item in nodes:
                for constant in constants(item) if isinstance(item, (ast.Constant, ast.IfExp)) else ():
                    if constant in self.here.types:  # else it is of a branch for other versions
                        self.resolve_value(constant, constant.value, sources)
                if isinstance(item, CARRYING):
                    self.check_carried(item, sources)
        elif isinstance(node, CARRYING) and CLASS_NAMES.get(symbol.path) == parameter.name:
            self.here.resolutions.pop(node, None)
            text = self.carried_text(node)
            if text and not self.api.is_class(T + text):
                self.resolve(node, "class", text, missing=sources)

    def _decided(self, result: Type, symbol: Symbol, call: ReadCall) -> Type:
        """A result as its arguments decide it: ``modifiers.new("x", 'CLOTH')`` is a ClothModifier."""
        if not isinstance(result, Instance):
            return result
        names = (parameter.name for parameter in symbol.positional)
        given = {**dict(zip(names, call.arguments, strict=False)), **call.keywords}
        if result.cls == OBJECT and "object_data" in given:
            data = without_none(given["object_data"])
            return (
                replace(result, traits=(("data", data),)) if data is not UNKNOWN and data != NONE else result
            )
        if result.cls == OPERATOR_PROPERTIES:
            return self._set_up(result, given.get("operator", UNKNOWN))
        if result.cls == _KEY:
            properties = self._set_up(Instance(OPERATOR_PROPERTIES), given.get("idname", UNKNOWN))
            return replace(result, traits=(("properties", properties),))
        if cls := self.api.literals.class_of_maker(result.cls, symbol.name):
            return replace(result, cls=cls)
        is_open = not DERIVED_BY_SCRIPTS.isdisjoint(self.api.lineage(result.cls))
        found: list[Type] = []
        for name in ("type", "socket_type", "effect_type"):
            for value in literal_texts(given[name]) if name in given else ():
                cls = self.api.literals.class_of_value(result.cls, value)
                if not cls and is_open and (own := self._own_class(value, result.cls)):
                    found.append(LocalInstance(own.number))
                    continue
                # A value that no class of the API answers to may be that of a script's own class.
                found.append(
                    replace(result, cls=cls or result.cls, sure=result.sure and bool(cls or not is_open))
                )
        return union(found) if found else result

    def _own_class(self, name: str, base: str) -> LocalClass | None:
        """The class of the script that Blender knows by a name, if it derives from one of the API's."""
        own = self.own_types.get(name)
        if not isinstance(own, LocalClass):
            return None
        bases, known = self.api_bases(own.number)
        return own if known and any(self.api.descends(cls, base) for cls in bases) else None

    @staticmethod
    def _set_up(result: Instance, name: Type) -> Type:
        """What an operator is called with by a button, or by a key, that names it."""
        paths = [operator_path(text) for text in literal_texts(name)]
        return (
            union(replace(result, traits=((OF_OPERATOR, Operator(path)),)) for path in paths)
            if paths
            else result
        )

    def _names(self, callee: Function, name: str, call: ReadCall) -> None:
        """Records texts that name a property: ``layout.prop(cloth, "quality")``, ``ob.keyframe_insert("location")``."""
        node = call.node
        if name == "operator" and node.args:
            self._named_operator(node.args[0], call.argument(0))
            return
        if name not in _NAMES_PROPERTY:
            return
        place, keyword, owner_place = _NAMES_PROPERTY[name]
        text_node = node.args[place] if len(node.args) > place else None
        for given in node.keywords:
            if given.arg == keyword:
                text_node = given.value
        if not isinstance(text_node, ast.Constant):
            return
        if owner_place < 0:
            owner = callee.receiver
            if isinstance(owner, Collection):
                owner = owner.element
        else:
            owner = call.argument(owner_place)
        text = text_node.value
        if not isinstance(text, str) or not text.isidentifier() or owner is UNKNOWN:
            return
        found = self.attribute(owner, text)
        if found.symbols or found.missing or found.possible:
            kind = "text" if owner_place < 0 else "button"
            self.resolve(text_node, kind, text, found.symbols, found.missing, found.possible, sure=found.sure)

    def _names_beside(self, symbol: Symbol, call: ReadCall) -> None:
        """Records the other texts by which a layout finds properties of what stands before them.

        ``layout.prop_search(ob, "parent", scene, "objects")`` has one of each kind.
        """
        names = [parameter.name for parameter in symbol.positional]
        nodes = {
            **dict(zip(names, call.node.args, strict=False)),
            **{key.arg: key.value for key in call.node.keywords},
        }
        kinds = {**dict(zip(names, call.arguments, strict=False)), **call.keywords}
        for holder, parameter in pairwise(symbol.positional):
            node, owner = nodes.get(parameter.name), kinds.get(holder.name, UNKNOWN)
            if node is None or holder.type != _ANY_STRUCT or parameter.type != "string":
                continue
            row = self.here.resolutions.get(node)
            if row is None or row.kind != "button":
                self._names_property(node, owner)

    def _names_property(self, node: ast.expr, owner: Type) -> None:
        """Records a text that names a property of an owner, and is not the one that a button shows."""
        match node:
            case ast.Constant(value=str(text)) if text.isidentifier() and owner is not UNKNOWN:
                self.here.resolutions.pop(node, None)
                found = self.attribute(owner, text)
                if found.symbols or found.missing or found.possible:
                    self.resolve(
                        node, "text", text, found.symbols, found.missing, found.possible, sure=found.sure
                    )
            case _:
                pass

    def _named_operator(self, node: ast.expr, kind: Type) -> None:
        text = literal_text(kind)
        if text and isinstance(node, ast.Constant):
            path = operator_path(text)
            known = self.api.symbols.symbol(path) is not None
            if path in self.own_operators or self.is_there_at_times(path):
                return
            self.resolve(node, "button", path, (path,) if known else (), () if known else ("bpy.ops",))

    def _property(self, name: str, keywords: Keywords) -> Type:
        """The value of a property that bpy.props declares."""
        self.given_to_property(keywords)
        if name in {"PointerProperty", "CollectionProperty"}:
            element = instance_of(keywords.get("type", UNKNOWN))
            if name == "PointerProperty" or element is UNKNOWN:
                return element
            return Collection(element, "bpy.types.bpy_prop_collection_idprop", "", UNKNOWN)
        if name == "FloatVectorProperty" and "subtype" in keywords:
            return self._vector(keywords)
        if isinstance(keywords.get("size"), Tuple):  # of rows
            return Instance(ARRAY, ((ELEMENT, UNKNOWN),))
        return _PROPERTIES.get(name, UNKNOWN)

    def _vector(self, keywords: Keywords) -> Type:
        """The value of a vector that is declared with a subtype: a Quaternion of four numbers of a rotation."""
        subtype, size = literal_text(keywords["subtype"]), keywords.get("size")
        numbers = [
            literal(each) for each in (size.items if isinstance(size, Tuple) else (size,) if size else ())
        ]
        array = tuple(number for number in numbers if isinstance(number, int)) if numbers else _USUAL_VECTOR
        if subtype is None or len(array) < len(numbers):
            return UNKNOWN
        math = math_class_of(subtype, array)
        return Instance(math) if math else _PROPERTIES["FloatVectorProperty"]

    def _bmesh_result(self) -> Type:
        """What an operator of bmesh returns: lists by name."""
        items: list[tuple[str, Type]] = []
        for prefix, names in BMESH_RESULTS.items():
            element = union(Instance(f"bmesh.types.{name}") for name in names)
            for suffix in (
                "",
                "s",
                "_inner",
                "_split",
                "_cut",
                "_out",
                "s_out",
                "_contig",
                "_interior",
                "_holes",
            ):
                items.append((f"{prefix}{suffix}", Sequence("list", element)))
        return Mapping(STR, UNKNOWN, tuple(items))

    def call_class(self, callee: ClassObject, call: ReadCall) -> Type:
        """An instance of a class of the API; what it is given is recorded."""
        self.resolve(call.node, "call", callee.cls, (callee.cls,))
        symbol = self.api.symbols.symbol(callee.cls)
        if symbol and symbol.parameters:
            self._keywords(symbol, call.node)
            self._values(symbol, call.node)
        return Instance(callee.cls)


def _raises_instead(symbol: Symbol, call: ast.Call) -> bool:
    """Whether a call raises an error where it might return what it is given for that case: it is given nothing."""
    is_plain = not call.keywords and not any(isinstance(argument, ast.Starred) for argument in call.args)
    left = symbol.parameters[len(call.args) :] if is_plain and len(symbol.returns) == 1 else ()
    return any(not one.required and "(instead of raising" in one.description for one in left)


def _is_open(parameter: Parameter) -> bool:
    """Whether a parameter takes any keyword."""
    return parameter.name.startswith("*") or parameter.type.startswith("**")
