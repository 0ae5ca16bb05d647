"""Evaluates expressions: what each one is, and which symbols its parts stand for."""

from __future__ import annotations

import ast
import builtins
from typing import TYPE_CHECKING, ClassVar

from kb_build.flow.blender.facts import COMPUTED, COMPUTED_IN_PLACE, PRODUCTS, READ_ACTIVE
from kb_build.flow.evaluation.given_values import GivenValues
from kb_build.flow.evaluation.operations import (
    LONGEST_LITERAL,
    SEQUENCE,
    VECTOR,
    comparison,
    is_math,
    math_operand,
    operation_type,
)
from kb_build.flow.state.core import DEEPEST, StepsExhausted
from kb_build.flow.state.doubts import NO_DOUBTS
from kb_build.flow.state.scopes import chain_text, item_text
from kb_build.flow.syntax.trees import children
from kb_build.flow.values.type_parts import telling, tells
from kb_build.flow.values.types import (
    BOOL,
    FROM_VERSION,
    NONE,
    STR,
    UNKNOWN,
    Builtin,
    ClassObject,
    Collection,
    Instance,
    LocalFunction,
    Mapping,
    Plain,
    Sequence,
    Tuple,
    Type,
    Union,
    join,
    literal,
    literal_text,
    union,
    without_none,
)

if TYPE_CHECKING:
    from collections.abc import Callable


_ERRORS = frozenset(
    name
    for name, kind in vars(builtins).items()
    if isinstance(kind, type) and issubclass(kind, BaseException)
)
_BUILTINS = _ERRORS | frozenset(
    (  # noqa: SIM905
        "abs all any bool dict enumerate filter float frozenset getattr hasattr int isinstance iter len list map max "
        "min next open print range repr reversed round set setattr sorted str sum super tuple type zip delattr "
        "property staticmethod classmethod object callable"
    ).split()
)
_CLASSES: dict[type, str] = {bool: "bool", int: "int", float: "float", str: "str", bytes: "bytes"}
_SIGNS: dict[type[ast.operator], str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.MatMult: "@", ast.Div: "/",
}  # fmt: skip
_DEEPEST_ITEMS = 4  # dictionaries around one whose items are kept: what holds them, does so twice


class Expressions(GivenValues):
    """Evaluates expressions."""

    def evaluate(self, node: ast.expr) -> Type:
        """See :class:`core.Core`."""
        self.steps_left -= 1
        if self.steps_left < 0:
            raise StepsExhausted
        here = self.here
        if here.depth > DEEPEST:
            here.file.unread.add(node)
            return UNKNOWN
        reader = self._evaluators.get(type(node), Expressions._parts)
        here.depth += 1
        kind = reader(self, node)
        here.depth -= 1
        here.types[node] = kind
        return kind

    def _parts(self, node: ast.expr) -> Type:
        """Evaluates the parts of an expression of which no more is known."""
        for part in children(node):
            if isinstance(part, ast.expr):
                self.evaluate(part)
        return UNKNOWN

    def _behind(self, node: ast.expr) -> Type:
        """Evaluates what stands behind a condition."""
        if self.here.scope.state.doubted.everything:
            self.here.file.doubted.add(node)
        return self.evaluate(node)

    # Names, attributes, items.

    def _name(self, node: ast.Name) -> Type:
        if self.here.scope.state.chains and (known := self.here.scope.state.chains.get(node.id)) is not None:
            return known
        found = self.here.scope.lookup(node.id)
        if found is not None:
            return found
        if node.id in _BUILTINS:
            return Builtin(node.id)
        return UNKNOWN

    def _attribute(self, node: ast.Attribute) -> Type:
        owner = self.evaluate(node.value)
        known = None
        if self.here.scope.state.chains and (text := chain_text(node)):
            known = self.here.scope.state.chains.get(text)
        self.here.resolutions.pop(node, None)
        if owner is UNKNOWN:
            return known or UNKNOWN
        found = self.attribute(owner, node.attr)
        if found.symbols or found.possible or (found.missing and known is None):
            missing = found.missing if known is None else ()
            self.resolve(
                node, found.use, node.attr, found.symbols, missing, found.possible,
                sure=found.sure, guarded=self.here.scope.state.doubts_members_of(node.value),
            )  # fmt: skip
        if known is not None:
            return known
        if found.missing and self._may_be_of_another(node):
            return UNKNOWN  # what took its place here says nothing of code for where it was
        made = self.here.scope.state.active
        return made if made is not None and READ_ACTIVE.issuperset(found.symbols or "?") else found.type

    def _may_be_of_another(self, node: ast.Attribute) -> bool:
        """Whether an attribute that something lacks is read of something else, or for another Blender."""
        row = self.here.resolutions[node]
        return not row.sure or row.is_ready_for("AttributeError")

    def _subscript(self, node: ast.Subscript) -> Type:
        owner = self.evaluate(node.value)
        key = self.evaluate(node.slice)
        if isinstance(node.slice, ast.Slice):
            return self._sliced(owner, node.slice)
        if (chains := self.here.scope.state.chains) and (known := chains.get(item_text(node)[0])) is not None:
            return known
        return self.item(owner, key, node) if owner is not UNKNOWN else UNKNOWN

    def _sliced(self, owner: Type, part: ast.Slice) -> Type:
        if isinstance(owner, Tuple):
            if part.step is None and all(
                bound is None or (isinstance(bound, ast.Constant) and isinstance(bound.value, int))
                for bound in (part.lower, part.upper)
            ):
                low = part.lower.value if isinstance(part.lower, ast.Constant) else None
                high = part.upper.value if isinstance(part.upper, ast.Constant) else None
                assert low is None or isinstance(low, int)
                assert high is None or isinstance(high, int)
                return Tuple(owner.items[low:high])
            return Sequence("list", self.iterated(owner))
        if isinstance(owner, (Sequence, Plain)):
            return Plain(owner.kind) if isinstance(owner, Plain) else owner
        if isinstance(owner, Union):
            return union(self._sliced(member, part) for member in owner.members)
        if isinstance(owner, (Collection, Instance)):
            return Sequence("list", self.iterated(owner))
        # A text, an array, what a class of the script's own gives; None, for what is set later.
        return UNKNOWN

    # Literals.

    def _constant(self, node: ast.Constant) -> Type:
        value = node.value
        if value is None:
            return NONE
        kind = _CLASSES.get(type(value))
        if kind is None:
            return UNKNOWN
        # A text that the script has asked for may be one of another Blender: a class that ``nodes.new`` makes.
        doubted = self.here.scope.state.doubted
        if doubted is not NO_DOUBTS and isinstance(value, str) and doubted.has_member(value):
            self.here.file.doubted.add(node)
        if isinstance(value, (bytes, complex)) or (isinstance(value, str) and len(value) > LONGEST_LITERAL):
            return Plain(kind)
        return Plain(kind, value) if isinstance(value, (str, int, float)) else UNKNOWN

    def _text(self, node: ast.JoinedStr) -> Type:
        self._parts(node)
        return STR

    def _tuple(self, node: ast.Tuple | ast.List) -> Type:
        items: list[Type] = []
        starred = False
        for item in node.elts:
            if isinstance(item, ast.Starred):
                starred = True
                items.append(self.iterated(self.evaluate(item.value)))
            else:
                items.append(self.evaluate(item))
        if starred or len(items) > LONGEST_LITERAL:
            return Sequence("list", union(items))
        if isinstance(node, ast.List):
            return Tuple(tuple(items)) if items else Sequence("list", UNKNOWN, is_empty=True)
        return Tuple(tuple(items))

    def _set(self, node: ast.Set) -> Type:
        return Sequence("set", union([self.evaluate(item) for item in node.elts]))

    def _dict(self, node: ast.Dict) -> Type:
        keys: list[Type] = []
        values: list[Type] = []
        items: list[tuple[str, Type]] = []
        self.here.dictionaries += 1
        for key, value in zip(node.keys, node.values, strict=True):
            value_type = self.evaluate(value)
            if key is None:
                values.append(UNKNOWN)
                continue
            key_type = self.evaluate(key)
            keys.append(key_type)
            values.append(value_type)
            if (text := literal_text(key_type)) is not None and len(items) < LONGEST_LITERAL:
                items.append((text, value_type))
        self.here.dictionaries -= 1
        if len(items) < len(values) or self.here.dictionaries > _DEEPEST_ITEMS:
            items = []
        return Mapping(union(keys), union(values), tuple(items), is_empty=not node.keys)

    # Operations.

    def _binary(self, node: ast.BinOp) -> Type:
        long = [node]  # a sum of many terms is read from its first on
        while isinstance(first := long[-1].left, ast.BinOp):
            long.append(first)
        left = self.evaluate(first)
        for part in reversed(long):
            left = self.operation(part, left, self.evaluate(part.right))
            self.here.types[part] = left
        return left

    def operation(self, node: ast.BinOp | ast.AugAssign, left: Type, right: Type) -> Type:
        """What an operation gives; what mathutils refuses to compute is recorded."""
        operator = node.op
        sign = _SIGNS.get(type(operator), "")
        if not sign or not (is_math(left) or is_math(right)):
            return operation_type(left, right, operator)
        self.here.resolutions.pop(node, None)
        pair = math_operand(left), math_operand(right)
        taken = COMPUTED if isinstance(node, ast.BinOp) else COMPUTED_IN_PLACE
        if all(pair) and pair not in taken[sign]:
            sure = all(kind.sure for kind in (left, right) if isinstance(kind, Instance))
            self.resolve(node, "product" if sign in PRODUCTS else "sum", sign, missing=pair, sure=sure)
            if sign in PRODUCTS and is_math(left) and is_math(right):
                if pair not in PRODUCTS["@"]:
                    return UNKNOWN
                operator = ast.MatMult()  # which is meant
            elif sign in PRODUCTS:  # a vector of the same numbers is meant
                left, right = (
                    Instance(VECTOR) if each == SEQUENCE else kind
                    for each, kind in zip(pair, (left, right), strict=True)
                )
        return operation_type(left, right, operator)

    def _unary(self, node: ast.UnaryOp) -> Type:
        operand = self.evaluate(node.operand)
        if isinstance(node.op, ast.Not):
            value = literal(operand) if isinstance(operand, Plain) and operand.kind == "bool" else None
            source = operand.source if isinstance(operand, Plain) else None
            return Plain("bool", not value, source) if isinstance(value, bool) else BOOL
        if isinstance(operand, Plain) and isinstance(node.op, ast.USub):
            value = operand.value
            return Plain(operand.kind, -value) if isinstance(value, (int, float)) else Plain(operand.kind)
        return operand if isinstance(operand, (Plain, Instance)) else UNKNOWN

    def _compare(self, node: ast.Compare) -> Type:
        left_node: ast.expr = node.left
        left = self.evaluate(left_node)
        result: Type = BOOL
        for operator, right_node in zip(node.ops, node.comparators, strict=True):
            right = self.evaluate(right_node)
            if isinstance(operator, (ast.Eq, ast.NotEq, ast.In, ast.NotIn)):
                self.check_value(left, right_node, "compared")
                if isinstance(operator, (ast.Eq, ast.NotEq)):
                    self.check_value(right, left_node, "compared")
            if len(node.ops) == 1:
                result = self._decided_here(left, operator, right, right_node)
            if result == BOOL:
                result = telling(BOOL, tells(left) or tells(right))
            left, left_node = right, right_node
        return result

    def _decided_here(self, left: Type, operator: ast.cmpop, right: Type, right_node: ast.expr) -> Type:
        """The value of a comparison, where this Blender's version or what it has decides it."""
        if isinstance(left, Tuple) and isinstance(right, Tuple):
            return comparison(left.items, right.items, operator)
        if (
            isinstance(left, Plain)
            and isinstance(right, Plain)
            and FROM_VERSION in (left.source, right.source)
        ):
            return comparison((left,), (right,), operator)
        text = literal_text(left)
        if text is None or not isinstance(operator, (ast.In, ast.NotIn)):
            return BOOL
        there = self._is_listed(text, right_node)
        return BOOL if there is None else Plain("bool", there == isinstance(operator, ast.In), FROM_VERSION)

    def _is_listed(self, name: str, node: ast.expr) -> bool | None:
        """Whether ``bpy.types.Scene.bl_rna.properties``, ``dir(bpy.types)`` or a node's sockets list a name; None for
        what is not sure.

        ``node`` was evaluated.
        """
        if self.has_socket(self.here.types.get(node, UNKNOWN), name):
            return True
        match node:
            case ast.Attribute(
                attr="properties" | "functions", value=ast.Attribute(attr="bl_rna", value=owner)
            ):
                kind = self.here.types.get(owner, UNKNOWN)
                if isinstance(kind, Instance) and not (kind.sure and not self.here.guessing):
                    return None
                cls = kind.cls if isinstance(kind, (Instance, ClassObject)) else ""
                wanted = "property" if node.attr == "properties" else "function"
                member = self.api.member(cls, name) if cls else None
                if member is not None:
                    return member.symbol.kind == wanted
                is_known = self.api.is_class(cls) and not self.is_open(cls)
                added = is_known and (self.is_registered(cls, name) or self.api.below(cls, name))
                return False if is_known and not added else None
            case ast.Call(func=ast.Name(id="dir"), args=[owner]):
                return self.has(self.here.types.get(owner, UNKNOWN), name) or None
            case _:
                return None

    def _boolean(self, node: ast.BoolOp) -> Type:
        before = self.here.scope.state
        kinds: list[Type] = []
        holds = isinstance(node.op, ast.And)
        settles = Plain("bool", not holds, FROM_VERSION)  # what follows it is for other versions
        for place, value in enumerate(node.values):
            kinds.append(self._behind(value))
            if kinds[-1] == settles:
                self.here.file.left_out.update(node.values[place + 1 :])
                break
            if place < len(node.values) - 1:
                if place == 0:
                    self.here.scope.state = self.copied(before)
                self.narrow(value, holds=holds)
        after, self.here.scope.state = self.here.scope.state, before
        if after is not before:
            assigned = {name: kind for name, kind in after.names.items() if name not in before.names}
            before.names.update(assigned)
        if kinds[-1] == settles:
            return settles
        open_kinds = [kind for kind in kinds if not is_decided(kind)]
        if not open_kinds:
            return kinds[-1]
        if holds:
            return BOOL if is_decided(kinds[-1]) else kinds[-1]
        return union([*(without_none(kind) for kind in open_kinds[:-1]), open_kinds[-1]])

    def _choice(self, node: ast.IfExp) -> Type:
        test = self.evaluate(node.test)
        if isinstance(test, Plain) and isinstance(test.value, bool):
            body, other = (node.body, node.orelse) if test.value else (node.orelse, node.body)
            self.here.file.left_out.add(other)  # it is for other versions
            chosen = self.evaluate(body)
            return telling(chosen, FROM_VERSION, value=True) if is_decided(test) else chosen
        before = self.here.scope.state
        self.here.scope.state = self.copied(before)
        self.narrow(node.test, holds=True)
        first = self._behind(node.body)
        self.here.scope.state = self.copied(before)
        self.narrow(node.test, holds=False)
        second = self._behind(node.orelse)
        self.here.scope.state = before
        return join(first, second)

    def _walrus(self, node: ast.NamedExpr) -> Type:
        kind = self.evaluate(node.value)
        self.bind_target(node.target, kind, node.value)
        return kind

    def _awaited(self, node: ast.Await | ast.Starred | ast.YieldFrom) -> Type:
        self.evaluate(node.value)
        return UNKNOWN

    def _yielded(self, node: ast.Yield) -> Type:
        kind = self.evaluate(node.value) if node.value else NONE
        if self.here.function is not None:
            before = self.here.function.returned
            after = Sequence("iterator", kind)
            self.here.function.returned = after if before is None else join(before, after)
        return UNKNOWN

    # What has names of its own.

    def _lambda(self, node: ast.Lambda) -> Type:
        self.read_defaults(node.args)
        number = self.define_function(node)
        self.functions[number].stale = self.functions[number].runs == 0
        return LocalFunction(number)

    def read_defaults(self, arguments: ast.arguments) -> None:
        """Evaluates the values that a function's parameters have by default, where it is defined."""
        for default in (*arguments.defaults, *arguments.kw_defaults):
            if default is not None:
                self.evaluate(default)

    def _comprehension(self, node: ast.ListComp | ast.SetComp | ast.GeneratorExp) -> Type:
        element: list[Type] = []
        self._inside(node.generators, lambda: element.append(self._behind(node.elt)))
        return Sequence(_KINDS.get(type(node), "list"), element[0] if element else UNKNOWN)

    def _dict_comprehension(self, node: ast.DictComp) -> Type:
        kinds: list[Type] = []
        self._inside(
            node.generators, lambda: kinds.extend((self._behind(node.key), self._behind(node.value)))
        )
        return Mapping(kinds[0], kinds[1]) if len(kinds) == 2 else UNKNOWN

    def _inside(self, generators: list[ast.comprehension], read: Callable[[], None]) -> None:
        """Reads a comprehension's element with the names that its loops bind."""
        before = self.here.scope.state
        self.here.scope.state = self.copied(before)
        try:
            for generator in generators:
                kind = self.iterated(self.evaluate(generator.iter))
                self.bind_target(generator.target, kind)
                for test in generator.ifs:
                    self.evaluate(test)
                    self.narrow(test, holds=True)
            read()
        finally:
            self.here.scope.state = before

    def _call(self, node: ast.Call) -> Type:
        return self.call(self.evaluate(node.func), node)

    _evaluators: ClassVar[dict[type, Callable[..., Type]]] = {
        ast.Name: _name,
        ast.Attribute: _attribute,
        ast.Subscript: _subscript,
        ast.Constant: _constant,
        ast.JoinedStr: _text,
        ast.Tuple: _tuple,
        ast.List: _tuple,
        ast.Set: _set,
        ast.Dict: _dict,
        ast.BinOp: _binary,
        ast.UnaryOp: _unary,
        ast.Compare: _compare,
        ast.BoolOp: _boolean,
        ast.IfExp: _choice,
        ast.NamedExpr: _walrus,
        ast.Await: _awaited,
        ast.Starred: _awaited,
        ast.YieldFrom: _awaited,
        ast.Yield: _yielded,
        ast.Lambda: _lambda,
        ast.ListComp: _comprehension,
        ast.SetComp: _comprehension,
        ast.GeneratorExp: _comprehension,
        ast.DictComp: _dict_comprehension,
        ast.Call: _call,
    }


def is_decided(kind: Type) -> bool:
    """Whether a truth value is decided by the Blender that the script is read for."""
    return isinstance(kind, Plain) and kind.source is FROM_VERSION and isinstance(kind.value, bool)


_KINDS: dict[type, str] = {ast.ListComp: "list", ast.SetComp: "set", ast.GeneratorExp: "iterator"}
