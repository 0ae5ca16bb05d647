"""The options of a run: journalled at its beginning, and valid for all its sessions."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

Mode = Literal["make", "edit"]
Origin = Literal["live", "session", "replay"]

DEFAULT_MODEL = "claude-opus-5-5"  # the newest of the paper's line: one strong model for all roles
BEFORE_DRAFTS = {"early": False, "planner_looks": False}  # in records that are older than these options
ROLES = ("planner", "coder", "reviewer", "final_reviewer")


class Options(BaseModel):
    """What does not change from session to session.

    ``origin``: where answers come from: a live model, a ``session`` (its name) written by hand, or the ``replay`` of
    another run (its folder). ``file``, ``reference``: what is edited, and a picture of what it should be.
    ``verifier``, ``stages``: False leaves that out (the paper's ablations). ``early``: the scene is delivered as each
    stage closes, and a draft before the film; ``planner_looks``: the planner decides on that draft. Runs that were
    begun without these go on without them.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    mode: Mode = "make"
    prompt: str = Field(min_length=1, max_length=20_000)
    file: Path | None = None
    reference: Path | None = None
    origin: Origin = "live"
    source: str = ""
    model: str = DEFAULT_MODEL
    models: dict[str, str] = Field(default_factory=dict[str, str])
    blender: str | None = None
    blender_exe: Path | None = None
    sandbox: Literal["bubblewrap", "landlock", "none"] | None = None
    read: tuple[Path, ...] = ()
    render_minutes: float | None = Field(default=None, gt=0)
    samples: int | None = Field(default=None, ge=1)
    verifier: bool = True
    stages: bool = True
    early: bool = True
    planner_looks: bool = True

    def model_of(self, role: str) -> str:
        """The model that answers for a role."""
        return self.models.get(role, self.model)

    @property
    def source_text(self) -> str:
        """Where the answers come from, in words."""
        match self.origin:
            case "session":
                return f"hand-written session: {self.source}"
            case "replay":
                return f"recorded: {self.source}"
            case _:
                return "live"


class RunLimits(BaseModel):
    """What one session may use: dollars (over the whole run), and minutes; how films are rendered from now on."""

    model_config = ConfigDict(frozen=True)

    max_cost: float | None = Field(default=None, ge=0)
    max_minutes: float | None = Field(default=None, gt=0)
    render_minutes: float | None = Field(default=None, gt=0)
    samples: int | None = Field(default=None, ge=1)
