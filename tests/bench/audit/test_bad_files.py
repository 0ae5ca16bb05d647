"""Files that mean harm or are broken: scored where that is possible, else not scored and why; never executed."""

from __future__ import annotations

import json
import shutil
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner
from in_blender import HERE, run

from bench.audit import untrusted_blend
from bench.audit.audit import Audit, audit, open_scene
from bench.audit.untrusted_blend import GIB, BlenderOptions
from bench.scenes.spec import read_spec
from simworlds.cli import main
from simworlds.sandbox.program import Program

if TYPE_CHECKING:
    from pathlib import Path

    from bench.audit.facts import Object, Scene
    from bench.scenes.spec import Spec

pytestmark = pytest.mark.blender

SPEC = """
id: cloth_D1_99
category: cloth
level: D1
prompt: A checked tablecloth drapes over a small table in a quiet dining room at noon.
frames: {min: 12}
actors:
  - name: tablecloth
    role: cloth
    must_have: [renderable, cloth_modifier, cloth_cache_baked]
  - {name: table, role: static, must_have: [renderable]}
"""


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("bad")
    run("bad_files.py", place)
    return place


@pytest.fixture(scope="module")
def spec_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("spec") / "cloth_D1_99.yaml"
    path.write_text(SPEC)
    return path


@pytest.fixture(scope="module")
def spec(spec_file: Path) -> Spec:
    return read_spec(spec_file)


def state(folder: Path) -> dict[str, tuple[int, int]]:
    found = [path for path in folder.rglob("*") if "settings" not in path.parts]
    return {str(path): (path.stat().st_mtime_ns, path.stat().st_size) for path in found}


def audited(name: str, files: Path, spec: Spec, means: BlenderOptions | None = None) -> Audit:
    """The audit of a file; nothing beside it is written, and nothing in it executed."""
    before = state(files)
    found = audit(files / f"{name}.blend", spec, means)
    assert state(files) == before
    assert not (files / "executed").exists()
    return found


def outcomes(found: Audit) -> dict[str, str]:
    assert found.not_scored is None
    return {
        f"{actor.name}: {check.predicate}": check.outcome for actor in found.actors for check in actor.checks
    }


def scene_of(path: Path) -> Scene:
    with open_scene(path, None, lambda _: None) as (_, scene):
        return scene


def named(scene: Scene, name: str) -> Object:
    return next(one for one in scene.objects if one.name == name)


# Scored all the same


def test_a_file_without_a_camera_is_scored_and_the_same_on_every_run(files: Path, spec: Spec) -> None:
    first, second = audited("good", files, spec), audited("good", files, spec)
    assert (first.mpr, first.blend["camera"]) == (1.0, None)
    assert first.as_json() == second.as_json()
    assert json.loads(first.as_json())["mpr"] == 1.0


@pytest.mark.parametrize(
    ("name", "told"), [("script_on_load", "text start.py"), ("python_driver", "driver of Table")]
)
def test_scripts_are_reported_and_not_run(name: str, told: str, files: Path, spec: Spec) -> None:
    found = audited(name, files, spec)
    assert (found.mpr, found.blend["scripts_not_run"]) == (1.0, [told])


def test_a_bake_outside_the_clip_does_not_count(files: Path, spec: Spec) -> None:
    found = outcomes(audited("other_frames", files, spec))
    assert found["tablecloth: cloth_cache_baked"] == "failed"
    assert found["tablecloth: cloth_modifier"] == "passed"


def test_unbaked_physics_is_reported_and_read_at_the_start(files: Path, spec: Spec) -> None:
    assert audited("unbaked", files, spec).blend["unplayed"] == "unbaked: cloth of Tablecloth"
    scene = scene_of(files / "unbaked.blend")
    assert [len(named(scene, name).moments) for name in ("Tablecloth", "Table")] == [1, 3]


def test_a_missing_library_is_reported_and_the_rest_is_scored(files: Path, spec: Spec) -> None:
    found = audited("missing_library", files, spec)
    assert found.blend["missing_libraries"] == ["//library.blend"]
    assert outcomes(found)["tablecloth: cloth_cache_baked"] == "passed"


def test_of_a_million_instances_only_some_are_read(files: Path, spec: Spec) -> None:
    assert audited("many_instances", files, spec).mpr == 1.0


def test_a_cache_on_disk_counts_while_its_files_are_there(files: Path, spec: Spec, tmp_path: Path) -> None:
    assert outcomes(audited("on_disk", files, spec))["tablecloth: cloth_cache_baked"] == "passed"
    shutil.copy(files / "on_disk.blend", tmp_path)
    assert outcomes(audited("on_disk", tmp_path, spec))["tablecloth: cloth_cache_baked"] == "failed"


def test_a_fluid_plays_from_a_cache_that_moved_with_the_file(files: Path) -> None:
    before = state(files)
    here, moved = scene_of(files / "fluid.blend"), scene_of(files / "moved" / "fluid.blend")
    assert state(files) == before
    assert named(here, "Water").moments == named(moved, "Water").moments
    assert named(moved, "Water").moments[0] != named(moved, "Water").moments[2]
    domains = [named(scene, "Water").of_type("FLUID")[0].fluid for scene in (here, moved)]
    assert [each.domain.cache.moved for each in domains if each and each.domain] == [False, True]


def test_a_fluid_without_its_files_is_not_baked_whatever_the_file_says(files: Path, tmp_path: Path) -> None:
    shutil.copy(files / "fluid.blend", tmp_path)
    scene = scene_of(tmp_path / "fluid.blend")
    domain = named(scene, "Water").of_type("FLUID")[0].fluid
    assert domain is not None
    assert domain.domain is not None
    assert "data" in domain.domain.cache.baked
    assert domain.domain.cache.parts == ()
    assert scene.unplayed == "unbaked: fluid of Water"
    assert list(tmp_path.iterdir()) == [tmp_path / "fluid.blend"]


# Not scored


def test_half_of_a_file_is_not_scored(files: Path, spec: Spec, tmp_path: Path) -> None:
    whole = (files / "good.blend").read_bytes()
    (tmp_path / "half.blend").write_bytes(whole[: len(whole) // 2])
    found = audited("half", tmp_path, spec)
    assert "half.blend cannot be opened" in (found.not_scored or "")
    assert (found.mpr, found.actors) == (None, ())


@pytest.mark.parametrize(
    ("content", "said"), [(None, "no such file"), (b"", "it is empty"), (b"PK\x03\x04 a zip", "not a .blend")]
)
def test_a_file_that_is_not_a_blend_is_not_scored(
    content: bytes | None, said: str, spec: Spec, tmp_path: Path
) -> None:
    path = tmp_path / "scene.blend"
    if content is not None:
        path.write_bytes(content)
    assert said in (audit(path, spec).not_scored or "")


def test_a_file_of_a_newer_blender_is_not_scored_and_names_it(
    files: Path, spec: Spec, tmp_path: Path
) -> None:
    data = (files / "good.blend").read_bytes()
    assert data.startswith(b"BLENDER17-01v0501")
    (tmp_path / "newer.blend").write_bytes(data.replace(b"BLENDER17-01v0501", b"BLENDER17-01v0905", 1))
    found = audited("newer", tmp_path, spec)
    assert "Blender 9.5" in (found.not_scored or "")


def test_a_file_that_needs_too_much_memory_is_not_scored(files: Path, spec: Spec) -> None:
    found = audited("heavy", files, spec, BlenderOptions(memory=GIB // 2))
    said = "Blender ended while reading it: it ran out of memory; the limit is 0.5 GB"
    assert (found.not_scored or "").startswith(said)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("crash", "ended while opening it: it crashed (SIGSEGV)"),
        ("hang", "still opening it after its time limit of 3 s"),
        ("garbage", "not valid"),
        ("other", "not valid"),
        ("long", "not valid"),
        ("senseless", "Blender's facts of it were not valid"),
        ("playing", "it was asked without playing"),
        ("ends", "ended while opening it: it was ended from inside, with exit code 3"),
    ],
)
def test_a_file_over_which_blender_misbehaves_is_not_scored(
    name: str, said: str, files: Path, spec: Spec, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copy(files / "good.blend", tmp_path / f"{name}.blend")
    packages = {**untrusted_blend.AUDITOR.packages, "bad": HERE}
    monkeypatch.setattr(untrusted_blend, "AUDITOR", Program("bad.bad_entry", packages))
    assert said in (audit(tmp_path / f"{name}.blend", spec, BlenderOptions(seconds=3)).not_scored or "")


# The command


def test_the_command_prints_checks_and_scores(files: Path, spec_file: Path) -> None:
    done = CliRunner().invoke(main, ["bench", "audit", str(files / "good.blend"), "--scene", str(spec_file)])
    assert done.exit_code == 0
    assert "✓ cloth_cache_baked" in done.output
    assert "MPR 1.000" in done.output


def test_the_command_says_why_a_file_is_not_scored(spec_file: Path, tmp_path: Path) -> None:
    words = ["bench", "audit", str(tmp_path / "none.blend"), "--scene", str(spec_file), "--json"]
    done = CliRunner().invoke(main, words)
    assert done.exit_code == 2
    assert json.loads(done.stdout)["not_scored"] == "there is no such file"


def test_an_unknown_scene_is_an_error_with_suggestions(files: Path) -> None:
    done = CliRunner().invoke(main, ["bench", "audit", str(files / "good.blend"), "--scene", "cloth_D1_1"])
    assert done.exit_code == 2
    assert "Did you mean cloth_D1_01" in done.stderr
