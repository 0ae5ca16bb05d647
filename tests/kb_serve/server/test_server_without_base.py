"""A server without a base: it answers at once, says how to get one, and fetches it where it was told from where."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from typing import TYPE_CHECKING

import pytest
from download_site import Site
from running import COMMAND, Wire, environment

from kb_build.ready.export import export_base, ready_name
from kb_serve.errors import BaseMissing

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from kb_serve.service import Service

    ServeFrom = Callable[..., Service]

SECONDS = 120.0


@pytest.fixture(scope="module")
def packed(small_base: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, bytes]:
    """The version of a ready base, and its file."""
    exported = export_base(small_base, tmp_path_factory.mktemp("packed") / "base.tar.xz")
    return exported.manifest.minor, exported.path.read_bytes()


@pytest.fixture
def site(packed: tuple[str, bytes]) -> Iterator[Site]:
    server = Site(files={f"/{ready_name(packed[0])}": packed[1]})
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    yield server
    server.released.set()
    server.shutdown()
    server.server_close()
    thread.join()


@pytest.fixture
def without_blender(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kb_serve.bases.blender_in_use", lambda _: None)
    monkeypatch.delenv("SIMWORLDS_BASE_URL", raising=False)


def missing(service: Service, blender: str | None = None) -> str:
    with pytest.raises(BaseMissing) as caught:
        service.base(blender)
    return str(caught.value)


@pytest.mark.usefixtures("without_blender")
def test_it_says_how_to_get_a_base(serve_from: ServeFrom, tmp_path: Path) -> None:
    service = serve_from(tmp_path, rebuild=True)
    service.warm()
    service.upkeep.run()
    text = missing(service)
    assert "simworlds kb fetch 5.1 --from" in text
    assert "simworlds kb build 5.1" in text
    assert service.upkeep.state == "idle"


@pytest.mark.usefixtures("without_blender")
def test_it_fetches_from_the_address_that_it_was_given(
    serve_from: ServeFrom,
    site: Site,
    packed: tuple[str, bytes],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("SIMWORLDS_BASE_URL", site.url)
    service = serve_from(tmp_path, rebuild=True, default=packed[0])
    service.warm()
    assert "being fetched in the background" in missing(service)
    service.upkeep.run()
    assert service.upkeep.state == "idle", service.upkeep.reason
    assert service.base(None)[0].query("ClothSettings.quality").kind == "schema"


@pytest.mark.usefixtures("without_blender")
def test_a_fetch_that_fails_is_told_with_its_reason(
    serve_from: ServeFrom,
    site: Site,
    packed: tuple[str, bytes],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("SIMWORLDS_BASE_URL", site.url)
    (name,) = site.files
    site.files[name] = site.files[name][:1000]
    service = serve_from(tmp_path, rebuild=True, default=packed[0])
    service.warm()
    service.upkeep.run()
    assert "could not be fetched: No base was fetched" in missing(service)


@pytest.mark.usefixtures("without_blender")
def test_nothing_is_fetched_without_leave(
    serve_from: ServeFrom, site: Site, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SIMWORLDS_BASE_URL", site.url)
    service = serve_from(tmp_path)
    service.warm()
    service.upkeep.run()
    assert site.requests == []


@pytest.mark.usefixtures("without_blender")
def test_a_single_file_is_taken_for_the_version_that_it_is_of(
    serve_from: ServeFrom,
    site: Site,
    packed: tuple[str, bytes],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("kb_serve.rebuild.USUAL", "4.2")
    monkeypatch.setenv("SIMWORLDS_BASE_URL", f"{site.url}/{ready_name(packed[0])}")
    service = serve_from(tmp_path, rebuild=True)
    service.warm()
    service.upkeep.run()
    assert list(service.bases.built()) == [packed[0]], service.upkeep.reason


@pytest.mark.usefixtures("without_blender")
def test_it_builds_when_the_client_takes_up_its_offer(
    serve_from: ServeFrom, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in (("UV_OFFLINE", "1"), ("UV_CACHE_DIR", str(tmp_path / "cache"))):
        monkeypatch.setenv(name, value)  # so that it fails at once
    service = serve_from(tmp_path, rebuild=True)
    service.warm()
    assert "ask blender_docs 'kb build 5.1'" in missing(service)
    with pytest.raises(BaseMissing, match="being built in the background"):
        service.ask("kb build 4.3", blender=None, limit=1, max_tokens=500, part=1)
    service.upkeep.run()  # what the server runs beside: it starts no second build
    for thread in threading.enumerate():
        if thread.name == "build":
            thread.join(SECONDS)
    assert service.upkeep.state == "failed"
    assert "could not be built: " in missing(service)


@pytest.mark.parametrize("version", ["v4.3", " 4.3.1", "v4.3.2"])
@pytest.mark.usefixtures("without_blender")
def test_a_version_may_be_written_in_any_usual_way(
    serve_from: ServeFrom, tmp_path: Path, version: str
) -> None:
    service = serve_from(tmp_path, rebuild=True)
    text = missing(service, version)
    assert "no knowledge base for Blender 4.3" in text
    assert "ask blender_docs 'kb build 4.3'" in text


@pytest.mark.parametrize("version", ["next", "5", "v", "5.1beta"])
def test_what_is_no_version_is_told_while_a_base_is_being_fetched(
    serve_from: ServeFrom, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, version: str
) -> None:
    monkeypatch.setenv("SIMWORLDS_BASE_URL", "http://127.0.0.1:9")
    service = serve_from(tmp_path, rebuild=True)
    service.warm()
    assert "is not a Blender version" in missing(service, version)


@pytest.mark.skipif(os.name == "nt", reason="executables are shell scripts here")
@pytest.mark.parametrize(("version", "is_passed"), [("98.1", True), ("4.3", False)])
def test_an_executable_builds_the_base_of_its_own_version_alone(
    serve_from: ServeFrom, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, version: str, is_passed: bool
) -> None:
    blender = tmp_path / "blender"
    blender.write_text("#!/bin/sh\necho 'Blender 98.1.2'\n")
    blender.chmod(0o755)
    service = serve_from(tmp_path, blender_exe=blender, rebuild=True)
    jobs: list[list[str]] = []
    monkeypatch.setattr(type(service.upkeep), "_perform", lambda _, job: jobs.append(job.command))
    assert "being built" in service.upkeep.accept(f"kb build {version}")
    for thread in threading.enumerate():
        if thread.name == "build":
            thread.join(SECONDS)
    assert ("--blender-exe" in jobs[0]) is is_passed


@pytest.mark.usefixtures("without_blender")
def test_it_offers_nothing_that_it_may_not_do(serve_from: ServeFrom, tmp_path: Path) -> None:
    service = serve_from(tmp_path)
    service.warm()
    assert "ask blender_docs" not in missing(service)
    with pytest.raises(BaseMissing, match=r"Build it: .*kb build 4\.3"):
        service.ask("kb build 4.3", blender=None, limit=1, max_tokens=500, part=1)
    assert service.upkeep.state == "idle"


@pytest.mark.parametrize(
    ("query", "said"),
    [
        ("kb build 2.79", "No base can be built of Blender 2.79"),
        ("kb build 9.9", "Blender 9.9 has no bpy package"),
        ("simworlds kb fetch 5.1", r"kb fetch 5\.1 --from"),
    ],
)
@pytest.mark.usefixtures("without_blender")
def test_a_query_for_a_base_that_cannot_be_built_here_is_told_so(
    serve_from: ServeFrom, tmp_path: Path, query: str, said: str
) -> None:
    service = serve_from(tmp_path, rebuild=True)
    service.warm()
    with pytest.raises(BaseMissing, match=said):
        service.ask(query, blender=None, limit=1, max_tokens=500, part=1)
    assert service.upkeep.state == "idle"


@pytest.mark.parametrize("doing", ["build", "fetch"])
def test_a_query_for_a_base_that_is_there_is_told_how_to_ask_it(
    serve_from: ServeFrom, base: Path, doing: str
) -> None:
    service = serve_from(base.parent.parent, rebuild=True)
    (version, *_) = service.bases.built()
    with pytest.raises(BaseMissing, match=f'has its knowledge base already.*blender="{version}"'):
        service.ask(f"kb {doing} {version}", blender=None, limit=1, max_tokens=500, part=1)


@pytest.mark.skipif(os.name == "nt", reason="executables are shell scripts here")
def test_the_blender_in_use_has_its_base_built(serve_from: ServeFrom, tmp_path: Path) -> None:
    blender = tmp_path / "blender"
    blender.write_text('#!/bin/sh\n[ "$1" = --version ] && echo "Blender 98.1.2" && exit 0\nexit 7\n')
    blender.chmod(0o755)
    service = serve_from(tmp_path, blender_exe=blender, rebuild=True)
    service.warm()
    assert "being built in the background" in missing(service)
    service.upkeep.run()
    assert "could not be built" in missing(service)
    assert "98.1.2" in service.upkeep.reason


def test_a_client_is_answered_at_once_and_then_from_the_fetched_base(
    site: Site, packed: tuple[str, bytes], tmp_path: Path
) -> None:
    wire = Wire([*COMMAND, "serve", "--blender", packed[0]], tmp_path, SIMWORLDS_BASE_URL=site.url)
    with wire.process:
        wire.shake_hands()
        began = time.monotonic()
        answer = wire.ask("ClothSettings.quality")
        while answer.get("isError") and time.monotonic() - began < SECONDS:
            assert "being fetched" in answer["content"][0]["text"]
            answer = wire.ask("ClothSettings.quality")
        assert "quality" in answer["content"][0]["text"]
        assert not answer.get("isError")
        wire.close()


def test_commands_that_need_no_blender_work_without_one(base: Path, tmp_path: Path) -> None:
    """In an interpreter that finds no bpy, as after an installation without the extra."""
    (tmp_path / "kb").mkdir()
    os.link(base, tmp_path / "kb" / base.name)
    script = tmp_path / "door.py"
    script.write_text("import bpy\nbpy.ops.mesh.primitive_cube_add(radius=1)\n")
    hidden = (
        "import sys\nfrom importlib import metadata\nsys.modules['bpy'] = None\nreal = metadata.version\n"
        "def version(name):\n    if name == 'bpy':\n        raise metadata.PackageNotFoundError(name)\n"
        "    return real(name)\nmetadata.version = version\n"
        "from simworlds.cli import main\nmain(prog_name='simworlds')\n"
    )

    def run(*words: str) -> tuple[int, str]:
        done = subprocess.run(
            [sys.executable, "-c", hidden, *words],
            env=environment(tmp_path, PYTHONWARNINGS="default"),
            capture_output=True,
            text=True,
            check=False,
        )
        return done.returncode, done.stdout + done.stderr

    assert run("docs", "ClothSettings.quality")[0] == 0
    code, text = run("check", str(script))
    assert (code, "radius" in text) == (1, True), text
    assert run("kb", "info")[0] == 0
    code, text = run("migrate", str(script))
    assert code in {0, 1}, text
    code, text = run("stubs", "--out", str(tmp_path / "typings"))
    assert code == 0, text
    code, text = run("kb", "verify")
    assert code in {0, 1}, text
