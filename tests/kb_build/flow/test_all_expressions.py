"""Every place of Python's grammar where an expression may stand is read."""

from __future__ import annotations

import ast
import sys
from typing import TYPE_CHECKING

import pytest

from kb_build.flow.analysis import analyse

if TYPE_CHECKING:
    from kb_build.flow.blender.api import Api

GONE = "bpy.data.no_such"
# Class and field of the node → code that has it; ``@`` is where the expression stands.
PLACES = {
    "AnnAssign.annotation": "x: @ = 1",
    "AnnAssign.target": "@.y: int = 1",
    "AnnAssign.value": "x: int = @",
    "Assert.msg": "assert x, @",
    "Assert.test": "assert @",
    "Assign.targets": "@.y = 1",
    "Assign.value": "x = @",
    "AsyncFor.iter": "async def f():\n    async for x in @: pass",
    "AsyncFor.target": "async def f():\n    async for @.y in x: pass",
    "AsyncFunctionDef.decorator_list": "@@\nasync def f(): pass",
    "AsyncFunctionDef.returns": "async def f() -> @: pass",
    "Attribute.value": "@.y",
    "AugAssign.target": "@.y += 1",
    "AugAssign.value": "x += @",
    "Await.value": "async def f():\n    await @",
    "BinOp.left": "@ + x",
    "BinOp.right": "x + @",
    "BoolOp.values": "x and @",
    "Call.args": "x(@)",
    "Call.func": "@()",
    "ClassDef.bases": "class A(@): pass",
    "ClassDef.decorator_list": "@@\nclass A: pass",
    "Compare.comparators": "x < @",
    "Compare.left": "@ < x",
    "Delete.targets": "del @",
    "Dict.keys": "{@: 1}",
    "Dict.values": "{1: @}",
    "DictComp.key": "{@: 1 for x in y}",
    "DictComp.value": "{1: @ for x in y}",
    "ExceptHandler.type": "try:\n    x\nexcept @:\n    pass",
    "Expr.value": "@",
    "For.iter": "for x in @: pass",
    "For.target": "for @.y in x: pass",
    "FormattedValue.format_spec": "f'{1:{@}}'",
    "FormattedValue.value": "f'{@}'",
    "FunctionDef.decorator_list": "@@\ndef f(): pass",
    "FunctionDef.returns": "def f() -> @: pass",
    "GeneratorExp.elt": "(@ for x in y)",
    "If.test": "if @: pass",
    "IfExp.body": "@ if x else 1",
    "IfExp.orelse": "1 if x else @",
    "IfExp.test": "1 if @ else 2",
    "Interpolation.format_spec": "t'{1:{@}}'",
    "Interpolation.value": "t'{@}'",
    "JoinedStr.values": "f'a{@}b'",
    "Lambda.body": "lambda: @",
    "List.elts": "[@]",
    "ListComp.elt": "[@ for x in y]",
    "Match.subject": "match @:\n    case 1: pass",
    "MatchClass.cls": "match x:\n    case @(): pass",
    "MatchMapping.keys": "match x:\n    case {@: 1}: pass",
    "MatchValue.value": "match x:\n    case [@]: pass",
    "NamedExpr.value": "(x := @)",
    "ParamSpec.default_value": "def f[**P = @](): pass",
    "Raise.cause": "raise x from @",
    "Raise.exc": "raise @",
    "Return.value": "def f():\n    return @",
    "Set.elts": "{@}",
    "SetComp.elt": "{@ for x in y}",
    "Slice.lower": "x[@:]",
    "Slice.step": "x[::@] = y",
    "Slice.upper": "x[:@] += y",
    "Starred.value": "x(*@)",
    "Subscript.slice": "x[@]",
    "Subscript.value": "@[0]",
    "TemplateStr.values": "t'a{@}b'",
    "Tuple.elts": "(@, 1)",
    "TypeAlias.value": "type X = @",
    "TypeVar.bound": "def f[T: @](): pass",
    "TypeVar.default_value": "class A[T = @]: pass",
    "TypeVarTuple.default_value": "type X[*T = @] = int",
    "UnaryOp.operand": "not @",
    "While.test": "while @: pass",
    "Yield.value": "def f():\n    yield @",
    "YieldFrom.value": "def f():\n    yield from @",
    "arg.annotation": "def f(*x: foo(@)): pass",
    "arguments.defaults": "lambda x=@: x",
    "arguments.kw_defaults": "lambda *x, y=@: y",
    "comprehension.ifs": "[x for x in y if @]",
    "comprehension.iter": "[x for x in @]",
    "comprehension.target": "[x for @.y in x]",
    "keyword.value": "class A(metaclass=@): pass",
    "match_case.guard": "match x:\n    case 1 if @: pass",
    "withitem.context_expr": "with @: pass",
    "withitem.optional_vars": "with x as @.y: pass",
}  # fmt: skip
# Names that are bound, and trees that no file holds.
NO_PLACES = {
    "NamedExpr.target",
    "TypeAlias.name",
    "Expression.body",
    "FunctionType.argtypes",
    "FunctionType.returns",
}
SINCE = {"TypeAlias": (3, 12), "TypeVar": (3, 12), "Interpolation": (3, 14), "TemplateStr": (3, 14)}
DEFAULTS_SINCE = (3, 13)  # of type parameters


def _is_python_new_enough(place: str) -> bool:
    needed = DEFAULTS_SINCE if "default_value" in place else SINCE.get(place.partition(".")[0], (3, 11))
    return sys.version_info >= needed


@pytest.mark.parametrize("place", [place for place in PLACES if _is_python_new_enough(place)])
def test_an_expression_is_read_wherever_it_stands(api: Api, place: str) -> None:
    code = (
        PLACES[place].replace("@", GONE)
        if "@@" not in PLACES[place]
        else PLACES[place].replace("@@", f"@{GONE}")
    )
    found = analyse(f"import bpy\n{code}", api, (5, 1, 0))
    assert found.error is None
    rows = [row for row in found.resolutions.values() if row.value == "no_such" and row.missing]
    assert len(rows) == 1


@pytest.mark.skipif(sys.version_info < (3, 13), reason="Python tells the kinds of fields since 3.13")
def test_no_place_of_the_grammar_is_left_out() -> None:
    places = {
        f"{name}.{field}"
        for name, kind in vars(ast).items()
        if isinstance(kind, type) and issubclass(kind, ast.AST)
        for field, held in getattr(kind, "_field_types", {}).items()
        if ast.expr in {held, *getattr(held, "__args__", ())}
    }
    assert places - NO_PLACES <= PLACES.keys()
