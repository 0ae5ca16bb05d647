"""Evaluates calls of Python's own functions, and of the methods of its values."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import PYTHON_NAMES
from kb_build.flow.calls.callbacks import Callbacks
from kb_build.flow.state.core import ANY
from kb_build.flow.syntax.trees import TAKING_OUT
from kb_build.flow.values.texts import lessened
from kb_build.flow.values.type_parts import by_names
from kb_build.flow.values.types import (
    BOOL,
    FLOAT,
    FROM_VERSION,
    INT,
    NONE,
    STR,
    UNKNOWN,
    Builtin,
    ClassObject,
    Collection,
    Instance,
    LocalClass,
    LocalFunction,
    LocalInstance,
    Mapping,
    Operator,
    Plain,
    Sequence,
    Tuple,
    Type,
    general,
    join,
    literal_text,
    members,
    union,
)
from kb_build.symbols.api_names import TYPES

if TYPE_CHECKING:
    from kb_build.flow.calls.read_calls import ReadCall
    from kb_build.flow.evaluation.members import Lookup

_ITERATORS = {
    "list": "list", "sorted": "list", "set": "set", "frozenset": "set", "tuple": "list", "reversed": "iterator",
    "iter": "iterator",
}  # fmt: skip
_DATA = f"{TYPES}BlendData"
_PLAIN_RESULTS: dict[str, Type] = {
    "len": INT, "int": INT, "float": FLOAT, "str": STR, "bool": BOOL, "repr": STR, "isinstance": BOOL,
    "any": BOOL, "all": BOOL, "callable": BOOL, "print": NONE,
}  # fmt: skip
_STRING_RESULTS: dict[str, Type] = {
    "split": Sequence("list", STR), "rsplit": Sequence("list", STR), "splitlines": Sequence("list", STR),
    "partition": Tuple((STR, STR, STR)), "rpartition": Tuple((STR, STR, STR)), "find": INT, "rfind": INT,
    "index": INT, "count": INT, "startswith": BOOL, "endswith": BOOL, "encode": Plain("bytes"), "isdigit": BOOL,
}  # fmt: skip


class PythonCalls(Callbacks):
    """Evaluates calls of what Python has."""

    def call_builtin(  # noqa: PLR0911, PLR0912 - one case a function
        self, callee: Builtin, call: ReadCall
    ) -> Type:
        """What one of Python's functions, or a method of a value, returns."""
        if callee.receiver is not None:
            return self._method(callee.receiver, callee.name, call)
        name = callee.name
        if name in _PLAIN_RESULTS:
            return _PLAIN_RESULTS[name]
        arguments, first = call.arguments, call.argument(0)
        if name in {"list", "tuple"} and isinstance(first, Tuple):
            return first
        if name in PYTHON_NAMES:
            return self._of_library(name, call)
        if name in _ITERATORS:
            if name == "sorted":
                self._pass_to_key(call, UNKNOWN, self.iterated(first))
            return Sequence(
                _ITERATORS[name], self.iterated(first) if arguments else UNKNOWN, is_empty=not call.node.args
            )
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
                self._pass_to_key(call, UNKNOWN, compared)
                return compared
            case "abs":
                return Plain(first.kind) if isinstance(first, Plain) else UNKNOWN
            case "round":
                whole = len(arguments) == 1 and not call.keywords and isinstance(first, Plain)
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
                self._set_by_name(call)
                return NONE
            case "hasattr":
                text = literal_text(arguments[1]) if len(arguments) == 2 else None
                if text and (self.has(first, text) or self._lacks(first, text)):
                    return Plain("bool", self.has(first, text), FROM_VERSION)
                return BOOL
            case "getattr" | "delattr":
                return self._named_attribute(call)
            case "dict":
                return self._dictionary(call)
            case _:
                return UNKNOWN

    def _of_library(self, name: str, call: ReadCall) -> Type:  # noqa: PLR0911 - one return a function
        """What a function of Python's library returns (see :data:`facts.PYTHON_NAMES`)."""
        if any(isinstance(argument, ast.Starred) for argument in call.node.args):
            return UNKNOWN
        first = self.iterated(call.argument(0))
        match name.rpartition(".")[2]:
            case "choice":
                return first
            case "choices" | "sample":
                return Sequence("list", first)
            case "cycle" | "islice":
                return Sequence("iterator", first)
            case "deque":
                return Sequence("deque", first, is_empty=not call.node.args)
            case "combinations" | "permutations":
                return Sequence("iterator", Sequence("list", first))
            case "chain":
                return Sequence("iterator", union(map(self.iterated, call.arguments)))
            case "product" if not call.keywords:
                return Sequence("iterator", Tuple(tuple(map(self.iterated, call.arguments))))
            case "defaultdict" if call.argument(0) in {Builtin("list"), Builtin("set")}:
                kind = "list" if call.argument(0) == Builtin("list") else "set"
                return Mapping(UNKNOWN, Sequence(kind, UNKNOWN, is_empty=True))
            case "copy":
                return call.argument(0)
            case "partial":
                return self._partial(call)
            case name:
                return self._in_parts(name, call)

    def _in_parts(self, name: str, call: ReadCall) -> Type:
        """What a function of itertools makes of the elements that it goes through: some of them, pairs, groups."""
        if name in {"dropwhile", "filterfalse", "takewhile"} and len(call.arguments) == 2:
            return Sequence("iterator", self._applied(*call.arguments, keep=True))
        element = self.iterated(call.argument(0))
        match name:
            case "batched":
                return Sequence("iterator", Sequence("tuple", element))
            case "groupby":
                self._pass_to_key(call, call.argument(1), element)
                return Sequence("iterator", Tuple((UNKNOWN, Sequence("iterator", element))))
            case "pairwise":
                return Sequence("iterator", Tuple((element, element)))
            case "tee" if len(call.arguments) == 1:
                again = Sequence("iterator", element)
                return Tuple((again, again))
            case _:
                return UNKNOWN

    def _pass_to_key(self, call: ReadCall, key: Type, element: Type) -> None:
        """The function that things are sorted or grouped by is given each of them."""
        key = call.keywords.get("key", key)
        if isinstance(key, LocalFunction):
            self.pass_to(key.number, [element], {})

    def _partial(self, call: ReadCall) -> Type:
        """A class of the script that some names are given to already: what it makes has these, too."""
        cls = call.argument(0)
        if not isinstance(cls, LocalClass) or len(call.arguments) > 1 or "" in call.keywords:
            return UNKNOWN
        made = self.class_attribute(cls.number, "__init__")
        if made and isinstance(made[0], LocalFunction):
            self.pass_to(made[0].number, [], call.keywords)
        for name in self.classes[cls.number].fields:
            if name in call.keywords:
                self.classes[cls.number].bind(name, call.keywords[name])
        return cls

    def _dictionary(self, call: ReadCall) -> Type:
        """``dict(name=value)``, ``dict(pairs)``."""
        named, pairs = call.keywords, call.argument(0)
        if not call.node.args and "" not in named:
            return by_names(named)
        if named:
            return Mapping(UNKNOWN, UNKNOWN)
        if isinstance(pairs, Mapping):
            return pairs
        pair = self.iterated(pairs)
        key, value = pair.items if isinstance(pair, Tuple) and len(pair.items) == 2 else (UNKNOWN, UNKNOWN)
        return Mapping(general(key), value)

    def _set_by_name(self, call: ReadCall) -> None:
        """``setattr(x, "name", value)``."""
        owner, named, value = call.arguments
        name = literal_text(named)
        if name and self._is_surely_named(call):
            found = self.attribute(owner, name)
            self._resolve_named(call, name, found)
            self.check_value(found.type, call.node.args[2])
        self.register(owner, name or ANY, value, declared=self.is_declared(call.node.args[2]))
        if name and isinstance(owner, (LocalInstance, LocalClass)):
            self.classes[owner.number].bind(name, value)

    def _lacks(self, kind: Type, name: str) -> bool:
        """Whether a value surely lacks an attribute that another Blender gives it: of ``bpy.data``, to which scripts
        add nothing.
        """
        is_data = isinstance(kind, Instance) and kind.cls == _DATA and kind.sure and not self.here.guessing
        return is_data and self.api.had(_DATA, name) and bool(self.attribute(kind, name).missing)

    def _applied(self, function: Type, values: Type, *, keep: bool) -> Type:
        element = self.iterated(values)
        if isinstance(function, LocalFunction):
            self.pass_to(function.number, [element], {})
        if keep:
            return element
        if isinstance(function, LocalFunction):
            self.run_now(function.number)
            return self.returned(function.number) or UNKNOWN
        if isinstance(function, Builtin) and function.receiver is None:
            return _PLAIN_RESULTS.get(function.name, UNKNOWN)
        return UNKNOWN

    def _class_of(self, kind: Type) -> Type:
        if isinstance(kind, Instance):
            return ClassObject(kind.cls)
        return LocalClass(kind.number) if isinstance(kind, LocalInstance) else UNKNOWN

    def _super(self) -> Type:
        if self.here.function is None or self.here.function.cls is None:
            return UNKNOWN
        bases = self.classes[self.here.function.cls].bases
        found: list[Type] = []
        for base in bases:
            if isinstance(base, LocalClass):
                found.append(LocalInstance(base.number))
            elif isinstance(base, ClassObject):
                found.append(Instance(base.cls))
            else:
                return UNKNOWN
        return found[0] if len(found) == 1 else UNKNOWN

    def _named_attribute(self, call: ReadCall) -> Type:
        """``getattr(x, "name")``: read like an attribute; a script that gives a default is ready for its absence."""
        text = literal_text(call.argument(1))
        if not text or call.argument(0) is UNKNOWN:
            return UNKNOWN
        found = self.attribute(call.argument(0), text)
        if len(call.arguments) == 2 and self._is_surely_named(call):
            self._resolve_named(call, text, found)
        elif found.symbols:
            self.resolve(call.node.args[1], "text", text, found.symbols, sure=found.sure)
        if len(call.arguments) < 3:
            return found.type
        # Where it is lacking here, what is read is for another Blender.
        return UNKNOWN if found.missing else join(found.type, call.argument(2))

    def _is_surely_named(self, call: ReadCall) -> bool:
        """Whether a call surely asks things of the API for the attribute that its second argument names."""
        node = call.node.args[1]
        is_sure = isinstance(node, ast.Constant) or self.carried_text(node) is not None
        return is_sure and all(isinstance(kind, Instance) for kind in members(call.argument(0)))

    def _resolve_named(self, call: ReadCall, name: str, found: Lookup) -> None:
        self.resolve(
            call.node.args[1], "text", name, found.symbols, found.missing, found.possible, sure=found.sure
        )

    def _method(self, receiver: Type, name: str, call: ReadCall) -> Type:  # noqa: PLR0911, PLR0912 - one case a method
        arguments, first = call.arguments, call.argument(0)
        if name in TAKING_OUT and isinstance(receiver, (Sequence, Tuple, Mapping)):
            self._hold(receiver, lessened(receiver), call)
        if isinstance(receiver, Plain):
            return _STRING_RESULTS.get(name, STR) if receiver.kind == "str" else UNKNOWN
        if isinstance(receiver, Collection):
            return receiver.element if name == "add" else NONE
        if isinstance(receiver, Operator):
            return BOOL if name == "operator.poll" else UNKNOWN
        if isinstance(receiver, Mapping):
            match name:
                case "update":
                    self._grow(receiver, UNKNOWN, call)
                    return NONE
                case "setdefault" if len(arguments) > 1:
                    kind = join(self.item(receiver, first, ast.Pass()), arguments[1])
                    self._grow(receiver, arguments[1], call)
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
            case "pop" | "popleft":
                return self.iterated(receiver)
            case "copy" | "union" | "intersection" | "difference":
                return receiver
            case "index" | "count":
                return INT
            case "append" | "add" | "insert" | "appendleft" if arguments:
                if isinstance(call.node.func, ast.Attribute):
                    self.given_to_handlers(call.node.func.value, arguments[-1])
                self._grow(receiver, arguments[-1], call)
                return NONE
            case "extend" | "update" if arguments:
                self._grow(receiver, self.iterated(first), call)
                return NONE
            case _:
                return UNKNOWN

    def _grow(self, receiver: Type, kind: Type, call: ReadCall) -> None:
        """A list or a dictionary that names or an attribute hold gets one more element: their types follow."""
        grown: Type
        match receiver:
            case Sequence(element=before) if not receiver.is_empty:
                grown = Sequence(receiver.kind, union((before, kind)))
            case Sequence():
                grown = Sequence(receiver.kind, kind)
            case Tuple():
                grown = Sequence("list", union((*receiver.items, kind)))
            case Mapping():
                grown = Mapping(UNKNOWN, kind if receiver.is_empty else union((receiver.value, kind)))
            case _:
                return
        self._hold(receiver, grown, call)

    def _hold(self, receiver: Type, now: Type, call: ReadCall) -> None:
        """A list or a dictionary is another one behind the call of a method of it, wherever it is held."""
        held = self.here.scope.state.names
        self.spend(len(held))
        for name in [name for name, one in held.items() if one is receiver]:
            self.bind(name, now)
        match call.node.func:
            case ast.Attribute(value=ast.Attribute() | ast.Subscript() | ast.Call() as filled):
                self.fill(filled, now)
            case _:
                pass
