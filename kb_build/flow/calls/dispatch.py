"""Evaluates calls: finds what is called, one thing or one of several."""

from __future__ import annotations

import ast
from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

from kb_build.flow.blender.facts import leaves_active, made_by
from kb_build.flow.calls.api_calls import ApiCalls
from kb_build.flow.calls.python_calls import PythonCalls
from kb_build.flow.calls.read_calls import ReadCall
from kb_build.flow.calls.script_calls import ScriptCalls
from kb_build.flow.evaluation.given_values import CARRYING, constants
from kb_build.flow.values.type_parts import entered
from kb_build.flow.values.types import (
    NONE,
    UNKNOWN,
    Builtin,
    ClassObject,
    Function,
    Instance,
    LocalClass,
    LocalFunction,
    Operator,
    Resolution,
    Type,
    Union,
    Unknown,
    literal_text,
    literal_texts,
    members,
    union,
)
from kb_build.symbols.api_names import NODE, OBJECT
from kb_build.symbols.api_names import TYPES as T

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable


class Calls(ApiCalls, PythonCalls):
    """Evaluates calls."""

    def call(self, callee: Type, node: ast.Call) -> Type:
        """See :class:`core.Core`."""
        arguments = [self.evaluate(argument) for argument in node.args]
        keywords = {keyword.arg or "": self.evaluate(keyword.value) for keyword in node.keywords}
        call = ReadCall(node, arguments, keywords)
        if callee is UNKNOWN:
            result = self._of_unknown(call)
        elif isinstance(callee, Union):
            result = self._one_of_several(callee, call)
        else:
            result = self._one_call(callee, call)
        self._may_fill(callee, call)
        self.here.scope.state.active = self._active_after(callee, call)
        return result

    def _may_fill(self, callee: Type, call: ReadCall) -> None:
        """What was empty, and is given to what the script defines or imports, may be filled with anything there."""
        if not any(isinstance(one, (Unknown, LocalFunction, LocalClass)) for one in members(callee)):
            return
        for node in (*call.node.args, *(keyword.value for keyword in call.node.keywords)):
            self.give_away(node, self.here.types.get(node, UNKNOWN))

    def _active_after(self, callee: Type, call: ReadCall) -> Type | None:
        """The active object behind a call, where an operator has made it and nothing may have changed that."""
        match callee:
            case Operator(path=path) if kind := made_by(path):
                data = self._data_of_type(self.api.object_data(kind), call)
                return Instance(OBJECT, (("data", data),)) if data is not UNKNOWN else None
            case Operator(path=path) if not leaves_active(path):
                return None
            case Function(path=path) if path.endswith((".temp_override", ".remove", ".link", ".unlink")):
                return None
            case Operator() | Function() | ClassObject() | Builtin():
                return self.here.scope.state.active
            case _:
                return None

    def _data_of_type(self, data: Type, call: ReadCall) -> Type:
        """The data of an object as the call's type decides it: ``light_add(type='SPOT')`` makes a SpotLight."""
        values = literal_texts(call.keywords["type"]) if "type" in call.keywords else ()
        if not isinstance(data, Instance) or not values:
            return data
        classes = (self.api.literals.class_of_value(data.cls, value) for value in values)
        return union([replace(data, cls=cls) if cls else data for cls in classes])

    def _one_of_several(self, callee: Union, call: ReadCall) -> Type:
        """A call of one of several: an argument is recorded for all of them, and is none where none takes it."""
        node = call.node
        parts = [*node.keywords, *(part for argument in node.args for part in constants(argument))]
        parts += [part for keyword in node.keywords for part in constants(keyword.value)]
        given = [*node.args, *(keyword.value for keyword in node.keywords)]
        parts += [part for part in given if isinstance(part, CARRYING)]
        called = [member for member in callee.members if member is not NONE]
        results: list[Type] = []
        rows: dict[ast.AST, list[Resolution]] = defaultdict(list)
        for member in called:
            for part in parts:
                self.here.resolutions.pop(part, None)
            results.append(self._one_call(member, call))
            for part in parts:
                if row := self.here.resolutions.get(part):
                    rows[part].append(row)
        for part, found in rows.items():
            symbols = _in_order(path for row in found for path in row.symbols)
            missing = _in_order(path for row in found for path in row.missing)
            # What tells nothing of an argument may take it.
            is_sure = len(found) == len(called) and all(row.sure for row in found)
            self.here.resolutions[part] = replace(found[-1], symbols=symbols, missing=missing, sure=is_sure)
        return union(results)

    def _of_unknown(self, call: ReadCall) -> Type:
        """What a method gives of a thing that is not known: ``tree.nodes.new("ShaderNodeMath")``, for the text is the
        class whatever the tree is, and what an ExitStack enters.
        """
        match call.node.func:
            case ast.Attribute(value=ast.Attribute(attr="nodes") | ast.Name(id="nodes"), attr="new"):
                given = [*call.arguments, *call.keywords.values()]
                text = literal_text(given[0]) if given else None
                if text and self.api.descends(f"{T}{text}", NODE):
                    return Instance(f"{T}{text}")
            case ast.Attribute(attr="enter_context") if len(call.arguments) == 1:
                return entered(call.argument(0))  # of an ExitStack
            case _:
                pass
        return UNKNOWN

    def _one_call(self, callee: Type, call: ReadCall) -> Type:
        caller = self._callers.get(type(callee))
        return caller(self, callee, call) if caller else UNKNOWN

    _callers: ClassVar[dict[type, Callable[..., Type]]] = {
        Operator: ApiCalls.call_operator,
        Function: ApiCalls.call_function,
        ClassObject: ApiCalls.call_class,
        LocalClass: ScriptCalls.call_local_class,
        LocalFunction: ScriptCalls.call_local_function,
        Builtin: PythonCalls.call_builtin,
    }


def _in_order(paths: Iterable[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(paths))
