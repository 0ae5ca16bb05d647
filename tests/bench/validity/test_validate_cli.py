"""``simworlds bench validate``: which scenes, what it says and keeps, how it ends."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner
from small_specs import DRAPE, POUR, ROOM, spec_like

from bench.audit.predicates.catalogue import PREDICATES
from bench.audit.predicates.predicate import PredicateVerdict
from bench.scenes.spec import specs
from bench.validity.mutations.catalogue import SABOTAGES
from bench.validity.proof import Proof, Row
from bench.validity.report import as_markdown
from bench.validity.run import Task, prove, prove_all, subset
from simworlds.cli import main

if TYPE_CHECKING:
    from pathlib import Path

    from click.testing import Result

    from bench.audit.predicates.predicate import AuditContext, PredicateParams, Unit

QUICK = ("satisfiable", "deterministic")
STATIC = "static_D1_01"


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SIMWORLDS_HOME", str(tmp_path / "home"))
    return tmp_path / "home"


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, ["bench", "validate", *arguments])


# Which scenes, which properties


def test_the_subset_has_one_scene_of_each_cell() -> None:
    chosen = subset()
    assert len(chosen) == 17
    assert {spec.cell for spec in chosen} == {spec.cell for spec in specs()}


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--scenes", "cloth_D9_01"), "There is no scene 'cloth_D9_01'"),
        (("--properties", "fair,square"), "square: there are satisfiable, twins"),
        (("--jobs", "0"), "0 is not in the range"),
    ],
)
def test_a_name_that_is_none_is_refused_before_anything_is_done(
    arguments: tuple[str, ...], said: str, home: Path
) -> None:
    result = run(*arguments)
    assert result.exit_code == 2
    assert said in result.output
    assert not home.exists()


def test_every_predicate_has_a_sabotage_for_every_role_that_a_spec_asks_it_of() -> None:
    assert SABOTAGES.keys() == PREDICATES.keys()
    for spec in specs():
        for actor in spec.actors:
            for check in actor.must_have:
                ways = [one for one in SABOTAGES[check.predicate] if not one.roles or actor.role in one.roles]
                assert ways or actor.role in ("static", "keyframed"), (
                    f"{spec.id}: {actor.name}: {check.predicate}"
                )


# What is kept


@pytest.mark.blender
def test_a_proof_is_kept_until_its_scene_changes(home: Path, small_scenes: Path, tmp_path: Path) -> None:
    blend = tmp_path / "scene" / "room.blend"
    blend.parent.mkdir()
    blend.write_bytes((small_scenes / "room.blend").read_bytes())
    task = Task(spec_like(ROOM), ("satisfiable",), blend=blend)
    first, second = prove(task), prove(task)
    assert (first.kept, second.kept) == (0, 1)
    assert first.proofs == second.proofs
    assert first.proofs[0].holds
    assert [path.name for path in home.rglob("*.json")] == ["static_D1_99-satisfiable.json"]
    assert prove(replace(task, again=True)).kept == 0
    blend.write_bytes((small_scenes / "drape.blend").read_bytes())
    changed = prove(task)
    assert changed.kept == 0
    assert changed.proofs[0].holds is False


@pytest.mark.blender
def test_scenes_are_proven_at_once_and_what_cannot_be_opened_is_told(
    home: Path, small_scenes: Path, tmp_path: Path
) -> None:
    (tmp_path / "broken.blend").write_bytes(b"BLENDER half of it")
    tasks = [
        Task(spec_like(DRAPE), ("satisfiable",), blend=small_scenes / "drape.blend"),
        Task(spec_like(POUR), ("satisfiable",), blend=small_scenes / "pour.blend"),
        Task(spec_like(ROOM), ("fair",), blend=tmp_path / "broken.blend"),
    ]
    found = {done.scene: done.proofs[0] for done in prove_all(tasks, 2)}
    assert found["cloth_D3_99"].holds
    assert found["fluid_D1_99"].holds
    assert "broken" in found["static_D1_99"].unable
    assert [path.name for path in home.rglob("*99*")] == [
        "cloth_D3_99-satisfiable.json",
        "fluid_D1_99-satisfiable.json",
    ]


# How it ends


def never(unit: Unit, stage: AuditContext, params: PredicateParams) -> PredicateVerdict:
    del unit, stage, params
    return PredicateVerdict("failed", {})


@pytest.mark.blender
def test_it_builds_proves_reports_and_tells_by_its_exit_code(
    home: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = ("--scenes", STATIC, "--properties", ",".join(QUICK))
    first = run(*asked, "--output", str(tmp_path / "report"))
    assert first.exit_code == 0, first.output
    assert f"1/1 {STATIC}" in first.output
    told = json.loads((tmp_path / "report" / "validation.json").read_text())
    assert [(each["scene"], each["about"]) for each in told] == [(STATIC, about) for about in QUICK]
    text = (tmp_path / "report" / "validation.md").read_text()
    assert text.endswith("Nothing.\n")
    assert "(kept)" in run(*asked).output
    assert (home / "validation" / "validation.md").read_text() == text
    with monkeypatch.context() as patched:
        patched.setitem(PREDICATES, "renderable", replace(PREDICATES["renderable"], judge=never))
        failed = run("--scenes", STATIC, "--properties", "satisfiable", "--again")
    assert failed.exit_code == 1
    assert "sofa: renderable" in failed.output
    monkeypatch.setenv("SIMWORLDS_HOME", str(tmp_path / "report" / "validation.md"))
    unable = run(*asked, "--output", str(tmp_path / "report"))
    assert unable.exit_code == 2
    assert "not looked into" in unable.output


@pytest.mark.blender
def test_an_interrupt_ends_all_and_keeps_what_was_proven(home: Path, tmp_path: Path) -> None:
    place = tmp_path / "tmp"
    place.mkdir()
    arguments = ["--scenes", f"{STATIC},cloth_D2_03", "--properties", "satisfiable", "--jobs", "2"]
    command = [
        sys.executable,
        "-c",
        "from simworlds.cli import main; main()",
        "bench",
        "validate",
        *arguments,
    ]
    with subprocess.Popen(
        command,
        stderr=subprocess.PIPE,
        env={**os.environ, "TMPDIR": str(place)},
        text=True,
        start_new_session=True,
    ) as process:
        assert process.stderr is not None
        while STATIC not in (line := process.stderr.readline()):
            assert line, "it ended by itself"
        process.send_signal(signal.SIGINT)
        rest = process.stderr.read()
    assert process.returncode == 130
    assert "Interrupted. What was proven is kept" in rest
    assert "Traceback" not in rest
    assert not list(place.glob("simworlds-*"))
    assert [path.name for path in home.rglob("*.json")] == [f"{STATIC}-satisfiable.json"]
    assert [path.name.partition("-")[0] for path in (home / "references").iterdir()] == [STATIC]


# The report


def test_a_report_shows_what_does_not_hold_and_what_could_not_be_looked_into() -> None:
    proofs = [
        Proof(
            scene="a",
            about="twins",
            rows=(Row(name="keys", holds=False, why="it is not told from the scene"),),
        ),
        Proof(scene="b", about="twins", unable="Blender crashed"),
        Proof(
            scene="c", about="fair", rows=(Row(name="joined", holds=None, why="nothing in it can be joined"),)
        ),
    ]
    text = as_markdown(proofs)
    assert "| It sees through fakes | 0 of 2 | 1 | 0 |" in text
    assert "| Fair | 0 of 0 | 0 | 0 |" in text
    assert "- a, twins, keys: it is not told from the scene\n" in text
    assert "- b, twins: could not be looked into: Blender crashed\n" in text
    assert as_markdown(proofs) == text
