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
from bench.validity.mutations.catalogue import MUTATIONS
from bench.validity.proof import Proof, ProofRow
from bench.validity.report import as_markdown
from bench.validity.run import ProofTask, prove, prove_all, subset
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
        (("--properties", "fair,square"), "square: the properties are satisfiable, counterfeits"),
        (("--jobs", "0"), "0 is not in the range"),
    ],
)
def test_refuses_an_unknown_name_before_it_does_anything(
    arguments: tuple[str, ...], said: str, home: Path
) -> None:
    result = run(*arguments)
    assert result.exit_code == 2
    assert said in result.output
    assert not home.exists()


def test_every_predicate_has_a_mutation_for_every_role_that_specs_ask_it_of() -> None:
    assert MUTATIONS.keys() == PREDICATES.keys()
    for spec in specs():
        for actor in spec.actors:
            for check in actor.must_have:
                ways = [way for way in MUTATIONS[check.predicate] if not way.roles or actor.role in way.roles]
                assert ways or actor.role in ("static", "keyframed"), (
                    f"{spec.id}: {actor.name}: {check.predicate}"
                )


# What is kept


@pytest.mark.blender
def test_a_proof_is_kept_until_its_scene_changes(home: Path, small_scenes: Path, tmp_path: Path) -> None:
    blend = tmp_path / "scene" / "room.blend"
    blend.parent.mkdir()
    blend.write_bytes((small_scenes / "room.blend").read_bytes())
    task = ProofTask(spec_like(ROOM), ("satisfiable",), blend=blend)
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
def test_proves_scenes_in_parallel_and_reports_those_that_cannot_be_opened(
    home: Path, small_scenes: Path, tmp_path: Path
) -> None:
    (tmp_path / "broken.blend").write_bytes(b"BLENDER half of it")
    tasks = [
        ProofTask(spec_like(DRAPE), ("satisfiable",), blend=small_scenes / "drape.blend"),
        ProofTask(spec_like(POUR), ("satisfiable",), blend=small_scenes / "pour.blend"),
        ProofTask(spec_like(ROOM), ("invariance",), blend=tmp_path / "broken.blend"),
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
def test_builds_proves_reports_and_sets_the_exit_code(
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
    assert "could not be tested" in unable.output


@pytest.mark.blender
def test_an_interrupt_ends_all_and_keeps_proofs(home: Path, tmp_path: Path) -> None:
    place = tmp_path / "tmp"
    place.mkdir()
    arguments = ["--scenes", f"{STATIC},cloth_D2_03", "--properties", "satisfiable", "--jobs", "2"]
    command = [
        sys.executable,
        "-m",
        "simworlds",
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
    assert "Interrupted. Proofs are kept" in rest
    assert "Traceback" not in rest
    assert not list(place.glob("simworlds-*"))
    assert [path.name for path in home.rglob("*.json")] == [f"{STATIC}-satisfiable.json"]
    assert [path.name.partition("-")[0] for path in (home / "references").iterdir()] == [STATIC]


# The report


def test_the_report_lists_failures_and_what_could_not_be_tested() -> None:
    proofs = [
        Proof(
            scene="a",
            about="counterfeits",
            rows=(ProofRow(name="keys", holds=False, why="the audit does not tell it from the scene"),),
        ),
        Proof(scene="b", about="counterfeits", unable="Blender crashed"),
        Proof(
            scene="c",
            about="invariance",
            rows=(ProofRow(name="joined", holds=None, why="nothing in it can be joined"),),
        ),
    ]
    text = as_markdown(proofs)
    assert "| It rejects counterfeits | 0 of 2 | 1 | 0 |" in text
    assert "| Invariant | 0 of 0 | 0 | 0 |" in text
    assert "- a, counterfeits, keys: the audit does not tell it from the scene\n" in text
    assert "- b, counterfeits: could not be tested: Blender crashed\n" in text
    assert as_markdown(proofs) == text
