"""Three scenes in which everything is right, built by script, each with the plan that it was built to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from scenes import TOOLS
from valid_motion import CLOTH, DOMINOES, cloth_plan, dominoes_plan
from valid_parts import STAGE
from valid_room import ROOM, room_plan

from agents.blender.tools.bake import TOOL as BAKE

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.plan.scene import ScenePlan


@dataclass(frozen=True, slots=True)
class ValidScene:
    """A scene that breaks no rule: the script that builds it, and its plan. ``baked``: the timeline is simulated."""

    name: str
    script: str
    plan: ScenePlan
    baked: bool = False

    def build(self, session: LiveSession) -> None:
        """Builds it in an empty scene, and bakes what is simulated."""
        session.run(f"{TOOLS}\n{STAGE}\n{self.script}\nbpy.context.view_layer.update()")
        if self.baked:
            session.use(BAKE)


def valid_scenes() -> tuple[ValidScene, ...]:
    """All of them."""
    return (
        ValidScene("room", ROOM, room_plan()),
        ValidScene("dominoes", DOMINOES, dominoes_plan(), baked=True),
        ValidScene("cloth", CLOTH, cloth_plan(), baked=True),
    )
