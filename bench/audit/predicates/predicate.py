"""What a predicate is: facts and parameters in, a verdict with the values seen out.

A predicate is a pure function. Its docstring is its definition: what is looked at, the threshold, and why.
"""

from __future__ import annotations

import inspect
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

from pydantic import BaseModel, ConfigDict, ValidationError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from bench.audit.facts import Modifier, Object, Scene

Outcome = Literal["passed", "failed", "not_applicable"]
Group = Literal["universal", "cloth", "fluid", "rigid body", "particle", "soft body", "anti-cheat"]
# unit: judged for each object (with its parts) that stands for the actor. scene: once, over the whole scene.
Scope = Literal["unit", "scene"]
GROUPS: tuple[Group, ...] = (
    "universal", "cloth", "fluid", "rigid body", "particle", "soft body", "anti-cheat",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether a predicate holds, and the values that this was read off (JSON: text, numbers, switches, lists)."""

    outcome: Outcome
    seen: dict[str, Any] = field(default_factory=dict[str, Any])


def judged(holds: object, **seen: Any) -> Verdict:
    """Passed if it holds, else failed."""
    return Verdict("passed" if holds else "failed", seen)


@dataclass(frozen=True, slots=True)
class Unit:
    """One of the things that stand for an actor: its object and what belongs to it, first the object itself."""

    objects: tuple[Object, ...]
    role: str = "static"

    @property
    def name(self) -> str:
        """The object that it is named after; "" for none."""
        return self.objects[0].name if self.objects else ""

    @property
    def names(self) -> frozenset[str]:
        """Of all its objects."""
        return frozenset(one.name for one in self.objects)

    def modifiers(self, *types: str) -> Iterator[tuple[Object, Modifier]]:
        """Its modifiers of these types, with the objects that they stand on."""
        for one in self.objects:
            for modifier in one.of_type(*types):
                yield one, modifier


@dataclass(frozen=True)
class Stage:
    """What surrounds a unit: the scene, whoever else was found in it, and the least length of the clip (frames)."""

    scene: Scene
    cast: Mapping[str, tuple[Unit, ...]] = field(default_factory=dict[str, tuple["Unit", ...]])
    least_frames: int = 1

    def named(self, actor: str) -> tuple[Object, ...]:
        """All objects of an actor's units; () where it was not found."""
        return tuple(one for unit in self.cast.get(actor, ()) for one in unit.objects)


class Params(BaseModel):
    """Parameters of a predicate that has none; those of others derive from it."""

    model_config = ConfigDict(extra="forbid", frozen=True)


@dataclass(frozen=True, slots=True)
class Predicate:
    """A row of the table. ``judge`` gets a unit, the stage and ``params``."""

    name: str
    group: Group
    judge: Callable[[Unit, Stage, Any], Verdict]
    params: type[Params] = Params
    scope: Scope = "unit"

    @property
    def definition(self) -> str:
        """What it looks at, its threshold and why: one paragraph."""
        return " ".join((inspect.getdoc(self.judge) or "").split())

    def read(self, given: Mapping[str, Any]) -> Params:
        """Its parameters from a spec's. Raises ValueError, saying which one is wrong."""
        try:
            return self.params.model_validate(dict(given))
        except ValidationError as error:
            wrong = "; ".join(
                f"{'.'.join(map(str, one['loc']))}: {one['msg']}" for one in error.errors(include_url=False)
            )
            raise ValueError(f"{self.name}: {wrong}") from error
