"""Runs the verifier on the open scene: gets its facts and measurements from Blender."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from agents.protocol.engine import verify
from agents.protocol.facts import SceneFacts
from simworlds.sandbox.errors import Refusal, ToolBroke
from simworlds.sandbox.replies import Claim, Frame, Name

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.blender.supervisor import Supervisor
    from agents.blender.tools.base import Call
    from agents.plan.scene import ScenePlan
    from agents.protocol.findings import Report
    from agents.protocol.rule import Rule

SNAPSHOT_SECONDS = 60.0
MEASURE_SECONDS = 600.0


class ScenePosition(Claim):
    """The open scene, and the frame that it is at."""

    scene: Name
    frame: Frame


def read_measures(count: int, value: Any) -> list[dict[str, Any]]:
    """Blender's answers to ``count`` requests; each is read by its request's own model. Raises ValueError."""
    if (
        not isinstance(value, list)
        or len(value) != count
        or not all(isinstance(each, dict) for each in value)
    ):
        raise ValueError(f"it does not hold {count} answers")
    return value


def verify_scene(blender: Supervisor, rules: Sequence[Rule], plan: ScenePlan | None, call: Call) -> Report:
    """Checks the open scene against rules. Raises BlenderError if Blender is lost or cannot give the facts."""

    def measure(requests: list[dict[str, Any]]) -> list[dict[str, Any]]:
        try:
            return blender.call(
                "measure",
                {"requests": requests},
                partial(read_measures, len(requests)),
                timeout=MEASURE_SECONDS,
                progress=call.progress,
                cancelled=call.cancelled,
            ).value
        except (Refusal, ToolBroke) as error:
            return [{"unmeasured": str(error)}] * len(requests)

    facts = blender.call(
        "scene_facts", {}, SceneFacts.model_validate, timeout=SNAPSHOT_SECONDS, cancelled=call.cancelled
    )
    return verify(facts.value, measure, rules, plan)
