"""Which Python names stand beside a label of the manual: what it surely means, at most two or as many as it lists."""

from __future__ import annotations

import pytest

from kb_build.index.label_names import find_label_names
from kb_build.index.passages import Passage
from kb_build.pages.page import Page, Section
from kb_build.symbols.records import Symbol

SLUG = "render/lights"
LIGHT = Symbol("bpy.types.Light", "class", "bpy.types", label="Light")
SUN = Symbol("bpy.types.SunLight", "class", "bpy.types", label="Sun Light", base=LIGHT.path)
SPOT = Symbol("bpy.types.SpotLight", "class", "bpy.types", label="Spot Light", base=LIGHT.path)


def member(cls: Symbol, name: str, label: str) -> Symbol:
    return Symbol(f"{cls.path}.{name}", "property", cls.path, label=label)


def operator(path: str, label: str) -> Symbol:
    return Symbol(f"bpy.ops.{path}", "operator", "bpy.ops." + path.partition(".")[0], label=label)


def socket(name: str, *subscripts: str) -> Symbol:
    return Symbol(f'{SUN.path}.{name}["Color"]', "socket", SUN.path, label="Color", subscripts=subscripts)


def names(label: str, *symbols: Symbol, heading: str = "Lights") -> dict[int, str]:
    """The names on a page whose one section begins with a label: by line."""
    text = f"{label}\n  What it does.\n\n**Other**\n  Else."
    page = Page(SLUG, "manual", "5.1", "Lights", (Section("lights", heading, 1, text),))
    of_classes = {cls.path: Passage(SLUG, 0, -1) for cls in symbols if cls.kind == "class"}
    passages = {symbol.path: Passage(SLUG, 0, 0) for symbol in symbols} | of_classes
    known = {symbol.path: symbol for symbol in (LIGHT, SUN, SPOT, *symbols)}
    return {row.line: row.names for row in find_label_names([*known.values()], [page], passages)}


def name(label: str, *symbols: Symbol) -> str:
    return names(f"**{label}**", *symbols).get(0, "")


def test_a_property_has_its_class_and_an_operator_is_called() -> None:
    assert name("Angle", member(SUN, "angle", "Angle")) == "`SunLight.angle`"
    assert name("Bake All", operator("fluid.bake_all", "Bake All")) == "`bpy.ops.fluid.bake_all()`"


def test_a_label_of_two_things_has_both_names_in_its_order() -> None:
    free, bake = operator("fluid.free_all", "Free All"), operator("fluid.bake_all", "Bake All")
    assert name("Bake All, Free All", free, bake) == "`bpy.ops.fluid.bake_all()`, `bpy.ops.fluid.free_all()`"


def test_of_a_family_the_base_class_is_named() -> None:
    symbols = [member(cls, "energy", "Power") for cls in (SPOT, SUN, LIGHT)]
    assert name("Power", *symbols) == "`Light.energy`"


@pytest.mark.parametrize(
    ("owners", "expected"),
    [
        ((SUN, SPOT), "`SunLight.angle`, `SpotLight.angle`"),
        ((SUN, SPOT, Symbol("bpy.types.Camera", "class", "bpy.types")), ""),
    ],
)
def test_of_more_than_two_names_there_is_none(owners: tuple[Symbol, ...], expected: str) -> None:
    assert name("Angle", *(member(cls, "angle", "Angle") for cls in owners)) == expected


def test_a_label_that_lists_more_has_the_names_of_all() -> None:
    limits = [member(SUN, f"limit_{axis}", f"Limit {axis.upper()}") for axis in "xyz"]
    expected = "`SunLight.limit_x`, `SunLight.limit_y`, `SunLight.limit_z`"
    assert name("Limit X, Y, Z", *limits) == expected


def test_what_is_called_just_so_goes_before_what_stands_there_too() -> None:
    symbols = member(LIGHT, "temperature", "Temperature"), member(LIGHT, "use_temperature", "Use Temperature")
    assert name("Temperature", *symbols) == "`Light.temperature`"


@pytest.mark.parametrize(
    ("label", "labels", "is_named"),
    [
        ("Upres Factor", ("Scale",), True),  # the manual's own mark
        ("Noise", ("Noise Threshold", "Viewport Noise"), True),
        ("Strength", ("Strength Randomness", "Use Pressure"), False),
        ("Before/After", ("Ghosts", "Frames"), True),
    ],
)
def test_other_names_must_be_sure(label: str, labels: tuple[str, ...], is_named: bool) -> None:
    symbols = [member(SUN, f"m{number}", each) for number, each in enumerate(labels)]
    assert bool(name(label, *symbols)) is is_named


def test_a_socket_is_named_by_the_subscript_that_works() -> None:
    by_number = socket("inputs", "inputs[2]", 'inputs["Color"]')
    assert name("Color", by_number) == "`SunLight.inputs[2]`"
    assert name("Color", socket("inputs")) == ""


def test_where_the_page_is_of_one_class_its_sockets_do_not_repeat_it() -> None:
    assert names("**Color**", SUN, socket("inputs", 'inputs["Color"]'), heading="Sun Light") == {
        -1: "`SunLight`",
        0: '`inputs["Color"]`',
    }


def test_a_line_that_is_no_label_has_no_name() -> None:
    assert names("The **Angle** of the sun.", member(SUN, "angle", "Angle")) == {}


@pytest.mark.parametrize(
    ("title", "heading", "expected"),
    [
        ("Sun Settings", "Else", {(0, -1): "`SunLight`"}),  # a title may say it in other words
        ("Lights", "Sun Settings", {(1, -1): "`SunLight`"}),
        ("Lights", "Sun Shadows", {}),  # which the class is only one of
    ],
)
def test_a_class_has_its_name_beside_its_own_heading(
    title: str, heading: str, expected: dict[tuple[int, int], str]
) -> None:
    sections = Section("top", title, 1, "It shines."), Section("more", heading, 2, "It shines.")
    passage = Passage(SLUG, 0 if "Sun" in title else 1, -1)
    rows = find_label_names([SUN], [Page(SLUG, "manual", "5.1", title, sections)], {SUN.path: passage})
    assert {(row.section, row.line): row.names for row in rows} == expected
