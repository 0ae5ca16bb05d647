"""The sheets of the solvers: how each is set up, with numbers that work, for coders whose plan needs it.

Each sheet has one recipe, a block of Python that runs in every supported Blender as it stands.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal, get_args

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.plan.edit import EditedActor
    from agents.plan.scene import ScenePlan

Solver = Literal["cloth", "soft", "rigid", "liquid", "gas", "particles", "wind"]
SOLVERS: tuple[Solver, ...] = get_args(Solver)
_FOLDER = Path(__file__).with_name("prompts") / "sheets"
_BY_ROLE: dict[str, Solver] = {
    "cloth": "cloth",
    "soft": "soft",
    "rigid": "rigid",
    "emitter": "particles",
    "force": "wind",
}
_BY_KIND: dict[str, tuple[Solver, ...]] = {
    "sim_cloth": ("cloth",),
    "sim_soft": ("soft",),
    "sim_rigid": ("rigid",),
    "sim_particle": ("particles",),
    "sim_fluid": ("liquid", "gas"),
}


@cache
def sheet(solver: Solver) -> str:
    """The sheet of a solver, as Markdown."""
    return (_FOLDER / f"{solver}.md").read_text(encoding="utf-8").strip()


def solvers_of(plan: ScenePlan | None, actors: Sequence[EditedActor] = ()) -> tuple[Solver, ...]:
    """The solvers that a scene plan's objects need, or those of an edit's ``actors``."""
    needed: set[Solver] = {solver for actor in actors for solver in _BY_KIND.get(actor.deformation_kind, ())}
    for planned in plan.objects if plan else ():
        if planned.role == "fluid":
            needed.add("liquid" if planned.fluid_kind in {None, "liquid"} else "gas")
        elif planned.role in _BY_ROLE:
            needed.add(_BY_ROLE[planned.role])
    return tuple(solver for solver in SOLVERS if solver in needed)
