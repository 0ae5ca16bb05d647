"""Runs that need no key: transcripts that come with the package, and records of other runs."""

from __future__ import annotations

import logging
import shutil
import tomllib
from typing import TYPE_CHECKING, Any

from agents.blender.blender_sessions import SessionSetup
from agents.loop.answer_source import transcript_folder, transcripts
from agents.loop.errors import NoRun, RunError
from agents.loop.options import BEFORE_DRAFTS
from agents.loop.record.reducer import read_run_state
from agents.loop.running.tool_client import ToolClient
from simworlds.sandbox.confinement.confined_command import best_sandbox

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

_LOG = logging.getLogger(__name__)


def listed() -> str:
    """The demos, a line each."""
    lines = ["Each plays a transcript against a real Blender, without a key:", ""]
    for name in transcripts():
        settings = _settings(name)
        lines.append(f"  simworlds demo {name:12} about {settings['minutes']:g} min   {settings['about']}")
        lines.append(f"  {'':42}Answered by {settings['by']}.")
    return "\n".join(lines)


def demo_options(name: str, made: Path) -> dict[str, Any]:
    """The options of a demo's run. The file that an edit starts from is built as ``made``. Raises NoRun."""
    folder = transcript_folder(name)
    settings = _settings(name)
    asked: dict[str, Any] = {
        "origin": "session",
        "source": name,
        "by": settings["by"],
        "planner_looks": False,
        "prompt": settings.get("instruction", settings["prompt"]),
    }
    if "file" in settings:
        _build(folder / settings["file"], made)
        asked |= {"mode": "edit", "file": made}
    return asked


def replay_options(run: Path) -> dict[str, Any]:
    """The options of a run that plays the record of ``run``. Raises NoRun."""
    options = read_run_state(run).options
    if not options:
        raise NoRun(f"{run} does not hold a record of a run.")
    return {**BEFORE_DRAFTS, **options, "origin": "replay", "source": str(run)}


def _settings(name: str) -> Mapping[str, Any]:
    return tomllib.loads((transcript_folder(name) / "session.toml").read_text("utf-8"))


def _build(script: Path, made: Path) -> None:
    """Runs a script in a Blender of its own, confined as always, and saves the scene."""
    work = made.with_suffix("")
    is_ours = not work.exists()
    try:
        with ToolClient(SessionSetup(best_sandbox(), run=work, tell=_LOG.info)) as tools:
            code = tools.call("blender_execute", {"code": script.read_text("utf-8"), "timeout": 300})
            saved = tools.call("blender_save", {"name": made.stem})
        for outcome in (code, saved):
            if outcome.failed:
                raise RunError(f"The scene to edit could not be built: {outcome.text}")
        (work / made.name).replace(made)
    finally:
        if is_ours:
            shutil.rmtree(work, ignore_errors=True)
