"""Stubs become paths, and only those that hold where a Blender can be asked are kept."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_build.errors import KBBuildError
from kb_build.versions.history import ApiHistory
from kb_build.versions.history_builder import build_history
from kb_build.versions.history_merge import merge_versions
from kb_build.versions.stub_check import kept_stubs
from kb_build.versions.stub_reader import read_stubs

if TYPE_CHECKING:
    from pathlib import Path

TYPES = """
import typing
import bpy.stub_internal.rna_enums

class _Hidden: ...

class ID:
    name: str
    def copy(self): ...

class Object(ID, bpy_struct):
    '''A docstring with an escape: \\] that Python warns of'''
    name: str
    draw_type: typing.Literal["WIRE", "SOLID"] | None
    modes: set[typing.Literal["A", "B"]]
    kind: bpy.stub_internal.rna_enums.KindItems
    free: str
    @property
    def data(self) -> Mesh | None: ...
    @data.setter
    def data(self, value): ...
    @classmethod
    def bl_rna_get_subclass(cls, id: str): ...
    def select_set(self, state: bool, *, view_layer: ViewLayer | None = None) -> None: ...

class Context:
    scene: Scene
    selected_objects: list[Object]
"""
OPS = """
class cube_add(bpy.ops._BPyOpsSubModOp):
    def __new__(
        cls, override_context=None, undo=None, /, *, radius: float = 1.0, align: typing.Literal["WORLD"] = 1
    ): ...
"""
BMESH_OPS = "def create_cone(bm: BMesh, diameter1: float = 0): ...\n"
ENUMS = 'type KindItems = typing.Literal[\n    "ONE",  # One.\n    "TWO",\n]\n'


def write_stubs(folder: Path, types: str = TYPES) -> Path:
    for name, text in {
        "bpy-stubs/types": types,
        "bpy-stubs/ops/mesh": OPS,
        "bpy-stubs/stub_internal/rna_enums": ENUMS,
        "bmesh-stubs/ops": BMESH_OPS,
        "other-stubs": "thing: int\n",
    }.items():
        (folder / name).mkdir(parents=True, exist_ok=True)
        (folder / name / "__init__.pyi").write_text(text, encoding="utf-8")
    return folder


def test_every_kind_of_name_becomes_a_path(tmp_path: Path) -> None:
    paths = read_stubs(write_stubs(tmp_path))
    assert {
        "bpy.types.Object", "bpy.types.Object.draw_type", "bpy.types.Object.draw_type:WIRE",
        "bpy.types.Object.modes:B", "bpy.types.Object.kind:TWO", "bpy.types.Object.data",
        "bpy.types.Object.select_set(state)", "bpy.types.Object.select_set(view_layer)",
        "bpy.ops.mesh.cube_add", "bpy.ops.mesh.cube_add(radius)", "bpy.ops.mesh.cube_add(align):WORLD",
        "bmesh.ops.create_cone(bmesh)", "bmesh.ops.create_cone(diameter1)", "other.thing",
    } <= paths  # fmt: skip


def test_what_repeats_or_is_no_name_of_blender_is_left_out(tmp_path: Path) -> None:
    paths = read_stubs(write_stubs(tmp_path))
    assert "bpy.types.ID.name" in paths
    assert not paths & {
        "bpy.types.Object.name", "bpy.types._Hidden", "bpy.types.Object.bl_rna_get_subclass",
        "bpy.ops.mesh.cube_add(undo)", "bpy.types.Object.data(value)", "bpy.types.Object.select_set(self)",
    }  # fmt: skip


def test_members_of_the_context_are_given_in_both_notations(tmp_path: Path) -> None:
    paths = read_stubs(write_stubs(tmp_path))
    assert {"bpy.types.Context.selected_objects", "bpy.context.selected_objects"} <= paths


@pytest.mark.parametrize("types", ["class Object(", "x = \x00"])
def test_a_file_that_is_no_python_is_named(tmp_path: Path, types: str) -> None:
    with pytest.raises(KBBuildError, match="types"):
        read_stubs(write_stubs(tmp_path, types))


def test_a_folder_without_stubs_is_refused(tmp_path: Path) -> None:
    with pytest.raises(KBBuildError, match="no stubs of Blender"):
        read_stubs(tmp_path)


BASE = {"bpy", "bpy.types", "bpy.types.A", *(f"bpy.types.A.m{n}" for n in range(200))}


def test_a_path_that_a_blender_contradicts_is_dropped_from_all_versions() -> None:
    stubs = {"2.79": BASE | {"bpy.types.A.made_up", "bpy.types.A.old"}, "4.2": BASE | {"bpy.types.A.made_up"}}
    kept, agreement = kept_stubs(stubs, {"4.2": BASE})
    assert kept == {"2.79": BASE | {"bpy.types.A.old"}}
    assert (agreement["member"].both, agreement["member"].extra) == (200, 1)


def test_a_kind_that_is_often_wrong_is_dropped() -> None:
    wrong = {f"bpy.types.A.run(p{n})" for n in range(3)}
    kept, _ = kept_stubs(
        {"2.79": BASE | {"bpy.types.A.run(old)", "nowhere.x"}, "4.2": BASE | wrong}, {"4.2": BASE}
    )
    assert kept == {"2.79": BASE}


def test_what_no_stubs_tell_is_unknown_rather_than_missing() -> None:
    socket = 'bpy.types.A.inputs["Fac"]'
    history = merge_versions(
        {
            "2.79": {"bpy.types.A", "bpy.types.A.old"},
            "4.2.1": {"bpy.types.A", socket},
            "5.1.0": {"bpy.types.A"},
        }
    )
    assert history.exists("bpy.types.A.old", "2.79") is True
    assert history.exists("bpy.types.A.old", "4.2") is False
    assert history.exists(socket, "2.79") is None
    assert ApiHistory.from_bytes(history.to_bytes()) == history
    assert {span.path: (span.last, span.gone) for span in history.removed_from("5.1")} == {
        "bpy.types.A.old": ("2.79", "4.2"),
        socket: ("4.2", "5.1"),
    }


def test_items_are_unknown_where_stubs_list_none() -> None:
    history = merge_versions(
        {
            "2.79": {"bpy.types.A.kind"},
            "2.80": {"bpy.types.A.kind", "bpy.types.A.kind:ONE"},
            "4.2.1": {"bpy.types.A.kind", "bpy.types.A.kind:ONE", "bpy.types.A.kind:TWO"},
        }
    )
    assert history.exists("bpy.types.A.kind:ONE", "2.79") is None
    assert not any(each.is_sure for each in history.arrivals("4.2"))


def test_stubs_that_leave_a_class_out_for_a_while_do_not_remove_it() -> None:
    history = merge_versions(
        {"2.79": {"a", "a.B", "a.B.old"}, "2.80": {"a"}, "2.81": {"a"}, "3.4.1": {"a", "a.B"}}
    )
    assert history.exists("a.B", "2.80") is None
    assert history.exists("a.B.old", "2.81") is None
    assert [(span.last, span.gone) for span in history.removed_from("3.4")] == [("2.79", "3.4")]


def test_shared_items_are_inferred_from_where_stubs_list_them() -> None:
    def version(*items: str, shared: bool) -> set[str]:
        places = ["a.x.kind", "a.y.kind", *(["rna_enum_kind"] if shared else [])]
        return {"a", "a.x", "a.y", *places, *(f"{place}:{item}" for place in places for item in items)}

    history = merge_versions(
        {"2.79": version("OLD", "ONE", shared=False), "4.2.1": version("ONE", "TWO", shared=True)}
    )
    assert history.shared == {"a.x.kind": "rna_enum_kind", "a.y.kind": "rna_enum_kind"}
    assert [history.exists("a.x.kind:OLD", v) for v in ("2.79", "4.2")] == [True, False]
    assert [history.exists("a.y.kind:TWO", v) for v in ("2.79", "4.2")] == [False, True]
    assert ApiHistory.from_bytes(history.to_bytes()) == history


def test_the_builder_adds_stubs_to_the_versions_of_the_file(tmp_path: Path) -> None:
    output, stubs = tmp_path / "api.csv.gz", tmp_path / "stubs"
    write_stubs(stubs / "2.79")
    asked = {
        path for path in read_stubs(stubs / "2.79") if "Context." not in path and "draw_type" not in path
    }
    output.write_bytes(merge_versions({"4.2.1": {*asked, "bpy", "bmesh"}}).to_bytes())
    write_stubs(stubs / "4.2", TYPES.replace("draw_type", "name"))
    report = build_history([], home=tmp_path, output=output, stubs=stubs)
    assert (report.kept, report.from_stubs, report.written) == (("4.2.1",), ("2.79",), True)
    history = ApiHistory.load(output)
    assert history.span("bpy.types.Object.draw_type:WIRE") == ("2.79", "2.79")
    assert report.agreement["class"].both > 0
