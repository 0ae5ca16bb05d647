"""The spec of a 4DBuildBench scene: its prompt, and what the result is checked for (paper, "Benchmark Details").

Specs are YAML files in ``bench/scenes``, one per scene, named after its id. A check is a predicate's name, or a mapping
of this name to its parameters.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from simworlds.schemas.faults import every_fault

try:  # the one in C reads all specs in a tenth of the time; it is not built everywhere
    from yaml import CSafeLoader as Loader
except ImportError:
    from yaml import SafeLoader as Loader

if TYPE_CHECKING:
    from collections.abc import Iterator

FOLDER = Path(__file__).parent

Category = Literal["cloth", "fluid", "rigid", "particle", "soft", "static"]
Level = Literal["D1", "D2", "D3"]
Role = Literal[
    "cloth", "fluid_domain", "fluid_flow", "fluid_effector", "rigid_active", "rigid_passive", "particle_emitter",
    "particle_hair", "soft", "force", "collider", "keyframed", "static",
]  # fmt: skip
PhaseKind = Literal[
    "hold", "move", "fall", "slide", "roll", "spin", "topple", "swing", "bounce", "break", "drape", "flutter", "deform",
    "flow", "emit", "settle",
]  # fmt: skip
When = Literal["start", "middle", "end"]
RelationType = Literal[
    "SupportedBy", "OnTopOf", "Inside", "InContact", "Against", "AttachedTo", "NextTo", "Above", "Below", "LeftOf",
    "RightOf", "InFrontOf", "Behind",
]  # fmt: skip
CATEGORIES: tuple[Category, ...] = ("cloth", "fluid", "rigid", "particle", "soft", "static")
WHEN: tuple[When, ...] = ("start", "middle", "end")
Name = Annotated[str, Field(min_length=1, max_length=60)]
Share = Annotated[float, Field(ge=0, le=1)]


class BadSpec(Exception):  # noqa: N818 - reads as the state it names
    """An invalid spec; the message says which file, where, and what is wrong."""


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class SpecCheck(_Part):
    """A predicate, and its parameters."""

    predicate: str
    params: dict[str, Any] = Field(default_factory=dict[str, Any])

    @model_validator(mode="before")
    @classmethod
    def _written(cls, given: Any) -> Any:
        """``name``, or ``{name: {…}}``."""
        if isinstance(given, str):
            return {"predicate": given}
        if isinstance(given, dict) and len(given) == 1 and "predicate" not in given:
            [(name, params)] = given.items()
            return {"predicate": name, "params": params or {}}
        return given


class Hints(_Part):
    """How to find an actor without its name: the diagonal of its bounds (metres), its topology, its collection."""

    size: tuple[float, float] | None = None
    topology: Literal["open", "closed", "any"] = "any"
    collection: Literal["object", "any"] = "any"


class SpecActor(_Part):
    """Something that the prompt names. ``count``: how many units of it there must be.

    ``implied``: the prompt does not name it, but the scene cannot be built without it (a source of fluid, a floor).
    """

    name: Name
    synonyms: tuple[Name, ...] = ()
    role: Role
    implied: bool = False
    count: int = Field(default=1, ge=1)
    hints: Hints = Hints()
    must_have: tuple[SpecCheck, ...] = Field(min_length=1)
    must_not_have: tuple[SpecCheck, ...] = ()


class SpecRelation(_Part):
    """How ``a`` stands to ``b`` at these times of the clip; ``tolerance``: metres apart, or deep.

    It must hold for each unit of ``a``, to all units of ``b`` together.
    """

    type: RelationType
    a: Name
    b: Name
    when: tuple[When, ...] = WHEN
    tolerance: float = Field(default=0.02, gt=0)


class SpecPhase(_Part):
    """What an actor does, from ``start`` to ``end`` (shares of the clip)."""

    actor: Name
    kind: PhaseKind
    start: Share
    end: Share


class ClipLength(_Part):
    """The minimum length of the clip (frames)."""

    min: int = Field(ge=2)
    fps: int = Field(default=24, ge=1)


class Spec(_Part):
    """One scene. ``assertions`` are predicates of the whole scene that must not hold."""

    id: str = Field(pattern=r"^(cloth|fluid|rigid|particle|soft|static)_D[123]_\d\d$")
    category: Category
    level: Level
    prompt: str = Field(min_length=20, max_length=900)
    frames: ClipLength | None = None
    actors: tuple[SpecActor, ...] = Field(min_length=1)
    relations: tuple[SpecRelation, ...] = ()
    phases: tuple[SpecPhase, ...] = ()
    assertions: tuple[SpecCheck, ...] = ()

    @property
    def cell(self) -> str:
        """Its cell in the result tables: category and level."""
        return f"{self.category}_{self.level}"

    def actor(self, name: str) -> SpecActor | None:
        """The actor of that name."""
        return next((actor for actor in self.actors if actor.name == name), None)

    @model_validator(mode="after")
    def _consistent(self) -> Spec:
        names = [actor.name for actor in self.actors]
        if not self.id.startswith(f"{self.category}_{self.level}_"):
            raise ValueError(f"id: {self.id} does not begin with {self.category}_{self.level}_")
        if repeated := {name for name in names if names.count(name) > 1}:
            raise ValueError(f"actors: {', '.join(sorted(repeated))}: this name is used twice")
        if unknown := {name for name in self._named() if name not in names}:
            raise ValueError(f"no actor is called {', '.join(sorted(unknown))}")
        if (self.frames is None) != (self.category == "static"):
            raise ValueError("frames: required, except for static scenes, which have none")
        return self

    def _named(self) -> Iterator[str]:
        for relation in self.relations:
            yield from (relation.a, relation.b)
        yield from (phase.actor for phase in self.phases)


def read_spec(path: Path) -> Spec:
    """The spec in a file. Raises BadSpec."""
    try:
        return Spec.model_validate(yaml.load(path.read_text("utf-8"), Loader))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise BadSpec(f"{path.name} cannot be read: {error}") from error
    except ValidationError as error:
        raise BadSpec(f"{path.name}: {every_fault(error, whole='spec')}") from error


@cache
def specs() -> tuple[Spec, ...]:
    """All scenes, by category, level and number. Raises BadSpec."""
    unsorted = [read_spec(path) for path in FOLDER.glob("*.yaml")]
    return tuple(sorted(unsorted, key=lambda spec: (CATEGORIES.index(spec.category), spec.id)))


def spec_of(name: str) -> Spec:
    """The scene of that id. Raises BadSpec."""
    spec = next((spec for spec in specs() if spec.id == name), None)
    if spec is None:
        raise BadSpec(f"There is no scene {name[:80]!r}. List them with 'simworlds bench list'.")
    return spec
