"""Reads statements in the order in which they run: ways part at conditions and meet again behind them."""

from __future__ import annotations

import ast
import sys
from typing import TYPE_CHECKING, ClassVar

from kb_build.flow.annotations import Readers, annotated, unquoted
from kb_build.flow.calls import Calls
from kb_build.flow.core import ANY, DEEPEST
from kb_build.flow.definitions import ClassDefinition, FunctionDefinition
from kb_build.flow.expressions import is_decided, is_math
from kb_build.flow.facts import DISCRIMINANTS, LOST_MODULES, PARAMETERS, T
from kb_build.flow.guards import assigned_names
from kb_build.flow.scopes import EVERYTHING, Loop, Scope, State, chain_text, joined
from kb_build.flow.trees import children, default_values, walk
from kb_build.flow.types import (
    NONE,
    STR,
    UNKNOWN,
    Builtin,
    ClassObject,
    Function,
    Instance,
    LocalClass,
    LocalFunction,
    LocalInstance,
    LocalModule,
    Mapping,
    Module,
    Plain,
    Sequence,
    Tuple,
    Type,
    bounded,
    can_be_unsure,
    general,
    join,
    literal,
    members,
    union,
    unsure,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from collections.abc import Sequence as Rows

_TYPES = Module("bpy.types")
_MOST_CLASSES = 1_000  # of one script; which ones later classes are mixed into is not asked
_FORGIVING = frozenset(
    {
        "AttributeError",
        "Exception",
        "BaseException",
        "ImportError",
        "KeyError",
        "LookupError",
        "ModuleNotFoundError",
        "TypeError",
        "RuntimeError",
        "ValueError",
    }
)
_LEAVING = (ast.Return, ast.Raise, ast.Break, ast.Continue)
_API_MODULES = frozenset({"bpy", "mathutils", "bmesh", "gpu", "gpu_extras", "bpy_extras", "blf", "aud", "freestyle",
                          "bl_math", "idprop", "imbuf"})  # fmt: skip


class Statements(Calls):
    """Reads statements. Each reader returns whether the next statement can be reached."""

    def read_body(self, body: Rows[ast.stmt]) -> bool:
        """Reads statements one after the other; whether what follows them can be reached."""
        for place, statement in enumerate(body):
            self.statement = statement
            if self.scope.state.doubted and self.scope.state.doubts():
                self.file.doubted.add(statement)
            reader = self._statement_readers.get(type(statement))
            if reader is not None and not reader(self, statement):
                if not isinstance(statement, _LEAVING):  # what is left behind a condition
                    self.file.left_out.update(body[place + 1 :])
                return False
        return True

    # Assignments.

    def bind_target(self, target: ast.expr, kind: Type, value: ast.expr | None = None) -> None:
        """See :class:`core.Core`."""
        kind = self.told(kind, value)
        match target:
            case ast.Name():
                self.scope.bind(target.id, kind)
                self.types[target] = kind
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
                value = kind if owner.value is UNKNOWN and not owner.items else join(owner.value, kind)
                known = key if owner.key is UNKNOWN else join(owner.key, key)
                filled = Mapping(general(known), value)
            case Tuple() | Sequence(kind="list"):
                held = self.iterated(kind) if isinstance(target.slice, ast.Slice) else kind
                filled = Sequence("list", join(self.iterated(owner), held))
            case _:
                return
        match target.value:
            case ast.Name(id=name) if name in self.scope.state.names:
                self.scope.bind(name, filled)
            case ast.Name(id=name):
                self.scope.fill_outside(name, filled)
            case ast.Attribute(value=value, attr=name):
                of = self.types.get(value, UNKNOWN)
                if isinstance(of, (LocalInstance, LocalClass)):
                    self.classes[of.number].bind(name, filled)
            case _:
                pass

    def _store(self, target: ast.Attribute, kind: Type, value: ast.expr | None) -> None:
        owner = self.evaluate(target.value)
        text = chain_text(target)
        if isinstance(owner, LocalInstance):
            self._store_on_instance(owner, target.attr, kind)
        elif isinstance(owner, LocalClass):
            self.classes[owner.number].bind(target.attr, kind)
        elif owner == _TYPES:
            # Whatever is assigned to the module is there, as the server that an add-on keeps.
            self.own_types[target.attr] = join(self.own_types.get(target.attr, kind), kind)
            self.resolutions.pop(target, None)
            return
        else:
            self.register(owner, target.attr, kind, declared=self.is_declared(value))
            if all(isinstance(member, ClassObject) for member in members(owner)):
                self.resolutions.pop(target, None)
                return
        is_expected = text in self.scope.state.chains
        if text and self.scope.state.chains:
            self.scope.forget(text)
        self.resolutions.pop(target, None)
        if owner is UNKNOWN:
            return
        found = self.attribute(owner, target.attr)
        if found.symbols or found.missing or found.possible:
            missing = () if is_expected else found.missing
            self.resolve(
                target, "store", target.attr, found.symbols, missing, found.possible,
                sure=found.sure, guarded=self.scope.state.doubts(chain_text(target.value)),
            )  # fmt: skip
        if target.attr in DISCRIMINANTS:
            self._forget_kinds(owner)
        if found.symbols and value is not None:
            self.check_value(found.type, value)
        elif found.possible and found.sure and not found.missing and value is not None:
            self.check_possible(owner, target.attr, found.possible, value)
        converts = is_math(kind) and is_math(found.type)  # a vector, given to a colour, becomes a colour
        holds = (
            isinstance(kind, (Instance, LocalInstance)) and isinstance(found.type, Instance) and not converts
        )
        if text and holds:
            self.scope.state.chains[text] = kind

    def _forget_kinds(self, owner: Type) -> None:
        """Something becomes of another class: what is read anew from a chain may be that."""
        bases = {
            self.api.settable_kind(kind.cls) for kind in members(owner) if isinstance(kind, Instance)
        } - {""}
        chains = self.scope.state.chains
        for text, kind in [*chains.items()] if bases else ():
            if any(self.api.descends(one.cls, base) for one in members(kind) for base in bases
                   if isinstance(one, Instance)):  # fmt: skip
                del chains[text]

    def _store_on_instance(self, owner: LocalInstance, name: str, kind: Type) -> None:
        if self.class_attribute(owner.number, name) is None:
            bases, _ = self.api_bases(owner.number)
            if any(self.api.member(base, name) for base in bases):
                return
        found = self.class_attribute(owner.number, name)
        self.classes[found[1] if found else owner.number].bind(name, general(kind))

    def _assign(self, node: ast.Assign) -> bool:
        kind = self.evaluate(node.value)
        for target in node.targets:
            self.bind_target(target, kind, node.value)
            if isinstance(target, ast.Name):
                self._note_asked(target.id, node.value)
        return True

    def _note_asked(self, name: str, value: ast.expr) -> None:
        """Notes ``name = hasattr(owner, "member")`` and ``name = getattr(owner, "member", default)``."""
        self.scope.asked.pop(name, None)
        match value:
            case (
                ast.Call(func=ast.Name(id="hasattr"), args=[_, _])
                | ast.Call(func=ast.Name(id="getattr"), args=[_, _, _])
            ):
                self.scope.asked[name] = value
            case _:
                pass

    def _assign_annotated(self, node: ast.AnnAssign) -> bool:
        kind = self.evaluate(node.value) if node.value is not None else UNKNOWN
        if isinstance(node.annotation, ast.Call):  # ``size: FloatProperty(...)``
            declared = self.evaluate(node.annotation)
        else:
            declared = self._annotated(node.annotation)
        if kind is UNKNOWN or kind is NONE or (isinstance(kind, Sequence) and kind.element is UNKNOWN):
            kind = declared
        self.bind_target(node.target, kind, node.value)
        return True

    def _assign_augmented(self, node: ast.AugAssign) -> bool:
        right = self.evaluate(node.value)
        before = self.evaluate(node.target)
        if isinstance(node.op, (ast.Mult, ast.MatMult)) and is_math(before) and is_math(right):
            before = self.operation(node, before, right)
        if isinstance(node.target, ast.Name):
            grown = isinstance(before, (Sequence, Tuple)) and isinstance(right, (Sequence, Tuple))
            if grown:
                before = Sequence("list", join(self.iterated(before), self.iterated(right)))
            self.scope.bind(node.target.id, general(before))
        elif isinstance(node.target, ast.Attribute):
            self._store(node.target, general(before), None)
        return True

    # Ways that part and meet.

    def _way(self, state: State, body: Rows[ast.stmt]) -> State | None:
        """Reads statements from a state on; the state behind them, or None if they do not get there."""
        self.scope.state = state
        return self.scope.state if self.read_body(body) else None

    def _meet(self, states: Rows[State | None], otherwise: State) -> bool:
        """Goes on from where several ways end; whether any does."""
        open_ways = [state for state in states if state is not None]
        self.scope.state = joined(open_ways) if open_ways else otherwise
        return bool(open_ways)

    def _if(self, node: ast.If) -> bool:
        test = self.evaluate(node.test)
        # Only another version's code is left out: a switch may be set by whoever reads the script.
        truth = literal(test) if is_decided(test) else None
        before = self.scope.state
        ways: list[State | None] = []
        for holds, body in ((True, node.body), (False, node.orelse)):
            if isinstance(truth, bool) and truth is not holds:
                self.file.left_out.update(body)
                continue
            self.scope.state = before.copy()
            self.narrow(node.test, holds=holds)
            ways.append(self._way(self.scope.state, body))
        reached = self._meet(ways, before)
        if None not in ways:
            self.scope.state.doubted = before.doubted
        if flags := assigned_names([*node.body, *node.orelse]):
            decided = truth is not None
            asked = frozenset({EVERYTHING}) if decided else self.asked(node.test)
            self.tell(flags, asked, decided=decided)
        return reached

    def _loop(self, body: Rows[ast.stmt], orelse: Rows[ast.stmt], enter: Callable[[], None]) -> bool:
        """Reads a loop's body twice, so that what one turn binds is known in the next."""
        before = self.scope.state
        loop = Loop()
        self.loops.append(loop)
        start = before
        bound = len(before.names), before
        for turn in range(2):
            self.scope.state = start.copy()
            enter()
            after = self._way(self.scope.state, body)
            ends = [state for state in (after, *loop.continued) if state is not None]
            start = joined([before, *ends])
            if turn == 0 and not _differs(bound[1], start):
                break
        self.loops.pop()
        self.scope.state = start.copy()
        reached = self.read_body(orelse) if orelse else True
        return self._meet([self.scope.state if reached else None, *loop.left], start)

    def _for(self, node: ast.For | ast.AsyncFor) -> bool:
        kind = self.iterated(self.evaluate(node.iter))

        def enter() -> None:
            self.statement = node
            self.bind_target(node.target, kind)

        return self._loop(node.body, node.orelse, enter)

    def _while(self, node: ast.While) -> bool:
        def enter() -> None:
            self.statement = node
            self.evaluate(node.test)
            self.narrow(node.test, holds=True)

        return self._loop(node.body, node.orelse, enter)

    def _break(self, _node: ast.Break) -> bool:
        if self.loops:
            self.loops[-1].left.append(self.scope.state)
        return False

    def _continue(self, _node: ast.Continue) -> bool:
        if self.loops:
            self.loops[-1].continued.append(self.scope.state)
        return False

    def _with(self, node: ast.With | ast.AsyncWith) -> bool:
        for item in node.items:
            kind = self.evaluate(item.context_expr)
            if item.optional_vars is not None:
                self.bind_target(item.optional_vars, _entered(kind))
        forgiving = any(self._suppresses(item.context_expr) for item in node.items)
        self.tolerant += forgiving
        reached = self.read_body(node.body)
        self.tolerant -= forgiving
        return reached or forgiving

    def _try(self, node: ast.Try) -> bool:
        forgives = [self._forgives(handler) for handler in node.handlers]
        forgiving = any(forgives)
        before = self.scope.state
        self.tolerant += forgiving
        after = self._way(before.copy(), node.body)
        self.tolerant -= forgiving
        within = joined([before, after or self.scope.state])
        if after is not None and node.orelse:
            after = self._way(after, node.orelse)
        ways = [after]
        for handler, is_ready in zip(node.handlers, forgives, strict=True):
            self.scope.state = within.copy()
            if handler.name:
                self.scope.bind(handler.name, UNKNOWN)
            # What is done where a name is lacking may be for another Blender.
            self.tolerant += is_ready
            ways.append(self._way(self.scope.state, handler.body))
            self.tolerant -= is_ready
        reached = self._meet(ways, within.copy())
        if forgiving:
            handled = [statement for handler in node.handlers for statement in handler.body]
            self.tell(assigned_names([*node.body, *node.orelse, *handled]), self.lacked(node.body))
        return self.read_body(node.finalbody) and reached

    def _forgives(self, handler: ast.ExceptHandler) -> bool:
        """Whether a handler is ready for a name that does not exist."""
        return handler.type is None or self._is_forgiving(handler.type)

    def _suppresses(self, manager: ast.expr) -> bool:
        """Whether a context manager, which was read, is ready for a name that does not exist.

        ``contextlib.suppress(AttributeError)`` is, and so is what else is given such an error: ``assertRaises``.
        """
        return isinstance(manager, ast.Call) and any(map(self._is_forgiving, manager.args))

    def _is_forgiving(self, errors: ast.expr) -> bool:
        """Whether one of the classes that an expression stands for is that of a missing name's error."""
        kinds = [*members(self.evaluate(errors))]
        for kind in kinds:  # it grows
            if isinstance(kind, Tuple):
                kinds += kind.items
        return any(isinstance(kind, Builtin) and kind.name in _FORGIVING for kind in kinds)

    def _match(self, node: ast.Match) -> bool:
        subject = self.evaluate(node.subject)
        before = self.scope.state
        otherwise = before.copy()
        otherwise.doubted |= self.asked(node.subject)
        ways: list[State | None] = []
        whole = False
        for case in node.cases:
            self.scope.state = otherwise.copy()
            self._bind_pattern(case.pattern, subject, node.subject)
            if case.guard is not None:
                self.evaluate(case.guard)
                self.narrow(case.guard, holds=True)
            whole = whole or (
                isinstance(case.pattern, ast.MatchAs) and case.pattern.pattern is None and not case.guard
            )
            ways.append(self._way(self.scope.state, case.body))
        if not whole:
            ways.append(otherwise)
        reached = self._meet(ways, before)
        if None not in ways:
            self.scope.state.doubted = before.doubted
        self.tell(assigned_names(part for case in node.cases for part in case.body), self.asked(node.subject))
        return reached

    def _bind_pattern(self, pattern: ast.pattern, subject: Type, node: ast.expr) -> None:
        if isinstance(pattern, ast.MatchValue):
            self.evaluate(pattern.value)
            self.check_value(subject, pattern.value, "compared")
            compared = ast.Compare(node, [ast.Eq()], [pattern.value])
            self.narrow(compared, holds=True)
            return
        for part in walk(pattern):
            match part:
                case ast.MatchValue(value=value) | ast.MatchClass(cls=value):
                    self.evaluate(value)
                case ast.MatchMapping(keys=keys):
                    for key in keys:
                        self.evaluate(key)
                case _:
                    pass
            name = getattr(part, "name", None) or getattr(part, "rest", None)
            if isinstance(name, str):
                self.scope.bind(name, UNKNOWN)

    # Ends and expressions.

    def _expression(self, node: ast.Expr) -> bool:
        self.evaluate(node.value)
        return True

    def _return(self, node: ast.Return) -> bool:
        kind = self.told(self.evaluate(node.value), node.value) if node.value is not None else NONE
        if self.function is not None:
            before, kind = self.function.returned, bounded(kind)
            self.function.returned = kind if before is None else join(before, kind)
        return False

    def _raise(self, node: ast.Raise) -> bool:
        for part in (node.exc, node.cause):
            if part is not None:
                self.evaluate(part)
        return False

    def _assert(self, node: ast.Assert) -> bool:
        holds = self.evaluate(node.test)
        self.narrow(node.test, holds=True)
        if node.msg is not None:
            self.evaluate(node.msg)
        return not is_decided(holds) or literal(holds) is True

    def _delete(self, node: ast.Delete) -> bool:
        for target in node.targets:
            if isinstance(target, (ast.Attribute, ast.Subscript)):
                owner = self.evaluate(target.value)
                if isinstance(target, ast.Attribute) and isinstance(owner, ClassObject):
                    continue
                self.evaluate(target)
        return True

    def _global(self, node: ast.Global | ast.Nonlocal) -> bool:
        if self.scope is not self.file.module:
            self.scope.elsewhere.update(node.names)
        return True

    # Definitions.

    def _import(self, node: ast.Import) -> bool:
        for alias in node.names:
            top = alias.name.partition(".")[0]
            known = top in _API_MODULES
            whole = self._module(alias.name) if known else UNKNOWN
            if known and whole is UNKNOWN and "." in alias.name:
                self.resolve(alias, "name", alias.name, missing=(alias.name,))
            elif known:
                self.resolve(alias, "name", alias.name, (alias.name,))
            if not known:
                whole = self.local_module(alias.name)
                self._tell_lost(alias, alias.name)
            if alias.asname:
                self.scope.bind(alias.asname, whole)
            else:
                self.scope.bind(top, self._module(top) if known else self.local_module(top))
        return True

    def _tell_lost(self, node: ast.AST, module: str) -> None:
        """Records an imported module that other Blenders bring and this one does not, unless the files have it."""
        top = module.partition(".")[0]
        if top in LOST_MODULES:
            is_lost = self.version >= LOST_MODULES[top][0] and not self._may_bring(top)
        else:
            is_lost = self.api.had("", top)
        if is_lost and self.local_module(top) is UNKNOWN:
            self.resolve(node, "name", top, missing=("",))

    def _may_bring(self, module: str) -> bool:
        """Whether a module may be one that stands beside the scripts, or where they say that others are."""
        beside = any(module in name.split(".") for name in (*self.files, *self.folders))
        return beside or any(file.moves_imports for file in self.sources)

    def _module(self, path: str) -> Type:
        symbol = self.api.symbols.symbol(path)
        if symbol is None:
            return UNKNOWN
        owner, _, name = path.rpartition(".")
        member = self.api.member(owner, name) if owner else None
        return member.type if member else Module(path)

    def _import_from(self, node: ast.ImportFrom) -> bool:
        module = node.module or ""
        known = not node.level and module.partition(".")[0] in _API_MODULES
        owner = self._module(module) if known else self.local_module(self.file.imported(node.level, module))
        if not known and not node.level:
            self._tell_lost(node, module)
        for alias in node.names:
            name = alias.asname or alias.name
            if alias.name == "*":
                self._import_all(owner)
                continue
            if owner is UNKNOWN:
                self.scope.bind(name, UNKNOWN)
                continue
            found = self.attribute(owner, alias.name)
            if found.symbols or found.missing:
                self.resolve(alias, "name", alias.name, found.symbols, found.missing)
            self.scope.bind(name, found.type)
        return True

    def _import_all(self, owner: Type) -> None:
        names: Iterable[str] = ()
        if isinstance(owner, Module):
            names = self.api.own(owner.path)
        elif isinstance(owner, LocalModule) and (file := self.files.get(owner.name)):
            names = list(file.module.ever)
        for name in names:
            if not name.startswith("_"):
                self.scope.bind(name, self.attribute(owner, name).type)

    def _define_function(self, node: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
        cls = self.scope.cls if self.scope.is_class else None
        number = self.define_function(node, cls)
        function = self.functions[number]
        kind: Type = LocalFunction(number)
        for decorator in node.decorator_list:
            self.evaluate(decorator)
            match decorator:
                case ast.Name(id="staticmethod"):
                    function.is_static = True
                case ast.Name(id="classmethod"):
                    function.is_class_method = True
                case (
                    ast.Name(id="property")
                    | ast.Attribute(attr="cached_property")
                    | ast.Name(id="cached_property")
                ):
                    function.is_property = True
                case ast.Attribute(attr="setter" | "getter" | "deleter"):
                    return True
                case ast.Attribute(attr="persistent") | ast.Name(id="persistent"):
                    pass
                case _:
                    kind = UNKNOWN if cls is None else kind
        self.read_defaults(node.args)
        self._read_type_parameters(node)
        self.scope.bind(node.name, kind)
        return True

    def _define_class(self, node: ast.ClassDef) -> bool:
        for decorator in node.decorator_list:
            self.evaluate(decorator)
        self._read_type_parameters(node)
        bases = tuple(self._base(base) for base in node.bases)
        for keyword in node.keywords:
            self.evaluate(keyword.value)
        number = self.numbers.get(node)
        if number is None:
            number = self.numbers[node] = len(self.classes)
            self.classes.append(ClassDefinition(node, bases))
            for kind in self.ancestors(number):
                if isinstance(kind, LocalClass) and kind.number != number and number < _MOST_CLASSES:
                    self.derived.setdefault(kind.number, []).append(number)
        scope = Scope(self.scope, is_class=True, cls=number)
        scope.state.chains = dict(self.scope.state.chains)
        scope.state.doubted = self.scope.state.doubted
        outer, self.scope = self.scope, scope
        try:
            self.read_body(node.body)
        finally:
            self.scope = outer
        definition = self.classes[number]
        self._add_to_api(node.name, number, scope.state.names.get("bl_idname"))
        for name, kind in scope.ever.items():
            definition.bind(name, general(kind) if isinstance(kind, Plain) else kind)
        self.scope.bind(node.name, LocalClass(number))
        return True

    def _read_type_parameters(self, node: ast.stmt) -> None:
        """Evaluates what ``[T: bound]`` and ``type X = value`` name, which Python reads when it is asked for."""
        self.tolerant += 1
        for parameter in getattr(node, "type_params", ()):
            for part in children(parameter):
                if isinstance(part, ast.expr):
                    self.evaluate(part)
        self.tolerant -= 1

    def _type_alias(self, node: ast.stmt) -> bool:
        self._read_type_parameters(node)
        match children(node):
            case [ast.Name(id=name), *_, ast.expr() as value]:
                self.tolerant += 1
                self.evaluate(value)
                self.tolerant -= 1
                self.scope.bind(name, UNKNOWN)
            case _:
                pass
        return True

    def _add_to_api(self, name: str, number: int, identifier: Type | None) -> None:
        """Notes that a class, once it is registered, is found below bpy.types, and an operator below bpy.ops."""
        bases, known = self._direct_bases(number)
        if known and not any(base.startswith(T) for base in bases):
            return
        text = literal(identifier) if identifier is not None else name
        if not isinstance(text, str):
            self.own_types[name] = LocalClass(number)
            if not known or any(self.api.descends(base, f"{T}Operator") for base in bases):
                self.own_operators.add(ANY)
            return
        module, is_class_name, operator = text.partition("_OT_")
        if not is_class_name:
            module, _, operator = text.partition(".")
        if module and operator:
            self.own_operators |= {f"bpy.ops.{module.lower()}", f"bpy.ops.{module.lower()}.{operator}"}
            text = f"{module.upper()}_OT_{operator}"
        self.own_types[name] = self.own_types[text] = LocalClass(number)

    def _base(self, node: ast.expr) -> Type:
        kind = self.evaluate(node)
        if isinstance(node, ast.Name) and node.id == "object":
            return ClassObject("object")
        return kind

    # Functions.

    def run(self, number: int) -> None:
        """See :class:`core.Core`."""
        function = self.functions[number]
        function.running, function.stale, function.runs = True, False, function.runs + 1
        function.seen = self.stamp(function)
        function.readings = {}
        try:
            file = function.file or self.file
            shared = file.shared_names.get(function.node, frozenset())
            scope = Scope(function.scope, state=State(doubted=function.doubted), shared=shared)
            with self.inside(file, scope, function):
                self._read_function(function)
        finally:
            function.running = False

    def _read_function(self, function: FunctionDefinition) -> None:
        self._bind_parameters(function)
        if isinstance(function.node, ast.Lambda):
            function.returned = self.evaluate(function.node.body)
        elif self.read_body(function.node.body) and function.returned is not None:
            function.returned = join(function.returned, NONE)
        if not isinstance(function.node, ast.Lambda) and function.node.returns is not None:
            self.statement = None
            declared = self._annotated(function.node.returns)
            if declared is not UNKNOWN and function.returned in {UNKNOWN, None}:
                function.returned = declared

    def stamp(self, function: FunctionDefinition) -> tuple[int, int]:
        """What changes when a function should be read again: its module's names, its class's attributes."""
        module = function.file.module if function.file else self.file.module
        return module.changes, self.classes[function.cls].changes if function.cls is not None else 0

    def _bind_parameters(self, function: FunctionDefinition) -> None:
        arguments = function.node.args
        positional = [*arguments.posonlyargs, *arguments.args]
        declared = self._declared_parameters(function, len(positional))
        defaults = default_values(arguments)
        for place, argument in enumerate((*positional, *arguments.kwonlyargs)):
            given = declared[place] if place < len(declared) else UNKNOWN
            self.scope.bind(
                argument.arg, self._parameter(function, argument, given, defaults.get(argument.arg))
            )
        for rest in (arguments.vararg, arguments.kwarg):
            if rest is not None and rest.annotation is not None:
                self._annotated(rest.annotation)
        if arguments.vararg is not None:
            self.scope.bind(arguments.vararg.arg, Sequence("tuple", UNKNOWN))
        if arguments.kwarg is not None:
            self.scope.bind(arguments.kwarg.arg, Mapping(STR, UNKNOWN))

    def _parameter(
        self, function: FunctionDefinition, argument: ast.arg, declared: Type, default: ast.expr | None
    ) -> Type:
        """A parameter's type: annotated, declared by the API, seen in calls, its default's, or by its name."""
        if argument.annotation is not None:
            kind = self._annotated(argument.annotation)
            if kind is not UNKNOWN:
                received = function.received.get(argument.arg, UNKNOWN)
                return join(unsure(kind), received) if self._contradicts(received, kind) else kind
        if declared is not UNKNOWN:
            return declared
        received = function.received.get(argument.arg, UNKNOWN)
        if argument.arg in function.unknown and received is not UNKNOWN:
            # Some calls pass what is not known: the others tell no more than what may be passed.
            self.guessing = self.guessing or not can_be_unsure(received)
            received = unsure(received)
        fallback = self.types.get(default, UNKNOWN) if default is not None else UNKNOWN
        if argument.arg in function.unknown:
            fallback = unsure(fallback)
        if received is not UNKNOWN and received is not NONE:
            return received if fallback is UNKNOWN else join(received, general(fallback))
        if fallback is not UNKNOWN and fallback is not NONE:
            return general(fallback)
        # An annotation that says nothing here may name another library's class: a ``mesh: trimesh.Trimesh``.
        return UNKNOWN if argument.annotation is not None else self._by_convention(function, argument.arg)

    def _annotated(self, node: ast.expr) -> Type:
        """What an annotation means; a wrong name in it is no error where Python does not read it."""
        unread = self.file.keeps_annotations
        self.tolerant += unread
        kind = annotated(node, Readers(self.evaluate, self._quoted))
        self.tolerant -= unread
        return kind

    def _quoted(self, node: ast.Constant) -> Type:
        """What a quoted annotation means, which Python does not read."""
        if node not in self.file.quoted:
            self.file.quoted[node] = unquoted(node)
        inner = self.file.quoted[node]
        if inner is None or self.depth > DEEPEST:
            return UNKNOWN
        self.tolerant += 1
        self.depth += 1
        kind = annotated(inner, Readers(self.evaluate, self._quoted))
        self.depth -= 1
        self.tolerant -= 1
        return kind

    def _contradicts(self, received: Type, declared: Type) -> bool:
        """Whether calls pass something else than the annotation says, which nobody checks."""
        return any(
            not any(self._may_be(member, one) for one in members(declared)) for member in members(received)
        )

    def _may_be(self, given: Type, declared: Type) -> bool:  # noqa: PLR0911 - one return a pair
        """Whether something of a type may be what is declared, as far as is known of both."""
        if declared is UNKNOWN or given is UNKNOWN or given is NONE:
            return True
        match given, declared:
            case Instance(), Instance():
                return self.api.descends(given.cls, declared.cls) or self.api.descends(
                    declared.cls, given.cls
                )
            case LocalInstance(), Instance():
                return any(
                    isinstance(kind, ClassObject) and self._may_be(Instance(kind.cls), declared)
                    for kind in self.ancestors(given.number)
                )
            case LocalInstance(), LocalInstance():
                return LocalClass(declared.number) in self.ancestors(given.number) or LocalClass(
                    given.number
                ) in self.ancestors(declared.number)
            case Mapping(), Mapping():
                return not self._contradicts(given.value, declared.value)
            case Tuple(), Tuple() if len(given.items) == len(declared.items):
                return not any(map(self._contradicts, given.items, declared.items))
            case ((Sequence() | Tuple()), Sequence()):
                return not self._contradicts(self.iterated(given), declared.element)
            case _, Instance() | LocalInstance():
                return not isinstance(given, (Plain, Sequence, Tuple, Mapping, Instance))
            case _:
                return declared is not NONE

    def _by_convention(self, function: FunctionDefinition, name: str) -> Type:
        """The type that everyone's parameters of this name have, if the function uses it so."""
        cls = T + PARAMETERS.get(name, "")
        if not self.api.is_class(cls):
            return UNKNOWN
        if function.used is None:
            function.used = _used_names(function.node)
        for attribute in function.used.get(name, ()):
            known = attribute and (self.api.member(cls, attribute) or self.api.below(cls, attribute))
            if not known and not (attribute and self.api.had(cls, attribute)):
                return UNKNOWN
        return Instance(cls, sure=False)

    def _declared_parameters(self, function: FunctionDefinition, count: int) -> list[Type]:
        """What a method is called with: itself, and what the API's class passes to the method that it overrides."""
        if function.cls is None or count == 0:
            return []
        node = function.node
        first: list[Type] = []
        if not function.is_static:
            made = function.is_class_method or (
                isinstance(node, ast.FunctionDef) and node.name in {"__new__", "__init_subclass__"}
            )
            first = [LocalClass(function.cls) if made else LocalInstance(function.cls)]
        if isinstance(node, ast.Lambda):
            return first
        bases, _ = self.api_bases(function.cls)
        for base in bases:
            member = self.api.member(base, node.name)
            if member is not None and isinstance(member.type, Function):
                symbol = member.symbol
                rest = [p for p in symbol.parameters if p.name not in {"self", "cls"}]
                return first + [self.api.read_type(parameter.plain_type, symbol.path) for parameter in rest]
        return first

    _statement_readers: ClassVar[dict[type, Callable[..., bool]]] = {
        ast.Assign: _assign,
        ast.AnnAssign: _assign_annotated,
        ast.AugAssign: _assign_augmented,
        ast.If: _if,
        ast.For: _for,
        ast.AsyncFor: _for,
        ast.While: _while,
        ast.Break: _break,
        ast.Continue: _continue,
        ast.With: _with,
        ast.AsyncWith: _with,
        ast.Try: _try,
        ast.TryStar: _try,
        ast.Match: _match,
        ast.Expr: _expression,
        ast.Return: _return,
        ast.Raise: _raise,
        ast.Assert: _assert,
        ast.Delete: _delete,
        ast.Global: _global,
        ast.Nonlocal: _global,
        ast.Import: _import,
        ast.ImportFrom: _import_from,
        ast.FunctionDef: _define_function,
        ast.AsyncFunctionDef: _define_function,
        ast.ClassDef: _define_class,
        **({ast.TypeAlias: _type_alias} if sys.version_info >= (3, 12) else {}),
    }


def _used_names(function: ast.AST) -> dict[str, set[str]]:
    """Name → the attributes that a function reads from it; an empty one where it is indexed."""
    used: dict[str, set[str]] = {}
    for node in walk(function):
        if isinstance(node, (ast.Attribute, ast.Subscript)) and isinstance(node.value, ast.Name):
            used.setdefault(node.value.id, set()).add(node.attr if isinstance(node, ast.Attribute) else "")
    return used


def _differs(before: State, after: State) -> bool:
    """Whether a loop's first turn bound something that its beginning has otherwise."""
    return any(
        before.names.get(name) is not kind and before.names.get(name) != kind
        for name, kind in after.names.items()
        if name in before.names
    )


def _entered(kind: Type) -> Type:
    """What ``with`` gives: of a generator, which only a decorator makes a context manager, what it yields."""
    yielded = [one.element for one in members(kind) if isinstance(one, Sequence) and one.kind == "iterator"]
    return union(yielded) if yielded else kind
