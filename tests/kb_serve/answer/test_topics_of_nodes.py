"""Nodes and zones as topics: whatever is to be done with their items, by their place, by some of their words."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING

import pytest

from kb_build.pages.page import Page, Section
from kb_build.store import Contents, write_base
from kb_build.symbols.records import Link
from kb_serve.answer.topic.overview import Topics
from kb_serve.reader import BaseReader

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

TYPES = "bpy.types."
GEOMETRY, COMMON = "modeling/geometry_nodes/", "interface/controls/nodes/types/"
BAKE, SWITCH, EACH = f"{GEOMETRY}bake", f"{GEOMETRY}menu_switch", f"{GEOMETRY}for_each_geometry_zone"
CLOSURE, BUNDLE, LAYOUT = f"{COMMON}closure", f"{COMMON}combine_bundle", f"{COMMON}layout"
FILE, BLUR = "compositing/types/file_output", "compositing/types/bake"
# Page → its title, and the classes that it explains.
PAGES = {
    BAKE: ("Bake Node", "GeometryNodeBake"),
    BLUR: ("Bake Node", "CompositorNodeBlur"),
    SWITCH: ("Menu Switch Node", "GeometryNodeMenuSwitch"),
    f"{GEOMETRY}switch": ("Switch Node", "GeometryNodeSwitch"),
    f"{GEOMETRY}index_switch": ("Index Switch Node", "GeometryNodeIndexSwitch"),
    EACH: ("For Each Geometry Element Zone", "GeometryNodeForeachGeometryElementInput"),
    f"{GEOMETRY}repeat_zone": ("Repeat Zone", "GeometryNodeRepeatInput"),
    CLOSURE: ("Closure", "NodeClosureInput"),
    f"{GEOMETRY}closure": ("Closure", ""),
    f"{GEOMETRY}closure/index": ("Node Closures", ""),
    f"{GEOMETRY}closure/evaluate": ("Evaluate Closure Node", "NodeEvaluateClosure"),
    BUNDLE: ("Combine Bundle Node", "NodeCombineBundle"),
    LAYOUT: ("Layout Nodes", "UILayout"),
    FILE: ("File Output Node", "CompositorNodeOutputFile"),
}


@pytest.fixture(scope="module")
def topics(reader: BaseReader, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Topics]:
    """Of a base with a few nodes and pages about them."""
    names = {name for _, name in PAGES.values() if name}
    paths = {entry.path for name in names for entry in reader.lineage(f"{TYPES}{name}")}
    symbols = [symbol for path in sorted(paths) if (symbol := reader.symbol(path))]
    pages = [
        Page(
            slug,
            "manual",
            "5.1",
            title,
            (Section("a", title, 1, "It does something."),),
            children=(f"{GEOMETRY}closure", f"{GEOMETRY}closure/evaluate") if slug.endswith("/index") else (),
        )
        for slug, (title, _) in PAGES.items()
    ]
    links = [Link(f"{TYPES}{name}", slug, "manual") for slug, (_, name) in PAGES.items() if name]
    path: Path = tmp_path_factory.mktemp("nodes") / "base.sqlite"
    write_base(path, Contents(symbols, pages, links, {"minor": "5.1"}))
    with closing(BaseReader(path)) as own:
        yield Topics(own)


@pytest.mark.parametrize(
    ("text", "slug"),
    [
        ("create a closure zone in geometry nodes by script", CLOSURE),
        ("closure zone", CLOSURE),
        ("combine bundle node items", BUNDLE),
        ("menu switch node add items", SWITCH),
        ("how to add items to the menu switch node", SWITCH),
        ("for each element zone", EACH),
        ("for each geometry element zone", EACH),
        ("file output node compositor slots", FILE),
        ("geometry nodes bake node", BAKE),
        ("bake node geometry nodes", BAKE),
        ("compositor bake node", BLUR),
        ("bake node in the compositor", BLUR),
        # What several are called, what none is, and a page that only an aside part of the manual has.
        ("switch element node", ""),
        ("for each image zone", ""),
        ("layout nodes", ""),
        ("a menu switch node that has items with names of their own", ""),
    ],
)
def test_a_node_is_found_by_what_is_to_be_done_with_it(topics: Topics, text: str, slug: str) -> None:
    assert topics.find(text) == slug
