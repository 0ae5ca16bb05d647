"""Which base answers, and that a new one takes over from the old without a break."""

from __future__ import annotations

import os
from contextlib import closing
from typing import TYPE_CHECKING

import pytest

from kb_serve.bases import Bases
from kb_serve.errors import BaseMissing
from kb_serve.in_use import blender_in_use
from simworlds.releases import minor_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from kb_serve.knowledge_base import KnowledgeBase

IN_USE = blender_in_use() or ""


class Clock:
    """Seconds that pass when a test says so."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def bases(home: Path, clock: Clock) -> Iterator[Bases]:
    with closing(Bases(home, clock=clock)) as opened:
        yield opened


def answers_for(base: KnowledgeBase) -> str:
    assert base.query("ClothSettings.quality").hits
    return base.meta["blender"]


def test_the_version_named_answers(bases: Bases, make_base: Callable[..., Path]) -> None:
    make_base("4.5.3")
    assert answers_for(bases.pick("4.5")) == "4.5.3"
    assert answers_for(bases.pick("4.5.1")) == "4.5.3"
    assert answers_for(bases.pick(minor_of(IN_USE))) == IN_USE


def test_by_default_the_blender_in_use_answers_though_there_is_a_newer_base(
    bases: Bases, make_base: Callable[..., Path]
) -> None:
    make_base("99.1.0")
    make_base("4.5.3")
    assert answers_for(bases.pick()) == IN_USE


def test_the_newest_answers_when_the_blender_in_use_has_no_base(
    home: Path, base: Path, make_base: Callable[..., Path]
) -> None:
    make_base("4.5.3")
    make_base("4.10.0")
    (home / "kb" / base.name).unlink()
    with closing(Bases(home)) as bases:
        assert answers_for(bases.pick()) == "4.10.0"


def test_a_default_version_comes_before_the_blender_in_use(
    home: Path, make_base: Callable[..., Path]
) -> None:
    make_base("4.5.3")
    with closing(Bases(home, default="4.5")) as bases:
        assert answers_for(bases.pick()) == "4.5.3"
        assert answers_for(bases.pick(minor_of(IN_USE))) == IN_USE


@pytest.mark.skipif(os.name == "nt", reason="the executable is a shell script")
def test_an_executable_that_was_named_is_the_blender_in_use(
    home: Path, make_base: Callable[..., Path]
) -> None:
    make_base("4.5.3")
    blender = home / "blender"
    blender.write_text("#!/bin/sh\necho noise\necho 'Blender 4.5.3 LTS'\n")
    blender.chmod(0o755)
    with closing(Bases(home, blender_exe=blender)) as bases:
        assert answers_for(bases.pick()) == "4.5.3"


def test_an_invalid_executable_falls_back_to_the_newest_base(
    home: Path, make_base: Callable[..., Path]
) -> None:
    make_base("99.1.0")
    with closing(Bases(home, blender_exe=home / "nothing")) as bases:
        assert answers_for(bases.pick()) == "99.1.0"


def test_a_version_that_was_not_built_is_named_with_those_that_were(
    bases: Bases, make_base: Callable[..., Path]
) -> None:
    make_base("4.5.3")
    with pytest.raises(BaseMissing, match=rf"Built are: 4\.5, {minor_of(IN_USE)}.*simworlds kb build 4\.4"):
        bases.pick("4.4")


def test_a_base_that_is_built_while_serving_is_found_at_once(
    bases: Bases, make_base: Callable[..., Path]
) -> None:
    with pytest.raises(BaseMissing):
        bases.pick("4.5")
    make_base("4.5.3")
    assert answers_for(bases.pick("4.5")) == "4.5.3"


def test_the_first_base_is_found_at_once(tmp_path: Path, base: Path) -> None:
    with closing(Bases(tmp_path)) as bases:
        with pytest.raises(BaseMissing):
            bases.pick()
        (tmp_path / "kb").mkdir()
        os.link(base, tmp_path / "kb" / base.name)
        assert answers_for(bases.pick()) == IN_USE


def test_a_base_that_is_replaced_while_serving_takes_over(
    bases: Bases, clock: Clock, make_base: Callable[..., Path]
) -> None:
    make_base("4.5.1")
    assert answers_for(bases.pick("4.5")) == "4.5.1"
    make_base("4.5.2")
    clock.now += 0.9
    assert answers_for(bases.pick("4.5")) == "4.5.1", (
        "its file is looked at once a second, not for every answer"
    )
    clock.now += 0.2
    assert answers_for(bases.pick("4.5")) == "4.5.2"


def test_the_old_base_answers_on_when_its_replacement_is_damaged(
    bases: Bases, clock: Clock, home: Path, make_base: Callable[..., Path]
) -> None:
    make_base("4.5.1")
    assert answers_for(bases.pick("4.5")) == "4.5.1"
    damaged = home / "damaged"
    damaged.write_bytes(b"this is no base")
    damaged.replace(home / "kb" / "blender-4.5.sqlite")
    for _second in range(3):
        clock.now += 1.0
        assert answers_for(bases.pick("4.5")) == "4.5.1"
    make_base("4.5.2")
    clock.now += 1.0
    assert answers_for(bases.pick("4.5")) == "4.5.2"


def test_the_file_is_only_read(bases: Bases, home: Path, base: Path) -> None:
    target = home / "kb" / base.name
    before = target.stat()
    answers_for(bases.pick())
    after = target.stat()
    assert (before.st_mtime_ns, before.st_size) == (after.st_mtime_ns, after.st_size)
    assert [path.name for path in (home / "kb").iterdir()] == [base.name]
