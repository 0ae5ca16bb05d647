"""Which scenes are meant, which files are a scene's, what a key depends on, what a person sees meanwhile."""

from __future__ import annotations

import io
import shutil
from pathlib import Path

import pytest
from pydantic import ValidationError

from bench.scenes.spec import BadSpec, spec_of
from bench.sweep import provenance as origin
from bench.sweep.content_hash import digest_of
from bench.sweep.executor import FinishedTask
from bench.sweep.records import BadSceneRecord, File, SystemInfo, read_record
from bench.sweep.scene_selection import select_scenes
from bench.sweep.scene_task import SceneTask
from bench.sweep.sweep_view import LiveSweepView, SweepView
from bench.sweep.systems.folder import FolderSystem
from simworlds.files import write_whole
from simworlds.terminal.console import Console

SCENE = "cloth_D1_01"
INFO = SystemInfo(name="theirs", kind="folder")


def folder(place: Path, *names: str) -> FolderSystem:
    for name in names:
        path = place / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(name)
    return FolderSystem(INFO, place)


# Scenes


@pytest.mark.parametrize(
    ("names", "count", "first"),
    [
        (["all"], 50, "cloth_D1_01"),
        (["dynamic"], 45, "cloth_D1_01"),
        (["ablation"], 15, "cloth_D1_01"),
        (["soft"], 9, "soft_D1_01"),
        (["static_D2"], 2, "static_D2_01"),
        (["D3"], 15, "cloth_D3_01"),
        (["rigid_D?_02"], 3, "rigid_D1_02"),
        (["soft_D1_02,cloth_D1_02", "cloth_D1_02"], 2, "cloth_D1_02"),
    ],
)
def test_selects_scenes_by_id_category_level_pattern_or_set(names: list[str], count: int, first: str) -> None:
    found = [spec.id for spec in select_scenes(names)]
    assert (len(found), found[0]) == (count, first)
    assert len({*found}) == count


def test_rejects_a_name_that_matches_no_scene() -> None:
    with pytest.raises(BadSpec, match="'cloth_D1_99' matches no scene"):
        select_scenes(["cloth_D1_01,cloth_D1_99"])


# Files


@pytest.mark.parametrize(
    ("names", "blend", "video"),
    [
        (["cloth_D1_01.blend"], "cloth_D1_01.blend", None),
        (["cloth_D1_01.blend", "cloth_D1_01.mp4"], "cloth_D1_01.blend", "cloth_D1_01.mp4"),
        (
            ["cloth_D1_01/any.blend", "cloth_D1_01/video.webm"],
            "cloth_D1_01/any.blend",
            "cloth_D1_01/video.webm",
        ),
        (["cloth_D1_01/a.blend", "cloth_D1_01/scene.blend"], "cloth_D1_01/scene.blend", None),
        (["cloth_D1_01/a.blend", "cloth_D1_01/cloth_D1_01.blend"], "cloth_D1_01/cloth_D1_01.blend", None),
        (["cloth_D1_01.blend", "video.mp4", "cloth_D1_02.mp4", "cloth_D1_01.png"], "cloth_D1_01.blend", None),
    ],
)
def test_finds_the_unambiguous_file_of_a_scene(
    names: list[str], blend: str, video: str | None, tmp_path: Path
) -> None:
    made = folder(tmp_path, *names).produce(spec_of(SCENE), tmp_path, lambda _: None)
    assert made.outcome == "taken"
    assert made.blend == tmp_path / blend
    assert made.video == (tmp_path / video if video else None)


@pytest.mark.parametrize(
    ("names", "why"),
    [
        ([], "no file"),
        (["cloth_D1_02.blend"], "no file"),
        (["cloth_D1_01/a.blend", "cloth_D1_01/b.blend"], "several .blend"),
    ],
)
def test_reports_a_missing_or_ambiguous_file(names: list[str], why: str, tmp_path: Path) -> None:
    made = folder(tmp_path, *names).produce(spec_of(SCENE), tmp_path, lambda _: None)
    assert (made.outcome, made.blend) == ("missing", None)
    assert made.why.startswith(why)


def test_what_lies_in_a_common_folder_is_a_scenes_unless_it_is_anothers(tmp_path: Path) -> None:
    system = folder(
        tmp_path,
        *("cloth_D1_01.blend", "blendcache_cloth_D1_01/a.bphys", "textures/wood.png"),
        *("cloth_D1_02.blend", "blendcache_cloth_D1_02/b.bphys", "soft_D1_01/scene.blend"),
    )
    assert {*system.depends_on(spec_of(SCENE))} == {
        "cloth_D1_01.blend",
        "blendcache_cloth_D1_01/a.bphys",
        "textures/wood.png",
    }
    assert {*system.depends_on(spec_of("soft_D1_01"))} == {"soft_D1_01/scene.blend"}
    assert system.depends_on(spec_of("rigid_D1_01")) == {}


def test_several_files_without_a_name_are_not_guessed_at_in_a_key_either(tmp_path: Path) -> None:
    system = folder(tmp_path, "cloth_D1_01/a.blend", "cloth_D1_01/b.blend")
    assert len(system.depends_on(spec_of(SCENE))) == 2


# Content


def test_a_digest_is_of_what_data_says_not_of_its_order() -> None:
    assert digest_of({"a": 1, "b": [1, 2]}) == digest_of({"b": [1, 2], "a": 1})
    assert digest_of({"a": [1, 2]}) != digest_of({"a": [2, 1]})


def test_a_file_that_cannot_be_written_whole_leaves_the_old_one(tmp_path: Path) -> None:
    write_whole(tmp_path / "file", b"old")
    with pytest.raises(TypeError):
        write_whole(tmp_path / "file", 5)  # type: ignore[arg-type]
    assert (tmp_path / "file").read_bytes() == b"old"
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_the_digest_of_a_step_covers_only_the_code_that_it_imports(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench = tmp_path / "bench"
    for name, text in {
        "audit/audit.py": "from bench.rules import size\nimport json\n",
        "rules/size.py": "if True:\n    from bench import names\n",
        "names.py": "",
        "other.py": "",
        "inside/read.py": "",
    }.items():
        (bench / name).parent.mkdir(parents=True, exist_ok=True)
        (bench / name).write_text(text)
    monkeypatch.setattr(origin, "_ROOT", tmp_path)

    def code() -> str:
        origin.code_of.cache_clear()
        return origin.code_of("bench.audit.audit", "bench/inside/*.py")

    before = code()
    (bench / "other.py").write_text("changed = True")
    assert code() == before
    for name in ("audit/audit.py", "rules/size.py", "names.py", "inside/read.py"):
        text = (bench / name).read_text()
        (bench / name).write_text(f"{text}changed = True\n")
        assert code() != before
        (bench / name).write_text(text)
    assert code() == before
    origin.code_of.cache_clear()


def test_the_digests_of_steps_cover_what_runs_in_blender(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    root = Path(origin.__file__).parents[2]
    for part in ("bench", "simworlds/sandbox/inside"):
        shutil.copytree(root / part, tmp_path / part, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(origin, "_ROOT", tmp_path)

    def codes() -> tuple[str, str]:
        origin.code_of.cache_clear()
        return origin.code_of_audit(), origin.code_of_frames()

    try:
        before = codes()
        with (tmp_path / "simworlds/sandbox/inside/open_blend.py").open("a") as file:
            file.write("changed = True\n")
        changed = codes()
        assert changed[0] != before[0]
        assert changed[1] != before[1]
        with (tmp_path / "bench/audit/inside/shapes.py").open("a") as file:
            file.write("changed = True\n")
        assert codes()[0] != changed[0]
        assert codes()[1] == changed[1]
    finally:
        origin.code_of.cache_clear()


def test_a_record_of_another_shape_is_named(tmp_path: Path) -> None:
    assert read_record(tmp_path) is None
    (tmp_path / "record.json").write_text('{"format": 1, "scene": "cloth_D1_01"}')
    with pytest.raises(BadSceneRecord, match=r"record\.json is not a valid record: system: Field required"):
        read_record(tmp_path)


@pytest.mark.parametrize("path", ["", "/etc/passwd", "../secret", "frames/../../secret", "a\0b"])
def test_a_record_rejects_paths_outside_its_folder(path: str) -> None:
    with pytest.raises(ValidationError, match="is outside of its folder"):
        File(path=path, sha256="", bytes=0)


# What is seen


def test_screen_shows_progress_without_control_characters(tmp_path: Path) -> None:
    stream = io.StringIO()
    task = SceneTask(spec_of(SCENE), FolderSystem(INFO, tmp_path), tmp_path)
    with LiveSweepView(Console(stream, force_terminal=True, width=80), 2) as view:
        view.doing(None, "two nodes")
        view.doing(task, "opening")
        view.done(FinishedTask(task, None, "crashed over \x1b[2J\x07evil"))
    said = stream.getvalue()
    assert "two nodes" in said
    assert "cloth_D1_01      could not be done: crashed over \ufffd[2J\ufffdevil" in said
    assert "\x1b[2J" not in said
    assert "\x07" not in said


def test_log_tells_the_steps_of_each_scene(tmp_path: Path) -> None:
    stream = io.StringIO()
    task = SceneTask(spec_of(SCENE), FolderSystem(INFO, tmp_path), tmp_path)
    with SweepView(stream, 1) as view:
        view.doing(task, "taking frames")
        view.done(FinishedTask(task, None, "crashed"))
    assert stream.getvalue().splitlines() == [
        "cloth_D1_01      taking frames …",
        "[1/1] cloth_D1_01      could not be done: crashed",
    ]


def test_survives_a_closed_log_reader(tmp_path: Path) -> None:
    class Gone(io.StringIO):
        def write(self, text: str) -> int:
            raise BrokenPipeError

    view = SweepView(Gone(), 1)
    view.done(
        FinishedTask(SceneTask(spec_of(SCENE), FolderSystem(INFO, tmp_path), tmp_path), None, "crashed")
    )
