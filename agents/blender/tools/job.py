"""``blender_job``: long work of other tools, which goes on while nobody waits for it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field, model_validator

from agents.blender.tools import bake, render, trial
from agents.blender.tools.base import Arguments, BlenderTool
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from agents.blender.tools.base import Call, Result, ToolContext

WORK = {tool.name: tool for tool in (bake.TOOL, render.TOOL, trial.TOOL)}
"""The tools whose work can be a job, by name."""
DEFAULTS: dict[str, dict[str, Any]] = {bake.TOOL.name: {"timeout": 21_600}}
"""What their arguments are in a job unless they are given: nobody waits, so a bake has time."""


class JobArguments(Arguments):
    """The arguments of ``blender_job``."""

    action: Literal["start", "status", "result", "cancel"] = Field(description="What.")
    tool: Literal["blender_bake", "blender_render", "blender_trial"] | None = Field(
        default=None, description="Of start."
    )
    arguments: dict[str, Any] | None = Field(default=None, description="Of start.")
    job: int | None = Field(default=None, ge=1, description="Default: the last.")
    wait: float = Field(default=0.0, ge=0, le=3600, description="Of status and result: seconds.")

    @model_validator(mode="after")
    def _fit(self) -> JobArguments:
        if self.action == "start":
            if self.tool is None:
                raise ValueError(f"start needs tool: {', '.join(WORK)}")
            if self.job is not None or self.wait:
                raise ValueError(
                    "start takes tool and arguments alone; then ask for status with job and wait"
                )
        elif self.tool is not None or self.arguments is not None:
            raise ValueError(f"tool and arguments belong to action='start'; {self.action} takes job and wait")
        return self


DESCRIPTION = """\
Bake, render or try as a job, where a call may take longer than you wait. start gives its number at once; \
status how far it is, with `wait` at its end; result what the tool returned; cancel ends it: a bake is undone, \
frames stay. Other calls are refused meanwhile."""


def _run(context: ToolContext, arguments: JobArguments, call: Call) -> Result:
    del context, arguments, call
    raise Refusal("Jobs run beside the calls of a session, in 'simworlds mcp' only.")


TOOL = BlenderTool(
    "blender_job",
    "Run long work",
    DESCRIPTION,
    JobArguments,
    _run,
    destructive=True,
    habit="for a bake or an animation that may take longer than a minute",
)
