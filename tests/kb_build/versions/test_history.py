"""What the history says, how it is written down, and that it survives being read back."""

from __future__ import annotations

import gzip
from typing import TYPE_CHECKING

import pytest

from kb_build.errors import StoreError
from kb_build.symbols.paths import split_path
from kb_build.versions.history import ApiHistory, Arrival, RemovedSpan
from kb_build.versions.history_merge import merge_versions

if TYPE_CHECKING:
    from pathlib import Path

PATHS = {
    "4.2.1": {"bpy", "bpy.types", "bpy.types.A", "bpy.types.A.old", "aud", "rna_enum_x", "rna_enum_x:ONE"},
    "4.3.0": {
        "bpy", "bpy.types", "bpy.types.A", "bpy.types.A.kind", "bpy.types.A.kind:ONE", "bpy.types.A.kind:TWO",
        'bpy.types.A.inputs["A: (b.c)"]', 'bpy.types.A.inputs[""]', "bpy.types.A.run(size)",
        "rna_enum_x", "rna_enum_x:ONE", "rna_enum_x:TWO",
    },
    "4.10.2": {
        "bpy", "bpy.types", "bpy.types.A", "bpy.types.A.old", 'bpy.types.A.outputs["Out"]', "aud",
        "rna_enum_x",
        "bpy.types.A.look", "bpy.types.A.look:", "bpy.types.A.look:Two words", 'bpy.types.A.look:=q"uote',
        'bpy.types.A.inputs["Mode"]', 'bpy.types.A.inputs["Mode"]:Fast one',
    },
}  # fmt: skip


@pytest.fixture(scope="module")
def committed() -> ApiHistory:
    return ApiHistory.load()


@pytest.mark.parametrize(
    ("path", "span"),
    [
        ("bpy.types.Object.select", ("2.79", "2.79")),
        ("bpy.types.Object.draw_type:WIRE", ("2.79", "2.79")),
        ("bpy.ops.mesh.primitive_cube_add(radius)", ("2.79", "2.79")),
        ("bpy.context.user_preferences", ("2.79", "2.79")),
        ("bpy.types.INFO_MT_file_export", ("2.79", "2.79")),
        ("bpy.types.BevelModifier.use_only_vertices", ("2.79", "2.83")),
        ("bpy.types.Action.fcurves", ("2.79", "4.5")),
        ("bpy.types.Scene.node_tree", ("2.79", "4.5")),
        ("bpy.types.Scene.compositing_node_group", ("5.0", "5.3")),
        ("bpy.types.Mesh.use_auto_smooth", ("2.79", "4.0")),
        ("bpy.types.SceneEEVEE.use_bloom", ("2.80", "4.2")),
        ("bpy.ops.export_mesh.stl", ("2.79", "4.1")),
        ("bpy.ops.wm.stl_export", ("4.1", "5.3")),
        ('bpy.types.ShaderNodeBsdfPrincipled.inputs["Specular"]', ("3.4", "3.4")),
        ('bpy.types.ShaderNodeBsdfPrincipled.inputs["Specular IOR Level"]', ("4.2", "5.3")),
        ("bpy.types.ShaderNodeTexSky.sky_type:NISHITA", ("2.90", "4.5")),
        ("bpy.types.SequenceEditor.sequences", ("2.79", "4.5")),
        ("bpy.types.SequenceEditor.strips", ("4.4", "5.3")),
        ("bpy.types.RenderSettings.engine:BLENDER_EEVEE_NEXT", ("4.2", "4.5")),
        ("bpy.types.UILayout.label(icon):CAMERA_DATA", ("2.79", "5.3")),
        ("bpy.ops.object.modifier_add(type):NODES", ("2.92", "5.3")),
        ('bpy.types.CompositorNodeRLayers.outputs["Image"]', ("3.4", "5.3")),
        ("bpy.types.Object.no_such_property", None),
    ],
)
def test_the_committed_history_dates_symbols(
    committed: ApiHistory, path: str, span: tuple[str, str] | None
) -> None:
    assert committed.span(path) == span


def test_the_committed_history_reaches_from_2_79_to_5_3_without_a_gap(committed: ApiHistory) -> None:
    old = "2.79 2.80 2.81 2.82 2.83 2.90 2.91 2.92 2.93 3.0 3.1 3.2 3.3 3.4 3.5 3.6"
    assert committed.versions == tuple(f"{old} 4.0 4.1 4.2 4.3 4.4 4.5 5.0 5.1 5.2 5.3".split())


def test_the_committed_history_survives_a_round_trip(committed: ApiHistory) -> None:
    assert ApiHistory.from_bytes(committed.to_bytes()) == committed


def test_removed_and_new_symbols_of_5_1_have_versions(committed: ApiHistory) -> None:
    gone = {span.path: span for span in committed.removed_from("5.1.2")}
    since = {each.path: each.first for each in committed.arrivals("5.1") if each.is_sure}
    path = "bpy.types.Action.fcurves"
    assert gone[path] == RemovedSpan(path, "2.79", "4.5", "5.0")
    assert since["bpy.types.Scene.compositing_node_group"] == "5.0"
    assert "bpy.types.Object" not in gone.keys() | since.keys()
    assert not gone.keys() & since.keys()


def test_every_path_of_every_version_is_found_again() -> None:
    history = ApiHistory.from_bytes(merge_versions(PATHS).to_bytes())
    for version, paths in PATHS.items():
        expected = paths | {"aud"} if version == "4.3.0" else paths
        assert set(history.paths(version)) == expected


def test_versions_are_ordered_as_numbers() -> None:
    assert merge_versions(PATHS).versions == ("4.2", "4.3", "4.10")


def test_a_symbol_that_came_back_counts_since_it_came_back() -> None:
    history = merge_versions(PATHS)
    found = {each.path: each for each in history.arrivals("4.10")}
    assert found["bpy.types.A.old"] == Arrival("bpy.types.A.old", "4.10", "4.3", is_sure=True, is_return=True)
    assert RemovedSpan("bpy.types.A.old", "4.2", "4.2", "4.3") in set(history.removed_from("4.3"))


def test_a_symbol_of_which_some_versions_are_unknown_has_the_last_that_lacks_it(
    committed: ApiHistory,
) -> None:
    found = {each.path: each for each in committed.arrivals("5.1")}
    path = "bpy.types.GreasePencilArrayModifier"
    assert found[path] == Arrival(path, "4.2", "3.4", is_sure=False, is_return=False)


def test_a_future_symbol_has_the_version_that_brings_it() -> None:
    assert RemovedSpan("bpy.types.A.look", "4.10", "4.10", "") in set(
        merge_versions(PATHS).removed_from("4.3")
    )


def test_an_unknown_version_gives_neither_yes_nor_no() -> None:
    history = merge_versions(PATHS)
    assert history.exists("bpy", "2.79") is None
    assert history.exists("bpy", "4.3") is True
    assert history.exists("bpy.types.A.kind", "4.2") is False
    assert list(history.removed_from("2.79")) == []
    assert list(history.arrivals("2.79")) == []


@pytest.mark.parametrize(
    ("path", "parts"),
    [
        ("bpy", ("", ".", "bpy")),
        ("bpy.types.A.old", ("bpy.types.A", ".", "old")),
        ("bpy.types.A.run(size)", ("bpy.types.A.run", "(", "size")),
        ("bpy.types.A.run(mode):ONE", ("bpy.types.A.run(mode)", ":", "ONE")),
        ("bpy.types.A.look:", ("bpy.types.A.look", ":", "")),
        ("bpy.types.A.look:Two words", ("bpy.types.A.look", ":", "Two words")),
        ('bpy.types.A.inputs["A: (b.c)"]', ("bpy.types.A", "<", "A: (b.c)")),
        ('bpy.types.A.outputs[""]', ("bpy.types.A", ">", "")),
        ('bpy.types.A.inputs["Mode"]:Fast one', ('bpy.types.A.inputs["Mode"]', ":", "Fast one")),
    ],
)
def test_a_path_is_split_before_its_last_step(path: str, parts: tuple[str, str, str]) -> None:
    assert split_path(path) == parts


TABLE = b"path,items_of,4.2.1,4.3.0\n"


# What is packed, and how many bytes of its end are lost.
@pytest.mark.parametrize(
    ("table", "lost"),
    [
        (TABLE + b"bpy,,1,0\n", 9),
        (b"", 0),
        (b"path,items_of\nbpy,\n", 0),
        (b"path,4.2.1\nbpy,1\n", 0),
        (b"path,items_of,4.3.0,4.2.1\nbpy,,1,0\n", 0),
        (b"path,items_of,x\nbpy,,1\n", 0),
        (TABLE + b"bpy,,1\n", 0),
        (TABLE + b"bpy,,1,yes\n", 0),
        (TABLE + b"\xff,,1,1\n", 0),
    ],
)
def test_refuses_a_packed_table_that_is_not_a_history(tmp_path: Path, table: bytes, lost: int) -> None:
    packed = gzip.compress(table)
    refuses(tmp_path, packed[: len(packed) - lost])


@pytest.mark.parametrize("data", [b"", b"\x00\x01", TABLE])
def test_refuses_a_file_that_is_not_packed(tmp_path: Path, data: bytes) -> None:
    refuses(tmp_path, data)


def refuses(tmp_path: Path, data: bytes) -> None:
    file = tmp_path / "api.csv.gz"
    file.write_bytes(data)
    with pytest.raises(StoreError, match="simworlds kb history"):
        ApiHistory.load(file)


def test_a_module_that_a_build_lacks_as_a_whole_is_not_new_in_the_next(committed: ApiHistory) -> None:
    """The package of 4.2 comes without ``aud``, which Blender has had since long before."""
    history = merge_versions({"4.2.0": {"bpy"}, "4.3.0": {"bpy", "bpy.new", "aud", "aud.Device"}})
    assert history.exists("aud.Device", "4.2") is None
    assert {span.path for span in history.removed_from("4.2")} == {"bpy.new"}
    assert [each.path for each in history.arrivals("4.3") if each.lacked] == ["bpy.new"]
    assert [set(history.modules(version)) for version in ("4.2", "9.9")] == [{"aud", "bpy"}, set()]
    assert "aud" in committed.modules("4.2")
    assert not [span.path for span in committed.removed_from("4.2") if span.path.startswith("aud")]


def test_a_module_that_stubs_tell_of_is_new_where_they_lack_it() -> None:
    history = merge_versions({"2.83": {"bpy"}, "2.90": {"bpy", "bl_math"}, "4.2.0": {"bpy", "bl_math"}})
    assert history.exists("bl_math", "2.83") is False


def test_of_what_is_doubted_a_version_neither_has_nor_lacks_it() -> None:
    doubted = {"bpy.types.A.old", "bpy.types.A.kind"}
    history = merge_versions(PATHS, {"4.3.0": doubted})
    assert [history.exists(path, "4.3") for path in ("bpy.types.A.old", "bpy.types.A.kind")] == [None, True]
    again = ApiHistory.from_bytes(history.to_bytes())
    assert again.exists("bpy.types.A.old", "4.3") is None


def test_a_placeholder_alone_does_not_say_which_items_are_gone() -> None:
    """A Blender that was built without languages lists DEFAULT for all of them."""
    language, codec = "bpy.types.View.language", "bpy.types.View.codec"
    both = {"bpy", language, codec, f"{language}:DEFAULT", f"{codec}:NONE", f"{codec}:PNG"}
    history = merge_versions({
        "3.4.1": {*both, f"{language}:de_DE", f"{codec}:GIF"},
        "4.2.0": both,
    })  # fmt: skip
    assert history.exists(f"{language}:de_DE", "4.2") is None
    assert [span.path for span in history.removed_from("4.2")] == [f"{codec}:GIF"]


def test_what_stubs_left_out_while_blenders_had_it_they_do_not_call_gone() -> None:
    """Stubs of old versions list the settings of Cycles, and later ones none."""
    rows = {
        "2.80": {"bpy", "bpy.types.Cycles", "bpy.types.Old"},
        "2.90": {"bpy"},
        "3.4.1": {"bpy", "bpy.types.Cycles"},
        "3.5": {"bpy"},
        "4.2.0": {"bpy"},
    }
    history = merge_versions(rows)
    assert [history.exists("bpy.types.Cycles", version) for version in ("3.4", "3.5", "4.2")] == [
        True,
        None,
        False,
    ]
    assert history.exists("bpy.types.Old", "2.90") is False
