"""How single symbols are written, with names and texts that are hard to write."""

from __future__ import annotations

import ast

from kb_build.symbols.records import EnumItem, Parameter, Symbol
from kb_check.stubs.modules import Stubs, write_modules
from kb_check.stubs.names import docstring, imports_of, shorten

THING = "bpy.types.Thing"


def written(*symbols: Symbol, with_docs: bool = False) -> Stubs:
    """Stubs of a Blender that has one class, and ``symbols``."""
    modules = [Symbol("bpy", "module"), Symbol("bpy.types", "module", owner="bpy")]
    thing = Symbol(THING, "class", owner="bpy.types", group="data")
    stubs = write_modules([*modules, thing, *symbols], with_docs=with_docs)
    for text in stubs.modules.values():
        ast.parse(text)
    return stubs


def types_of(*symbols: Symbol, with_docs: bool = False) -> str:
    return written(*symbols, with_docs=with_docs).modules["bpy.types"]


def prop(name: str, type_: str = "int", **fields: object) -> Symbol:
    return Symbol(f"{THING}.{name}", "property", owner=THING, type=type_, **fields)  # type: ignore[arg-type]


def function(name: str, signature: str, *parameters: Parameter) -> Symbol:
    return Symbol(f"{THING}.{name}", "function", owner=THING, signature=signature, parameters=parameters)


def test_a_name_that_python_cannot_spell_is_left_out_and_said() -> None:
    stubs = written(prop("lambda"), prop("good"), Symbol("bpy.types.import", "class", owner="bpy.types"))
    assert "lambda" not in stubs.modules["bpy.types"]
    assert "good: int" in stubs.modules["bpy.types"]
    assert stubs.left_out == [f"{THING}.lambda", "bpy.types.import"]


def test_a_member_does_not_hide_a_type_from_its_neighbours() -> None:
    text = types_of(prop("int", "boolean"), prop("property", flags=("readonly",)), prop("size"))
    assert "    int: bool" in text
    assert "    size: builtins.int" in text
    assert "@builtins.property" in text
    assert "import builtins" in text


def test_a_parameter_keeps_its_name() -> None:
    take = function("take", "take(type)", Parameter("type", "string", required=True))
    assert "def take(self, type: builtins.str)" in types_of(take, prop("type"), prop("str"))


def test_values_with_quotes_are_values() -> None:
    items = (EnumItem("it's"), EnumItem('"'), EnumItem("a\\b\n"))
    text = types_of(prop("mode", "enum", enum_items=items))
    literal = next(node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.AnnAssign))
    assert isinstance(literal.annotation, ast.Subscript)
    assert ast.literal_eval(literal.annotation.slice) == tuple(item.identifier for item in items)


def test_a_description_cannot_end_its_docstring() -> None:
    text = types_of(prop("size", description="\"\"\"\n''' \\"), with_docs=True)
    said = [node.value for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Expr)]
    assert (
        next(ast.literal_eval(value) for value in said if isinstance(value, ast.Constant)) == "\"\"\" ''' \\."
    )


def test_what_must_be_given_behind_what_need_not_goes_by_its_name() -> None:
    call = function(
        "call", "call(a=1, b)", Parameter("a", "int", default=1), Parameter("b", "int", required=True)
    )
    assert "def call(self, a: int = ..., *, b: int)" in types_of(call)


def test_a_signature_that_is_no_python_is_taken_from_its_parameters() -> None:
    call = function("call", "call(report=<function>)", Parameter("report", "", default=None))
    assert "def call(self, report: typing.Any = ...)" in types_of(call)


def test_types_that_nest_without_end_are_anything() -> None:
    deep = "list[" * 500 + "int" + "]" * 500
    assert "typing.Any" in types_of(prop("deep", deep))


def test_read_only_and_settable() -> None:
    text = types_of(
        prop("fixed", flags=("readonly",)),
        prop("place", "float", array=(3,), subtype="TRANSLATION"),
        prop("other", "pointer", target="Thing"),
    )
    assert "def fixed(self) -> int" in text
    assert "fixed.setter" not in text
    assert "def place(self, value: bpy._typing.Items[float], /)" in text
    assert "def other(self, value: Thing | None, /)" in text


def test_names_are_short_in_their_own_module() -> None:
    assert shorten("bpy.types.Object | mathutils.Vector", "bpy.types") == "Object | mathutils.Vector"
    assert shorten('typing.Literal["bpy.types.Object"]', "bpy.types") == 'typing.Literal["bpy.types.Object"]'


def test_imports_are_those_that_are_named() -> None:
    modules = {"bpy", "bpy.types", "mathutils"}
    text = 'a: mathutils.Vector | bpy.types.bpy_struct = "gpu.types"\nb: collections.abc.Iterable[x.y]'
    assert imports_of(text, "bmesh", modules) == [
        "import bpy.types", "import collections.abc", "import mathutils",
    ]  # fmt: skip


def test_docstrings_are_one_sentence_each() -> None:
    assert docstring("Size", "How large.\nIt grows. Really.") == "'Size. How large.'"
    assert docstring("", "  ") == ""
