"""What a run leaves behind when a limit ends it: the newest sound scene, and a picture of what stands."""

from __future__ import annotations

import logging
from contextlib import suppress
from typing import TYPE_CHECKING

from agents.loop.errors import RunError
from agents.loop.review.evidence import still
from agents.loop.review.verdicts import verify
from agents.loop.running.position import START
from agents.loop.running.run_tools import RENDER, RUNNER
from simworlds.sandbox.errors import BlenderError

if TYPE_CHECKING:
    from agents.loop.running.run import Run
    from agents.loop.running.tool_client import ToolOutcome

_LOG = logging.getLogger(__name__)
LATEST = "latest.png"
_LAYOUT = "blender_scene_layout_preview"
_SHOWING = 0.5  # of the time that is kept back, for a still


def leave(run: Run) -> None:
    """Delivers the scene as it is, if no rule of its stage objects, and shows what is delivered. Raises nothing.

    Nothing of it is journalled: a session that goes on takes the run up where it stopped.
    """
    task, position, stage = run.task, run.position, run.position.stage
    if task is None or stage is None:
        return
    run.tools.is_leaving = True
    with suppress(RunError, BlenderError, OSError):
        if position.is_changed and verify(run, stage, task).ok:
            run.deliver(stage)
        elif position.is_changed and position.closed != START:
            run.load(stage, run.files.checkpoint(position.closed))
        seconds = max(1.0, run.deadline.seconds_kept_back * _SHOWING)
        shown = _shown(run.tools.use(RUNNER, stage, RENDER, still("latest", None, seconds=seconds)))
        shown = shown or _shown(run.tools.use(RUNNER, stage, _LAYOUT, {}))
        if shown:
            (run.files.root / LATEST).write_bytes(shown)
            return
    _LOG.info("The scene could not be shown as the run stopped.")


def _shown(outcome: ToolOutcome) -> bytes:
    return outcome.pictures[-1].data if outcome.pictures and not outcome.failed else b""
