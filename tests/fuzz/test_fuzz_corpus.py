"""What fuzzing has found is read or refused, as are a few inputs more; ``make fuzz`` tries many."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

FOLDER = Path(__file__).resolve().parent
sys.path.append(str(FOLDER.parent / "agents"))  # the plan that it begins with

from run_fuzz import CORPUS, all_targets, fuzz  # noqa: E402
from targets import Target, small_blend  # noqa: E402

if TYPE_CHECKING:
    from collections.abc import Iterator

NAMES = ("archive", "ready_base", "rst", "html", "blend", "journal", "plan", "query", "message")
SECONDS = 1.0
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def found(small_base: Path) -> Iterator[dict[str, Target]]:
    with all_targets(small_base, small_base.parents[1]) as targets:
        yield {target.name: target for target in targets}


def test_every_target_is_there(found: dict[str, Target]) -> None:
    assert tuple(found) == NAMES
    assert {path.name for path in CORPUS.iterdir() if path.is_dir()} <= set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_what_was_found_is_read_or_refused(found: dict[str, Target], name: str) -> None:
    for path in sorted((CORPUS / name).glob("*")):
        found[name].check(path.read_bytes())


@pytest.mark.parametrize("name", NAMES)
def test_more_is_read_or_refused(found: dict[str, Target], name: str) -> None:
    _, data, fault = fuzz(found[name], SECONDS, first_seed=1)
    assert data is None, f"{data!r}\n{fault}"


def test_a_reader_that_fails_is_seen_and_its_input_shrunk(found: dict[str, Target]) -> None:
    def fails(data: bytes) -> None:
        assert b"DNA1" not in data

    target = Target("blend", found["blend"].given, fails)
    _, data, fault = fuzz(target, 60.0, first_seed=1)
    assert data is not None
    assert b"DNA1" in data
    assert "AssertionError" in fault


def test_the_blend_that_it_begins_with_is_one(found: dict[str, Target], tmp_path: Path) -> None:
    from agents.blender.inside.blend.stored_texts import replace_texts

    for new_head in (True, False):
        path = tmp_path / "small.blend"
        path.write_bytes(small_blend(new_head=new_head))
        assert replace_texts(str(path), "Object", "name", {"old": "new"}) == 1
        assert b"new\0" in path.read_bytes()
