"""Fixtures that every test may ask for."""

from __future__ import annotations

import compileall
import gc
import os
import shutil
import tempfile
from contextlib import closing, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, cast

import pytest
from made_once import made_once
from places import REPO
from whole import IS_WHOLE

from simworlds.settings import SHADERS_VARIABLE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from built_base import Built

    from kb_build.blender.extract_reader import Extract
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader


_mktemp = pytest.TempPathFactory.mktemp


def _readable_mktemp(self: pytest.TempPathFactory, basename: str, numbered: bool = True) -> Path:
    """A new folder that others may read, as most folders: run by root, Blender is another user."""
    path = _mktemp(self, basename, numbered)
    path.chmod(0o755)
    return path


pytest.TempPathFactory.mktemp = _readable_mktemp

# What tests get from a Blender, or from the documentation sources, by asking for a fixture.
_OF_BLENDER = frozenset({"base", "built_once", "extract", "kb", "reader", "small"})


def pytest_configure(config: pytest.Config) -> None:
    """Has what processes leave in their temporary folder go with the tests: a Blender that is killed leaves its own.

    The folders that tests get stay, as pytest keeps them.
    """
    if "PYTEST_XDIST_WORKER" in os.environ:  # it is in the folder of the process that started it
        return
    folder = Path(tempfile.mkdtemp(prefix="simworlds-tests-"))
    folder.chmod(0o1777)  # as others are: run by root, Blender is another user
    config.add_cleanup(partial(shutil.rmtree, folder, ignore_errors=True))
    os.environ["TMPDIR"] = str(folder)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leaves out what only `make test-whole` takes.

    Marks tests by the fixtures that they ask for, by way of others too: `make test-fast` leaves them out.
    """
    if not IS_WHOLE and (left_out := [item for item in items if item.get_closest_marker("whole")]):
        config.hook.pytest_deselected(items=left_out)
        items[:] = [item for item in items if not item.get_closest_marker("whole")]
    for item in items:
        names = frozenset(getattr(item, "fixturenames", ()))
        if names & _OF_BLENDER:
            item.add_marker(pytest.mark.blender)
        if "corpora" in names:
            item.add_marker(pytest.mark.corpora)
    if "PYTEST_XDIST_WORKER" in os.environ:
        _begin_with_long_files(items)


def pytest_collection_finish() -> None:
    """What was collected lives to the end: neither this process nor those that it forks look through it again."""
    gc.collect()
    gc.freeze()


def _begin_with_long_files(items: list[pytest.Item]) -> None:
    """Moves the files that `make test-fast` has nothing or little of to the front.

    What is left for the end then takes moments, and no process works alone on a long file while others wait. Of the
    long ones, one that needs the base is the first, and those that need none are next: the others need not wait for it.
    """
    marks = ("blender", "corpora", "slow")
    long = {item.path for item in items if any(item.get_closest_marker(mark) for mark in marks)}
    of_base = [item.path for item in items if "built_once" in getattr(item, "fixturenames", ())]
    builds, waiting = of_base[:1], {*of_base}
    items.sort(key=lambda item: (item.path not in builds, item.path not in long, item.path in waiting))


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Before the first test with a Blender: what each would do again, since it may write nothing that stays.

    Shaders for all of them, as `simworlds doctor` keeps them for its user, and the byte code of what runs inside.
    """
    if item.get_closest_marker("blender") and SHADERS_VARIABLE not in os.environ:
        factory = cast("pytest.TempPathFactory", item.config._tmp_path_factory)  # type: ignore[attr-defined]
        made_once(factory, "byte-code", _with_byte_code)
        os.environ[SHADERS_VARIABLE] = str(made_once(factory, "shaders", _compiled))


def _with_byte_code(_: Path) -> None:
    for package in ("agents", "bench", "kb_build", "kb_check", "simworlds", "tests"):
        for inside in (REPO / package).rglob("inside"):
            compileall.compile_dir(inside, quiet=2)


def _compiled(folder: Path) -> Path:
    from agents.blender.files.run_folder import RunFolder
    from agents.blender.first_pictures import keep_drawn
    from agents.blender.launch import make_launch
    from agents.blender.supervisor import Supervisor
    from simworlds.installed import installed_bpy
    from simworlds.sandbox.errors import BlenderError

    os.environ[SHADERS_VARIABLE] = str(folder / "kept")
    if installed_bpy() is not None:
        run = RunFolder.make(folder / "run")
        with suppress(BlenderError, OSError), Supervisor(make_launch(run.workspace), run) as blender:
            keep_drawn(blender)
    return folder / "kept"


@pytest.fixture(scope="session")
def corpora() -> Path:
    """The folder with the real documentation sources; the test is skipped where it is absent."""
    folder = Path(os.environ.get("SIMWORLDS_CORPORA") or REPO.parent / "shared" / "corpora")
    if not folder.is_dir():
        pytest.skip("the real documentation sources are not on this machine")
    return folder


@pytest.fixture(scope="session")
def built_once(tmp_path_factory: pytest.TempPathFactory) -> Built:
    """What ``base`` is in: its home, and the miniature documentation that it was built from. Never write to it."""
    from built_base import build_miniature

    from simworlds.installed import installed_bpy

    if installed_bpy() is None:
        pytest.skip("there is no Blender in this environment")
    return made_once(tmp_path_factory, "built", build_miniature)


@pytest.fixture(scope="session")
def base(built_once: Built) -> Path:
    """The file of a real base of this environment's Blender, with the miniature documentation's pages.

    Its home folder is ``base.parent.parent``. Never write to it.
    """
    return built_once.path


@pytest.fixture(scope="session")
def _small_once(built_once: Built, tmp_path_factory: pytest.TempPathFactory) -> Built:
    return made_once(tmp_path_factory, "small", lambda folder: built_once.copy(folder).rebuilt_small())


@pytest.fixture(scope="session")
def small_base(_small_once: Built) -> Path:
    """The file of a base like ``base``, of few symbols. Never write to it."""
    return _small_once.path


@pytest.fixture
def small(_small_once: Built, tmp_path: Path) -> Built:
    """A base of one's own like ``base``, of few symbols: for tests that build again.

    A build in its home asks Blender only if it is forced to.
    """
    return _small_once.copy(tmp_path)


@pytest.fixture(scope="session")
def extract(base: Path) -> Extract:
    """What this environment's Blender said of its API when ``base`` was built."""
    from kb_build.blender.extract_reader import read_extract

    return read_extract(next((base.parent.parent / "extracts").glob("*.jsonl")))


@pytest.fixture(scope="session")
def reader(base: Path) -> Iterator[BaseReader]:
    """Look-ups in ``base``."""
    from kb_serve.reader import BaseReader

    with closing(BaseReader(base)) as opened:
        yield opened


@pytest.fixture(scope="session")
def kb(base: Path) -> Iterator[KnowledgeBase]:
    """``base`` as a caller sees it."""
    from kb_serve.knowledge_base import KnowledgeBase

    with KnowledgeBase(base) as opened:
        yield opened
