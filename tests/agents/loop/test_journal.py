"""The newest value of an event in a journal."""

from __future__ import annotations

import json
from contextlib import closing
from typing import TYPE_CHECKING

import pytest

from agents.loop.errors import NoRun
from agents.loop.record.events import (
    RunBegan,
    SceneRestored,
    SessionBegan,
    StageMoved,
    ToolAnswered,
    types_of,
)
from agents.loop.record.journal import Journal

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.fixture
def journal(tmp_path: Path) -> Iterator[Journal]:
    with closing(Journal(tmp_path / "journal.jsonl")) as journal:
        yield journal


def checkpoint(journal: Journal) -> int | None:
    return journal.newest(ToolAnswered, SceneRestored, value=lambda event: event.checkpoint)


def test_the_newest_value_is_that_of_the_last_event_that_has_one(journal: Journal) -> None:
    assert checkpoint(journal) is None
    journal.append(ToolAnswered(n=1, checkpoint=3))
    journal.append(ToolAnswered(n=2))
    assert checkpoint(journal) == 3
    journal.append(SceneRestored.model_validate({"from": 3, "checkpoint": 1}))
    assert checkpoint(journal) == 1
    journal.append(ToolAnswered(n=3, checkpoint=2))
    assert checkpoint(journal) == 2


def test_a_field_of_that_name_in_other_events_does_not_count(journal: Journal) -> None:
    journal.append(SessionBegan(render_minutes=20.0))
    journal.append_row({"type": "an.event.of.tomorrow", "checkpoint": 7, "render_minutes": 1.0})
    assert checkpoint(journal) is None
    assert journal.newest(SessionBegan, value=lambda began: began.render_minutes) == 20.0


def test_a_broken_row_is_told_instead_of_an_older_value(tmp_path: Path) -> None:
    path = tmp_path / "journal.jsonl"
    rows = [{"i": i, "type": "tool.answered", "checkpoint": kept} for i, kept in ((1, 4), (2, "five"))]
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
    with (
        closing(Journal(path)) as journal,
        pytest.raises(NoRun, match=r"row 2: not a valid 'tool\.answered'"),
    ):
        checkpoint(journal)


def test_a_class_knows_the_types_of_its_rows() -> None:
    assert types_of(RunBegan) == ("run.began",)
    assert types_of(StageMoved) == ("stage.began", "stage.skipped", "stage.closed")
