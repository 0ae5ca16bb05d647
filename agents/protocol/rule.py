"""What a rule is: it requests measurements and judges by them, without Blender."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from agents.protocol.findings import Finding

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from agents.plan.scene import ScenePlan
    from agents.protocol.facts import SceneFacts
    from agents.protocol.findings import Severity
    from agents.protocol.measures.requests import Measures, Request
    from agents.protocol.structure import SceneStructure
    from agents.protocol.tolerances import Tolerances


@dataclass(frozen=True, slots=True)
class RuleContext:
    """What a rule judges: a scene's facts, and the plan that it was built to, if there is one.

    ``judges_end``: the last frame counts too. It does not where simulations lack an up-to-date bake and no rule follows
    motion: then all of them would be simulated for it, and what is set up may still change.
    """

    facts: SceneFacts
    structure: SceneStructure
    tolerances: Tolerances
    plan: ScenePlan | None = None
    judges_end: bool = True

    @property
    def planned(self) -> ScenePlan:
        """The plan, for rules that need one."""
        assert self.plan is not None
        return self.plan


NO_PLAN = "no plan was given"
NO_ROLES = "no collection has the tag protocol_role"  # why rules about the layout do not apply


class NotApplicable(Exception):  # noqa: N818 - a state, not a failure
    """A rule has nothing to judge in this scene; the message says why."""


def no_requests(_context: RuleContext) -> Iterable[Request[Any]]:
    """The requests of rules that need no measurements."""
    return ()


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule: ``requests`` yields what to measure, ``judge`` yields findings; both may raise NotApplicable.

    ``about`` says what must hold, ``why`` what goes wrong otherwise, ``fix`` what to do. ``needs_plan``: the rule does
    not apply without a plan. ``tolerances`` are the names of those it uses.
    """

    id: str
    name: str
    severity: Severity
    about: str
    why: str
    fix: str
    judge: Callable[[RuleContext, Measures], Iterable[Finding]]
    requests: Callable[[RuleContext], Iterable[Request[Any]]] = no_requests
    needs_plan: bool = False
    tolerances: tuple[str, ...] = ()

    @property
    def follows_motion(self) -> bool:
        """Whether it is of the family that follows actors through the whole timeline."""
        return self.id.startswith("T")

    def finding(self, objects: tuple[str, ...], message: str, **more: Any) -> Finding:
        """A breach of this rule; ``more`` are further fields of the finding."""
        return Finding(self.id, self.severity, objects, message, more.pop("fix", self.fix), **more)

    def undecided(self, objects: tuple[str, ...], reason: object, **more: Any) -> Finding:
        """A finding that the rule could not be decided for ``objects``, and why."""
        message = f"{', '.join(map(repr, objects)) or 'The scene'} could not be checked: {reason}."
        return Finding(
            self.id, self.severity, objects, message, more.pop("fix", self.fix), outcome="undecided", **more
        )
