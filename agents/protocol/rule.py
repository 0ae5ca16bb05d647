"""What a rule is: it asks for measurements, and judges by them. It never sees Blender."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from agents.protocol.findings import Finding

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from agents.plan.scene import ScenePlan
    from agents.protocol.facts import Facts
    from agents.protocol.findings import Severity
    from agents.protocol.measures.measure import Measures, Request
    from agents.protocol.structure import Structure
    from agents.protocol.tolerances import Tolerances


@dataclass(frozen=True, slots=True)
class Subject:
    """What is judged: a scene's facts, and the plan it was built to, if there is one."""

    facts: Facts
    structure: Structure
    tolerances: Tolerances
    plan: ScenePlan | None = None

    @property
    def planned(self) -> ScenePlan:
        """The plan; for rules that need one."""
        assert self.plan is not None
        return self.plan


class Idle(Exception):  # noqa: N818 - reads as the state it names
    """A rule has nothing to judge in this scene; the message says why."""


def nothing(_subject: Subject) -> Iterable[Request[Any]]:
    """For rules that facts suffice for."""
    return ()


@dataclass(frozen=True, slots=True)
class Rule:
    """``requests`` names what is to be measured, ``judge`` yields findings (both may raise Idle).

    ``about`` says in a sentence what must hold, ``why`` what goes wrong otherwise, ``fix`` what to do.
    ``needs_plan``: without a plan it has nothing to judge.
    """

    id: str
    name: str
    severity: Severity
    about: str
    why: str
    fix: str
    judge: Callable[[Subject, Measures], Iterable[Finding]]
    requests: Callable[[Subject], Iterable[Request[Any]]] = nothing
    needs_plan: bool = False
    tolerances: tuple[str, ...] = ()

    def finding(self, objects: tuple[str, ...], message: str, **more: Any) -> Finding:
        """A breach of this rule; ``more`` are further fields of the finding."""
        return Finding(self.id, self.severity, objects, message, more.pop("fix", self.fix), **more)

    def undecided(self, objects: tuple[str, ...], reason: object, **more: Any) -> Finding:
        """That it could not be told whether this rule holds there, and why."""
        message = f"Could not be decided for {', '.join(map(repr, objects)) or 'the scene'}: {reason}."
        return Finding(self.id, self.severity, objects, message, self.fix, outcome="undecided", **more)
