"""What a script asks of Blender before it goes on: its version, and whether a name exists.

What stands behind such a condition may be for another Blender. A condition that this Blender decides leaves the other
way out; behind one that is not decided, everything is *doubted*, or the names that were asked for.
"""

from __future__ import annotations

import ast
from functools import reduce
from operator import or_
from typing import TYPE_CHECKING

from kb_build.flow.evaluation.expressions import Expressions, is_decided
from kb_build.flow.state.doubts import CHOSEN, EVERYTHING, NO_DOUBTS, Doubts, as_doubts, as_source, without
from kb_build.flow.syntax.trees import children, walk
from kb_build.flow.values.type_parts import is_computed, telling, tells
from kb_build.flow.values.types import (
    UNKNOWN,
    FromNames,
    Instance,
    LocalFunction,
    Mapping,
    Module,
    Plain,
    Sequence,
    Telling,
    Tuple,
    Type,
    literal,
    literal_text,
    members,
)
from kb_build.symbols.api_names import OPERATORS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator


class Guards(Expressions):
    """Finds what conditions ask, and which names hold the answers."""

    def doubt(self, test: ast.expr, *, holds: bool, asked: Doubts | None = None) -> None:
        """Doubts what is read from here on, where a condition, which was read, holds or does not; ``asked`` is what it
        asks, where that is known.
        """
        kind = self.here.types.get(test, UNKNOWN)
        if not is_decided(kind):
            found = self.asked(test, chooses=True) if asked is None else asked
            self.doubt_here(found | without(test, holds=holds) | self._of_another(test, holds=holds))
        elif literal(kind) is not holds:
            self.doubt_here(EVERYTHING)

    def _of_another(self, test: ast.expr, *, holds: bool) -> Doubts:
        """Everything, where a condition finds a member that a class has in another Blender only, or lacks one that it
        has in this one; or a value that a property has in another Blender only.
        """
        match test:
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                return self._of_another(operand, holds=not holds)
            case ast.BoolOp(op=operator, values=sides) if isinstance(operator, ast.And) is holds:
                return reduce(or_, (self._of_another(side, holds=holds) for side in sides))
            case ast.Call(func=ast.Name(id="hasattr"), args=[owner, ast.Constant(value=str(name))]):
                return self._of_another_with(owner, name, has=holds)
            case ast.Compare(
                left=ast.Constant(value=str(name)),
                ops=[ast.In() | ast.NotIn() as operator],
                comparators=[ast.Call(func=ast.Name(id="dir"), args=[owner])],
            ):
                return self._of_another_with(
                    owner, name, has=isinstance(operator, ast.In) is holds, listed=True
                )
            case ast.Compare(left=left, ops=[operator], comparators=[right]):
                is_former = self._has_former_value(left, operator, right, holds=holds)
                return EVERYTHING if is_former else NO_DOUBTS
            case _:
                return NO_DOUBTS

    def _has_former_value(self, left: ast.expr, operator: ast.cmpop, right: ast.expr, *, holds: bool) -> bool:
        """Whether a comparison finds a property to have one of some values that it has in another Blender only."""
        match operator, right:
            case ((ast.Eq() | ast.NotEq()), _):
                return isinstance(operator, ast.Eq) is holds and any(map(self._is_former, (left, right)))
            case (
                (ast.In() | ast.NotIn()),
                ast.Tuple(elts=items) | ast.List(elts=items) | ast.Set(elts=items),
            ):
                return (
                    isinstance(operator, ast.In) is holds and bool(items) and all(map(self._is_former, items))
                )
            case _:
                return False

    def _is_former(self, compared: ast.expr) -> bool:
        row = self.here.resolutions.get(compared)
        if row is None or row.kind != "compared" or not row.missing:
            return False
        return all(self.api.had_value(path, row.value) for path in row.missing)

    def _of_another_with(self, owner: ast.expr, name: str, *, has: bool, listed: bool = False) -> Doubts:
        """Everything, where something has a name, or lacks it, in another Blender and not in this one.
        Modules of operators have every name, and list those that are there.
        """
        for kind in members(self.here.types.get(owner, UNKNOWN)):
            match kind:
                case Instance(cls=path):
                    is_there = self.api.member(path, name) is not None
                case Module(path=path) if listed or not f"{path}.".startswith(OPERATORS):
                    is_there = self.api.symbols.symbol(f"{path}.{name}") is not None
                case _:
                    continue
            if is_there is not has and (is_there or self.api.had(path, name)):
                return EVERYTHING
        return NO_DOUBTS

    def asked(self, node: ast.expr, *, chooses: bool = False) -> Doubts:
        """What becomes doubted by what an expression, which was read, asks without being decided.

        With ``chooses`` that is ``chosen`` too, where it may hold of some texts from elsewhere but not of all.
        """
        found = NO_DOUBTS
        names: set[str] = set()
        waiting: list[ast.AST] = [node]
        for part in waiting:
            if isinstance(part, ast.BoolOp):  # the sides that are decided leave the answer to the others
                waiting += (
                    side for side in part.values if not is_decided(self.here.types.get(side, UNKNOWN))
                )
                continue
            if isinstance(part, ast.expr) and (source := tells(self.here.types.get(part, UNKNOWN))):
                found |= as_doubts(source)
            match part:
                case ast.Name(id="TYPE_CHECKING") | ast.Attribute(attr="TYPE_CHECKING"):
                    found |= EVERYTHING  # what follows never runs: it may name what only stubs have
                case ast.Attribute(value=ast.Attribute(attr="build_options")):
                    found |= EVERYTHING  # what another build has
                case ast.Call(
                    func=ast.Name(id="version") | ast.Attribute(attr="version"),
                    args=[ast.Constant(value="bpy")],
                ):
                    found |= EVERYTHING  # that of the package, by importlib.metadata
                case ast.Name() if chooses and not found.chosen and self._may_choose(part):
                    found |= CHOSEN
                case ast.Call():
                    names.update(self._texts(part.args))
                    if self._calls_for_version(part):
                        found |= EVERYTHING
                case ast.Compare(ops=[ast.In() | ast.NotIn()]):
                    names.update(self._texts([part.left], of_any_form=True))
                case _:
                    pass
            waiting += children(part)
        return found | Doubts(members=frozenset(names)) if names else found

    def _may_choose(self, name: ast.Name) -> bool:
        """Whether a name holds a plain value, or what is not known."""
        kind = self.here.types.get(name, UNKNOWN)
        return any(
            one is UNKNOWN or isinstance(one, (Plain, Sequence, Tuple, Mapping)) for one in members(kind)
        )

    def told(self, kind: Type, value: ast.expr | None) -> Type:
        """A value as a name holds it: one that is computed from what Blender told tells it on."""
        if not self.version or value is None or isinstance(value, ast.Constant) or not _may_tell(kind):
            return kind
        return telling(kind, as_source(self.asked(value)))

    def tell(self, names: Iterable[str], source: Telling | None, *, decided: bool = False) -> None:
        """Names hold what they do because of what Blender told: flags that are set behind a condition."""
        held = self.here.scope.state.names
        for name in names if source is not None else ():
            kind = held.get(name, UNKNOWN)
            if _may_tell(kind):
                self.bind(name, telling(kind, source, value=decided))

    def lacked(self, statements: Iterable[ast.stmt]) -> FromNames | None:
        """How a value tells of this Blender that depends on the names in statements, which were read, that it lacks."""
        rows = (self.here.resolutions.get(node) for statement in statements for node in walk(statement))
        lacked = (row.value for row in rows if row is not None and row.missing)
        names = frozenset(name for value in lacked for name in value.split("."))
        return FromNames(names) if names else None

    def _texts(self, nodes: Iterable[ast.expr], *, of_any_form: bool = False) -> Iterator[str]:
        """The texts among expressions that may be names; of an operator's class, its module's and its own as well."""
        for node in nodes:
            text = literal_text(self.here.types.get(node, UNKNOWN))
            if text is not None and (of_any_form or text.isidentifier()):
                yield text
                module, of_class, operator = text.partition("_OT_")
                if of_class:
                    yield from (module.lower(), operator)

    def _calls_for_version(self, call: ast.Call) -> bool:
        """Whether a function of the script is called that looks at Blender's version."""
        kind = self.here.types.get(call.func)
        if not isinstance(kind, LocalFunction):
            return False
        function = self.functions[kind.number]
        if function.asks_version is None:
            function.asks_version = _reads_version(function.node)
        return function.asks_version


def assigned_names(statements: Iterable[ast.stmt]) -> list[str]:
    """The names that statements assign to in their own scope, as far as that is plainly written."""
    found: list[str] = []
    for statement in statements:
        if isinstance(statement, ast.Assign):
            found += [target.id for target in statement.targets if isinstance(target, ast.Name)]
    return found


def _may_tell(kind: Type) -> bool:
    """Whether a value can tell of this Blender: a plain one, one of several such, or a row of computed ones."""
    if isinstance(kind, Sequence):
        return is_computed(kind.element)
    return any(isinstance(member, Plain) for member in members(kind))


def _reads_version(function: ast.AST) -> bool:
    """Whether a function looks at ``app.version``."""
    return any(
        isinstance(node, ast.Attribute)
        and node.attr.startswith("version")
        and isinstance(node.value, (ast.Attribute, ast.Name))
        and (node.value.attr if isinstance(node.value, ast.Attribute) else node.value.id) == "app"
        for node in walk(function)
    )
