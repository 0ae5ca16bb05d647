"""What is said about the differences of two APIs."""

from __future__ import annotations

import json
from dataclasses import replace

from kb_build.blender.extract_reader import Extract
from kb_build.symbols.records import EnumItem, Parameter, Symbol
from kb_build.versions.diff import SymbolChange, diff, format_diff


def extract(version: str, *symbols: Symbol) -> Extract:
    return Extract(version, "", (), symbols, (), ())


CLASS = Symbol("bpy.types.A", "class", owner="bpy.types", group="data", base="bpy.types.ID")
SIZE = Symbol(
    "bpy.types.A.size", "property", owner="bpy.types.A", type="float", default=1.0, hard_min=0, hard_max=10
)
KIND = Symbol(
    "bpy.types.A.kind", "property", owner="bpy.types.A", type="enum",
    enum_items=(EnumItem("ONE"), EnumItem("TWO")),
)  # fmt: skip
CALL = Symbol(
    "bpy.ops.a.run", "operator", owner="bpy.ops.a",
    parameters=(Parameter("old"), Parameter("level", "int", default=1), Parameter("mode", "enum")),
)  # fmt: skip
PANEL = Symbol("bpy.types.A_PT_b", "class", owner="bpy.types", group="ui")


def test_what_came_and_what_went_is_told_with_its_kind() -> None:
    found = diff(extract("4.5.0", CLASS, SIZE), extract("5.1.0", CLASS, KIND))
    assert [(entry.path, entry.kind) for entry in found.added] == [("bpy.types.A.kind", "property")]
    assert [entry.path for entry in found.removed] == ["bpy.types.A.size"]
    assert found.changed == ()


def test_type_default_range_and_base_are_compared() -> None:
    new = replace(SIZE, type="int", default=2, hard_max=None)
    found = diff(extract("4.5.0", CLASS, SIZE), extract("5.1.0", replace(CLASS, base="bpy.types.B"), new))
    assert set(found.changed) == {
        SymbolChange("bpy.types.A", "base", "bpy.types.ID", "bpy.types.B"),
        SymbolChange("bpy.types.A.size", "type", "float", "int"),
        SymbolChange("bpy.types.A.size", "default", "1.0", "2"),
        SymbolChange("bpy.types.A.size", "range", "0 … 10", "0 … inf"),
    }


def test_enum_items_that_came_and_went_are_listed() -> None:
    new = replace(KIND, enum_items=(EnumItem("TWO"), EnumItem("THREE")))
    found = diff(extract("4.5.0", KIND), extract("5.1.0", new))
    assert found.changed == (SymbolChange("bpy.types.A.kind", "enum items", "ONE", "THREE"),)


def test_an_operators_parameters_are_compared_one_by_one() -> None:
    new = replace(
        CALL, parameters=(Parameter("level", "int", default=3), Parameter("mode", "string"), Parameter("new"))
    )
    found = diff(extract("4.5.0", CALL), extract("5.1.0", new))
    assert found.changed == (
        SymbolChange("bpy.ops.a.run", "parameters", "old", "new"),
        SymbolChange("bpy.ops.a.run", "level: default", "1", "3"),
        SymbolChange("bpy.ops.a.run", "mode: type", "enum", "string"),
    )


def test_panels_are_left_out_unless_asked_for() -> None:
    old, new = extract("4.5.0"), extract("5.1.0", PANEL)
    assert diff(old, new).added == ()
    assert [entry.path for entry in diff(old, new, interface=True).added] == ["bpy.types.A_PT_b"]


def test_a_prefix_ends_where_a_name_ends() -> None:
    others = [
        replace(SIZE, path=f"bpy.types.{name}.size", owner=f"bpy.types.{name}") for name in ("AB", "A2", "A_")
    ]
    found = diff(extract("4.5.0"), extract("5.1.0", CLASS, SIZE, *others)).under("bpy.types.A")
    assert [entry.path for entry in found.added] == ["bpy.types.A", "bpy.types.A.size"]


def test_the_text_gives_counts_first_and_names_a_new_class_once() -> None:
    text = format_diff(diff(extract("4.5.0", CALL), extract("5.1.0", CLASS, SIZE, KIND)))
    assert text.splitlines()[:5] == [
        "# Blender 4.5.0 → 5.1.0",
        "",
        "- added: 3 (property 2, class 1)",
        "- removed: 1 (operator 1)",
        "- changed: 0",
    ]
    assert "`A` class" in text
    assert "`size`" not in text


def test_a_long_part_is_cut_and_says_by_how_much() -> None:
    many = [replace(SIZE, path=f"bpy.types.A.p{n:02}") for n in range(20)]
    text = format_diff(diff(extract("4.5.0", CLASS), extract("5.1.0", CLASS, *many)), limit=5)
    assert "- … and 15 more" in text
    assert text.count("property") == 6


def test_members_that_follow_from_their_class_take_no_place_of_the_limit() -> None:
    many = [replace(SIZE, path=f"bpy.types.A.p{n:02}", owner="bpy.types.A") for n in range(20)]
    more = [replace(CLASS, path=f"bpy.types.B{n}") for n in range(3)]
    found = diff(extract("4.5.0"), extract("5.1.0", CLASS, *many, *more))
    text = format_diff(found, limit=3)
    assert [name in text for name in ("`A`", "`B0`", "`B1`", "`B2`")] == [True, True, True, False]
    assert "- … and 1 more" in text


def test_the_json_form_survives_json() -> None:
    found = diff(extract("4.5.0", SIZE), extract("5.1.0", replace(SIZE, default=2.0), CLASS))
    data = json.loads(json.dumps(found.to_json()))
    assert data["changed"] == [{"path": SIZE.path, "what": "default", "old": "1.0", "new": "2.0"}]
    assert data["added"][0]["kind"] == "class"
