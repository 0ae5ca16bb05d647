"""The audit of a .blend: which parts of a scene's spec hold for its data in Blender, whoever made it.

For each actor, the checks of its spec with the values seen; MPR, the mean over actors of the share of their checks that
pass (checks that do not apply are left out; an actor that is missing, or cannot be identified, scores 0); the relations
and SPR; the assertions about the whole scene. A file that cannot be read is not scored, and the audit says why. The
audit looks at no pixels and relies on no system's conventions. The same file gives the same JSON.
"""

from __future__ import annotations

import json
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

from pydantic import TypeAdapter, ValidationError

from bench.audit.actors import ActorResolution, find_actors
from bench.audit.facts import Scene
from bench.audit.predicates.catalogue import PREDICATES
from bench.audit.predicates.predicate import AuditContext, Outcome, PredicateVerdict, Unit
from bench.audit.roles import UNMARKED
from bench.audit.spr import RelationResult, judge_relations, spr_of
from bench.audit.untrusted_blend import BlenderOptions, Crashed, NotScored, UntrustedBlend
from bench.scenes.spec import BadSpec
from simworlds.schemas.faults import first_fault

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Mapping, Sequence
    from pathlib import Path

    from bench.audit.spr import BlenderQuery
    from bench.scenes.spec import Spec, SpecCheck

Wanted = Literal["must_have", "must_not_have"]
_SCENE: TypeAdapter[Scene] = TypeAdapter(Scene)
_DIGITS = 6
_MOST_FAILING = 4


@dataclass(frozen=True, slots=True)
class CheckResult:
    """A check of an actor, or of the scene. ``outcome``: of the check; of a ``must_not_have``, it passes if absent."""

    predicate: str
    wanted: Wanted
    outcome: Outcome
    params: dict[str, Any] = field(default_factory=dict[str, Any])
    seen: dict[str, Any] = field(default_factory=dict[str, Any])


@dataclass(frozen=True, slots=True)
class ActorAudit:
    """An actor: how it was found (``outcome``: resolved, ambiguous, missing), its checks, the share that passes.

    ``score`` is None if none of its checks applies.
    """

    name: str
    role: str
    outcome: str
    by: str
    evidence: dict[str, Any]
    checks: tuple[CheckResult, ...]
    score: float | None


@dataclass(frozen=True, slots=True)
class Audit:
    """A scene's audit. ``not_scored``: None, or the reason why the file is not scored; then the rest is empty."""

    scene: str
    not_scored: str | None
    actors: tuple[ActorAudit, ...] = ()
    mpr: float | None = None
    relations: tuple[RelationResult, ...] = ()
    spr: float | None = None
    assertions: tuple[CheckResult, ...] = ()
    blend: dict[str, Any] = field(default_factory=dict[str, Any])

    def as_json(self) -> str:
        """JSON with sorted keys; the same for the same file, on every run."""
        return json.dumps(asdict(self), indent=1, sort_keys=True, ensure_ascii=False, allow_nan=False)


def audit(
    blend: Path,
    spec: Spec,
    means: BlenderOptions | None = None,
    progress: Callable[[str], None] | None = None,
) -> Audit:
    """Audits a file by a spec. ``progress`` is called with each step, in words.

    Raises BadSpec for a spec with an unknown predicate or wrong parameters, CannotStart if no Blender works.
    """
    check_predicates(spec)
    try:
        report = progress or _ignore_progress
        with open_scene(blend, means, report) as (file, scene):
            report("measuring")
            return audit_of(file, scene, spec)
    except NotScored as error:
        return Audit(spec.id, str(error))


def audit_of(file: BlenderQuery, scene: Scene, spec: Spec) -> Audit:
    """The audit of an open file whose facts have been read."""
    resolutions = find_actors(spec, scene)
    relations = judge_relations(spec, scene, resolutions, file)
    return replace(audit_scene(spec, scene, resolutions), relations=relations, spr=spr_of(relations))


@contextmanager
def open_scene(
    blend: Path, means: BlenderOptions | None, progress: Callable[[str], None]
) -> Generator[tuple[UntrustedBlend, Scene]]:
    """A file in its Blender, and its facts. If Blender crashes while playing the clip, only its start is read.

    Raises NotScored, CannotStart.
    """
    with ExitStack() as stack:
        progress("opening")
        file = stack.enter_context(UntrustedBlend(blend, means))
        try:
            progress("reading and playing")
            scene = read_scene(file, play=True)
        except Crashed:
            stack.close()
            progress("reading, without playing")
            file = stack.enter_context(UntrustedBlend(blend, means))
            scene = read_scene(file, play=False)
        yield file, scene


def _ignore_progress(_: str) -> None:
    """Ignores progress."""


def read_scene(file: UntrustedBlend, *, play: bool) -> Scene:
    """The facts of an open file. Raises NotScored."""
    try:
        return _SCENE.validate_python(file.ask("facts", play=play, doing="reading it"))
    except ValidationError as error:
        raise NotScored(f"Blender's facts of it were not valid: {first_fault(error)}") from error


def check_predicates(spec: Spec) -> None:
    """Raises BadSpec for a check with an unknown predicate or wrong parameters."""
    for actor in spec.actors:
        for check in (*actor.must_have, *actor.must_not_have):
            _check_known(spec, check, actor.name)
    for check in spec.assertions:
        _check_known(spec, check, "assertions")


def _check_known(spec: Spec, check: SpecCheck, where: str) -> None:
    if check.predicate not in PREDICATES:
        raise BadSpec(f"{spec.id}: {where}: there is no predicate {check.predicate!r}")
    try:
        params = PREDICATES[check.predicate].read(check.params)
    except ValueError as error:
        raise BadSpec(f"{spec.id}: {where}: {error}") from error
    if unknown := [name for name in getattr(params, "partners", ()) if spec.actor(name) is None]:
        raise BadSpec(f"{spec.id}: {where}: {check.predicate}: no actor is called {', '.join(unknown)}")


def audit_scene(spec: Spec, scene: Scene, resolutions: Mapping[str, ActorResolution]) -> Audit:
    """The audit of a scene that has been read, its actors found."""
    units = {name: resolution.units for name, resolution in resolutions.items() if resolution.can_be_judged}
    context = AuditContext(scene, units, spec.frames.min if spec.frames else 1)
    actors = tuple(_audit_actor(resolution, context) for resolution in resolutions.values())
    scores = [resolution.score for resolution in actors if resolution.score is not None]
    everything = Unit(scene.objects)
    assertions = tuple(
        _result_of(check, "must_not_have", _judge(check, everything, context)) for check in spec.assertions
    )
    return Audit(
        spec.id,
        None,
        actors,
        round(sum(scores) / len(scores), _DIGITS) if scores else None,
        assertions=assertions,
        blend=_blend_facts(scene),
    )


def _blend_facts(scene: Scene) -> dict[str, Any]:
    return {
        "blender": scene.blender,
        "saved_by": list(scene.saved_by),
        "frames": list(scene.range),
        "fps": scene.fps,
        "objects": len(scene.objects),
        "camera": scene.camera,
        "unplayed": scene.unplayed,
        "missing_libraries": [library.path for library in scene.libraries if library.missing],
        "scripts_not_run": list(scene.scripts),
    }


def _audit_actor(resolution: ActorResolution, context: AuditContext) -> ActorAudit:
    actor = resolution.actor
    checks = (
        *(_check_actor(check, "must_have", resolution, context) for check in actor.must_have),
        *(_check_actor(check, "must_not_have", resolution, context) for check in actor.must_not_have),
    )
    counted = [check.outcome == "passed" for check in checks if check.outcome != "not_applicable"]
    score = round(sum(counted) / len(counted), _DIGITS) if counted else None
    return ActorAudit(
        actor.name, actor.role, resolution.outcome, resolution.by, resolution.evidence, checks, score
    )


def _check_actor(
    check: SpecCheck, wanted: Wanted, resolution: ActorResolution, context: AuditContext
) -> CheckResult:
    if not resolution.can_be_judged:
        return CheckResult(check.predicate, wanted, "failed", check.params, {"actor": resolution.outcome})
    if PREDICATES[check.predicate].scope == "scene":
        objects = tuple(obj for unit in resolution.units for obj in unit.objects)
        return _result_of(check, wanted, _judge(check, Unit(objects, resolution.actor.role), context))
    verdicts = [(unit, _judge(check, unit, context)) for unit in resolution.units]
    needed = len(verdicts) if resolution.outcome == "ambiguous" or wanted == "must_not_have" else 0
    return _combine_units(check, wanted, verdicts, max(needed, _count(resolution)))


def _count(resolution: ActorResolution) -> int:
    """How many units must pass. Of an actor without a solver, one mesh of several loose pieces counts as several."""
    wanted, units = resolution.actor.count, resolution.units
    if len(units) >= wanted or resolution.actor.role not in UNMARKED:
        return wanted
    pieces = sum(max(1, *(obj.islands for obj in unit.objects)) for unit in units)
    return len(units) if pieces >= wanted else wanted


def _combine_units(
    check: SpecCheck, wanted: Wanted, verdicts: Sequence[tuple[Unit, PredicateVerdict]], needed: int
) -> CheckResult:
    """The outcome over several units: at least ``needed`` pass; for a ``must_not_have``, none may have it."""
    results = [(unit, _result_of(check, wanted, verdict)) for unit, verdict in verdicts]
    if len(results) == 1 and needed == 1:
        unit, result = results[0]
        return replace(result, seen={"object": unit.name, **result.seen})
    if all(result.outcome == "not_applicable" for _, result in results):
        return results[0][1]
    passing = [unit for unit, result in results if result.outcome != "failed"]
    failing = [(unit, result) for unit, result in results if result.outcome == "failed"]
    enough = not failing if wanted == "must_not_have" else len(passing) >= needed
    listed = failing or results[:1]
    seen: dict[str, Any] = {
        "units": len(results),
        "good": len(passing),
        "needed": needed,
        "some": {unit.name: result.seen for unit, result in listed[:_MOST_FAILING]},
    }
    return CheckResult(check.predicate, wanted, "passed" if enough else "failed", check.params, seen)


def _judge(check: SpecCheck, unit: Unit, context: AuditContext) -> PredicateVerdict:
    predicate = PREDICATES[check.predicate]
    return predicate.judge(unit, context, predicate.read(check.params))


def _result_of(check: SpecCheck, wanted: Wanted, verdict: PredicateVerdict) -> CheckResult:
    """The outcome of a check by the verdict of its predicate."""
    outcome = verdict.outcome
    if wanted == "must_not_have" and outcome != "not_applicable":
        outcome = "failed" if outcome == "passed" else "passed"
    return CheckResult(check.predicate, wanted, outcome, check.params, verdict.seen)
