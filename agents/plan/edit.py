"""The plan of an edit: what to add, modify or remove in an existing scene (paper, "Edit Mode")."""

from __future__ import annotations

import re
from difflib import get_close_matches
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, model_validator

from agents.plan.part import STAGES, Frame, PlanPart, Stage
from agents.plan.scene import RenderSettings
from agents.protocol.vocabulary import DeformationKind, MotionKind

if TYPE_CHECKING:
    from collections.abc import Iterable, Set

_SLIP = 0.8  # from how alike on (0 to 1) a name is taken for a slip of another one
# A name as it is in the file, which need not follow a plan's rules for names.
FileName = Annotated[str, Field(min_length=1, max_length=255)]


class EditTask(PlanPart):
    """One change. Everything that it does not name stays as it is."""

    kind: Literal["add", "modify", "remove"]
    stage: Stage = Field(description="The stage that makes the change; not `render`.")
    targets: tuple[FileName, ...] = Field(
        min_length=1,
        description="Names of what changes, exactly as in the file: objects, collections, materials, lights, cameras, "
        "the world or scene. For an addition: the names that the new items get; a modification may name new materials "
        "beside what gets them.",
    )
    instruction: str = Field(min_length=1, max_length=4000, description="What to change, and into what.")

    @model_validator(mode="after")
    def _is_built(self) -> EditTask:
        if self.stage == "render":
            raise ValueError("stage: rendering changes nothing; name the stage that makes the change")
        return self


class EditedActor(PlanPart):
    """An actor that moves after the edit, with the mechanism tags that its collection gets."""

    name: FileName
    deformation_kind: DeformationKind
    motion_kind: MotionKind


class EditPlan(PlanPart):
    """All tasks of an edit, and how the result is rendered."""

    title: str = Field(min_length=1, max_length=200)
    tasks: tuple[EditTask, ...] = Field(min_length=1)
    actors: tuple[EditedActor, ...] = Field(
        default=(), description="Actors whose motion is new or changes with the edit."
    )
    stays: str = Field(
        default="", max_length=2000, description="What must look and move as before, in one or two sentences."
    )
    frame_start: Frame | None = None
    frame_end: Frame | None = None
    render: RenderSettings

    @model_validator(mode="after")
    def _holds_together(self) -> EditPlan:
        start, end = self.frame_start, self.frame_end
        if start is not None and end is not None and end < start:
            raise ValueError("frame_end: it is before frame_start")
        if self.actors and "motion" not in self.stages:
            raise ValueError(
                "tasks: actors are given, but no task is in the stage motion, which moves them; add one"
            )
        return self

    @property
    def stages(self) -> tuple[Stage, ...]:
        """The stages that have a task, in order."""
        return tuple(stage for stage in STAGES if any(task.stage == stage for task in self.tasks))

    @property
    def targets(self) -> frozenset[str]:
        """The names of everything that may change."""
        return frozenset(name for task in self.tasks for name in task.targets)


def mentioned_in(plan: EditPlan, names: Iterable[str]) -> list[str]:
    """Those of the file's ``names`` that instructions speak of without changing them, as in "like the Mug"."""
    told = "\n".join(task.instruction for task in plan.tasks)
    return [
        name
        for name in names
        if name in told and name not in plan.targets and re.search(rf"(?<!\w){re.escape(name)}(?!\w)", told)
    ]


def unknown_targets(plan: EditPlan, names: Set[str]) -> list[str]:
    """Sentences about targets that the plan modifies or removes but that are not among the file's ``names``.

    A modification may bring something new, such as a material, beside what it changes, unless it looks like a slip.
    """
    known = names | {name for task in plan.tasks if task.kind == "add" for name in task.targets}
    faults: list[str] = []
    for number, task in enumerate(plan.tasks):
        may_bring = task.kind == "modify" and not known.isdisjoint(task.targets)
        for name in task.targets:
            if name in known or (may_bring and not get_close_matches(name, known, n=1, cutoff=_SLIP)):
                continue
            nearest = ", ".join(map(repr, get_close_matches(name, sorted(known), n=3)))
            hints = [f"Nearest: {nearest}."] if nearest else ["Use a name of the scene's state."]
            if task.kind == "modify":
                hints.append("If it is new, name it in a task of the kind add.")
            faults.append(
                f"tasks.{number}.targets: there is nothing called {name!r} in the file. {' '.join(hints)}"
            )
    return faults
