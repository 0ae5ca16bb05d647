"""The plan of an edit: what is to be added, modified or removed in a scene that is there (paper, "Edit Mode")."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, model_validator

from agents.plan.part import STAGES, Frame, Part, Stage
from agents.plan.scene import DeformationKind, MotionMechanism, Render

if TYPE_CHECKING:
    from collections.abc import Set

# As the names stand in the file, which may know nothing of a plan's rules for names.
FileName = Annotated[str, Field(min_length=1, max_length=255)]


class EditTask(Part):
    """One change. What is not named here is right as it is, and stays."""

    kind: Literal["add", "modify", "remove"]
    stage: Stage = Field(description="The stage that it belongs to; not `render`.")
    targets: tuple[FileName, ...] = Field(
        min_length=1,
        description="Names of what is changed, as they are in the file: objects, collections, materials, lights, "
        "cameras, the world or scene; of what is added, as it is to be called.",
    )
    instruction: str = Field(
        min_length=1, max_length=4000, description="What is to be changed, and into what."
    )

    @model_validator(mode="after")
    def _is_built(self) -> EditTask:
        if self.stage == "render":
            raise ValueError("stage: rendering changes nothing; name the stage that does")
        return self


class EditedActor(Part):
    """Something that is to move after the edit, and by what mechanism: how its collection is to be tagged."""

    name: FileName
    deformation_kind: DeformationKind
    motion_kind: MotionMechanism


class EditPlan(Part):
    """All tasks of an edit, and how the result is rendered."""

    title: str = Field(min_length=1, max_length=200)
    tasks: tuple[EditTask, ...] = Field(min_length=1)
    actors: tuple[EditedActor, ...] = Field(
        default=(), description="What moves after the edit and did not, or moved otherwise, before."
    )
    stays: str = Field(
        default="", max_length=2000, description="What must look and move as before, in one or two sentences."
    )
    frame_start: Frame | None = None
    frame_end: Frame | None = None
    render: Render

    @model_validator(mode="after")
    def _holds_together(self) -> EditPlan:
        start, end = self.frame_start, self.frame_end
        if start is not None and end is not None and end < start:
            raise ValueError("frame_end: is before frame_start")
        if self.actors and "motion" not in self.stages:
            raise ValueError("tasks: actors are set in motion in the stage motion; give it a task")
        return self

    @property
    def stages(self) -> tuple[Stage, ...]:
        """The stages that have something to do, in order."""
        return tuple(stage for stage in STAGES if any(task.stage == stage for task in self.tasks))

    @property
    def targets(self) -> frozenset[str]:
        """Everything that may change."""
        return frozenset(name for task in self.tasks for name in task.targets)


def unknown_targets(plan: EditPlan, names: Set[str]) -> list[str]:
    """What a plan is to modify or remove that the file, with these ``names``, does not have; in sentences."""
    known = names | {name for task in plan.tasks if task.kind == "add" for name in task.targets}
    faults: list[str] = []
    for number, task in enumerate(plan.tasks):
        for name in task.targets:
            if name not in known:
                near = ", ".join(map(repr, get_close_matches(name, sorted(known), n=3)))
                hint = (
                    f" Nearest: {near}."
                    if near
                    else " Use the names of the readout, or a task of the kind add."
                )
                faults.append(f"tasks.{number}.targets: there is nothing called {name!r} in the file.{hint}")
    return faults
