"""What the script inside Blender wrote is read whole, or refused."""

from __future__ import annotations

import ast
import fnmatch
import json
import random
import re
from typing import TYPE_CHECKING

import pytest

from kb_build.blender.call_texts import call_text, python_value
from kb_build.blender.extract_reader import read_extract
from kb_build.blender.manual_links import manual_links
from kb_build.errors import ExtractError
from kb_build.symbols.records import EnumItem, NewValue, Parameter, Symbol
from kb_build.symbols.taken import NEVER

if TYPE_CHECKING:
    from pathlib import Path

    from kb_build.blender.extract_reader import Extract

HEADER = {"record": "blender", "version": "5.1.2", "build": "abc", "addons": ["cycles"]}
STRUCT = {"record": "symbol", "path": "bpy.types.bpy_struct", "kind": "class", "owner": "bpy.types"}


def write(path: Path, *rows: dict[str, object], lines: int | None = None) -> Path:
    count = len(rows) if lines is None else lines
    texts = [json.dumps(row) for row in (*rows, {"record": "end", "lines": count})]
    path.write_text("\n".join(texts) + "\n", encoding="utf-8")
    return path


def symbol(path: str, kind: str = "class", **more: object) -> dict[str, object]:
    return {"record": "symbol", "path": path, "kind": kind, "owner": path.rpartition(".")[0], **more}


def read(tmp_path: Path, *rows: dict[str, object]) -> Extract:
    return read_extract(write(tmp_path / "x.jsonl", HEADER, *rows))


def test_the_header_says_which_blender_it_was(tmp_path: Path) -> None:
    extract = read(tmp_path, STRUCT)
    assert (extract.version, extract.build, extract.addons) == ("5.1.2", "abc", ("cycles",))
    assert [row.path for row in extract.symbols] == ["bpy.types.bpy_struct"]


@pytest.mark.parametrize("lines", [0, 1, 3, 99])
def test_refuses_an_extract_with_a_wrong_line_count(tmp_path: Path, lines: int) -> None:
    with pytest.raises(ExtractError, match=r"x\.jsonl.*run the build again"):
        read_extract(write(tmp_path / "x.jsonl", HEADER, STRUCT, lines=lines))


def test_refuses_a_truncated_extract(tmp_path: Path) -> None:
    whole = write(tmp_path / "x.jsonl", HEADER, STRUCT, symbol("bpy.types.A")).read_bytes()
    random.seed(4)
    for size in [0, 1, *random.sample(range(2, len(whole) - 1), 60)]:
        (tmp_path / "cut.jsonl").write_bytes(whole[:size])
        with pytest.raises(ExtractError, match="stopped half-way"):
            read_extract(tmp_path / "cut.jsonl")


def test_a_failed_step_is_reported_and_the_rest_kept(tmp_path: Path) -> None:
    extract = read(tmp_path, STRUCT, {"record": "fault", "step": "nodes", "traceback": "Boom"})
    assert extract.faults == ("nodes: Boom",)
    assert len(extract.symbols) == 1


def test_the_first_of_two_records_with_one_path_counts(tmp_path: Path) -> None:
    extract = read(tmp_path, STRUCT, symbol("bpy.types.A", label="one"), symbol("bpy.types.A", label="two"))
    assert [row.label for row in extract.symbols if row.path == "bpy.types.A"] == ["one"]


def test_items_of_an_instance_join_those_that_rna_lists(tmp_path: Path) -> None:
    contexts = [{"items": ["NONE", "AgX"], "made": [["scene", ""]], "states": {}}]
    asked = {"contexts": contexts, "texts": {"AgX": ["AgX look", "Soft"]}}
    extract = read(
        tmp_path,
        symbol("bpy.types.A.view", "property", enum_items=[{"identifier": "NONE", "name": "None"}]),
        {"record": "enum_items", "path": "bpy.types.A.view", **asked},
        {"record": "enum_items", "path": "bpy.types.Gone.view", **asked},
    )
    assert extract.symbols[0].enum_items == (EnumItem("NONE", "None"), EnumItem("AgX", "AgX look", "Soft"))


def test_values_of_new_things_stand_beside_rnas_default(tmp_path: Path) -> None:
    values = [{"value": 10}, {"value": 1, "made": ["sun"]}]
    modes = [{"value": 5, "when": "type='B'", "made": ["lamp"]}]
    extract = read(
        tmp_path,
        symbol("bpy.types.A.energy", "property", default=0),
        symbol("bpy.types.A.same", "property", default=0),
        symbol("bpy.types.A.unread", "property", default=0),
        {"record": "new_values", "path": "bpy.types.A.energy", "values": values, "modes": modes},
        {"record": "new_values", "path": "bpy.types.A.same"},
        {"record": "new_values", "path": "bpy.types.Gone.energy", "values": values},
    )
    energy, same, unread = extract.symbols
    assert energy.default == 0
    assert energy.new_values == (NewValue(10), NewValue(1, ("sun",)), NewValue(5, ("lamp",), "type='B'"))
    assert (same.new_values, same.flags, unread.flags) == ((), ("compared",), ())


def test_what_is_chosen_or_computed_has_no_default(tmp_path: Path) -> None:
    extract = read(
        tmp_path,
        symbol("bpy.types.A.matrix", "property", default=[0, 0]),
        {"record": "new_values", "path": "bpy.types.A.matrix", "chosen": True},
        {"record": "new_values", "path": "bpy.types.Gone.matrix", "chosen": True},
    )
    assert (extract.symbols[0].default, extract.symbols[0].flags) == (None, ())


def test_names_and_places_that_blender_gives_are_kept_by_class(tmp_path: Path) -> None:
    extract = read(
        tmp_path,
        STRUCT,
        {"record": "own_name", "path": "bpy.types.A", "name": "An A"},
        {"record": "stands_in", "path": "bpy.types.A", "name": "World"},
    )
    assert (extract.names, extract.places) == ({"A": "An A"}, {"A": "World"})


def test_pointers_of_new_things_say_whether_they_are_none(tmp_path: Path) -> None:
    empty = {"is_empty": True, "filled": ["lamp"], "filler": "a.b()"}
    extract = read(
        tmp_path,
        *(symbol(f"bpy.types.A.{name}", "property", type="pointer") for name in ("field", "data", "render")),
        {"record": "new_pointer", "path": "bpy.types.A.field", **empty},
        {"record": "new_pointer", "path": "bpy.types.A.data", "is_empty": True, "empty": ["sun"]},
        {"record": "new_pointer", "path": "bpy.types.A.render"},
        {"record": "new_pointer", "path": "bpy.types.Gone.field", **empty},
    )
    assert [(pointer.new_values, pointer.flags) for pointer in extract.symbols] == [
        ((NewValue(None),), ("compared", "filled-on:lamp", "filled-by:a.b()")),
        ((NewValue(None, ("sun",)),), ("compared",)),
        ((), ("compared",)),
    ]


def test_what_the_code_of_a_function_makes_is_what_it_returns_where_nothing_else_says_it(
    tmp_path: Path,
) -> None:
    said = "Copies.\n\n:rtype: int"
    extract = read(
        tmp_path,
        STRUCT,
        symbol("bpy.types.bpy_struct.copy", "function", signature="(self)", returned="dict[Any, Any]"),
        symbol(
            "bpy.types.bpy_struct.count", "function", signature="(self)", docstring=said, returned="list[Any]"
        ),
    )
    returned = {one.name: [result.type for result in one.returns] for one in extract.symbols if one.returns}
    assert (returned["copy"], returned["count"]) == (["dict[Any, Any]"], ["int"])


def test_former_names_that_still_work_are_kept(tmp_path: Path) -> None:
    row = {"record": "still_works", "path": "bpy.types.Old", "taken_as": "bpy.types.New"}
    assert read(tmp_path, STRUCT, row).still_works == (("bpy.types.Old", "bpy.types.New"),)


def test_a_template_becomes_a_page_with_its_code(tmp_path: Path) -> None:
    extract = read(tmp_path, {"record": "template", "name": "ui_panel_simple", "text": "import bpy\n"})
    page = extract.templates[0]
    assert (page.slug, page.title, page.version) == ("templates_py/ui_panel_simple", "Ui panel simple", "5.1")
    assert page.sections[0].text == "```python\nimport bpy\n```"


def test_a_pointer_to_a_node_tree_says_which_kind(tmp_path: Path) -> None:
    extract = read(
        tmp_path,
        symbol("bpy.types.ShaderNodeTree"),
        symbol("bpy.types.Material.node_tree", "property", type="pointer", target="NodeTree"),
        symbol("bpy.types.NodesModifier.node_group", "property", type="pointer", target="NodeTree"),
    )
    assert {row.name: row.target for row in extract.symbols if row.kind == "property"} == {
        "node_tree": "ShaderNodeTree",
        "node_group": "NodeTree",  # this Blender has no such tree
    }


def test_every_data_class_has_the_look_up_that_the_reference_lists_on_it(tmp_path: Path) -> None:
    extract = read(
        tmp_path,
        STRUCT,
        symbol("bpy.types.bpy_struct.bl_rna_get_subclass", "function", docstring="Look up."),
        symbol("bpy.types.A", group="data"),
        symbol("bpy.types.A_PT_b", group="ui"),
    )
    owners = [row.owner for row in extract.symbols if row.name == "bl_rna_get_subclass"]
    assert owners == ["bpy.types.bpy_struct", "bpy.types.A"]


def test_substitutions_of_a_module_apply_to_its_members(tmp_path: Path) -> None:
    extract = read(
        tmp_path,
        symbol("m", "module", docstring=".. |NOTE| replace:: Take :class:`Care`.\n"),
        symbol("m.f", "function", docstring="Does.\n\n|NOTE| Then x|y."),
    )
    assert extract.symbols[1].description == "Does.\n\nTake `Care`. Then x|y."


def test_methods_described_only_in_a_docstring_are_symbols(tmp_path: Path) -> None:
    docstring = (
        "Smooths.\n\n.. method:: __init__(a=1)\n\n   Makes.\n\n.. staticmethod:: shade(s)\n\n   Shades."
    )
    extract = read(
        tmp_path,
        symbol("m.A", docstring=docstring),
        symbol("m.A.shade", "function", docstring="Its own words."),
    )
    found = {row.path: row for row in extract.symbols}
    assert found["m.A"].signature == "A(a=1)"
    assert (found["m.A.__init__"].signature, found["m.A.__init__"].owner) == ("__init__(a=1)", "m.A")
    assert found["m.A.shade"].description == "Its own words."


def test_a_method_called_like_its_class_is_the_constructor(tmp_path: Path) -> None:
    docstring = "A stroke.\n\n.. method:: Stroke()\n            Stroke(brother)\n\n   Makes one.\n"
    extract = read(tmp_path, symbol("m.Stroke", docstring=docstring))
    found = {row.path: row for row in extract.symbols}
    assert "m.Stroke.Stroke" not in found
    assert found["m.Stroke"].signature == "Stroke(brother)"
    assert found["m.Stroke.__init__"].signature == "__init__(brother)"


def test_a_call_without_its_arguments_gets_those_that_are_described(tmp_path: Path) -> None:
    text = (
        ".. method:: add()\n\n   Adds.\n\n   :arg sound: What.\n   :type sound: Sound\n   :arg end: When.\n"
        "   :type ends: float\n"
    )
    extract = read(
        tmp_path,
        symbol("m.A.add", "function", docstring=text, flags=["no-keywords", "requires:1"]),
        symbol("m.A.unknown", "function", docstring=text),
    )
    added, unknown = extract.symbols
    assert added.signature == "add(sound, end=..., /)"
    assert [(p.name, p.type, p.required) for p in added.parameters] == [
        ("sound", "Sound", True),
        ("end", "float", False),
    ]
    assert unknown.signature == "unknown()"


@pytest.mark.parametrize(
    ("path", "signature"),
    [
        ("aud.Sequence.remove", "remove(entry, /)"),
        ("aud.Sequence.add", "add(sound, begin, end=..., skip=...)"),
        ("aud.Sound.binaural", "binaural(hrtfs, source, threadPool, /)"),
        ("aud.Sound.list", "list(random, /)"),
        ("aud.Sound.resample", "resample(rate, quality=..., /)"),
        (
            "aud.Sound.write",
            "write(filename, rate=..., channels=..., format=..., container=..., codec=..., bitrate=..., "
            "buffersize=...)",
        ),
        (
            "aud.Sound.timeStretchPitchScale",
            "timeStretchPitchScale(time_stretch=..., pitch_scale=..., quality=..., preserve_formant=...)",
        ),
        ("aud.SequenceEntry.setAnimationData", "setAnimationData(type, frame, data, animated, /)"),
    ],
)
def test_calls_of_sounds_have_what_they_require(extract: Extract, path: str, signature: str) -> None:
    found = next(row for row in extract.symbols if row.path == path)
    assert found.signature == signature


# The manual's table


def test_the_first_matching_pattern_counts_in_any_case(tmp_path: Path) -> None:
    extract = read(
        tmp_path,
        symbol("bpy.types.ClothSettings.quality", "property"),
        symbol("bpy.types.Other", "class"),
        symbol("mathutils.Vector", "class"),
        {"record": "manual", "pattern": "bpy.types.ClothSettings.q*", "page": "a/b.html#bpy-x"},
        {"record": "manual", "pattern": "bpy.types.clothsettings*", "page": "never.html"},
        {"record": "manual", "pattern": "*vector*", "page": "never.html"},
    )
    assert [link for link in extract.links if link.kind == "manual"] == [
        next(link for link in extract.links if link.target == "a/b#bpy-x")
    ]


def test_the_table_is_applied_as_blender_itself_does(extract: Extract, base: Path) -> None:
    """Blender goes through its patterns one by one; the indexed way finds the same for a sample."""
    rows = [
        json.loads(line)
        for line in next((base.parent.parent / "extracts").glob("*.jsonl")).read_text("utf-8").splitlines()
        if line.startswith('{"record":"manual"')
    ]
    table = [(row["pattern"], row["page"]) for row in rows]
    random.seed(9)
    sample = random.sample(
        [row for row in extract.symbols if row.path.startswith("bpy.") and row.kind != "socket"], 150
    )
    found = {link.source: link.target for link in manual_links(sample, table)}
    # fnmatch keeps fewer patterns compiled than the table has.
    compiled = [(re.compile(fnmatch.translate(pattern.lower())), page) for pattern, page in table]
    for row in sample:
        path = row.path.lower()
        page = next((page for pattern, page in compiled if pattern.match(path)), "")
        assert found.get(row.path, "") == page.replace(".html", ""), row.path


def test_what_only_begins_with_the_letters_of_a_data_blocks_name_has_not_its_page(extract: Extract) -> None:
    linked = {link.source.removeprefix("bpy.types.") for link in extract.links if link.kind == "manual"}
    assert {
        "Key",
        "KeyMapItem",
        "Curve",
        "CurveProfile",
        "CurveSplines",
        "MeshVertex",
        "ImageTexture",
    } <= linked
    assert linked.isdisjoint({"KeyingSet", "KeyMap", "CurveMapping", "CurveMapping.clip_max_x", "Lightgroup"})


# Calls


@pytest.mark.parametrize(
    "value", [None, True, 0, -1.5, "it's", 'say "x"', [], [1], [1, 2.5, "x"], [[1, 2], [3, 4]], "é\n"]
)
def test_a_default_is_python_that_means_the_same(value: object) -> None:
    def as_tuple(item: object) -> object:
        return tuple(map(as_tuple, item)) if isinstance(item, list) else item

    assert ast.literal_eval(python_value(value)) == as_tuple(value)  # type: ignore[arg-type]


def test_a_call_shows_required_arguments_bare_and_the_others_with_defaults() -> None:
    parameters = [
        Parameter("a", "int", required=True),
        Parameter("b", "enum", default="X"),
        Parameter("c", "enum", default=["P"]),
        Parameter("d", "enum", default=[]),
        Parameter("e", "float[2]", default=[0, 1]),
        Parameter("g", "enum", enum_items=(EnumItem("X", where=NEVER),)),
        Parameter("h", "string"),
        Parameter("i", "list of Mesh"),
        Parameter("j", "int[1]"),
        Parameter("k", "Mesh"),
    ]
    told = "f(a, b='X', c={'P'}, d=set(), e=(0, 1), g=..., h='', i=[], j=..., k=None)"
    assert call_text("f", parameters) == told
    assert call_text("f", []) == "f()"


def test_the_call_of_every_operator_is_python(extract: Extract) -> None:
    checked = 0
    for row in extract.symbols:
        if row.kind == "operator":
            call = ast.parse(row.signature, mode="eval").body
            assert isinstance(call, ast.Call)
            assert [word.arg for word in call.keywords] == [p.name for p in row.parameters if not p.required]
            checked += 1
    assert checked > 2_400


def test_symbols_without_a_docstring_keep_what_rna_says(tmp_path: Path) -> None:
    row = symbol(
        "bpy.types.A.f", "function", description="Does.", parameters=[{"name": "a", "required": True}]
    )
    assert read(tmp_path, row).symbols[0] == Symbol(
        "bpy.types.A.f", "function", "bpy.types.A", description="Does.", signature="f(a)",
        parameters=(Parameter("a", required=True),),
    )  # fmt: skip


def test_what_the_dot_gives_to_a_method_is_none_of_its_arguments(extract: Extract) -> None:
    kinds = {row.path: row.kind for row in extract.symbols}
    taking = {
        row.path: kinds.get(row.owner)
        for row in extract.symbols
        if any(parameter.name in {"self", "cls"} for parameter in row.parameters)
    }
    assert set(taking.values()) == {"module"}
    assert "nodeitems_utils.draw_node_categories_menu" in taking  # a panel gives itself to it


def test_of_a_call_that_nobody_describes_nothing_is_claimed(tmp_path: Path) -> None:
    rows = [
        symbol("m.unknown", "function", call="unknown"),
        symbol("bpy.types.A.none", "function"),  # RNA lists no arguments
    ]
    unknown, none = read(tmp_path, *rows).symbols
    assert (unknown.signature, unknown.has_empty_signature) == ("", False)
    assert (none.signature, none.has_empty_signature) == ("none()", True)


def test_python_itself_tells_what_a_method_written_in_it_takes(tmp_path: Path) -> None:
    text = ".. method:: load(name, filepath)\n\n:arg name: It.\n:arg filepath: The file."
    row = symbol("m.A.load", "function", docstring=text, signature="(self, name, path)")
    sure, unsure = (read(tmp_path, {**row, **more}).symbols[0] for more in ({"call": "python"}, {}))
    assert sure.signature == "load(name, path)"
    assert [(one.name, one.description) for one in sure.parameters] == [
        ("name", "It."),
        ("path", "The file."),
    ]
    assert unsure.signature == "load(name, filepath)"


def test_names_of_any_kind_stay_last_behind_those_that_may_be_left_out(tmp_path: Path) -> None:
    text = ".. method:: f(window, area, **keywords)"
    row = symbol("m.f", "function", docstring=text, flags=["all-optional", "by-place:0"])
    assert read(tmp_path, row).symbols[0].signature == "f(*, window=None, area=None, **keywords)"
