"""The verifier's way to Blender: facts and measurements of the scene that is open."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from agents.protocol.engine import verify
from agents.protocol.facts import SceneFacts
from simworlds.sandbox.errors import Refusal, ToolBroke

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.blender.supervisor import Supervisor
    from agents.blender.tools.base import Call
    from agents.plan.scene import ScenePlan
    from agents.protocol.findings import Report
    from agents.protocol.rule import Rule

SNAPSHOT_SECONDS = 60.0
MEASURE_SECONDS = 600.0


def verify_scene(blender: Supervisor, rules: Sequence[Rule], plan: ScenePlan | None, call: Call) -> Report:
    """Judges the open scene. Raises BlenderError when Blender is lost, or cannot be asked for the facts."""

    def ask(requests: list[dict[str, Any]]) -> list[dict[str, Any]]:
        try:
            return blender.call(
                "measure",
                {"requests": requests},
                timeout=MEASURE_SECONDS,
                progress=call.progress,
                given_up=call.given_up,
            ).value
        except (Refusal, ToolBroke) as error:
            return [{"unmeasured": str(error)}] * len(requests)

    told = blender.call("snapshot", {}, timeout=SNAPSHOT_SECONDS, given_up=call.given_up)
    return verify(SceneFacts.model_validate(told.value), ask, rules, plan)
