"""Records survive being written down and read back, whatever Blender put into them."""

from __future__ import annotations

import json
import random
from dataclasses import asdict, fields, replace
from typing import TYPE_CHECKING

import pytest

from kb_build.pages.page import Page, Section, page_from_json, page_to_json
from kb_build.symbols.needs import Case, OperatorNeeds, Wanted
from kb_build.symbols.records import (
    Deprecation,
    EnumItem,
    NewValue,
    Parameter,
    Refusal,
    Symbol,
    symbol_from_json,
    to_json,
)
from kb_build.symbols.taken import Beside, Setting, Taken

if TYPE_CHECKING:
    from kb_build.blender.extract_reader import Extract

WHERE = Taken(
    "not", (Setting("m", ("A",), (("A", Setting("n", ("B",))),)),), ("lamp",), ("Tree",), Taken("never"),
    Beside(Setting("m", ("C",)), Setting("Other.o", ("D",))), True,
)  # fmt: skip
FULL = Symbol(
    path='bpy.types.A.inputs["B.c"]', kind="socket", owner="bpy.types.A", label="B", description="d", type="float",
    subtype="FACTOR", unit="LENGTH", target="T", array=(4, 4), default=[1, [2.5, "x"], None, True], hard_min=-1.0,
    hard_max=2, soft_min=0.0, soft_max=1.5, flags=("readonly",),
    enum_items=(EnumItem("ONE", "One", "1", WHERE), EnumItem("")),
    enum_computed=True, base="bpy.types.B", group="data", signature="f(a)",
    parameters=(Parameter("a", "enum", "d", ["X"], True, (EnumItem("X"),), "L", 0.0, 1.0, "MASS"),),
    returns=(Parameter(""),), deprecation=Deprecation("gone", "5.0", "6.0"), modes=("m=A|B",), collection="C",
    trees=("ShaderNodeTree",), reached="bpy.context", lacks="bpy.types.A.b", subscripts=("inputs[1]",),
    new_values=(NewValue([1, 2], ("a", "b")), NewValue(0, when="m='A'")),
    refusals=(Refusal("no", "type", ("A", "B"), ("a",), ("b", "c"), ("length",), "EDIT", "any"), Refusal("")),
    needs=OperatorNeeds(
        "any", Wanted(("A",)), Wanted(("B",), True), (Case(("C",)), Case(("D",), Wanted(("E",)))), True, ("F",),
        ("g()",), True,
    ),
)  # fmt: skip


def test_a_symbol_with_every_field_filled_comes_back_as_it_was() -> None:
    assert set(to_json(FULL)) == {field.name for field in fields(FULL)}
    assert symbol_from_json(json.loads(json.dumps(to_json(FULL)))) == FULL


@pytest.mark.parametrize(
    "field", [field.name for field in fields(Symbol) if field.name not in {"path", "kind", "default"}]
)
def test_each_field_alone_comes_back(field: str) -> None:
    symbol = replace(Symbol("a", "property"), **{field: getattr(FULL, field)})
    row = to_json(symbol)
    assert set(row) == {"path", "kind", field}
    assert symbol_from_json(json.loads(json.dumps(row))) == symbol


@pytest.mark.parametrize("default", [0, 0.0, False, "", [], [0], [[1, 2], [3, 4]], "text", True, -1.5])
def test_a_default_that_is_falsy_is_not_lost(default: object) -> None:
    symbol = Symbol("a", "property", default=default)  # type: ignore[arg-type]
    again = symbol_from_json(json.loads(json.dumps(to_json(symbol))))
    assert again.default == default
    assert type(again.default) is type(default)


def test_every_symbol_of_blender_comes_back_as_it_was(extract: Extract) -> None:
    for symbol in extract.symbols:
        assert symbol_from_json(json.loads(json.dumps(to_json(symbol)))) == symbol, symbol.path


def test_empty_fields_are_not_written() -> None:
    assert to_json(Symbol("bpy", "module")) == {"path": "bpy", "kind": "module"}


def test_an_unknown_field_is_refused() -> None:
    with pytest.raises(TypeError):
        symbol_from_json({"path": "a", "kind": "class", "colour": "red"})
    with pytest.raises(TypeError):
        page_from_json({**asdict(PAGE), "colour": "red"})


@pytest.mark.parametrize(
    ("path", "kind", "name"),
    [
        ("bpy.types.ClothSettings.quality", "property", "quality"),
        ("bpy", "module", "bpy"),
        ('bpy.types.N.inputs["Specular IOR Level"]', "socket", "Specular IOR Level"),
        ('bpy.types.N.inputs["A.B [c]"]', "socket", "A.B [c]"),
        ('bpy.types.N.outputs[""]', "socket", ""),
        ('bpy.types.N.outputs["say \\"x\\""]', "socket", 'say \\"x\\"'),
    ],
)
def test_the_name_is_the_last_part_of_the_path(path: str, kind: str, name: str) -> None:
    assert Symbol(path, kind).name == name  # type: ignore[arg-type]


PAGE = Page(
    "a/b", "manual", "5.1", "T", (Section("", "T", 1, "Lead."), Section("x", "X", 2, ""), Section("y", "Y", 3, "End.")),
    ("Up",), ("a/b/c",), ("d",), "https://x/a/b.html", ("careful",),
)  # fmt: skip


def test_a_page_comes_back_as_it_was() -> None:
    assert page_from_json(json.loads(json.dumps(page_to_json(PAGE)))) == PAGE


def test_the_text_of_a_page_holds_every_heading_and_section_in_order() -> None:
    assert PAGE.text == "# T\n\nLead.\n\n## X\n\n### Y\n\nEnd."


def test_the_content_hash_ignores_layout() -> None:
    spread = replace(
        PAGE, sections=(Section("other", "T", 1, " Lead.\n\n"), *PAGE.sections[1:]), url="", links=()
    )
    assert spread.content_hash == PAGE.content_hash
    random.seed(5)
    hashes = {PAGE.content_hash}
    for _ in range(50):
        position = random.randrange(len("Lead."))
        text = "Lead."[:position] + "x" + "Lead."[position:]
        hashes.add(replace(PAGE, sections=(Section("", "T", 1, text),)).content_hash)
    assert len(hashes) > 5
    assert replace(PAGE, sections=PAGE.sections[::-1]).content_hash != PAGE.content_hash
