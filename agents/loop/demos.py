"""Runs that need no key: sessions that come with the package, and records of other runs."""

from __future__ import annotations

import logging
import tomllib
from typing import TYPE_CHECKING, Any

from agents.blender.blender_sessions import SessionSetup
from agents.loop.answer_source import session_folder, sessions
from agents.loop.errors import NoRun, RunError
from agents.loop.reducer import read_run_state
from agents.loop.toolbox import Toolbox
from simworlds.sandbox.confined_command import best_sandbox

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

_LOG = logging.getLogger(__name__)


def listed() -> str:
    """The sessions, a line each."""
    lines = ["Sessions written by hand; each plays against a real Blender, without a key:", ""]
    for name in sessions():
        told = _told(name)
        lines.append(f"  simworlds demo {name:12} about {told['minutes']:g} min   {told['about']}")
    return "\n".join(lines)


def demo_options(name: str, made: Path) -> dict[str, Any]:
    """The options of a session's run. The file that an edit begins with is built as ``made``. Raises NoRun."""
    folder = session_folder(name)
    told = _told(name)
    asked: dict[str, Any] = {
        "origin": "session",
        "source": name,
        "prompt": told.get("instruction", told["prompt"]),
    }
    if "file" in told:
        _build(folder / told["file"], made)
        asked |= {"mode": "edit", "file": made}
    return asked


def replay_options(run: Path) -> dict[str, Any]:
    """The options of a run that plays the record of ``run``. Raises NoRun."""
    options = read_run_state(run).options
    if not options:
        raise NoRun(f"{run} does not hold a record of a run.")
    return {**options, "origin": "replay", "source": str(run)}


def _told(name: str) -> Mapping[str, Any]:
    return tomllib.loads((session_folder(name) / "session.toml").read_text("utf-8"))


def _build(script: Path, made: Path) -> None:
    """Runs a script in a Blender of its own, confined as always, and saves the scene."""
    work = made.with_suffix("")
    with Toolbox(SessionSetup(best_sandbox(), run=work, tell=_LOG.info)) as toolbox:
        code = toolbox.call("blender_execute", {"code": script.read_text("utf-8"), "timeout": 300})
        saved = toolbox.call("blender_save", {"name": made.stem})
    for outcome in (code, saved):
        if outcome.failed:
            raise RunError(f"The scene to edit could not be built: {outcome.text}")
    (work / made.name).replace(made)
