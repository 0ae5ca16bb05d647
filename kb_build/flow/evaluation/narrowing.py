"""What conditions tell: ``isinstance``, ``type(x) is y``, ``ob.type == 'MESH'``, ``hasattr``, ``is not None``."""

from __future__ import annotations

import ast
from dataclasses import replace

from kb_build.flow.blender.facts import AREA, DISCRIMINANTS, SPACE
from kb_build.flow.evaluation.guards import Guards
from kb_build.flow.state.doubts import Doubts
from kb_build.flow.state.scopes import chain_text
from kb_build.flow.syntax.trees import default_values
from kb_build.flow.values.types import (
    NONE,
    UNKNOWN,
    Builtin,
    Instance,
    Plain,
    Tuple,
    Type,
    Union,
    instance_of,
    literal,
    literal_text,
    literal_texts,
    members,
    union,
    without_none,
)
from kb_build.symbols.api_names import OBJECT

_ACTIVE_SPACE = "spaces.active"


class Narrowing(Guards):
    """Applies conditions to what names and chains hold."""

    def narrow(self, test: ast.expr, *, holds: bool, asked: Doubts | None = None) -> None:
        """See :class:`core.Core`."""
        self.doubt(test, holds=holds, asked=asked)
        self._narrow(test, holds=holds)

    def _narrow(self, test: ast.expr, *, holds: bool) -> None:  # noqa: PLR0912 - one case a form
        match test:
            case ast.UnaryOp(op=ast.Not()):
                self._narrow(test.operand, holds=not holds)
            case ast.BoolOp(op=ast.And()) if holds:
                for value in test.values:
                    self._narrow(value, holds=True)
            case ast.BoolOp(op=ast.Or()) if not holds:
                for value in test.values:
                    self._narrow(value, holds=False)
            case ast.BoolOp(op=ast.Or()) if holds:
                self._any_of(test.values)
            case ast.Name() | ast.Attribute() | ast.NamedExpr():
                if holds:
                    self._without_none(test.target if isinstance(test, ast.NamedExpr) else test)
                self._answered(test, holds=holds)
            case ast.Compare(ops=[operator], comparators=[right]):
                self._comparison(test.left, operator, right, holds=holds)
            case ast.Call(func=ast.Name(id=name)):
                if name in {"hasattr", "getattr"}:
                    self._has(test, holds=holds)
                elif holds:
                    self._is_instance(name, test.args)
                else:
                    self._is_no_instance(name, test)
            case _:
                pass

    def _answered(self, node: ast.expr, *, holds: bool) -> None:
        """Narrows by the ``hasattr`` or ``getattr`` whose answer a name, or an expression, is."""
        if isinstance(node, ast.NamedExpr):
            node = node.value
        asked = self.here.scope.asked_by(node.id) if isinstance(node, ast.Name) else node
        if isinstance(asked, ast.Call):
            self._narrow(asked, holds=holds)

    def _doubt_chain(self, text: str) -> None:
        if text:
            self.doubt_here(Doubts(chains=frozenset({text})))

    def _type_of(self, node: ast.expr) -> Type:
        return self.here.types.get(node, UNKNOWN)

    def _know(self, node: ast.expr, kind: Type) -> None:
        """What a name or a chain holds from here on; only for the way that is being read."""
        text = chain_text(node)
        if not text:
            return
        if isinstance(node, ast.Name) and node.id in self.here.scope.state.names:
            self.here.scope.state.names[node.id] = kind
        else:
            self.here.scope.state.chains[text] = kind
        self.here.types[node] = kind

    def _without_none(self, node: ast.expr) -> None:
        kind = self._type_of(node)
        if isinstance(kind, Union):
            self._know(node, without_none(kind))

    def _any_of(self, tests: list[ast.expr]) -> None:
        """``a.type == 'X' or a.type == 'Y'``: either."""
        before = self.here.scope.state
        kinds: dict[str, list[Type]] = {}
        for test in tests:
            self.here.scope.state = self.copied(before)
            self._narrow(test, holds=True)
            for name, kind in self.here.scope.state.names.items():
                if before.names.get(name) is not kind:
                    kinds.setdefault(name, []).append(kind)
        self.here.scope.state = before
        for name, found in kinds.items():
            if len(found) == len(tests):
                before.names[name] = union(found)

    def _is_no_default(self, node: ast.expr, others: ast.expr) -> None:
        """What a parameter holds that is not its default: anything, where that is all that tells its type."""
        if self.here.function is None or not isinstance(node, ast.Name):
            return
        given = self.here.function.node.args
        defaults = default_values(given)
        default = defaults.get(node.id)
        is_told = self.here.function.received.get(node.id, UNKNOWN) is not UNKNOWN or any(
            argument.arg == node.id and argument.annotation is not None
            for argument in (*given.posonlyargs, *given.args, *given.kwonlyargs)
        )
        if is_told or not isinstance(default, ast.Constant) or default.value is None:
            return
        kind = self._type_of(others)
        if any(literal(one) == default.value for one in (kind.items if isinstance(kind, Tuple) else (kind,))):
            self._know(node, UNKNOWN)

    def _comparison(self, left: ast.expr, operator: ast.cmpop, right: ast.expr, *, holds: bool) -> None:
        positive = isinstance(operator, (ast.Eq, ast.In, ast.Is)) == holds
        if not positive:
            self._is_no_default(left, right)
        if isinstance(right, ast.Constant) and right.value is None:
            if not positive:
                self._without_none(left.target if isinstance(left, ast.NamedExpr) else left)
            self._answered(left, holds=not positive)
            return
        if positive and isinstance(left, ast.Call) and isinstance(left.func, ast.Name):
            self._is_instance(left.func.id, [*left.args, right], "type")
        if not positive or not isinstance(left, ast.Attribute) or left.attr not in DISCRIMINANTS:
            return
        texts: list[str] = []
        if isinstance(operator, (ast.In, ast.NotIn)):
            kind = self._type_of(right)
            held = kind.items if isinstance(kind, Tuple) else (self.iterated(kind),)
            texts = [text for item in held for text in literal_texts(item)]
        elif text := literal_text(self._type_of(right)):
            texts = [text]
        if texts:
            self._told_apart(left.value, texts)

    def _told_apart(self, node: ast.expr, values: list[str]) -> None:
        """A value whose ``type`` is one of ``values``."""
        kind = without_none(self._type_of(node))
        if isinstance(kind, Instance) and kind.cls == AREA:
            self._know_space(node, values)
            return
        found: list[Type] = []
        for member in members(kind):
            if not isinstance(member, Instance):
                return
            for value in values:
                if member.cls == OBJECT:
                    data = self.api.object_data(value)
                    found.append(replace(member, traits=(("data", data),)) if data is not UNKNOWN else member)
                elif cls := self.api.literals.class_of_value(member.cls, value):
                    found.append(Instance(cls))
                else:
                    found.append(member)
        if found and (result := union(found)) is not UNKNOWN:
            self._know(node, result)

    def _know_space(self, area: ast.expr, values: list[str]) -> None:
        """The active space of an area whose type is one of ``values`` is one of theirs."""
        spaces = [self.api.literals.class_of_value(SPACE, value) for value in values]
        if (text := chain_text(area)) and all(spaces):
            self.here.scope.state.chains[f"{text}.{_ACTIVE_SPACE}"] = union(map(Instance, spaces))

    def _is_instance(self, name: str, arguments: list[ast.expr], asking: str = "isinstance") -> None:
        """``isinstance(x, y)``, or ``type(x) is y``."""
        if name != asking or len(arguments) != 2:
            return
        subject, answer = arguments
        wanted = self._type_of(answer)
        kinds = wanted.items if isinstance(wanted, Tuple) else members(wanted)
        found = [instance_of(kind) for kind in kinds]
        if UNKNOWN not in found:
            self._know(subject, union(found))
        elif chain_text(subject):
            self._know(subject, UNKNOWN)

    def _is_no_instance(self, name: str, call: ast.Call) -> None:
        """``not isinstance(x, str)`` of what is known to be one: then it is something else."""
        if name != "isinstance" or len(call.args) != 2:
            return
        subject, answer = call.args
        wanted = self._type_of(answer)
        # Where the test held, the name was something else, and is still noted as that.
        held = self.here.scope.state.names.get(subject.id) if isinstance(subject, ast.Name) else None
        kind = held or self._type_of(subject)
        names = {
            one.name
            for one in (wanted.items if isinstance(wanted, Tuple) else members(wanted))
            if isinstance(one, Builtin)
        }
        if all(isinstance(member, Plain) and member.kind in names for member in members(kind)):
            self._know(subject, UNKNOWN)

    def _has(self, call: ast.Call, *, holds: bool) -> None:
        """``hasattr(x, "y")``, and ``getattr(x, "y", None)`` as a condition."""
        if len(call.args) < 2:
            return
        subject, answer = call.args[:2]
        text, attribute = chain_text(subject), literal_text(self._type_of(answer))
        if not holds:
            self._doubt_chain(text)
            return
        owner = self._type_of(subject)
        if not text or not attribute or owner is UNKNOWN or owner is NONE:
            return
        found = self.attribute(owner, attribute)
        if found.missing or found.possible:
            # Where it is lacking here, this is for another Blender.
            self.here.scope.state.chains[f"{text}.{attribute}"] = UNKNOWN if found.missing else found.type
        if found.missing:
            self._doubt_chain(text)
