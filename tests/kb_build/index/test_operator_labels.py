"""Operators that the manual calls by their labels or buttons: where it is surely them, and where it is not."""

from __future__ import annotations

import pytest

from kb_build.blender.buttons import Button
from kb_build.index.label_names import find_label_names
from kb_build.index.operator_labels import find_labelled_operators, passages_of
from kb_build.index.passages import Passage, address_of
from kb_build.pages.page import Page, Section
from kb_build.symbols.records import Link, Symbol

BAKE = "bpy.ops.ptcache.bake_all"


def operator(path: str, label: str) -> Symbol:
    return Symbol(path, "operator", path.rpartition(".")[0], label=label)


ALL = operator(BAKE, "Bake All Physics")
FREE = operator("bpy.ops.ptcache.free_bake_all", "Delete Bakes")
BUTTONS = {
    BAKE: [
        Button("Bake All Dynamics", "bake=True"),
        Button("Bake Scene Dynamics", ""),
        Button("Update", "bake=False"),
    ]
}


def page(slug: str, label: str, *, marks: tuple[tuple[str, int], ...] = (), title: str = "Baking") -> Page:
    sections = (
        Section("top", title, 1, "It takes time."),
        Section("more", "More", 2, f"**{label}**\n  Does it.", marks),
    )
    return Page(slug, "manual", "5.1", title, sections)


def named(at: Page, *others: Symbol, link: str = "physics/baking") -> list[str]:
    """The names beside the labels of a page; the module's operators are linked to ``link``."""
    symbols = [ALL, FREE, *others]
    links = [Link(each.path, f"{link}#bpy-ops-ptcache", "manual") for each in symbols]
    labelled = find_labelled_operators(symbols, [at], links, BUTTONS)
    return [row.names for row in find_label_names(symbols, [at], {}, labelled)]


@pytest.mark.parametrize(
    ("label", "expected"),
    [
        ("Bake All Physics", ["`bpy.ops.ptcache.bake_all()`"]),
        ("Bake All Dynamics", ["`bpy.ops.ptcache.bake_all(bake=True)`"]),
        ("Bake All Dynamics `Ctrl-B`, `B`", ["`bpy.ops.ptcache.bake_all(bake=True)`"]),
        ("Update", ["`bpy.ops.ptcache.bake_all(bake=False)`"]),
        (
            "Update, Delete Bakes",
            ["`bpy.ops.ptcache.bake_all(bake=False)`, `bpy.ops.ptcache.free_bake_all()`"],
        ),
        ("Update/Freeze", []),
        ("Bake All Dynamics and Go", []),
    ],
)
def test_on_its_page_an_operator_is_known_by_its_label_and_its_buttons(
    label: str, expected: list[str]
) -> None:
    assert named(page("physics/baking", label)) == expected


@pytest.mark.parametrize(
    ("slug", "link", "label", "is_named"),
    [
        ("physics/cloth/cache", "physics/index", "Update", False),
        ("physics/cloth/cache", "physics/index", "Delete Bakes", True),
        ("physics/cloth/cache", "physics/baking", "Delete Bakes", True),
        ("render/cache", "physics/baking", "Delete Bakes", False),
        ("render/cache", "physics/baking", "Bake All Dynamics", False),
        ("render/cache", "physics/baking", "Bake Scene Dynamics", True),
        ("physics/cloth/toolbar", "physics/baking", "Bake All Dynamics", False),
    ],
)
def test_the_farther_from_its_page_the_more_a_label_must_say(
    slug: str, link: str, label: str, is_named: bool
) -> None:
    assert bool(named(page(slug, label), link=link)) is is_named


@pytest.mark.parametrize(
    "other",
    [
        operator("bpy.ops.ptcache.other", "Delete Bakes"),
        Symbol("bpy.types.FreeAll", "class", "bpy.types", label="Delete Bakes"),
    ],
)
def test_what_another_thing_is_called_too_is_not_sure(other: Symbol) -> None:
    assert named(page("physics/baking", "Delete Bakes"), other) == []


def test_away_from_its_page_a_propertys_label_is_not_sure() -> None:
    other = Symbol("bpy.types.Scene.bake", "property", "bpy.types.Scene", label="Bake Scene Dynamics")
    assert named(page("render/cache", "Bake Scene Dynamics"), other) == []


def test_an_operator_with_an_address_of_its_own_is_looked_for_there() -> None:
    sections = (
        Section("top", "Baking", 1, "**Update**\n  Now and then."),
        Section("own", "All", 2, "**Update**\n  Does it.", ((address_of(BAKE), -1),)),
    )
    at = Page("physics/baking", "manual", "5.1", "Baking", sections)
    links = [Link(BAKE, f"{at.slug}#{address_of(BAKE)}", "manual")]
    (found,) = find_labelled_operators([ALL], [at], links, BUTTONS)
    assert found.place == Passage(at.slug, 1, 0)


def test_a_title_is_an_operators_only_if_it_is_called_so_itself() -> None:
    assert named(page("physics/baking", "Else", title="Bake All Physics")) == ["`bpy.ops.ptcache.bake_all()`"]
    assert named(page("physics/baking", "Else", title="Bake All Dynamics")) == []


def test_only_a_place_about_the_operator_as_such_is_its_passage() -> None:
    at = page("physics/baking", "Delete Bakes")
    links = [Link(each.path, at.slug, "manual") for each in (ALL, FREE)]
    assert passages_of(find_labelled_operators([ALL, FREE], [at], links, BUTTONS), [at]) == {
        FREE.path: Passage(at.slug, 1, 0)
    }
    one_use = page("physics/baking", "Update")
    assert passages_of(find_labelled_operators([ALL], [one_use], links, BUTTONS), [one_use]) == {}


def test_operators_that_need_computed_arguments_have_no_names() -> None:
    at = page("interface/window", "Toggle Dope Sheet")
    symbol = operator("bpy.ops.wm.context_set_enum", "Toggle Dope Sheet")
    assert find_labelled_operators([symbol], [at], [Link(symbol.path, at.slug, "manual")], {}) == []
