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

from bench.audit.actors import Found, find_actors
from bench.audit.facts import Scene
from bench.audit.predicates.catalogue import PREDICATES
from bench.audit.predicates.predicate import Outcome, Stage, Unit, Verdict
from bench.audit.roles import UNMARKED
from bench.audit.spr import Related, judge_relations, share
from bench.audit.untrusted_blend import Crashed, Means, NotScored, Untrusted
from bench.scenes.spec import BadSpec

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Mapping, Sequence
    from pathlib import Path

    from bench.audit.spr import Measurer
    from bench.scenes.spec import Check, Spec

Wanted = Literal["must_have", "must_not_have"]
_SCENE: TypeAdapter[Scene] = TypeAdapter(Scene)
_DIGITS = 6
_FAILING_SHOWN = 4


@dataclass(frozen=True, slots=True)
class Checked:
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
    checks: tuple[Checked, ...]
    score: float | None


@dataclass(frozen=True, slots=True)
class Audit:
    """A scene's audit. ``not_scored``: None, or the reason why the file is not scored; then the rest is empty."""

    scene: str
    not_scored: str | None
    actors: tuple[ActorAudit, ...] = ()
    mpr: float | None = None
    relations: tuple[Related, ...] = ()
    spr: float | None = None
    assertions: tuple[Checked, ...] = ()
    blend: dict[str, Any] = field(default_factory=dict[str, Any])

    def as_json(self) -> str:
        """JSON with sorted keys; the same for the same file, on every run."""
        return json.dumps(asdict(self), indent=1, sort_keys=True, ensure_ascii=False, allow_nan=False)


def audit(
    blend: Path, spec: Spec, means: Means | None = None, progress: Callable[[str], None] | None = None
) -> Audit:
    """Audits a file by a spec. ``progress`` is called with each step, in words.

    Raises BadSpec for a spec with an unknown predicate or wrong parameters, CannotStart if no Blender works.
    """
    check_predicates(spec)
    try:
        tell = progress or _silent
        with opened(blend, means, tell) as (file, scene):
            tell("measuring")
            return audit_of(file, scene, spec)
    except NotScored as error:
        return Audit(spec.id, str(error))


def audit_of(file: Measurer, scene: Scene, spec: Spec) -> Audit:
    """The audit of an open file whose facts have been read."""
    found = find_actors(spec, scene)
    related = judge_relations(spec, scene, found, file)
    return replace(audited(spec, scene, found), relations=related, spr=share(related))


@contextmanager
def opened(
    blend: Path, means: Means | None, progress: Callable[[str], None]
) -> Generator[tuple[Untrusted, Scene]]:
    """A file in its Blender, and its facts. If Blender crashes while playing the clip, only its start is read.

    Raises NotScored, CannotStart.
    """
    with ExitStack() as stack:
        progress("opening")
        file = stack.enter_context(Untrusted(blend, means))
        try:
            progress("reading and playing")
            scene = read_scene(file, play=True)
        except Crashed:
            stack.close()
            progress("reading, without playing")
            file = stack.enter_context(Untrusted(blend, means))
            scene = read_scene(file, play=False)
        yield file, scene


def _silent(_: str) -> None:
    """Ignores progress."""


def read_scene(file: Untrusted, *, play: bool) -> Scene:
    """The facts of an open file. Raises NotScored."""
    try:
        return _SCENE.validate_python(file.ask("facts", play=play, doing="reading it"))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(map(str, first["loc"]))
        raise NotScored(f"Blender's facts of it were not valid: {where}: {first['msg']}") from error


def check_predicates(spec: Spec) -> None:
    """Raises BadSpec for a check with an unknown predicate or wrong parameters."""
    for actor in spec.actors:
        for check in (*actor.must_have, *actor.must_not_have):
            _checked(spec, check, actor.name)
    for check in spec.assertions:
        _checked(spec, check, "assertions")


def _checked(spec: Spec, check: Check, where: str) -> None:
    if check.predicate not in PREDICATES:
        raise BadSpec(f"{spec.id}: {where}: there is no predicate {check.predicate!r}")
    try:
        params = PREDICATES[check.predicate].read(check.params)
    except ValueError as error:
        raise BadSpec(f"{spec.id}: {where}: {error}") from error
    if unknown := [name for name in getattr(params, "partners", ()) if spec.actor(name) is None]:
        raise BadSpec(f"{spec.id}: {where}: {check.predicate}: no actor is called {', '.join(unknown)}")


def audited(spec: Spec, scene: Scene, found: Mapping[str, Found]) -> Audit:
    """The audit of a scene that has been read, its actors found."""
    cast = {name: one.units for name, one in found.items() if one.told_apart}
    stage = Stage(scene, cast, spec.frames.min if spec.frames else 1)
    actors = tuple(_actor(one, stage) for one in found.values())
    scores = [one.score for one in actors if one.score is not None]
    everything = Unit(scene.objects)
    assertions = tuple(
        _asked(check, "must_not_have", _judge(check, everything, stage)) for check in spec.assertions
    )
    return Audit(
        spec.id,
        None,
        actors,
        round(sum(scores) / len(scores), _DIGITS) if scores else None,
        assertions=assertions,
        blend=_seen_of(scene),
    )


def _seen_of(scene: Scene) -> dict[str, Any]:
    return {
        "blender": scene.blender,
        "saved_by": list(scene.saved_by),
        "frames": list(scene.range),
        "fps": scene.fps,
        "objects": len(scene.objects),
        "camera": scene.camera,
        "unplayed": scene.unplayed,
        "missing_libraries": [each.path for each in scene.libraries if each.missing],
        "scripts_not_run": list(scene.scripts),
    }


def _actor(found: Found, stage: Stage) -> ActorAudit:
    actor = found.actor
    checks = (
        *(_check(check, "must_have", found, stage) for check in actor.must_have),
        *(_check(check, "must_not_have", found, stage) for check in actor.must_not_have),
    )
    counted = [check.outcome == "passed" for check in checks if check.outcome != "not_applicable"]
    score = round(sum(counted) / len(counted), _DIGITS) if counted else None
    return ActorAudit(actor.name, actor.role, found.outcome, found.by, found.evidence, checks, score)


def _check(check: Check, wanted: Wanted, found: Found, stage: Stage) -> Checked:
    if not found.told_apart:
        return Checked(check.predicate, wanted, "failed", check.params, {"actor": found.outcome})
    if PREDICATES[check.predicate].scope == "scene":
        objects = tuple(one for unit in found.units for one in unit.objects)
        return _asked(check, wanted, _judge(check, Unit(objects, found.actor.role), stage))
    verdicts = [(unit, _judge(check, unit, stage)) for unit in found.units]
    needed = len(verdicts) if found.outcome == "ambiguous" or wanted == "must_not_have" else 0
    return _of_units(check, wanted, verdicts, max(needed, _count(found)))


def _count(found: Found) -> int:
    """How many units must pass. Of an actor without a solver, one mesh of several loose pieces counts as several."""
    wanted, units = found.actor.count, found.units
    if len(units) >= wanted or found.actor.role not in UNMARKED:
        return wanted
    pieces = sum(max(1, *(one.islands for one in unit.objects)) for unit in units)
    return len(units) if pieces >= wanted else wanted


def _of_units(check: Check, wanted: Wanted, verdicts: Sequence[tuple[Unit, Verdict]], needed: int) -> Checked:
    """The outcome over several units: at least ``needed`` pass; for a ``must_not_have``, none may have it."""
    asked = [(unit, _asked(check, wanted, verdict)) for unit, verdict in verdicts]
    if len(asked) == 1 and needed == 1:
        unit, only = asked[0]
        return replace(only, seen={"object": unit.name, **only.seen})
    if all(one.outcome == "not_applicable" for _, one in asked):
        return asked[0][1]
    good = [unit for unit, one in asked if one.outcome != "failed"]
    bad = [(unit, one) for unit, one in asked if one.outcome == "failed"]
    enough = not bad if wanted == "must_not_have" else len(good) >= needed
    shown = bad or asked[:1]
    seen: dict[str, Any] = {
        "units": len(asked),
        "good": len(good),
        "needed": needed,
        "some": {unit.name: one.seen for unit, one in shown[:_FAILING_SHOWN]},
    }
    return Checked(check.predicate, wanted, "passed" if enough else "failed", check.params, seen)


def _judge(check: Check, unit: Unit, stage: Stage) -> Verdict:
    predicate = PREDICATES[check.predicate]
    return predicate.judge(unit, stage, predicate.read(check.params))


def _asked(check: Check, wanted: Wanted, verdict: Verdict) -> Checked:
    """The outcome of a check by the verdict of its predicate."""
    outcome = verdict.outcome
    if wanted == "must_not_have" and outcome != "not_applicable":
        outcome = "failed" if outcome == "passed" else "passed"
    return Checked(check.predicate, wanted, outcome, check.params, verdict.seen)
