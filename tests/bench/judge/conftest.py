"""Judges over the real clients, against servers on this machine."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from judge_apis import Anthropic, OpenAI, film

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.fixture(autouse=True)
def _environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for name in ("ANTHROPIC_AUTH_TOKEN", "ANTHROPIC_BASE_URL", "OPENAI_BASE_URL", "OPENAI_ORG_ID"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("ANTHROPIC_API_KEY", "key")
    monkeypatch.setenv("OPENAI_API_KEY", "key")
    monkeypatch.setenv("SIMWORLDS_HOME", str(tmp_path / "home"))


@pytest.fixture(params=[Anthropic, OpenAI], ids=["anthropic", "openai"])
def api(request: pytest.FixtureRequest) -> Iterator[Anthropic | OpenAI]:
    """Both providers, one after the other."""
    yield from _served(request.param())


@pytest.fixture
def claude() -> Iterator[Anthropic]:
    """One provider, where it does not matter which."""
    yield from _served(Anthropic())


def _served(api: Anthropic | OpenAI) -> Iterator[Any]:
    with api.server:
        yield api
    for provider in api.providers:
        provider.close()


@pytest.fixture
def store(tmp_path: Path) -> Path:
    return tmp_path / "kept"


@pytest.fixture
def frames(tmp_path: Path) -> list[Path]:
    return film(tmp_path / "frames")
