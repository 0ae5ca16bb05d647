"""A Blender that is newer than its base: the base is built again, and the old one answers meanwhile."""

from __future__ import annotations

import os
import shutil
import sqlite3
import subprocess
import sys
import threading
import time
from contextlib import closing
from typing import TYPE_CHECKING

import pytest
from running import COMMAND, REPO, Wire, environment

from kb_serve.answer.budget import tokens
from kb_serve.errors import BaseMissing
from kb_serve.in_use import blender_in_use
from simworlds.releases import minor_of

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from built_base import Built

    from kb_serve.answer.docs_answer import DocsAnswer
    from kb_serve.service import Service

    MakeBase = Callable[..., Path]
    ServeFrom = Callable[..., Service]

pytestmark = pytest.mark.skipif(os.name == "nt", reason="executables are shell scripts here")

IN_USE = blender_in_use() or "0.0.0"
MINOR = minor_of(IN_USE)
OLD = f"{MINOR}.0"
WITHOUT_PAGES = {"options": {"pages": False, "summaries": "none"}, "sources": []}
SECONDS = 120.0


def ask(service: Service, blender: str | None = None, **more: int) -> tuple[DocsAnswer, str]:
    arguments = {"limit": 8, "max_tokens": 1500, "part": 1, **more}
    return service.ask("ClothSettings.quality", blender=blender, **arguments)


def stopping_blender(home: Path, version: str, then: str) -> Path:
    """An executable that passes for a Blender until it is asked to do anything."""
    path = home / "blender"
    path.write_text(f'#!/bin/sh\n[ "$1" = --version ] && echo "Blender {version}" && exit 0\n{then}\n')
    path.chmod(0o755)
    return path


def test_what_became_of_another_versions_base_is_not_told_as_this_ones(
    home: Path, make_base: MakeBase, serve_from: ServeFrom
) -> None:
    (home / "kb" / f"blender-{MINOR}.sqlite").unlink(missing_ok=True)
    make_base("3.6.0")
    service = serve_from(home, rebuild=False)
    upkeep = service.upkeep
    before = ask(service)[0].notes
    assert "simworlds kb build" in before[0]
    upkeep._job = upkeep._building("4.5", {})
    for upkeep.state, upkeep.reason in (("running", ""), ("failed", "no space on device")):
        assert ask(service)[0].notes == before


@pytest.fixture
def service(home: Path, serve_from: ServeFrom) -> Service:
    return serve_from(home, rebuild=True)


def test_an_up_to_date_base_is_left_alone(service: Service) -> None:
    before = service.bases.pick().path.stat().st_ino
    service.upkeep.run()
    assert (service.upkeep.state, service.bases.pick().path.stat().st_ino) == ("idle", before)
    assert ask(service)[0].notes == ()


def test_a_blender_of_a_newer_minor_version_gets_a_base_of_its_own(serve_from: ServeFrom, home: Path) -> None:
    blender = stopping_blender(home, "98.1.2", "exit 7")
    service = serve_from(home, blender_exe=blender, rebuild=True)
    assert "98.1.2" in ask(service)[0].notes[0]
    assert ask(service, blender=MINOR)[0].notes == (), "who names a version wants that one"
    service.upkeep.run()
    assert service.upkeep.state == "failed"
    assert "98.1.2" in service.upkeep.reason


def test_an_older_blender_starts_no_rebuild(service: Service, make_base: MakeBase) -> None:
    path = make_base(f"{MINOR}.99")
    before = path.stat().st_ino
    service.upkeep.run()
    assert (service.upkeep.state, path.stat().st_ino) == ("idle", before)
    assert ask(service)[0].notes == ()


def test_without_leave_to_build_the_note_says_how(
    home: Path, make_base: MakeBase, serve_from: ServeFrom
) -> None:
    service = serve_from(home)
    before = make_base(OLD).stat().st_ino
    service.upkeep.run()
    answer, version = ask(service)
    assert version == OLD
    assert f"simworlds kb build {MINOR}" in answer.notes[0]
    assert service.bases.pick().path.stat().st_ino == before


@pytest.mark.parametrize("max_tokens", [150, 160, 250, 400])
def test_the_note_is_within_the_budget(service: Service, make_base: MakeBase, max_tokens: int) -> None:
    make_base(OLD)
    answer, _ = service.ask("bpy.types.Object", blender=None, limit=8, max_tokens=max_tokens, part=1)
    assert IN_USE in answer.notes[0]
    assert tokens(answer.text) <= max_tokens
    last, _ = service.ask("bpy.types.Object", blender=None, limit=8, max_tokens=max_tokens, part=answer.parts)
    assert tokens(last.text) <= max_tokens


def test_a_build_that_fails_is_noted_and_the_old_base_answers_on(
    serve_from: ServeFrom, home: Path, make_base: MakeBase
) -> None:
    make_base(OLD, **WITHOUT_PAGES)
    blender = stopping_blender(home, f"{MINOR}.98", "echo 'no library libfoo' >&2; exit 7")
    service = serve_from(home, blender_exe=blender, rebuild=True)
    service.upkeep.run()
    assert service.upkeep.state == "failed"
    answer, version = ask(service)
    assert version == OLD
    assert "failed" in answer.notes[0]
    assert str(blender) in answer.notes[0]


def test_a_build_under_way_is_ended_with_the_server_and_its_children_too(
    serve_from: ServeFrom, home: Path, make_base: MakeBase
) -> None:
    before = make_base(OLD, **WITHOUT_PAGES).stat().st_ino
    running = home / "running"
    blender = stopping_blender(
        home, f"{MINOR}.98", f"sleep 1; echo $$ > {running}.new; mv {running}.new {running}; sleep 600"
    )
    service = serve_from(home, blender_exe=blender, rebuild=True)
    thread = threading.Thread(target=service.upkeep.run)
    thread.start()
    deadline = time.monotonic() + SECONDS
    while not running.exists():
        assert time.monotonic() < deadline
        assert thread.is_alive(), service.upkeep.reason
    assert "being built" in ask(service)[0].notes[0]
    service.upkeep.stop()
    thread.join(SECONDS)
    assert not thread.is_alive()
    with pytest.raises(ProcessLookupError):
        os.kill(int(running.read_text()), 0)
    assert ask(service)[1] == OLD
    assert service.bases.pick().path.stat().st_ino == before


def test_a_base_that_is_being_built_is_named_as_such(
    serve_from: ServeFrom, home: Path, make_base: MakeBase
) -> None:
    make_base("4.5.3")
    service = serve_from(home, blender_exe=stopping_blender(home, "98.1.2", ""), rebuild=True)
    service.upkeep.plan()
    with pytest.raises(BaseMissing, match="being built"):
        ask(service, blender="98.1")
    with pytest.raises(BaseMissing, match=r"simworlds kb build 4\.4"):
        ask(service, blender="4.4")


def test_two_servers_do_not_build_at_once(home: Path) -> None:
    command = [sys.executable, "-m", "kb_serve.rebuild", IN_USE, "--home", str(home), "--no-pages"]
    with closing(sqlite3.connect(home / "rebuild.lock", isolation_level=None)) as other:
        other.execute("BEGIN EXCLUSIVE")
        done = subprocess.run(command, env=environment(home), cwd=REPO, capture_output=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (3, b"", b"")


def test_the_reason_of_a_failure_is_one_line(home: Path) -> None:
    command = [sys.executable, "-m", "kb_serve.rebuild", "nonsense", "--home", str(home)]
    done = subprocess.run(
        command, env=environment(home), cwd=REPO, capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert "nonsense" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_an_outdated_base_is_built_again_while_it_answers_and_says_so(
    small: Built, home: Path, make_base: MakeBase
) -> None:
    make_base(OLD, **WITHOUT_PAGES)
    for known in ("extracts", "cache"):  # so that neither Blender is asked nor its scripts are read again
        shutil.copytree(small.home / known, home / known)
    wire = Wire([*COMMAND, "serve"], home)
    with wire.process:
        wire.shake_hands()
        assert wire.ask("bpy.types.Mesh")["structuredContent"]["blender"] == OLD
        deadline = time.monotonic() + SECONDS
        while (answer := wire.ask("bpy.types.Mesh")["structuredContent"])["blender"] == OLD:
            assert "being built" in answer["text"]
            assert time.monotonic() < deadline
            time.sleep(0.2)  # asked without end, it would take a core that the build could have
        assert answer["blender"] == IN_USE
        assert answer["notes"] == []
        assert wire.ask("physics/cloth/introduction")["structuredContent"]["kind"] != "page", (
            "nor had the old"
        )
        assert wire.close() == b""
