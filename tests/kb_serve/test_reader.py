"""One base file, read: what is in it, by which index, and what happens when it is no base."""

from __future__ import annotations

import random
import re
import shutil
import sqlite3
import threading
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from asking import SEED, TYPES, classes, of_data, paths

from kb_build.index.analysis import key
from kb_build.schema import APPLICATION_ID, SCHEMA_VERSION
from kb_serve.errors import BaseMissing, BaseUnreadable
from kb_serve.knowledge_base import KnowledgeBase
from kb_serve.reader import BaseReader

if TYPE_CHECKING:
    from collections.abc import Callable


@pytest.fixture
def copy(base: Path, tmp_path: Path) -> Path:
    """A base of one's own, to be damaged."""
    return Path(shutil.copy(base, tmp_path / "blender-5.1.sqlite"))


# Look-ups


def test_members_come_in_blenders_order_and_belong_to_their_owner(reader: BaseReader) -> None:
    for path in classes(reader, count=100):
        for name, entry in reader.members(path).items():
            assert entry.owner == path
            assert entry.path.startswith(path)
            assert entry.path.endswith(name)
    assert list(reader.members("bpy.types.RigidBodyObject"))[:3] == ["type", "mesh_source", "enabled"]


def test_the_lineage_ends_at_bpy_struct(reader: BaseReader) -> None:
    assert [entry.name for entry in reader.lineage("bpy.types.ClothModifier")] == [
        "ClothModifier",
        "Modifier",
        "bpy_struct",
    ]
    for path in classes(reader):
        assert [entry.name for entry in reader.lineage(path)][-1] in {
            "bpy_struct",
            "GeometrySet",
            path[len(TYPES) :],
        }
    assert list(reader.lineage("bpy.types.Nothing")) == []


def test_descendants_are_those_that_have_the_class_in_their_lineage(reader: BaseReader) -> None:
    below = {entry.path for entry in reader.descendants("bpy.types.Modifier")}
    assert "bpy.types.ClothModifier" in below
    assert len(below) > 60
    for path in below:
        assert "bpy.types.Modifier" in {entry.path for entry in reader.lineage(path)}


def test_entries_and_records_agree(reader: BaseReader) -> None:
    for kind in ("class", "property", "function", "operator", "socket", "context"):
        for path in paths(reader, kind, 60):
            entry, symbol = reader.entry(path), reader.symbol(path)
            assert entry is not None
            assert symbol is not None
            assert (entry.path, entry.kind, entry.name, entry.type, entry.target, entry.base, entry.group) == (
                symbol.path, symbol.kind, symbol.name, symbol.type, symbol.target, symbol.base, symbol.group,
            )  # fmt: skip


@pytest.mark.parametrize(
    "text", ["", "x_y_z", "bpy.types.", "' OR 1=1 --", "%", "*", "\x00", "\ud800", "x" * 10_000]
)
def test_unknown_symbols_and_pages_are_none(reader: BaseReader, text: str) -> None:
    assert reader.entry(text) is None
    assert reader.symbol(text) is None
    assert reader.manual.page(text) is None
    assert reader.manual.page_entry(text) is None
    assert reader.history.removed(text) is None
    assert not reader.members(text) or text == ""
    assert reader.names.by_name(text) == ()
    assert reader.manual.manual_links(text) == ()
    assert reader.history.successors(text) == []
    assert reader.history.similar_names(text) == []
    assert reader.history.since(text) == ""


def test_what_is_marked_stands_in_the_line(reader: BaseReader) -> None:
    entries = [entry for path in of_data(reader, "property", count=500) if (entry := reader.entry(path))]
    for entry in entries:
        words = entry.head.split()
        assert entry.is_read_only == ("read-only" in words), entry.line
        assert entry.is_deprecated == ("deprecated" in words), entry.line
        assert entry.is_unseen == ("(RNA's)" in words), entry.line
        assert " = None" in entry.head or not entry.is_given, entry.line
    assert any(entry.is_read_only for entry in entries)
    assert any(entry.is_unseen for entry in entries)


def test_operators_are_found_by_what_they_take(reader: BaseReader) -> None:
    assert "bpy.ops.mesh.primitive_cube_add" in reader.names.operators_taking("enter_editmode")
    assert reader.names.operators_taking("enter_edit") == []
    for path in paths(reader, "operator", count=100):
        symbol = reader.symbol(path)
        for parameter in symbol.parameters if symbol else ():
            assert path in reader.names.operators_taking(parameter.name)
            assert parameter.name in reader.names.operator_arguments


def test_no_look_up_reads_a_whole_table(base: Path) -> None:
    """SQLite says how it would answer each query that the reader makes: by an index, never by a scan."""
    calls: list[Callable[[BaseReader], object]] = [
        lambda r: r.entry("bpy.types.Object"), lambda r: r.members("bpy.types.Object"),
        lambda r: r.subclasses("bpy.types.Modifier"), lambda r: r.symbol("bpy.types.Object"),
        lambda r: r.names.by_name("quality"), lambda r: r.names.by_key("quality"),
        lambda r: r.names.enum_owners("emitter"),
        lambda r: r.history.removed("x"), lambda r: r.history.removed_by_key("x"), lambda r: r.history.successors("x"),
        lambda r: r.history.similar_names("x"), lambda r: r.history.since("x"),
        lambda r: r.manual.manual_links("bpy.types.Object"), lambda r: r.names.operators_taking("type"),
            lambda r: r.manual.manual_url("bpy.types.Object"), lambda r: r.manual.passage_text("bpy.types.Object"),
        lambda r: r.manual.page_entry("physics/index"), lambda r: r.manual.page_children("physics/index"),
        lambda r: r.manual.symbols_of_page("physics/index"), lambda r: r.manual.page("physics/cloth/introduction"),
    ]  # fmt: skip
    with closing(BaseReader(base)) as reader, closing(sqlite3.connect(base)) as file:
        asked: list[str] = []
        reader._connection.set_trace_callback(asked.append)
        for call in calls:
            call(reader)
        assert len(asked) >= len(calls)
        for sql in asked:
            plan = " / ".join(row[3] for row in file.execute(f"EXPLAIN QUERY PLAN {sql}"))
            assert "SCAN" not in plan, (sql, plan)


def test_a_base_is_shared_by_threads(base: Path) -> None:
    with KnowledgeBase(base) as kb, closing(BaseReader(base)) as reader:
        sample = of_data(reader, "property", 80)
        expected = {path: kb.query(path) for path in sample}
        wrong: list[object] = []

        def ask(seed: int) -> None:
            order = sample.copy()
            random.Random(seed).shuffle(order)
            try:
                wrong.extend(path for path in order if kb.query(path) != expected[path])
            except Exception as error:
                wrong.append(error)

        threads = [threading.Thread(target=ask, args=(seed,)) for seed in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert wrong == []


# Files that are no base


def test_a_file_that_is_not_there_is_missing_with_the_command_that_makes_it(tmp_path: Path) -> None:
    for path in (tmp_path / "no.sqlite", tmp_path):
        with pytest.raises(BaseMissing, match="simworlds kb build"):
            BaseReader(path)


@pytest.mark.parametrize(
    "content", [b"", b"\x00" * 5_000, b"hello", b"SQLite format 3\x00" + b"x" * 84, b"PK\x03\x04" * 99]
)
def test_a_file_of_another_kind_is_refused_with_advice(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "kb.sqlite"
    path.write_bytes(content)
    with pytest.raises(BaseUnreadable, match=r"kb\.sqlite.*simworlds kb build VERSION --force"):
        KnowledgeBase(path)


def test_another_programs_sqlite_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "kb.sqlite"
    with closing(sqlite3.connect(path)) as file:
        file.executescript("CREATE TABLE symbols (path TEXT); PRAGMA user_version = 1;")
    with pytest.raises(BaseUnreadable, match=r"not a knowledge base.*simworlds kb build VERSION --force"):
        KnowledgeBase(path)


def set_number(path: Path, name: str, value: int) -> None:
    with closing(sqlite3.connect(path)) as file:
        file.execute(f"PRAGMA {name} = {value}")


@pytest.mark.parametrize(
    ("version", "said"),
    [(SCHEMA_VERSION + 1, "newer SimWorlds.*upgrade"), (99, "newer"), (0, "older layout.*--force")],
)
def test_another_schema_version_is_refused_with_advice(copy: Path, version: int, said: str) -> None:
    set_number(copy, "user_version", version)
    with pytest.raises(BaseUnreadable, match=f"(?s){said}"):
        KnowledgeBase(copy)


def test_a_base_cut_off_anywhere_never_answers_wrongly(copy: Path) -> None:
    """It is refused when it is opened or when the damage shows; what it still answers is right."""
    whole, chance = copy.read_bytes(), random.Random(SEED)
    refused: list[str] = []
    for size in [100, 4_096, 65_536, *(chance.randrange(len(whole)) for _ in range(12))]:
        copy.write_bytes(whole[:size])
        try:
            with KnowledgeBase(copy) as kb:
                for query in ("ClothSettings.quality", "how to bake cloth", "physics/cloth/introduction"):
                    kb.query(query)
        except BaseUnreadable as error:
            refused.append(str(error))
    assert len(refused) >= 14
    assert all("--force" in said for said in refused)


def test_a_damaged_list_of_tables_is_reported(copy: Path) -> None:
    damaged = bytearray(copy.read_bytes())
    damaged[100:108] = b"\xff" * 8  # behind the header, which alone tells that it is a base
    copy.write_bytes(damaged)
    with pytest.raises(BaseUnreadable, match=re.escape(str(copy))):
        KnowledgeBase(copy)


def test_damaged_pages_are_reported(copy: Path) -> None:
    whole, chance = copy.read_bytes(), random.Random(SEED)
    refused: list[str] = []
    for _ in range(12):
        damaged = bytearray(whole)
        for _ in range(400):
            at = chance.randrange(4_096, len(damaged) - 4_096)
            damaged[at : at + 512] = chance.randbytes(512)
        copy.write_bytes(damaged)
        try:
            with KnowledgeBase(copy) as kb:
                for query in ("ClothSettings.quality", "how to bake cloth", "Object", "cloth", "EMITTER"):
                    kb.query(query)
        except BaseUnreadable as error:
            refused.append(str(error))
    assert len(refused) >= 3
    assert all(str(copy) in said for said in refused)


@pytest.mark.parametrize("weight", [np.nan, np.inf, -1.0])
def test_a_weight_that_no_stem_has_is_reported(copy: Path, weight: float) -> None:
    with closing(sqlite3.connect(copy)) as file:
        ((data,),) = file.execute("SELECT data FROM postings WHERE stem = 'cloth'")
        file.execute(
            "UPDATE postings SET data = ? WHERE stem = 'cloth'", (data[:-2] + np.float16(weight).tobytes(),)
        )
        file.commit()
    with KnowledgeBase(copy) as kb, pytest.raises(BaseUnreadable, match="the postings of"):
        kb.query("how to bake cloth in physics")


def test_a_missing_table_is_reported_as_damage(copy: Path) -> None:
    for table in ("symbols", "names", "levels", "phrases", "postings", "pages"):
        with closing(sqlite3.connect(copy)) as file:
            file.execute(f"ALTER TABLE {table} RENAME TO gone")
            file.commit()
        with KnowledgeBase(copy) as kb, pytest.raises(BaseUnreadable, match="damaged"):
            kb.query("how to bake cloth in physics")
        with closing(sqlite3.connect(copy)) as file:
            file.execute(f"ALTER TABLE gone RENAME TO {table}")
            file.commit()


def test_a_base_is_never_written_to(copy: Path) -> None:
    copy.chmod(0o400)
    before = copy.read_bytes()
    with KnowledgeBase(copy) as kb:
        kb.query("cloth")
    assert copy.read_bytes() == before
    assert [path.name for path in copy.parent.iterdir()] == [copy.name]


def test_a_path_with_odd_characters_is_opened(base: Path, tmp_path: Path) -> None:
    folder = tmp_path / "a b?c#d%20é&mode=rwc"
    folder.mkdir()
    path = Path(shutil.copy(base, folder / "kb.sqlite"))
    with closing(BaseReader(path)) as reader:
        assert reader.names.by_key(key("ClothSettings.quality"))


def test_the_file_says_whose_it_is(base: Path) -> None:
    with closing(sqlite3.connect(base)) as file:
        assert file.execute("PRAGMA application_id").fetchone() == (APPLICATION_ID,)


def test_a_module_that_the_build_lacks_is_said_to_be_unknown(make_base: Callable[..., Path]) -> None:
    with KnowledgeBase(make_base("4.2.0", unknown_modules=["aud"])) as kb:
        told = "has no module `aud`; other builds may have it."
        assert [note for note in kb.query("device = aud.Device()").notes if note.endswith(told)]
        assert [
            note
            for note in kb.query("ModuleNotFoundError: No module named 'aud'").notes
            if note.endswith(told)
        ]
        assert not [note for note in kb.query("bpy.ops.sound.open()").notes if note.endswith(told)]
