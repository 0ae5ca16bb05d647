"""Types of a predicate: a pure function from facts and parameters to a verdict with the values that decided it.

A predicate's docstring is its definition: what is checked, the threshold, and why.
"""

from __future__ import annotations

import inspect
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from simworlds.schemas.faults import every_fault

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from bench.audit.facts import Modifier, Object, Scene

Outcome = Literal["passed", "failed", "not_applicable"]
Group = Literal["universal", "cloth", "fluid", "rigid body", "particle", "soft body", "anti-cheat"]
# unit: judged for each unit of the actor. scene: once, over the whole scene.
Scope = Literal["unit", "scene"]
GROUPS: tuple[Group, ...] = (
    "universal", "cloth", "fluid", "rigid body", "particle", "soft body", "anti-cheat",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class PredicateVerdict:
    """Whether a predicate holds, and the values that decided it (JSON data)."""

    outcome: Outcome
    seen: dict[str, Any] = field(default_factory=dict[str, Any])


def verdict_of(holds: object, **seen: Any) -> PredicateVerdict:
    """A verdict: passed if ``holds``, else failed; the other arguments are the values seen."""
    return PredicateVerdict("passed" if holds else "failed", seen)


@dataclass(frozen=True, slots=True)
class Unit:
    """One instance of an actor in the file: its main object, then the objects that belong to it."""

    objects: tuple[Object, ...]
    role: str = "static"

    @property
    def name(self) -> str:
        """The name of its main object; "" without objects."""
        return self.objects[0].name if self.objects else ""

    @property
    def names(self) -> frozenset[str]:
        """The names of all its objects."""
        return frozenset(obj.name for obj in self.objects)

    def modifiers(self, *types: str) -> Iterator[tuple[Object, Modifier]]:
        """Its modifiers of these types, each with its object."""
        for obj in self.objects:
            for modifier in obj.of_type(*types):
                yield obj, modifier


@dataclass(frozen=True)
class AuditContext:
    """The surroundings of a unit: the scene, the units of all actors, and the clip's minimum length (frames)."""

    scene: Scene
    units: Mapping[str, tuple[Unit, ...]] = field(default_factory=dict[str, tuple["Unit", ...]])
    least_frames: int = 1

    def named(self, actor: str) -> tuple[Object, ...]:
        """All objects of an actor's units; () if it was not found."""
        return tuple(obj for unit in self.units.get(actor, ()) for obj in unit.objects)


class PredicateParams(BaseModel):
    """Base of the parameters of predicates; by itself, of those without any."""

    model_config = ConfigDict(extra="forbid", frozen=True)


@dataclass(frozen=True, slots=True)
class Predicate:
    """An entry of the catalogue. ``judge`` gets a unit, its context and ``params``."""

    name: str
    group: Group
    judge: Callable[[Unit, AuditContext, Any], PredicateVerdict]
    params: type[PredicateParams] = PredicateParams
    scope: Scope = "unit"

    @property
    def definition(self) -> str:
        """What it checks, its threshold and why: one paragraph."""
        return " ".join((inspect.getdoc(self.judge) or "").split())

    def read(self, given: Mapping[str, Any]) -> PredicateParams:
        """Its parameters, read from a spec's. Raises ValueError that names the wrong one."""
        try:
            return self.params.model_validate(dict(given))
        except ValidationError as invalid:
            raise ValueError(f"{self.name}: {every_fault(invalid)}") from invalid
