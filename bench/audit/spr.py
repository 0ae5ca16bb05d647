"""SPR: the share of a spec's relations that hold in a file, by distances that Blender measures.

A relation holds if each unit of ``a`` stands in it to ``b`` at each time that the spec names. It does not hold if an
actor is missing, or has no visible geometry. It is not scored if it depends on motion that was not played, such as
unbaked physics. SPR counts scored relations only.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal, Protocol

from pydantic import TypeAdapter, ValidationError

from bench.audit.assembly import Assemblies
from bench.audit.facts import GEOMETRY
from bench.audit.relation_measures import PairMeasurement, PairRequest
from bench.audit.relations import RELATIONS
from bench.audit.untrusted_blend import NotScored
from bench.scenes.spec import WHEN

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from bench.audit.actors import ActorResolution
    from bench.audit.facts import Object, Scene
    from bench.audit.predicates.predicate import Unit
    from bench.scenes.spec import RelationType, Role, Spec, SpecRelation, When

Outcome = Literal["holds", "does not hold", "not scored"]
# Of an actor with more units than these, an even selection is measured.
MOST_UNITS = 24
# Roles that may overlap anything: sources, forces, fluids.
_NOT_BODIES: tuple[Role, ...] = ("fluid_flow", "force", "particle_emitter", "fluid_domain")
_GROWS_BY_CONTACT: tuple[RelationType, ...] = (
    "SupportedBy", "OnTopOf", "InContact", "Against", "AttachedTo", "NextTo",
)  # fmt: skip
_MEASURED: TypeAdapter[list[dict[str, PairMeasurement]]] = TypeAdapter(list[dict[str, PairMeasurement]])
_DIGITS = 6


class BlenderQuery(Protocol):
    """A file in its Blender, as ``bench.audit.untrusted_blend.UntrustedBlend`` is."""

    def ask(self, job: str, *, doing: str, **arguments: Any) -> Any:
        """What Blender answers. Raises NotScored."""
        ...


@dataclass(frozen=True, slots=True)
class RelationMoment:
    """A relation of one ``unit`` at one time of the clip. ``seen``: the values measured, in metres."""

    when: When
    frame: int | None
    unit: str
    outcome: Outcome
    seen: dict[str, Any] = field(default_factory=dict[str, Any])


@dataclass(frozen=True, slots=True)
class RelationResult:
    """A relation's verdict. ``why``: the reason, in words, if nothing was measured or it is not scored.

    ``moments``: for each time, the deciding unit: the first for which the relation does not hold, or else the first.
    ``units``: how many units of ``a`` were measured; ``holding``: for how many it holds. ``assembled``: objects that
    were inferred to belong to either actor, without which it would not hold.
    """

    type: str
    a: str
    b: str
    tolerance: float
    outcome: Outcome
    why: str = ""
    moments: tuple[RelationMoment, ...] = ()
    units: int = 0
    holding: int = 0
    assembled: tuple[str, ...] = ()


def spr_of(results: Sequence[RelationResult]) -> float | None:
    """SPR; None if no relation is scored."""
    scored = [result for result in results if result.outcome != "not scored"]
    return (
        round(sum(result.outcome == "holds" for result in scored) / len(scored), _DIGITS) if scored else None
    )


def judge_relations(
    spec: Spec, scene: Scene, resolutions: Mapping[str, ActorResolution], file: BlenderQuery
) -> tuple[RelationResult, ...]:
    """The verdicts, in the spec's order. A relation that Blender cannot measure is not scored, and says why."""
    try:
        return _RelationJudge(spec, scene, resolutions, file).results()
    except NotScored as error:
        return tuple(_unmeasured(relation, "not scored", str(error)) for relation in spec.relations)


@dataclass(frozen=True, slots=True)
class _Case:
    """One unit of ``a`` and all of ``b``, to be measured at those times (``known``) whose motion was played."""

    relation: SpecRelation
    unit: str
    a: tuple[str, ...]
    b: tuple[str, ...]
    known: tuple[When, ...]

    def pair(self) -> PairRequest:
        turns = tuple(WHEN.index(when) for when in self.known)
        first, second = (self.b, self.a) if self.relation.type == "Below" else (self.a, self.b)
        return PairRequest(first, second, turns, self.relation.tolerance, RELATIONS[self.relation.type].wants)


class _RelationJudge:
    def __init__(
        self, spec: Spec, scene: Scene, resolutions: Mapping[str, ActorResolution], file: BlenderQuery
    ) -> None:
        self._spec, self._resolutions, self._file, self._scene = spec, resolutions, file, scene
        self._objects = {obj.name: obj for obj in scene.objects}
        actor_objects = {
            name for resolution in resolutions.values() for unit in resolution.units for name in unit.names
        }
        self._assemblies = Assemblies(scene, actor_objects)

    def results(self) -> tuple[RelationResult, ...]:
        absent = {relation: self._absent(relation) for relation in self._spec.relations}
        cases = [case for relation, why in absent.items() if not why for case in self._cases(relation)]
        plain = self._verdicts(cases)
        again = [grown for case in cases if _failed(plain[case]) and (grown := self._grown(case)) != case]
        inferred = self._verdicts(again)
        results: dict[SpecRelation, RelationResult] = {}
        for relation, why in absent.items():
            if why:
                results[relation] = _unmeasured(relation, "does not hold", why)
                continue
            own = [case for case in cases if case.relation == relation]
            results[relation] = self._of(relation, own, plain, inferred)
        return tuple(results[relation] for relation in self._spec.relations)

    def _of(
        self,
        relation: SpecRelation,
        cases: list[_Case],
        plain: Mapping[_Case, tuple[RelationMoment, ...]],
        inferred: Mapping[_Case, tuple[RelationMoment, ...]],
    ) -> RelationResult:
        measured: list[tuple[RelationMoment, ...]] = []
        assembled: set[str] = set()
        for case in cases:
            found = plain[case]
            grown = self._grown(case) if _failed(found) else case
            if grown in inferred and not _failed(inferred[grown]):
                found = inferred[grown]
                assembled |= {*grown.a, *grown.b} - {*case.a, *case.b}
            measured.append(found)
        moments = tuple(_deciding(each) for each in zip(*measured, strict=True))
        outcomes = {at.outcome for at in moments}
        outcome: Outcome = "holds"
        if "does not hold" in outcomes:
            outcome = "does not hold"
        elif "not scored" in outcomes:
            outcome = "not scored"
        why = f"motion not played: {self._scene.unplayed}" if outcome == "not scored" else ""
        holding = sum(not _failed(each) for each in measured)
        return replace(
            _unmeasured(relation, outcome, why),
            moments=moments,
            units=len(cases),
            holding=holding,
            assembled=tuple(sorted(assembled)),
        )

    def _absent(self, relation: SpecRelation) -> str:
        """Why there is nothing to measure, in words; "" if there is."""
        for name in (relation.a, relation.b):
            if not self._resolutions[name].can_be_judged:
                return f"{name} is {self._resolutions[name].outcome}"
        return ""

    def _cases(self, relation: SpecRelation) -> list[_Case]:
        units = _even_selection(self._resolutions[relation.a].units)
        names = [name for unit in self._resolutions[relation.b].units for name in self._visible(unit)]
        b = tuple(dict.fromkeys(names))
        cases: list[_Case] = []
        for unit in units:
            a = self._visible(unit)
            unplayed = any(self._is_unplayed(name) for name in (*a, *b))
            known: tuple[When, ...] = tuple(
                when for when in WHEN if when in relation.when and (when == "start" or not unplayed)
            )
            cases.append(_Case(relation, unit.name, a, b, known))
        return cases

    def _visible(self, unit: Unit) -> tuple[str, ...]:
        """The objects of a unit that are measured: those that are rendered, or if none is, all of them."""
        objects = [obj for obj in unit.objects if obj.in_scene]
        visible = [
            obj for obj in objects if obj.renders and (obj.type in GEOMETRY or obj.instances is not None)
        ]
        return tuple(obj.name for obj in visible or objects)

    def _is_unplayed(self, name: str) -> bool:
        """Whether its motion was not played, or may come from an object whose motion was not."""
        waiting, seen = [name], set[str]()
        while waiting:
            obj = self._objects.get(waiting.pop())
            if obj is None or obj.name in seen:
                continue
            if obj.in_scene and _lacks_motion(obj):
                return True
            seen.add(obj.name)
            waiting += obj.follows
        return False

    def _grown(self, case: _Case) -> _Case:
        if case.relation.type not in _GROWS_BY_CONTACT:
            return case
        return replace(case, a=self._assemblies.grown(case.a), b=self._assemblies.grown(case.b))

    def _verdicts(self, cases: list[_Case]) -> dict[_Case, tuple[RelationMoment, ...]]:
        if not cases:
            return {}
        pairs = [asdict(case.pair()) for case in cases]
        try:
            replies = _MEASURED.validate_python(self._file.ask("measure", pairs=pairs, doing="measuring it"))
        except ValidationError as error:
            raise NotScored("Blender's measurements were not valid") from error
        if len(replies) != len(cases):
            raise NotScored(f"Blender measured {len(replies)} pairs instead of {len(cases)}")
        return {case: self._judged(case, reply) for case, reply in zip(cases, replies, strict=True)}

    def _judged(self, case: _Case, reply: Mapping[str, PairMeasurement]) -> tuple[RelationMoment, ...]:
        return tuple(
            self._at(case, when, reply.get(str(WHEN.index(when))))
            for when in WHEN
            if when in case.relation.when
        )

    def _at(self, case: _Case, when: When, now: PairMeasurement | None) -> RelationMoment:
        if now is None:
            return RelationMoment(when, None, case.unit, "not scored")
        if now.empty:
            return RelationMoment(
                when, now.frame, case.unit, "does not hold", {"nothing_of": list(now.empty)}
            )
        relation = case.relation
        verdict = RELATIONS[relation.type].judge(now, relation.tolerance, self._are_bodies(relation))
        outcome: Outcome = "holds" if verdict.holds else "does not hold"
        return RelationMoment(when, now.frame, case.unit, outcome, verdict.seen)

    def _are_bodies(self, relation: SpecRelation) -> bool:
        actors = (self._resolutions[name].actor for name in (relation.a, relation.b))
        return all(actor.role not in _NOT_BODIES for actor in actors)


def _lacks_motion(obj: Object) -> bool:
    return len(obj.moments) < len(WHEN)


def _failed(moments: Iterable[RelationMoment]) -> bool:
    return any(at.outcome == "does not hold" for at in moments)


def _deciding(moments: Sequence[RelationMoment]) -> RelationMoment:
    """The deciding one of several units at one time: the first that fails, else is not scored, else the first."""
    for outcome in ("does not hold", "not scored"):
        for moment in moments:
            if moment.outcome == outcome:
                return moment
    return moments[0]


def _even_selection(units: Sequence[Unit]) -> list[Unit]:
    if len(units) <= MOST_UNITS:
        return list(units)
    return [units[place * (len(units) - 1) // (MOST_UNITS - 1)] for place in range(MOST_UNITS)]


def _unmeasured(relation: SpecRelation, outcome: Outcome, why: str) -> RelationResult:
    return RelationResult(relation.type, relation.a, relation.b, relation.tolerance, outcome, why)
