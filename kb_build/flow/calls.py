"""Evaluates calls: of the API's functions and operators, of Python's own, and of the script's."""

from __future__ import annotations

import ast
from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

from kb_build.flow.core import ANY, DEEPEST_RUN
from kb_build.flow.expressions import constants
from kb_build.flow.facts import (
    BMESH_RESULTS,
    CLASS_NAMES,
    DERIVED_BY_SCRIPTS,
    NAME_OF_PROPERTY,
    OPEN_CALLS,
    VERSION,
    T,
    leaves_active,
    made_by,
)
from kb_build.flow.narrowing import Narrowing
from kb_build.flow.texts import passed
from kb_build.flow.type_parts import bounded
from kb_build.flow.types import (
    BOOL,
    FLOAT,
    INT,
    NONE,
    STR,
    UNKNOWN,
    Builtin,
    ClassObject,
    Collection,
    Function,
    Instance,
    LocalClass,
    LocalFunction,
    LocalInstance,
    Mapping,
    Operator,
    Plain,
    Resolution,
    Sequence,
    Tuple,
    Type,
    Union,
    instance_of,
    join,
    literal,
    literal_text,
    literal_texts,
    union,
    without_none,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from kb_build.flow.definitions import FunctionDefinition
    from kb_build.records import Parameter, Symbol

_MOST_RUNS = 3
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
_ITERATORS = {
    "list": "list", "sorted": "list", "set": "set", "frozenset": "set", "tuple": "list", "reversed": "iterator",
    "iter": "iterator",
}  # fmt: skip
_PLAIN_RESULTS: dict[str, Type] = {
    "len": INT, "int": INT, "float": FLOAT, "str": STR, "bool": BOOL, "repr": STR, "isinstance": BOOL,
    "any": BOOL, "all": BOOL, "callable": BOOL, "print": NONE,
}  # fmt: skip
_STRING_RESULTS: dict[str, Type] = {
    "split": Sequence("list", STR), "rsplit": Sequence("list", STR), "splitlines": Sequence("list", STR),
    "partition": Tuple((STR, STR, STR)), "rpartition": Tuple((STR, STR, STR)), "find": INT, "rfind": INT,
    "index": INT, "count": INT, "startswith": BOOL, "endswith": BOOL, "encode": Plain("bytes"), "isdigit": BOOL,
}  # fmt: skip
_PROPERTIES: dict[str, Type] = {
    "FloatProperty": FLOAT, "IntProperty": INT, "BoolProperty": BOOL, "StringProperty": STR, "EnumProperty": STR,
    "FloatVectorProperty": Sequence("array", FLOAT), "IntVectorProperty": Sequence("array", INT),
    "BoolVectorProperty": Sequence("array", BOOL),
}  # fmt: skip
_CONVERTING, _OBJECT = "bpy.ops.object.convert", f"{T}Object"
_OPERATOR_RESULT = Sequence("set", STR)


def _in_order(paths: Iterable[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(paths))


class Calls(Narrowing):
    """Evaluates calls."""

    def call(self, callee: Type, node: ast.Call) -> Type:
        """See :class:`core.Core`."""
        arguments = [self.evaluate(argument) for argument in node.args]
        keywords = [(keyword, self.evaluate(keyword.value)) for keyword in node.keywords]
        if callee is UNKNOWN:
            result = self._made_by_class_name(node, arguments, keywords)
        elif isinstance(callee, Union):
            result = self._one_of_several(callee, node, arguments, keywords)
        else:
            result = self._one_call(callee, node, arguments, keywords)
        self.scope.state.active = self._active_after(callee)
        return result

    def _active_after(self, callee: Type) -> Type | None:
        """The active object behind a call, where an operator has made it and nothing may have changed that."""
        match callee:
            case Operator(path=path) if kind := made_by(path):
                data = self.api.object_data(kind)
                return Instance(_OBJECT, (("data", data),)) if data is not UNKNOWN else None
            case Operator(path=path) if not leaves_active(path):
                return None
            case Function(path=path) if path.endswith((".temp_override", ".remove", ".link", ".unlink")):
                return None
            case Operator() | Function() | ClassObject() | Builtin():
                return self.scope.state.active
            case _:
                return None

    def _one_of_several(
        self, callee: Union, node: ast.Call, arguments: list[Type], keywords: list[tuple[ast.keyword, Type]]
    ) -> Type:
        """A call of one of several: an argument is recorded for all of them, and is none where none takes it."""
        parts = [*node.keywords, *(part for argument in node.args for part in constants(argument))]
        parts += [part for keyword in node.keywords for part in constants(keyword.value)]
        given = [*node.args, *(keyword.value for keyword in node.keywords)]
        parts += [part for part in given if isinstance(part, ast.Name)]
        called = [member for member in callee.members if member is not NONE]
        results: list[Type] = []
        rows: dict[ast.AST, list[Resolution]] = defaultdict(list)
        for member in called:
            for part in parts:
                self.resolutions.pop(part, None)
            results.append(self._one_call(member, node, arguments, keywords))
            for part in parts:
                if row := self.resolutions.get(part):
                    rows[part].append(row)
        for part, found in rows.items():
            symbols = _in_order(path for row in found for path in row.symbols)
            missing = _in_order(path for row in found for path in row.missing)
            # What tells nothing of an argument may take it.
            is_sure = len(found) == len(called) and all(row.sure for row in found)
            self.resolutions[part] = replace(found[-1], symbols=symbols, missing=missing, sure=is_sure)
        return union(results)

    def _made_by_class_name(
        self, node: ast.Call, arguments: list[Type], keywords: list[tuple[ast.keyword, Type]]
    ) -> Type:
        """``tree.nodes.new("ShaderNodeMath")``: the text is the class, whatever the tree is."""
        match node.func:
            case ast.Attribute(value=ast.Attribute(attr="nodes") | ast.Name(id="nodes"), attr="new"):
                given = [*arguments, *(kind for _, kind in keywords)]
                text = literal_text(given[0]) if given else None
                if text and self.api.descends(f"{T}{text}", f"{T}Node"):
                    return Instance(f"{T}{text}")
            case _:
                pass
        return UNKNOWN

    def _one_call(
        self, callee: Type, node: ast.Call, arguments: list[Type], keywords: list[tuple[ast.keyword, Type]]
    ) -> Type:
        caller = self._callers.get(type(callee))
        return caller(self, callee, node, arguments, keywords) if caller else UNKNOWN

    # The API.

    def _operator(
        self,
        callee: Operator,
        node: ast.Call,
        _arguments: list[Type],
        keywords: list[tuple[ast.keyword, Type]],
    ) -> Type:
        symbol = self.api.symbols.symbol(callee.path)
        self.resolve(node, "call", callee.path, (callee.path,))
        if symbol:
            self._keywords(symbol, keywords)
        if callee.path == _CONVERTING:
            self._forget_data()
        return _OPERATOR_RESULT

    def _forget_data(self) -> None:
        """Objects have got data of another kind: a mesh has become a curve."""
        state = self.scope.state
        self.spend(len(state.names) + len(state.chains))
        for name, kind in state.names.items():
            if isinstance(kind, Instance) and kind.cls == _OBJECT and kind.traits:
                state.names[name] = replace(kind, traits=())
        for chain in [chain for chain in state.chains if chain.endswith(".data")]:
            del state.chains[chain]

    def _function(
        self,
        callee: Function,
        node: ast.Call,
        arguments: list[Type],
        keywords: list[tuple[ast.keyword, Type]],
    ) -> Type:
        path = callee.path
        symbol = self.api.symbols.symbol(path)
        if symbol is None:
            return UNKNOWN
        sure = not isinstance(callee.receiver, Instance) or callee.receiver.sure
        self.resolve(node, "call", path, (path,), sure=sure)
        self._keywords(symbol, keywords)
        self._values(symbol, node)
        name = symbol.name
        if symbol.owner == "bpy.props":
            return self._property(name, keywords)
        if symbol.owner == "bmesh.ops":
            return self._bmesh_result()
        if name in {"append", "prepend"} and isinstance(callee.receiver, ClassObject):
            for kind in arguments:
                if isinstance(kind, LocalFunction):
                    self._pass(kind.number, [Instance(callee.receiver.cls), Instance(f"{T}Context")], {})
        self._names(callee, name, node, arguments)
        if name == "context_pointer_set" and arguments:
            held = arguments[1] if len(arguments) > 1 else UNKNOWN
            self.registered[f"{T}Context", literal_text(arguments[0]) or ANY] = held
        if isinstance(callee.receiver, Collection) and name == "get":
            key = arguments[0] if arguments else UNKNOWN
            found = self.collection_item(callee.receiver, key, node.args[0] if node.args else node)
            return found if len(arguments) < 2 else join(found, arguments[1])
        if name == "driver_add":
            return self._added_drivers(node, arguments)
        result = self.api.returned(path, callee.receiver)
        if result is UNKNOWN and _raises_instead(symbol, node):
            result = self.api.read_type(symbol.returns[0].type.removesuffix(" | Any"), path)
        return self._decided(result, symbol, arguments, keywords)

    def _added_drivers(self, node: ast.Call, arguments: list[Type]) -> Type:
        """One curve, or a list of them where the property has several values and no index is given."""
        curve = self.api.instance(f"{T}FCurve")
        named = self.resolutions.get(node.args[0]) if len(arguments) == 1 and not node.keywords else None
        paths = named.symbols if named else ()
        symbols = [symbol for path in paths if (symbol := self.api.symbols.symbol(path))]
        if symbols and all(symbol.array for symbol in symbols):
            return Sequence("list", curve)
        index = literal(arguments[1]) if len(arguments) > 1 else None
        is_one = (isinstance(index, int) and index >= 0) or (symbols and not any(s.array for s in symbols))
        return curve if is_one else union((curve, Sequence("list", curve)))

    def _keywords(self, symbol: Symbol, keywords: list[tuple[ast.keyword, Type]]) -> None:
        parameters = {parameter.name: parameter for parameter in symbol.parameters}
        is_open = symbol.path in OPEN_CALLS or any(_is_open(parameter) for parameter in symbol.parameters)
        takes_nothing = symbol.owner.startswith(T) and symbol.has_empty_signature
        for keyword, _ in keywords:
            name = keyword.arg
            if name is None or (name == NAME_OF_PROPERTY and symbol.owner == "bpy.props"):
                continue
            if parameter := parameters.get(name):
                self.resolve(keyword, "keyword", name, (f"{symbol.path}({name})",))
                self._value(symbol, parameter, keyword.value)
            elif not is_open and (symbol.parameters or symbol.kind == "operator" or takes_nothing):
                self.resolve(keyword, "keyword", name, missing=(symbol.path,))

    def _values(self, symbol: Symbol, node: ast.Call) -> None:
        positional = [p for p in symbol.parameters if p.name not in {"self", "cls"}]
        for parameter, argument in zip(positional, node.args, strict=False):
            if isinstance(argument, ast.Starred):
                return
            self._value(symbol, parameter, argument)

    def _value(self, symbol: Symbol, parameter: Parameter, node: ast.expr) -> None:
        if parameter.enum_items:
            nodes = node.elts if isinstance(node, ast.Set) else [node]
            for item in nodes:
                for constant in constants(item) if isinstance(item, (ast.Constant, ast.IfExp)) else ():
                    if constant in self.types:  # else it is of a branch for other versions
                        self.resolve_value(constant, constant.value, (symbol.path,), parameter.name)
                if isinstance(item, ast.Name):
                    self.check_carried(item, (symbol.path,), parameter.name)
        elif isinstance(node, ast.Name) and CLASS_NAMES.get(symbol.path) == parameter.name:
            self.resolutions.pop(node, None)
            text = self.carried_text(node)
            if text and not self.api.is_class(T + text):
                self.resolve(node, "class", text, missing=(f"{symbol.path}({parameter.name})",))

    def _decided(
        self,
        result: Type,
        symbol: Symbol,
        arguments: list[Type],
        keywords: list[tuple[ast.keyword, Type]],
    ) -> Type:
        """A result as its arguments decide it: ``modifiers.new("x", 'CLOTH')`` is a ClothModifier."""
        if not isinstance(result, Instance):
            return result
        given = {keyword.arg: kind for keyword, kind in keywords}
        positional = [p for p in symbol.parameters if p.name not in {"self", "cls"}]
        for parameter, kind in zip(positional, arguments, strict=False):
            given.setdefault(parameter.name, kind)
        if result.cls == f"{T}Object" and "object_data" in given:
            data = without_none(given["object_data"])
            return (
                replace(result, traits=(("data", data),)) if data is not UNKNOWN and data != NONE else result
            )
        if cls := self.api.class_of_maker(result.cls, symbol.name):
            return replace(result, cls=cls)
        is_open = not DERIVED_BY_SCRIPTS.isdisjoint(self.api.lineage(result.cls))
        found: list[Type] = []
        for name in ("type", "socket_type", "effect_type"):
            for value in literal_texts(given[name]) if name in given else ():
                cls = self.api.class_of_value(result.cls, value)
                # A value that no class of the API answers to may be that of a script's own class.
                found.append(
                    replace(result, cls=cls or result.cls, sure=result.sure and bool(cls or not is_open))
                )
        return union(found) if found else result

    def _names(self, callee: Function, name: str, node: ast.Call, arguments: list[Type]) -> None:
        """Records texts that name a property: ``layout.prop(cloth, "quality")``, ``ob.keyframe_insert("location")``."""
        if name == "operator" and node.args:
            self._named_operator(node.args[0], arguments[0])
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
            owner = arguments[owner_place] if len(arguments) > owner_place else UNKNOWN
        text = text_node.value
        if not isinstance(text, str) or not text.isidentifier() or owner is UNKNOWN:
            return
        found = self.attribute(owner, text)
        if found.symbols or found.missing or found.possible:
            kind = "text" if owner_place < 0 else "button"
            self.resolve(text_node, kind, text, found.symbols, found.missing, found.possible, sure=found.sure)

    def _named_operator(self, node: ast.expr, kind: Type) -> None:
        text = literal_text(kind)
        if text and isinstance(node, ast.Constant):
            module, of_class, name = text.partition("_OT_")
            if not of_class:
                module, _, name = text.partition(".")
            path = f"bpy.ops.{module.lower()}.{name}"  # Blender takes the module in capitals too
            known = self.api.symbols.symbol(path) is not None
            if path in self.own_operators or self.is_there_at_times(path):
                return
            self.resolve(node, "button", path, (path,) if known else (), () if known else ("bpy.ops",))

    def _property(self, name: str, keywords: list[tuple[ast.keyword, Type]]) -> Type:
        """The value of a property that bpy.props declares."""
        for keyword, kind in keywords:
            if keyword.arg in {"update", "items"} and isinstance(kind, LocalFunction):
                self._pass(kind.number, [UNKNOWN, Instance(f"{T}Context")], {})
        if name in {"PointerProperty", "CollectionProperty"}:
            given = next((kind for keyword, kind in keywords if keyword.arg == "type"), UNKNOWN)
            element = instance_of(given)
            if name == "PointerProperty" or element is UNKNOWN:
                return element
            return Collection(element, "bpy.types.bpy_prop_collection_idprop", "", UNKNOWN)
        return _PROPERTIES.get(name, UNKNOWN)

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

    def _class(
        self,
        callee: ClassObject,
        node: ast.Call,
        _arguments: list[Type],
        keywords: list[tuple[ast.keyword, Type]],
    ) -> Type:
        self.resolve(node, "call", callee.cls, (callee.cls,))
        symbol = self.api.symbols.symbol(callee.cls)
        if symbol and symbol.parameters:
            self._keywords(symbol, keywords)
            self._values(symbol, node)
        return Instance(callee.cls)

    # The script's own.

    def _local_class(
        self,
        callee: LocalClass,
        _node: ast.Call,
        arguments: list[Type],
        keywords: list[tuple[ast.keyword, Type]],
    ) -> Type:
        instance = LocalInstance(callee.number)
        made = self.class_attribute(callee.number, "__init__")
        if made and isinstance(made[0], LocalFunction):
            self._pass(made[0].number, [instance, *arguments], {k.arg or "": t for k, t in keywords})
            self._run_now(made[0].number)
        return instance

    def _local_function(
        self,
        callee: LocalFunction,
        node: ast.Call,
        arguments: list[Type],
        keywords: list[tuple[ast.keyword, Type]],
    ) -> Type:
        function = self.functions[callee.number]
        if any(isinstance(argument, ast.Starred) for argument in node.args):
            arguments = []
        values = arguments if callee.receiver is None else [callee.receiver, *arguments]
        given = self._pass(callee.number, values, {keyword.arg or "": kind for keyword, kind in keywords})
        self._run_now(callee.number)
        if any(isinstance(part, ast.Starred) for part in node.args) or "" in given or function.running:
            # What it returns is not known where it was not read with what this call passes.
            is_read = function.running or not function.stale
            return (self.returned(callee.number) if is_read else None) or UNKNOWN
        return self.result_of_call(callee.number, given, node)

    def _run_now(self, number: int) -> None:
        """Reads a function for what it returns, or for what it binds, unless it is known or too far inside."""
        function = self.functions[number]
        if (
            function.stale
            and not self.tries
            and not function.running
            and self.depth < DEEPEST_RUN
            and function.runs < _MOST_RUNS
        ):
            self.run(number)

    def _pass(self, number: int, values: list[Type], keywords: dict[str, Type]) -> dict[str, Type]:
        """Adds what a call passes to what a function is known to receive; gives it by parameter."""
        function = self.functions[number]
        parameters = function.node.args
        names = [argument.arg for argument in (*parameters.posonlyargs, *parameters.args)]
        given = {**dict(zip(names, values, strict=False)), **keywords}
        if not self.tries:  # where it is read again, what it passes is a part of what it passed before
            for name, kind in given.items():
                if name:
                    self._receive(function, name, passed(kind))
        return given

    @staticmethod
    def _receive(function: FunctionDefinition, name: str, kind: Type) -> None:
        kind = bounded(kind)
        before = function.received.get(name)
        if kind is UNKNOWN and name not in function.unknown:
            function.unknown.add(name)
            function.stale = True
        if before is None or before is UNKNOWN:
            after = kind
        elif kind is UNKNOWN:
            return
        else:
            after = join(before, kind)
        if after != before:
            function.received[name] = after
            if kind is not UNKNOWN:
                function.stale = True

    # Python's own.

    def _builtin(  # noqa: PLR0911, PLR0912 - one case a function
        self,
        callee: Builtin,
        node: ast.Call,
        arguments: list[Type],
        keywords: list[tuple[ast.keyword, Type]],
    ) -> Type:
        if callee.receiver is not None:
            return self._method(callee.receiver, callee.name, arguments)
        name = callee.name
        if name in _PLAIN_RESULTS:
            return _PLAIN_RESULTS[name]
        first = arguments[0] if arguments else UNKNOWN
        if name in {"list", "tuple"} and isinstance(first, Tuple):
            return first
        if name in _ITERATORS:
            return Sequence(_ITERATORS[name], self.iterated(first) if arguments else UNKNOWN)
        match name:
            case "next":
                return (
                    self.iterated(first) if len(arguments) < 2 else join(self.iterated(first), arguments[1])
                )
            case "enumerate":
                return Sequence("iterator", Tuple((INT, self.iterated(first))))
            case "zip":
                return Sequence("iterator", Tuple(tuple(self.iterated(kind) for kind in arguments)))
            case "range":
                return Sequence("iterator", INT)
            case "filter" if len(arguments) == 2:
                return Sequence("iterator", self._applied(arguments[0], arguments[1], keep=True))
            case "map" if len(arguments) == 2:
                return Sequence("iterator", self._applied(arguments[0], arguments[1], keep=False))
            case "min" | "max":
                compared = self.iterated(first) if len(arguments) == 1 else union(arguments)
                self._key(keywords, compared)
                return compared
            case "abs":
                return Plain(first.kind) if isinstance(first, Plain) else UNKNOWN
            case "round":
                whole = len(arguments) == 1 and not keywords and isinstance(first, Plain)
                return INT if whole else first
            case "sum":
                element = self.iterated(first)
                return Plain(element.kind) if isinstance(element, Plain) and len(arguments) == 1 else UNKNOWN
            case "super":
                return self._super()
            case "type" if len(arguments) == 3:
                self.own_operators.add(ANY)
                self.own_types[ANY] = UNKNOWN
                return UNKNOWN
            case "type":
                return self._class_of(first)
            case "setattr" if len(arguments) == 3:
                declared = self.is_declared(node.args[2])
                name = literal_text(arguments[1])
                self.register(first, name or ANY, arguments[2], declared=declared)
                if name and isinstance(first, (LocalInstance, LocalClass)):
                    self.classes[first.number].bind(name, arguments[2])
                return NONE
            case "hasattr":
                text = literal_text(arguments[1]) if len(arguments) == 2 else None
                return Plain("bool", True, VERSION) if text and self.has(first, text) else BOOL
            case "getattr" | "delattr":
                return self._named_attribute(node, arguments)
            case "dict":
                return Mapping(UNKNOWN, UNKNOWN)
            case _:
                return UNKNOWN

    def _key(self, keywords: list[tuple[ast.keyword, Type]], value: Type) -> None:
        for keyword, kind in keywords:
            if keyword.arg == "key" and isinstance(kind, LocalFunction):
                self._pass(kind.number, [value], {})

    def _applied(self, function: Type, values: Type, *, keep: bool) -> Type:
        element = self.iterated(values)
        if isinstance(function, LocalFunction):
            self._pass(function.number, [element], {})
        return element if keep else UNKNOWN

    def _class_of(self, kind: Type) -> Type:
        if isinstance(kind, Instance):
            return ClassObject(kind.cls)
        return LocalClass(kind.number) if isinstance(kind, LocalInstance) else UNKNOWN

    def _super(self) -> Type:
        if self.function is None or self.function.cls is None:
            return UNKNOWN
        bases = self.classes[self.function.cls].bases
        found: list[Type] = []
        for base in bases:
            if isinstance(base, LocalClass):
                found.append(LocalInstance(base.number))
            elif isinstance(base, ClassObject):
                found.append(Instance(base.cls))
            else:
                return UNKNOWN
        return found[0] if len(found) == 1 else UNKNOWN

    def _named_attribute(self, node: ast.Call, arguments: list[Type]) -> Type:
        """``getattr(x, "name")``: read like an attribute, but a script that asks so is ready for its absence."""
        text = literal_text(arguments[1]) if len(arguments) > 1 else None
        if not text or arguments[0] is UNKNOWN:
            return UNKNOWN
        found = self.attribute(arguments[0], text)
        if found.symbols:
            self.resolve(node.args[1], "text", text, found.symbols, sure=found.sure)
        kind = found.type
        return join(kind, arguments[2]) if len(arguments) > 2 else kind

    def _method(self, receiver: Type, name: str, arguments: list[Type]) -> Type:  # noqa: PLR0911, PLR0912 - one case a method
        first = arguments[0] if arguments else UNKNOWN
        if isinstance(receiver, Plain):
            return _STRING_RESULTS.get(name, STR) if receiver.kind == "str" else UNKNOWN
        if isinstance(receiver, Collection):
            return receiver.element if name == "add" else NONE
        if isinstance(receiver, Operator):
            return BOOL if name == "operator.poll" else UNKNOWN
        if isinstance(receiver, Mapping):
            match name:
                case "update":
                    self._grow(receiver, UNKNOWN)
                    return NONE
                case "setdefault" if len(arguments) > 1:
                    kind = join(self.item(receiver, first, ast.Pass()), arguments[1])
                    self._grow(receiver, arguments[1])
                    return kind
                case "get" | "pop" | "setdefault":
                    kind = self.item(receiver, first, ast.Pass())
                    return join(kind, arguments[1]) if len(arguments) > 1 else kind
                case "items":
                    return Sequence("list", Tuple((receiver.key, receiver.value)))
                case "keys":
                    return Sequence("list", receiver.key)
                case "values":
                    return Sequence("list", receiver.value)
                case "copy":
                    return receiver
                case _:
                    return UNKNOWN
        match name:
            case "pop":
                return self.iterated(receiver)
            case "copy" | "union" | "intersection" | "difference":
                return receiver
            case "index" | "count":
                return INT
            case "append" | "add" | "insert" | "appendleft" if arguments:
                self._grow(receiver, arguments[-1])
                return NONE
            case "extend" | "update" if arguments:
                self._grow(receiver, self.iterated(first))
                return NONE
            case _:
                return UNKNOWN

    def _grow(self, receiver: Type, kind: Type) -> None:
        """A list or a dictionary that names hold gets one more element: their types follow."""
        grown: Type
        match receiver:
            case Sequence() | Tuple():
                before = receiver.element if isinstance(receiver, Sequence) else union(receiver.items)
                after = kind if before is UNKNOWN else join(before, kind)
                grown = Sequence(receiver.kind if isinstance(receiver, Sequence) else "list", after)
            case Mapping():
                is_empty = receiver.value is UNKNOWN and not receiver.items
                grown = Mapping(UNKNOWN, kind if is_empty else join(receiver.value, kind))
            case _:
                return
        held = self.scope.state.names
        self.spend(len(held))
        for name in [name for name, one in held.items() if one is receiver]:
            self.bind(name, grown)

    _callers: ClassVar[dict[type, Callable[..., Type]]] = {
        Operator: _operator,
        Function: _function,
        ClassObject: _class,
        LocalClass: _local_class,
        LocalFunction: _local_function,
        Builtin: _builtin,
    }


def _raises_instead(symbol: Symbol, call: ast.Call) -> bool:
    """Whether a call raises an error where it might return what it is given for that case: it is given nothing."""
    is_plain = not call.keywords and not any(isinstance(argument, ast.Starred) for argument in call.args)
    left = symbol.parameters[len(call.args) :] if is_plain and len(symbol.returns) == 1 else ()
    return any(not one.required and "(instead of raising" in one.description for one in left)


def _is_open(parameter: Parameter) -> bool:
    """Whether a parameter takes any keyword."""
    return parameter.name.startswith("*") or parameter.type.startswith("**")
