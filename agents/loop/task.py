"""What a run is held to, from its plan on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from agents.protocol.rules_by_stage import rules_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from agents.plan.edit import EditedActor
    from agents.plan.part import Stage
    from agents.plan.scene import ScenePlan
    from agents.protocol.findings import Finding
    from simworlds.llm.messages import Picture

_MOST_NAMES, _MOST_OLD = 200, 5_000  # of a tool's arguments
_READOUT_TOKENS = 2_000  # of a readout that is given with every request of an edit


@dataclass(frozen=True, slots=True)
class RunTask:
    """``plan_text`` is the whole plan in words; ``plan`` the scene plan that the verifier compares with.

    An ``edit`` has no scene plan; it is judged without what was ``known`` of the file before, and, unless the file is
    ``tagged`` (keeps the scene protocol), without the rules of its layout. ``actors`` are those that move;
    of an edit, ``declared`` says by what, ``targets`` are what its plan changes, ``mentioned`` objects that it speaks
    of besides, ``old`` the objects that the file had, and ``off_plan`` finds what has changed that its plan does not
    ask for, and what moves without the tags that it asks for.
    ``before`` is a still of the file as it was, at ``before_frame``, of ``before_width`` pixels and of
    ``before_samples`` a pixel, and ``goal`` a picture of what it is to look like.
    """

    plan_text: str
    plan: ScenePlan | None = None
    actors: tuple[str, ...] = ()
    edit: bool = False
    tagged: bool = True
    known: tuple[Finding, ...] = ()
    declared: tuple[EditedActor, ...] = ()
    targets: tuple[str, ...] = ()
    mentioned: tuple[str, ...] = ()
    old: tuple[str, ...] = ()
    off_plan: Callable[[Stage], list[Finding]] | None = None
    before: Picture | None = None
    before_frame: int | None = None
    before_width: int | None = None
    before_samples: int | None = None
    goal: Picture | None = None

    def readout(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Arguments of the scene's readout, and those that follow from the run.

        Of an edit, what its plan changes, adds or speaks of is told in full, the rest counted; of a new scene, all is
        told.
        """
        if not self.edit:
            return {}, {}
        named = list(dict.fromkeys((*self.targets, *self.actors, *self.mentioned)))[:_MOST_NAMES]
        return {"focus": named, "max_tokens": _READOUT_TOKENS}, self.old_objects

    @property
    def old_objects(self) -> dict[str, Any]:
        """The argument of a tool that tells what an edit added from what was there."""
        return {"old": list(self.old)} if len(self.old) <= _MOST_OLD else {}

    @property
    def trial(self) -> dict[str, Any]:
        """The argument of ``blender_trial`` that says what it tells of before others."""
        return {"first": list(self.actors)[:_MOST_NAMES]}

    def verification(self, stage: Stage) -> dict[str, Any]:
        """What ``blender_verify`` is asked at the end of a stage."""
        rules = [rule.id for rule in rules_of(stage, edit=self.edit, tagged=self.tagged)]
        if self.plan is None:
            return {"rules": rules}
        return {"rules": rules, "plan": self.plan.model_dump(mode="json", exclude_defaults=True)}
