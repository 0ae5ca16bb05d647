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
from bench.audit.relation_measures import Measured, Pair
from bench.audit.relations import KINDS
from bench.audit.untrusted_blend import NotScored
from bench.scenes.spec import WHEN

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from bench.audit.actors import Found
    from bench.audit.facts import Object, Scene
    from bench.audit.predicates.predicate import Unit
    from bench.scenes.spec import Relation, RelationType, Role, Spec, When

Outcome = Literal["holds", "does not hold", "not scored"]
# Of an actor with more units than these, an even selection is measured.
MOST_UNITS = 24
# Roles that may overlap anything: sources, forces, fluids.
_NO_BODIES: tuple[Role, ...] = ("fluid_flow", "force", "particle_emitter", "fluid_domain")
_BY_CONTACT: tuple[RelationType, ...] = (
    "SupportedBy", "OnTopOf", "InContact", "Against", "AttachedTo", "NextTo",
)  # fmt: skip
_MEASURED: TypeAdapter[list[dict[str, Measured]]] = TypeAdapter(list[dict[str, Measured]])
_DIGITS = 6


class Measurer(Protocol):
    """A file in its Blender, as ``bench.audit.untrusted_blend.Untrusted`` is."""

    def ask(self, job: str, *, doing: str, **arguments: Any) -> Any:
        """What Blender answers. Raises NotScored."""
        ...


@dataclass(frozen=True, slots=True)
class At:
    """A relation of one ``unit`` at one time of the clip. ``seen``: the values measured, in metres."""

    when: When
    frame: int | None
    unit: str
    outcome: Outcome
    seen: dict[str, Any] = field(default_factory=dict[str, Any])


@dataclass(frozen=True, slots=True)
class Related:
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
    moments: tuple[At, ...] = ()
    units: int = 0
    holding: int = 0
    assembled: tuple[str, ...] = ()


def share(related: Sequence[Related]) -> float | None:
    """SPR; None if no relation is scored."""
    scored = [one for one in related if one.outcome != "not scored"]
    return round(sum(one.outcome == "holds" for one in scored) / len(scored), _DIGITS) if scored else None


def judge_relations(
    spec: Spec, scene: Scene, found: Mapping[str, Found], file: Measurer
) -> tuple[Related, ...]:
    """The verdicts, in the spec's order. A relation that Blender cannot measure is not scored, and says why."""
    try:
        return _Judge(spec, scene, found, file).judged()
    except NotScored as error:
        return tuple(_told(relation, "not scored", str(error)) for relation in spec.relations)


@dataclass(frozen=True, slots=True)
class _Case:
    """One unit of ``a`` and all of ``b``, to be measured at those times (``known``) whose motion was played."""

    relation: Relation
    unit: str
    a: tuple[str, ...]
    b: tuple[str, ...]
    known: tuple[When, ...]

    def pair(self) -> Pair:
        turns = tuple(WHEN.index(when) for when in self.known)
        first, second = (self.b, self.a) if self.relation.type == "Below" else (self.a, self.b)
        return Pair(first, second, turns, self.relation.tolerance, KINDS[self.relation.type].wants)


class _Judge:
    def __init__(self, spec: Spec, scene: Scene, found: Mapping[str, Found], file: Measurer) -> None:
        self._spec, self._found, self._file, self._scene = spec, found, file, scene
        self._objects = {one.name: one for one in scene.objects}
        cast = {name for one in found.values() for unit in one.units for name in unit.names}
        self._assemblies = Assemblies(scene, cast)

    def judged(self) -> tuple[Related, ...]:
        absent = {relation: self._absent(relation) for relation in self._spec.relations}
        cases = [case for relation, why in absent.items() if not why for case in self._cases(relation)]
        plain = self._verdicts(cases)
        again = [grown for case in cases if _failed(plain[case]) and (grown := self._grown(case)) != case]
        inferred = self._verdicts(again)
        results: dict[Relation, Related] = {}
        for relation, why in absent.items():
            if why:
                results[relation] = _told(relation, "does not hold", why)
                continue
            own = [case for case in cases if case.relation == relation]
            results[relation] = self._of(relation, own, plain, inferred)
        return tuple(results[relation] for relation in self._spec.relations)

    def _of(
        self,
        relation: Relation,
        cases: list[_Case],
        plain: Mapping[_Case, tuple[At, ...]],
        inferred: Mapping[_Case, tuple[At, ...]],
    ) -> Related:
        looked: list[tuple[At, ...]] = []
        assembled: set[str] = set()
        for case in cases:
            found = plain[case]
            grown = self._grown(case) if _failed(found) else case
            if grown in inferred and not _failed(inferred[grown]):
                found = inferred[grown]
                assembled |= {*grown.a, *grown.b} - {*case.a, *case.b}
            looked.append(found)
        moments = tuple(_deciding(each) for each in zip(*looked, strict=True))
        outcomes = {at.outcome for at in moments}
        outcome: Outcome = "holds"
        if "does not hold" in outcomes:
            outcome = "does not hold"
        elif "not scored" in outcomes:
            outcome = "not scored"
        why = f"motion not played: {self._scene.unplayed}" if outcome == "not scored" else ""
        holding = sum(not _failed(each) for each in looked)
        return replace(
            _told(relation, outcome, why),
            moments=moments,
            units=len(cases),
            holding=holding,
            assembled=tuple(sorted(assembled)),
        )

    def _absent(self, relation: Relation) -> str:
        """Why there is nothing to measure, in words; "" if there is."""
        for name in (relation.a, relation.b):
            if not self._found[name].told_apart:
                return f"{name} is {self._found[name].outcome}"
        return ""

    def _cases(self, relation: Relation) -> list[_Case]:
        units = _even(self._found[relation.a].units)
        others = [name for unit in self._found[relation.b].units for name in self._shown(unit)]
        b = tuple(dict.fromkeys(others))
        cases: list[_Case] = []
        for unit in units:
            a = self._shown(unit)
            still = any(self._is_still(name) for name in (*a, *b))
            known: tuple[When, ...] = tuple(
                when for when in WHEN if when in relation.when and (when == "start" or not still)
            )
            cases.append(_Case(relation, unit.name, a, b, known))
        return cases

    def _shown(self, unit: Unit) -> tuple[str, ...]:
        """The objects of a unit that are measured: those that are rendered, or if none is, all of them."""
        own = [one for one in unit.objects if one.in_scene]
        seen = [one for one in own if one.renders and (one.type in GEOMETRY or one.instances is not None)]
        return tuple(one.name for one in seen or own)

    def _is_still(self, name: str) -> bool:
        """Whether its motion was not played, or may come from an object whose motion was not."""
        waiting, seen = [name], set[str]()
        while waiting:
            one = self._objects.get(waiting.pop())
            if one is None or one.name in seen:
                continue
            if one.in_scene and _unplayed(one):
                return True
            seen.add(one.name)
            waiting += one.follows
        return False

    def _grown(self, case: _Case) -> _Case:
        if case.relation.type not in _BY_CONTACT:
            return case
        return replace(case, a=self._assemblies.grown(case.a), b=self._assemblies.grown(case.b))

    def _verdicts(self, cases: list[_Case]) -> dict[_Case, tuple[At, ...]]:
        if not cases:
            return {}
        pairs = [asdict(case.pair()) for case in cases]
        try:
            told = _MEASURED.validate_python(self._file.ask("measure", pairs=pairs, doing="measuring it"))
        except ValidationError as error:
            raise NotScored("Blender's measurements were not valid") from error
        if len(told) != len(cases):
            raise NotScored(f"Blender measured {len(told)} pairs instead of {len(cases)}")
        return {case: self._judged(case, each) for case, each in zip(cases, told, strict=True)}

    def _judged(self, case: _Case, told: Mapping[str, Measured]) -> tuple[At, ...]:
        return tuple(
            self._at(case, when, told.get(str(WHEN.index(when))))
            for when in WHEN
            if when in case.relation.when
        )

    def _at(self, case: _Case, when: When, now: Measured | None) -> At:
        if now is None:
            return At(when, None, case.unit, "not scored")
        if now.empty:
            return At(when, now.frame, case.unit, "does not hold", {"nothing_of": list(now.empty)})
        relation = case.relation
        stands = KINDS[relation.type].judge(now, relation.tolerance, self._are_bodies(relation))
        outcome: Outcome = "holds" if stands.holds else "does not hold"
        return At(when, now.frame, case.unit, outcome, stands.seen)

    def _are_bodies(self, relation: Relation) -> bool:
        actors = (self._found[name].actor for name in (relation.a, relation.b))
        return all(actor.role not in _NO_BODIES for actor in actors)


def _unplayed(one: Object) -> bool:
    return len(one.moments) < len(WHEN)


def _failed(moments: Iterable[At]) -> bool:
    return any(at.outcome == "does not hold" for at in moments)


def _deciding(several: Sequence[At]) -> At:
    """The deciding one of several units at one time: the first that fails, else is not scored, else the first."""
    for outcome in ("does not hold", "not scored"):
        for at in several:
            if at.outcome == outcome:
                return at
    return several[0]


def _even(units: Sequence[Unit]) -> list[Unit]:
    if len(units) <= MOST_UNITS:
        return list(units)
    return [units[place * (len(units) - 1) // (MOST_UNITS - 1)] for place in range(MOST_UNITS)]


def _told(relation: Relation, outcome: Outcome, why: str) -> Related:
    return Related(relation.type, relation.a, relation.b, relation.tolerance, outcome, why)
