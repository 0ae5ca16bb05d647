"""A base is written whole, reads back as it was written, and is found under every usual spelling."""

from __future__ import annotations

import os
import sqlite3
from contextlib import closing
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from kb_build.errors import StoreError
from kb_build.index.analysis import key, short_path
from kb_build.pages.page import Page, Section
from kb_build.schema import APPLICATION_ID, SCHEMA_VERSION, pack, unpack
from kb_build.store import Contents, write_base
from kb_build.summaries.functions import with_function_summaries
from kb_build.summaries.types import PageSummary
from kb_build.symbols.records import Deprecation, EnumItem, Link, Parameter, Symbol
from kb_build.versions.removed_symbols import RemovedSymbols
from kb_serve.knowledge_base import KnowledgeBase
from kb_serve.lookups.records import Successor
from kb_serve.reader import BaseReader

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kb_build.blender.extract_reader import Extract

CLOTH = Symbol(
    "bpy.types.ClothSettings", "class", "bpy.types", label="Cloth Settings", group="data", reached="x"
)
STEPS = Symbol(
    "bpy.types.ClothSettings.quality_steps", "property", CLOTH.path, label="Quality Steps", type="enum", default="LOW",
    description="Finer.", enum_items=(EnumItem("LOW", "Low"), EnumItem("HIGH", "High", "Slow")),
    deprecation=Deprecation("gone", "5.0", "6.0"), array=(3,), flags=("readonly",),
)  # fmt: skip
ADD = Symbol(
    "bpy.ops.object.modifier_add", "operator", "bpy.ops.object", label="Add Modifier", target="OBJECT_OT_modifier_add",
    parameters=(Parameter("type", "enum", enum_items=(EnumItem("CLOTH", "Cloth"),)),),
)  # fmt: skip
SOCKET = Symbol(f'{CLOTH.path}.inputs["IOR Level"]', "socket", CLOTH.path, label="IOR Level", type="value")
PANEL = Symbol("bpy.types.VIEW3D_PT_x", "class", "bpy.types", label="X", group="ui")
TOP = Page(
    "physics/index",
    "manual",
    "5.1",
    "Physics",
    (Section("physics", "Physics", 1, "All."),),
    children=("physics/cloth/index",),
)
PAGE = Page(
    "physics/cloth/index", "manual", "5.1", "Cloth Simulation",
    (
        Section("a", "Cloth Simulation", 1, "Lead \x00 text 🎨."), Section("b", "More", 2, "x" * 40_000),
        Section("c", "None", 3, ""),
    ),
    ("Physics",), (), ("glossary/index",),
    "https://docs.blender.org/manual/en/5.1/physics/cloth/index.html", ("odd markup",),
)  # fmt: skip
SYMBOLS = (CLOTH, STEPS, ADD, SOCKET, PANEL)
REMOVED_SYMBOLS = RemovedSymbols(
    (("bpy.types.ClothSettings.old", "4.2", "4.5", "5.0", "old"),),
    ((key("ClothSettings.old"), "bpy.types.ClothSettings.old"),),
    (
        ("bpy.types.ClothSettings.older", 1, CLOTH.path, "", "5.0", "notes"),
        ("bpy.types.ClothSettings.older", 0, STEPS.path, "halve it", "5.0", "notes"),
    ),
    (("bpy.types.ClothSettings.old", STEPS.path, 0.9),), ((STEPS.path, "5.0", ""), (ADD.path, "4.2", "3.4")),
)  # fmt: skip
CONTENTS = Contents(
    symbols=SYMBOLS,
    pages=(TOP, PAGE),
    links=(Link(STEPS.path, "physics/cloth/index#steps", "manual"), Link(ADD.path, "physics/index", "manual")),
    meta={"minor": "5.1", "fingerprint": "f"},
    summaries={PAGE.slug: PageSummary("key", "In short.", "extractive", "extractive", "1")},
    removed_symbols=lambda: REMOVED_SYMBOLS,
)  # fmt: skip


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("store") / "kb" / "blender-5.1.sqlite"
    write_base(target, CONTENTS)
    return target


@pytest.fixture(scope="module")
def small(path: Path) -> Iterator[BaseReader]:
    with closing(BaseReader(path)) as opened:
        yield opened


@pytest.mark.parametrize("symbol", SYMBOLS, ids=lambda symbol: symbol.name)
def test_a_symbol_reads_back_as_it_was_written(small: BaseReader, symbol: Symbol) -> None:
    assert small.symbol(symbol.path) == symbol
    entry = small.entry(symbol.path)
    assert entry is not None
    assert (entry.kind, entry.owner, entry.name, entry.label) == (
        symbol.kind,
        symbol.owner,
        symbol.name,
        symbol.label,
    )


def test_a_page_reads_back_whole(small: BaseReader) -> None:
    assert small.manual.page(PAGE.slug) == PAGE
    entry = small.manual.page_entry(PAGE.slug)
    assert entry is not None
    assert (entry.parent, entry.summary, entry.summary_method) == (TOP.slug, "In short.", "extractive")
    assert [child.slug for child in small.manual.page_children(TOP.slug)] == [PAGE.slug]
    assert small.manual.page_entry("nowhere") is None


@pytest.mark.parametrize(
    ("spelled", "identifier"),
    [
        ("bpy.types.ClothSettings.quality_steps", STEPS.path), ("ClothSettings.quality_steps", STEPS.path),
        ("clothsettings.qualitysteps", STEPS.path), ("quality steps", STEPS.path), ("qualitySteps", STEPS.path),
        ("QUALITY_STEPS", STEPS.path), ("Cloth Settings", CLOTH.path), ("types.ClothSettings", CLOTH.path),
        ("OBJECT_OT_modifier_add", ADD.path), ("bpy.types.OBJECT_OT_modifier_add", ADD.path),
        ("modifier_add", ADD.path),
        ("object.modifier_add", ADD.path), ("Add Modifier", ADD.path), ("IOR Level", SOCKET.path),
        ("VIEW3D_PT_x", PANEL.path), ("physics/cloth/index", PAGE.slug), ("physics/cloth", PAGE.slug),
        ("cloth", PAGE.slug), ("Cloth Simulation", PAGE.slug),
    ],
)  # fmt: skip
def test_every_usual_spelling_is_kept(small: BaseReader, spelled: str, identifier: str) -> None:
    assert identifier in {row[1] for row in small.names.by_key(key(spelled))}


def test_fuller_spellings_come_first(small: BaseReader) -> None:
    forms = [form for form, _ in small.names.by_key(key("ClothSettings"))]
    assert forms == sorted(forms)


def test_labels_of_panels_are_no_names(small: BaseReader) -> None:
    assert PANEL.path not in {row[1] for row in small.names.by_key(key("X"))}


def test_enum_items_lead_to_their_property_or_argument(small: BaseReader) -> None:
    assert small.names.enum_owners("high") == [(STEPS.path, "HIGH", "High")]
    assert small.names.enum_owners("cloth") == [(f"{ADD.path}(type)", "CLOTH", "Cloth")]


def test_links_meta_and_other_versions_read_back(small: BaseReader) -> None:
    assert small.manual.manual_links(STEPS.path) == ("physics/cloth/index#steps",)
    assert small.manual.symbols_of_page("physics/index") == [ADD.path]
    assert small.meta == {"minor": "5.1", "fingerprint": "f"}
    assert small.history.removed("bpy.types.ClothSettings.old") == ("4.2", "4.5", "5.0")
    assert small.history.removed_by_key(key("ClothSettings.old")) == ["bpy.types.ClothSettings.old"]
    assert small.history.successors("bpy.types.ClothSettings.older") == [
        Successor(STEPS.path, "halve it", "5.0", "notes"), Successor(CLOTH.path, "", "5.0", "notes"),
    ]  # fmt: skip
    assert small.history.similar_names("bpy.types.ClothSettings.old") == [(STEPS.path, 0.9)]
    assert (small.history.since(STEPS.path), small.history.since(CLOTH.path)) == ("5.0", "")
    assert (small.history.arrival(ADD.path), small.history.since(ADD.path)) == (("4.2", "3.4"), "")


def test_the_file_has_our_application_id_and_is_sound(path: Path) -> None:
    with closing(sqlite3.connect(path)) as file:
        assert file.execute("PRAGMA application_id").fetchone() == (APPLICATION_ID,)
        assert file.execute("PRAGMA user_version").fetchone() == (SCHEMA_VERSION,)
        assert file.execute("PRAGMA integrity_check").fetchall() == [("ok",)]
    assert [other.name for other in path.parent.iterdir()] == [path.name]


def test_the_same_contents_give_the_same_bytes(path: Path, tmp_path: Path) -> None:
    write_base(tmp_path / "again.sqlite", CONTENTS)
    assert (tmp_path / "again.sqlite").read_bytes() == path.read_bytes()


def test_an_empty_base_answers_with_nothing(tmp_path: Path) -> None:
    write_base(tmp_path / "empty.sqlite", Contents((), (), (), {}))
    with KnowledgeBase(tmp_path / "empty.sqlite") as kb:
        for query in ("cloth", "ClothSettings.quality", "how do I bake?", "physics"):
            assert kb.query(query).kind == "none"


def test_a_base_without_pages_answers_from_symbols(tmp_path: Path) -> None:
    write_base(tmp_path / "api.sqlite", replace(CONTENTS, pages=(), links=(), summaries={}))
    with KnowledgeBase(tmp_path / "api.sqlite") as kb:
        assert kb.query("ClothSettings.quality_steps").hits[0].id == STEPS.path
        assert kb.query("finer steps for the simulation").hits[0].id == STEPS.path


def test_a_new_base_replaces_an_open_one(tmp_path: Path) -> None:
    target = tmp_path / "kb.sqlite"
    write_base(target, CONTENTS)
    with KnowledgeBase(target) as old:
        assert old.query("ClothSettings.quality_steps").kind == "schema"
        write_base(target, replace(CONTENTS, meta={"fingerprint": "new"}))
        assert old.meta["fingerprint"] == "f"
        assert old.query("ClothSettings").hits[0].id == CLOTH.path
        with KnowledgeBase(target) as new:
            assert new.meta["fingerprint"] == "new"


@pytest.mark.parametrize("record", [{}, {"a": [1, {"b": "é🎨"}]}, {"x": "\x00" * 1000}])
def test_packed_records_come_back(record: dict[str, object]) -> None:
    assert unpack(pack(record)) == record


@pytest.mark.parametrize(
    ("path", "short"),
    [
        ("bpy.types.A.b", "A.b"),
        ("bpy.ops.a.b", "a.b"),
        ("bpy.context.x", "context.x"),
        ("mathutils.X", "mathutils.X"),
    ],
)
def test_the_prefix_that_people_leave_out_is_left_out(path: str, short: str) -> None:
    assert short_path(path) == short


def test_all_of_blender_reads_back(extract: Extract, reader: BaseReader) -> None:
    for symbol in with_function_summaries(extract.symbols[::7]):
        read = reader.symbol(symbol.path)
        # How a class is reached is found by its uses, which the extract does not tell.
        assert read is not None
        assert replace(read, reached=symbol.reached, lacks=symbol.lacks) == symbol


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(StoreError, match=r"file.*cannot be written"):
        write_base(tmp_path / "file" / "kb.sqlite", CONTENTS)


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_without_permission_is_named(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(StoreError, match="cannot be written"):
        write_base(tmp_path / "kb.sqlite", CONTENTS)
