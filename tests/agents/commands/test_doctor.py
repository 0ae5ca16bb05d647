"""``simworlds doctor``: what it finds on this machine, on a broken one, and how it says so."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from live_session import LiveSession
from places import REPO
from running import run_here
from sandboxes import skip_unless_it_works
from whole import by_turns

from agents.commands import doctor_checks
from simworlds.installed import installed_bpy
from simworlds.own_command import own_command
from simworlds.sandbox.confinement import confine_self
from simworlds.sandbox.confinement.confined_command import Sandbox, best_sandbox, bubblewrap_fault
from simworlds.sandbox.confinement.walls import WALLS, WITHOUT, Wall
from simworlds.sandbox.runtime import Runtime

pytestmark = pytest.mark.blender

DEBIANS = Path("/usr/bin/blender")


def surroundings(home: Path) -> dict[str, str]:
    """A home and a folder for temporary files, nothing of the user's own."""
    kept = {name: value for name, value in os.environ.items() if name != "BLENDER_EXE"}
    place = home / "temporary"
    place.mkdir(exist_ok=True)
    return {**kept, "SIMWORLDS_HOME": str(home / "home"), "TMPDIR": str(place), "COLUMNS": "80"}


def run(*words: str, home: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """What it says in this process."""
    done = run_here(["doctor", *words], surroundings(home) | environment, home)
    return subprocess.CompletedProcess(done.args, done.returncode, done.stdout.decode(), done.stderr.decode())


def run_in_a_process(*words: str, home: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "simworlds", "doctor", *words],
        env=surroundings(home),
        capture_output=True,
        text=True,
        timeout=200,
        check=False,
    )


def test_a_place_for_runs_that_cannot_be_written_to_is_bad(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SIMWORLDS_HOME", "/proc/nothing")
    *_, (_, room) = doctor_checks.checks(doctor_checks.BlenderChoice(blender_exe=Path("/nowhere/blender")))
    found = room()
    assert (found.name, found.state) == ("Room", "bad")
    assert "/proc cannot be written to" in found.text
    assert "SIMWORLDS_HOME" in found.advice


def findings(done: subprocess.CompletedProcess[str]) -> dict[str, dict[str, Any]]:
    return {finding["name"]: finding for finding in json.loads(done.stdout)["findings"]}


@pytest.fixture(scope="module")
def here(tmp_path_factory: pytest.TempPathFactory) -> subprocess.CompletedProcess[str]:
    """What it says of this machine, as JSON."""
    home = tmp_path_factory.mktemp("doctor")
    done = run_in_a_process("--json", home=home)
    assert list((home / "temporary").iterdir()) == []
    return done


def test_this_machine_is_found_to_work(here: subprocess.CompletedProcess[str]) -> None:
    assert here.returncode == 0, here.stderr
    assert here.stderr == ""
    told = json.loads(here.stdout)
    assert told["works"] is True
    found = findings(here)
    assert list(found) == [
        "Blender",
        "Start",
        "Sandbox",
        "Workbench",
        "Cycles",
        "Films",
        "Fluids",
        "Knowledge",
        "Attach",
        "Room",
    ]
    assert found["Blender"]["data"]["version"] == installed_bpy()
    assert found["Blender"]["data"]["kind"] == "environment"
    assert 0.05 < found["Start"]["data"]["seconds"] < 60
    assert found["Cycles"]["state"] == "good", found["Cycles"]
    assert 0 < found["Cycles"]["data"]["seconds"] < 60
    assert found["Films"]["data"]["supported"] is True
    assert (found["Fluids"]["state"], found["Fluids"]["data"]["fault"]) == ("good", None)
    assert (found["Knowledge"]["state"], found["Knowledge"]["data"]["built"]) == ("poor", [])
    assert found["Knowledge"]["advice"].startswith(f"{own_command()} kb build")
    assert found["Room"]["data"]["free"] > 0
    drawn = found["Workbench"]["data"]
    assert drawn["fault"] or drawn["seconds"] > 0


def test_the_sandbox_is_the_one_that_works_here(here: subprocess.CompletedProcess[str]) -> None:
    found = findings(here)["Sandbox"]
    assert found["data"]["kind"] == best_sandbox().kind
    assert found["keeps"] == list(best_sandbox().holds)
    if found["data"]["kind"] == "landlock":
        assert "bubblewrap" in found["advice"]
    if found["data"]["kind"] == "bubblewrap":
        assert bubblewrap_fault() is None
        assert found["advice"] == ""


def test_a_page_for_people_fits_a_terminal_and_ends_with_a_verdict(tmp_path: Path) -> None:
    done = run("--sandbox", "none", home=tmp_path)
    assert done.returncode == 0
    lines = done.stdout.splitlines()
    assert max(map(len, lines)) <= 80
    assert all(line == line.rstrip() for line in lines)
    assert lines[0].startswith("✓  Blender    ")
    assert "!  Sandbox    none: code in Blender can read and write your files" in done.stdout
    assert "- does not prevent: reading and writing any file that you can" in done.stdout
    assert f"→ {own_command()} kb build" in " ".join(done.stdout.split())
    assert re.search(
        r"^✓  Blender can work here, but check: Sandbox.*Knowledge\.$", done.stdout, re.MULTILINE
    )


def test_wrong_executable_exits_with_1(tmp_path: Path) -> None:
    done = run("--blender-exe", "/bin/true", home=tmp_path, COLUMNS="200")
    assert done.returncode == 1
    assert "✗  Blender    No Blender was found: /bin/true is not Blender" in done.stdout
    assert "✗  Blender cannot work here." in done.stdout
    named = run("--json", home=tmp_path, BLENDER_EXE=str(tmp_path))
    assert (named.returncode, json.loads(named.stdout)["works"]) == (1, False)
    assert list(findings(named)) == ["Blender", "Knowledge", "Attach", "Room"]
    unknown = run("--json", "--blender", "4.9", home=tmp_path)
    assert unknown.returncode == 1
    assert "there is no bpy package for Blender 4.9" in findings(unknown)["Blender"]["text"]
    assert "kb build 4.9 --blender-exe /path/to/blender" in findings(unknown)["Knowledge"]["advice"]
    nonsense = run("--blender", "five", home=tmp_path)
    assert (nonsense.returncode, nonsense.stdout) == (2, "")
    assert "'five' is not a Blender version" in nonsense.stderr


def test_missing_libraries_are_named_with_their_packages(tmp_path: Path) -> None:
    """A program that says of itself what a Blender says whose libraries are not there."""
    fake = tmp_path / "fake" / "blender"
    fake.parent.mkdir()
    fake.write_text(
        '#!/bin/sh\n[ "$1" = --version ] && echo "Blender 5.1.9" && exit\n'
        "echo 'blender: error while loading shared libraries: libSM.so.6: cannot open shared object file' >&2\n"
        "exit 127\n"
    )
    fake.chmod(0o755)
    done = run("--json", "--blender-exe", str(fake), home=tmp_path)
    assert done.returncode == 1
    start = findings(done)["Start"]
    assert start["text"] == "system libraries are missing: libSM.so.6"
    assert start["advice"] == "apt-get install libsm6"
    assert start["data"] == {"missing": ["libSM.so.6"], "packages": ["libsm6"]}


def test_all_missing_libraries_are_listed_not_just_the_first(tmp_path: Path) -> None:
    compiler = shutil.which("cc")
    if compiler is None or shutil.which("ldd") is None:
        pytest.skip("no compiler to make a program with that lacks libraries")
    (tmp_path / "main.c").write_text("int one(void); int two(void); int main(void) { return one() + two(); }")
    for name in ("one", "two"):
        (tmp_path / f"{name}.c").write_text(f"int {name}(void) {{ return 0; }}")
        subprocess.run([compiler, "-shared", "-o", f"lib{name}.so.7", f"{name}.c"], cwd=tmp_path, check=True)
    subprocess.run(
        [compiler, "-o", "blender", "main.c", "./libone.so.7", "./libtwo.so.7"], cwd=tmp_path, check=True
    )
    for name in ("one", "two"):
        (tmp_path / f"lib{name}.so.7").unlink()
    runtime = Runtime(tmp_path / "blender", "executable", "5.1.9")
    assert doctor_checks.missing_libraries(runtime, "libother.so.1: cannot open shared object file") == [
        "libone.so.7",
        "libtwo.so.7",
    ]


def test_the_packages_are_those_that_the_readme_installs() -> None:
    listed = (REPO / ".ci" / "debian-packages").read_text().split()
    assert set(listed) <= set(doctor_checks.PACKAGES.values())


def test_detects_a_sandbox_that_does_not_hold(tmp_path: Path) -> None:
    """Here, one that only limits amounts passes itself off as one that closes files."""
    skip_unless_it_works("landlock")
    open_one, told = best_sandbox("none"), best_sandbox("landlock")
    session = LiveSession(tmp_path / "run", sandbox=Sandbox("none", told.holds, told.lacks, open_one.limits))
    try:
        found = doctor_checks._confined(session.blender, told, None)
    finally:
        session.blender.close()
    assert found.state == "bad"
    assert found.lacks[0] == "reading and writing any file that you can"
    assert WITHOUT["attributes"] in found.lacks
    assert WITHOUT["sockets"] not in found.lacks
    assert confine_self.has_seccomp()
    assert not list(Path.home().glob(".simworlds-doctor-*"))


@pytest.mark.parametrize(
    "wall",
    by_turns(
        [
            "files",
            "capabilities",
            "namespaces",
            "sockets",
            "processes",
            "signals",
            "memfd",
            "kernel",
            "limits",
        ],
        3,
    ),
)
def test_names_the_wall_that_is_down(tmp_path: Path, wall: Wall) -> None:
    skip_unless_it_works("bubblewrap")
    whole = best_sandbox("bubblewrap")
    # Root that becomes another user can do less by that alone.
    without: frozenset[Wall] = frozenset({wall, "uid"})
    session = LiveSession(tmp_path / "run", sandbox=best_sandbox("bubblewrap", without=without))
    try:
        found = doctor_checks._confined(session.blender, whole, None)
    finally:
        session.blender.close()
    assert found.state == "bad"
    assert WITHOUT[wall] in found.lacks


def test_tries_every_wall_but_those_that_only_show_from_outside(
    here: subprocess.CompletedProcess[str],
) -> None:
    tried = findings(here)["Sandbox"]["data"]["tried"]
    assert set(WALLS) - set(tried) == {"memory", "disk"}


def test_a_damaged_knowledge_base_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SIMWORLDS_HOME", str(tmp_path))
    base = tmp_path / "kb" / "blender-5.1.sqlite"
    base.parent.mkdir()
    base.write_bytes(b"not a database")
    own = Runtime(Path("/opt/blender"), "executable", "5.1.2")
    for runtime, text in ((None, "no base"), (own, "no base for Blender 5.1")):
        found = doctor_checks._knowledge(None, runtime)
        assert (found.state, found.text) == ("poor", f"{text}; not readable: {base}")


def test_a_knowledge_base_that_is_there_is_found(base: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SIMWORLDS_HOME", str(base.parent.parent))
    found = doctor_checks._knowledge(installed_bpy(), None)
    assert found.state == "good"
    assert found.place == str(base)
    assert doctor_checks._knowledge(None, None) == found  # no Blender was found, none was asked for
    own = Runtime(Path("/opt/my blender/blender"), "executable", "3.4.1")
    other = doctor_checks._knowledge(None, own)
    assert other.state == "poor"
    assert other.advice == f"{own_command()} kb build 3.4 --blender-exe '/opt/my blender/blender'"
    assert other.text == f"no base for Blender 3.4, only for {found.data['wanted']}"
    assert doctor_checks._knowledge("4.3", None).advice == f"{own_command()} kb build 4.3"
    assert "No base can be built of Blender 2.79" in doctor_checks._knowledge("2.79", None).advice


def test_checks_an_installed_blender(tmp_path: Path) -> None:
    if not DEBIANS.exists():
        pytest.skip(f"there is no {DEBIANS}")
    done = run("--json", home=tmp_path, BLENDER_EXE=str(DEBIANS))
    assert done.returncode == 0, done.stdout
    found = findings(done)
    assert found["Blender"]["data"]["kind"] == "executable"
    assert found["Start"]["state"] == found["Sandbox"]["state"] == "good"
    assert found["Cycles"]["state"] == "good", found["Cycles"]
    assert found["Fluids"]["state"] == "good"


def test_stopping_the_checks_ends_blender(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    each = doctor_checks.checks(doctor_checks.BlenderChoice())
    for _, check in each:
        if check().name == "Start":
            break
    assert [path.name[:16] for path in tmp_path.iterdir()] == ["simworlds-doctor"]
    each.close()
    assert list(tmp_path.iterdir()) == []
    monkeypatch.setattr("tempfile.tempdir", None)


def test_nothing_is_installed_unasked(tmp_path: Path) -> None:
    done = run("--json", "--blender", "4.2.0", home=tmp_path)
    assert done.returncode == 1
    found = findings(done)["Blender"]
    assert found["text"] == "Blender 4.2.0 is not installed."
    assert "doctor --blender 4.2.0 --install gets it (about 350 MB)" in found["advice"]
    assert not (tmp_path / "home" / "runtimes").exists()
