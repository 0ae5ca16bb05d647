"""Sessions at runs, as a person has them, but with small pictures; and what is left of them."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import pytest
from fake_messages_api import FakeMessagesAPI, Reply
from live_session import LiveSession
from shared_docs import share_docs

from agents.blender.tools import material_preview, previews, uv_preview
from agents.blender.tools.files import LOAD
from agents.blender.tools.scene_state import TOOL as SCENE_STATE
from agents.loop import answer_source
from agents.loop.options import Options, RunLimits
from agents.loop.record.journal import NAME, Row, read_rows
from agents.loop.review import evidence
from agents.loop.session import Ended, RunSession, Stop, begin, resume
from simworlds.llm.apis.providers import connect

if TYPE_CHECKING:
    from pathlib import Path

    from agents.loop.record.events import Event

DOCS = "docs.url"
"""The file in a home that says where its documentation is served, if it is."""
PROMPT = "A crate stands on a floor"
MESSAGES = "POST /v1/messages"
OnRow = Callable[[Mapping[str, Any]], object]


def make_small(patch: pytest.MonkeyPatch) -> None:
    """Pictures of few pixels, and no pauses before a model is asked again."""
    patch.setattr(previews, "PANEL", 48)
    patch.setattr(evidence, "WIDTH", 64)
    patch.setattr(evidence, "SAMPLES", 1)
    patch.setattr(material_preview, "_PANEL", 48)
    patch.setattr(uv_preview, "_PANEL", 48)
    patch.setattr(answer_source, "connect", lambda *given, **_: connect(*given, pause=lambda seconds: None))


def share_docs_of(patch: pytest.MonkeyPatch, home: Path) -> None:
    """Sessions ask the home's server of documentation, if it has one."""
    if (home / DOCS).exists():
        share_docs(patch, (home / DOCS).read_text())


@contextmanager
def at_home(home: Path) -> Iterator[pytest.MonkeyPatch]:
    """A home, small pictures, nobody who answers."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SIMWORLDS_HOME", str(home))
        for name in (
            *("ANTHROPIC_API_KEY", "ANTHROPIC_AUTH_TOKEN", "ANTHROPIC_BASE_URL"),
            *("OPENAI_API_KEY", "OPENAI_BASE_URL"),
        ):
            patch.delenv(name, raising=False)
        make_small(patch)
        share_docs_of(patch, home)
        yield patch


@contextmanager
def answered(home: Path, team: Callable[[dict[str, Any]], Reply]) -> Iterator[FakeMessagesAPI]:
    """The same, with a server that answers as the team does."""
    with at_home(home) as patch, FakeMessagesAPI(team) as api:
        patch.setenv("ANTHROPIC_API_KEY", "any")
        patch.setenv("ANTHROPIC_BASE_URL", api.base_url)
        yield api


def only_look(row: Mapping[str, Any]) -> None:
    """What an onlooker does at a row, if it is not told otherwise."""


@dataclass
class Onlooker:
    """Keeps what it is told; ``on_row`` may act on it."""

    on_row: OnRow = only_look
    rows: list[Row] = field(default_factory=list)
    heard: list[tuple[str, str]] = field(default_factory=list)

    def take(self, event: Event) -> None:
        self.rows.append(event.as_row())
        self.on_row(self.rows[-1])

    def saying(self, role: str, text: str) -> None:
        self.heard.append((role, text))

    def asking_again(self, role: str, why: str) -> None:
        self.heard.append((role, why))

    def progress(self, tool: str, done: float, total: float | None, text: str) -> None:
        pass


@dataclass
class Played:
    """A run after a session. ``requests`` are the bodies of what the model was asked."""

    root: Path
    ended: Ended
    onlooker: Onlooker
    requests: list[dict[str, Any]] = field(default_factory=list)

    @property
    def rows(self) -> list[Row]:
        return read_rows(self.root / NAME)

    def of(self, kind: str, **about: Any) -> list[Row]:
        """The rows of a type, with these fields."""
        return [row for row in self.rows if row["type"] == kind and about.items() <= row.items()]

    def the(self, kind: str, **about: Any) -> Row:
        (row,) = self.of(kind, **about)
        return row

    @property
    def taken(self) -> list[tuple[str, str]]:
        """(stage, what was done) of every decision."""
        return [(row["stage"], row["taken"]) for row in self.of("decided")]


def seat(limits: RunLimits | None = None, stop: Stop | None = None, on_row: OnRow = only_look) -> RunSession:
    return RunSession(limits or RunLimits(), Onlooker(on_row), stop or Stop(threading.Event()))


def sit(root: Path, at: RunSession | None = None, **options: Any) -> Played:
    """Begins a run."""
    at = at or seat()
    return _played(root, begin(root, Options(**{"prompt": PROMPT, **options}), at), at)


def go_on(root: Path, at: RunSession | None = None) -> Played:
    """Takes a run up again."""
    at = at or seat()
    return _played(root, resume(root, at), at)


def _played(root: Path, ended: Ended, at: RunSession) -> Played:
    assert isinstance(at.watcher, Onlooker)
    return Played(root, ended, at.watcher)


def asked_of(api: FakeMessagesAPI) -> list[dict[str, Any]]:
    return [request.body for request in api.received(MESSAGES)]


def scenes(folder: Path, *files: Path) -> list[dict[str, str]]:
    """{"Object Cube": digest, …} of all that is in each file."""
    read = tuple({file.parent for file in files})
    found: list[dict[str, str]] = []
    session = LiveSession(folder, read=read)
    with session.blender:
        for file in files:
            session.use(LOAD, path=str(file))
            found.append(dict(session.use(SCENE_STATE, sections=["data_blocks"]).data["data_blocks"]))
    return found
