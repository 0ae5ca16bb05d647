"""Every command that shows what files, pages, plans or runs say: nothing of that steers the terminal it is shown on."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from hostile_text import HOSTILE, on_terminal, steering
from places import REPO
from running import run_here
from sample_runs import Tape, write
from whole import IS_WHOLE

from simworlds.installed import installed_bpy
from simworlds.sandbox.runtime import clean_environment

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from built_base import Built

pytestmark = pytest.mark.blender

NAME = HOSTILE.replace("/", "").replace("\\", "")  # of a file
COMMAND = [sys.executable, "-m", "simworlds"]
SPEC = f"""
id: cloth_D1_99
category: cloth
level: D1
prompt: A checked tablecloth drapes over a small table in a quiet dining room at noon.
frames: {{min: 12}}
actors:
  - name: {json.dumps(HOSTILE[:4] + "l")}
    role: cloth
    must_have: [renderable, cloth_modifier, cloth_cache_baked]
"""
_MAKE = """
import sys, bpy
folder, hostile, name = sys.argv[1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
for number in range(2):
    bpy.ops.mesh.primitive_cube_add(location=(0, 0, 0.5 * number))
    made = bpy.context.object
    made.name = made.data.name = f"{number}{hostile}"
    made["contact_with"] = [hostile]
    made.modifiers.new(hostile, "CLOTH")
bpy.context.scene.name = hostile
bpy.ops.wm.save_as_mainfile(filepath=f"{folder}/{name}.blend")
bpy.context.preferences.filepaths.file_preview_type = "NONE"
scene = bpy.data.scenes.new(hostile)
heavy = bpy.data.objects.new(hostile, made.data)
scene.collection.objects.link(heavy)
heavy.modifiers.new(hostile, "ARRAY").count = 10**9
bpy.data.libraries.write(f"{folder}/{name}-heavy.blend", {scene})
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A scene, one that is too heavy, a plan, a spec and a run, all of them hostile in every name that they have."""
    if installed_bpy() is None:
        pytest.skip("there is no Blender in this environment")
    folder = tmp_path_factory.mktemp("hostile")
    done = subprocess.run(
        [sys.executable, "-P", "-c", _MAKE, str(folder), HOSTILE, NAME],
        env=clean_environment(folder / "settings"),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    (folder / "plan.json").write_text(
        json.dumps({"title": HOSTILE, HOSTILE: [HOSTILE], "objects": [HOSTILE]})
    )
    (folder / "cloth_D1_99.yaml").write_text(SPEC)
    tape = Tape()
    tape.began(HOSTILE, models={"planner": HOSTILE, "coder": HOSTILE}, source=HOSTILE)
    tape.simple_stage("modeling")
    tape.ended("failed", HOSTILE)
    for run in (folder / "home" / "runs" / NAME, folder / "run"):
        run.mkdir(parents=True)
        write(tape, run)
    (folder / "home" / "runs" / f"{NAME}-broken").mkdir()
    (folder / "home" / "runs" / f"{NAME}-broken" / "journal.jsonl").write_text(
        f'{{"type": "{NAME}"}}\n{HOSTILE}'
    )
    return folder


def environment(place: Path, **more: str) -> Mapping[str, str]:
    # With a key for a model at an address where nobody listens: a run begins, and says what it works on.
    given = {"ANTHROPIC_API_KEY": "any", "ANTHROPIC_BASE_URL": "http://127.0.0.1:9"}
    home = str(place / "home")
    return {**os.environ, **given, "PYTHONPATH": str(REPO), "SIMWORLDS_HOME": home, **more}


WORDS = {
    "verify": ("verify", "BLEND"),
    "verify-json": ("verify", "BLEND", "--json"),
    "verify-sarif": ("verify", "BLEND", "--sarif"),
    "verify-plan": ("verify", "BLEND", "--plan", "PLAN"),
    "verify-heavy": ("verify", "HEAVY"),
    "verify-none": ("verify", "NONE"),
    "audit": ("bench", "audit", "BLEND", "--scene", "SPEC"),
    "audit-json": ("bench", "audit", "BLEND", "--scene", "SPEC", "--json"),
    "audit-heavy": ("bench", "audit", "HEAVY", "--scene", "SPEC"),
    "runs": ("runs",),
    "show": ("show", "RUN"),
    "show-broken": ("show", "BROKEN"),
    "resume": ("resume", "RUN"),
    "replay": ("replay", "BROKEN"),
    "edit": ("edit", "BLEND", HOSTILE),
    "make": ("make", HOSTILE, "--run", "RUN"),
    "report": ("bench", "report", "RUN"),
    "scenes": ("bench", "show", HOSTILE),
    "kb": ("kb", "info", HOSTILE),
}


def words_of(place: Path, name: str) -> list[str]:
    paths = {
        "BLEND": place / f"{NAME}.blend",
        "HEAVY": place / f"{NAME}-heavy.blend",
        "NONE": place / NAME / "none.blend",
        "PLAN": place / "plan.json",
        "SPEC": place / "cloth_D1_99.yaml",
        "RUN": place / "home" / "runs" / NAME,
        "BROKEN": place / "home" / "runs" / f"{NAME}-broken",
    }
    return [str(paths.get(word, word)) for word in WORDS[name]]


# For programs, which read no terminal.
FOR_PROGRAMS = {"verify-json", "verify-sarif", "audit-json"}
# Drawn on a terminal only: what makes their text plain for a file is tried with the others.
ALIKE = {"verify-plan", "verify-heavy", "verify-none", "audit-heavy", "show-broken", "replay", "scenes", "kb"}
# What of those that are tried in both ways draws most: a table, a list, lines as a run goes on.
DRAWN = {"verify", "runs", "edit"}
ON_TERMINAL = [
    pytest.param(name, marks=() if name in ALIKE | DRAWN else pytest.mark.whole)
    for name in WORDS
    if name not in FOR_PROGRAMS
]


# "edit" takes longest, and is drawn on a terminal; how text is made plain for a file is tried with the others.
PRINTED_WHOLE = {"verify-json", "audit-json", "edit"}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.whole if name in PRINTED_WHOLE else ())
        for name in WORDS
        if name not in ALIKE
    ],
)
def test_what_a_command_prints_steers_nothing(name: str, place: Path) -> None:
    done = run_here(words_of(place, name), environment(place), place)
    printed = (done.stdout + done.stderr).decode()
    assert "evil" in printed, printed
    assert "Traceback" not in printed
    assert steering(printed) == []


# All of them one after the other on one terminal: what takes long of a command is its start.
_MARK = "=== The command: "
_EACH = f"""
import json, sys, traceback
from simworlds.cli import main
for name, words in json.loads(sys.argv[1]).items():
    print({_MARK!r} + name, flush=True)
    try:
        main(words, prog_name="simworlds")
    except SystemExit:
        pass
    except BaseException:
        traceback.print_exc()
"""


@pytest.fixture(scope="module")
def drawn(place: Path) -> dict[str, str]:
    """What each command draws."""
    names = [name for name in WORDS if name in ALIKE | DRAWN or (IS_WHOLE and name not in FOR_PROGRAMS)]
    words = {name: words_of(place, name) for name in names}
    printed = on_terminal([sys.executable, "-c", _EACH, json.dumps(words)], environment(place))
    parts = printed.split(_MARK)[1:]
    assert len(parts) == len(names), printed
    return dict(zip(names, parts, strict=True))


@pytest.mark.parametrize("name", ON_TERMINAL)
def test_what_a_command_draws_on_a_terminal_steers_nothing(name: str, drawn: dict[str, str]) -> None:
    printed = drawn[name]
    assert "evil" in printed, printed
    assert "Traceback" not in printed
    assert steering(printed, is_terminal=True) == []


def test_pages_steer_nothing(place: Path, small: Built) -> None:
    """A base is built from hostile pages, asked, inspected and checked."""
    manual = small.corpora / f"manual-{small.minor}-rst"
    (manual / f"{NAME}.rst").write_text(f"{HOSTILE}\n{'=' * 90}\n\nCloth {HOSTILE}\n\n:ref:`{HOSTILE}`\n")
    index = manual / "index.rst"
    index.write_text(f"{index.read_text()}\n\n{HOSTILE} `page <evil:{HOSTILE}>`__\n")
    given = environment(place, SIMWORLDS_HOME=str(small.home), SIMWORLDS_CORPORA=str(small.corpora))
    for words in (
        ("kb", "build", "--offline"),
        ("docs", "evil"),
        ("docs", "evil live", "--json"),
        ("kb", "info"),
    ):
        done = run_here(words, given, place)
        printed = (done.stdout + done.stderr).decode()
        assert done.returncode in (0, 1), printed
        assert words[1] != "build" or "Built the knowledge base" in printed
        assert steering(printed) == []
    printed = on_terminal([*COMMAND, "docs", "evil"], given)
    assert "evil" in printed
    assert steering(printed, is_terminal=True) == []
