"""Messages name a command that can be run as it stands, however this was installed."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING

from simworlds.operating_system import Windows
from simworlds.own_command import own_command

if TYPE_CHECKING:
    import pytest


class Installed:
    """A distribution that was installed from somewhere."""

    def __init__(self, url: str | None) -> None:
        self._url = url

    def read_text(self, name: str) -> str | None:
        return json.dumps({"url": self._url}) if name == "direct_url.json" and self._url else None


def by_uvx(monkeypatch: pytest.MonkeyPatch, url: str | None) -> str:
    monkeypatch.setenv("UV", "/bin/uv")
    monkeypatch.setattr(sys, "prefix", "/cache/uv/archive-v0/abc")
    monkeypatch.setattr(metadata, "distribution", lambda _: Installed(url))
    return own_command()


def test_under_uvx_it_is_uvx(monkeypatch: pytest.MonkeyPatch) -> None:
    assert by_uvx(monkeypatch, None) == "uvx simworlds"


def test_under_uvx_from_a_wheel_it_names_the_wheel(monkeypatch: pytest.MonkeyPatch) -> None:
    command = by_uvx(monkeypatch, "file:///a%20b/simworlds-0.1.0-py3-none-any.whl")
    assert command == "uvx --from '/a b/simworlds-0.1.0-py3-none-any.whl' simworlds"


def test_on_path_it_is_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(Path(sys.executable).parent))
    assert own_command() == "simworlds"


def test_off_path_it_is_the_program_that_windows_has(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    program = tmp_path / "Scripts" / "simworlds.exe"
    program.parent.mkdir()
    program.touch()
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    monkeypatch.setattr("simworlds.own_command.SYSTEM", Windows())
    assert own_command() == str(program)


def test_off_path_it_is_a_path_that_runs(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    done = subprocess.run([own_command(), "--version"], capture_output=True, text=True, check=False)
    assert done.stdout.startswith("simworlds, version"), done.stderr
