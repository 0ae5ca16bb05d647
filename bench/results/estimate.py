"""How long a sweep of many systems takes on many machines, from the times of tasks that were measured."""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from statistics import fmean
from typing import TYPE_CHECKING

from bench.scenes.spec import specs

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from bench.results.scores import Results, Scored
    from bench.scenes.spec import Spec

STEPS = ("produced", "audited", "framed", "judged")


@dataclass(frozen=True, slots=True)
class Estimate:
    """Seconds. ``work``: by step, over all scenes of one system; ``one``: done one after the other.

    ``measured``: of how many scenes the times were measured; the others are taken to last as long as those of their
    category do, or else as all do. ``together``: from begin to end, all systems on all machines. ``longest``: of one
    scene.
    """

    measured: int
    scenes: int
    systems: int
    machines: int
    at_a_time: int
    work: dict[str, float]
    one: float
    together: float
    longest: float


def estimate(
    results: Results, *, systems: int, machines: int, at_a_time: int, making: float | None = None
) -> Estimate | None:
    """All scenes by so many systems like those measured, ``at_a_time`` on each machine; None without measurements.

    ``making``: seconds that a system takes for a scene, instead of those measured.
    """
    times = _measured(results)
    if not times:
        return None
    every = specs()
    by_scene = {spec.id: _of(spec, times) for spec in every}
    if making is not None:
        by_scene = {name: each | {"produced": making} for name, each in by_scene.items()}
    work = {step: sum(each[step] for each in by_scene.values()) for step in STEPS}
    tasks = [sum(each.values()) for each in by_scene.values()]
    return Estimate(
        measured=len(times),
        scenes=len(every),
        systems=systems,
        machines=machines,
        at_a_time=at_a_time,
        work=work,
        one=sum(tasks),
        together=makespan(tasks * systems, machines * at_a_time),
        longest=max(tasks),
    )


def makespan(tasks: Sequence[float], workers: int) -> float:
    """When the last of ``workers`` is done, if each takes the next task when it is free, in the order given."""
    free = [0.0] * min(workers, max(1, len(tasks)))
    for seconds in tasks:
        heapq.heapreplace(free, free[0] + seconds)
    return max(free)


def _measured(results: Results) -> dict[str, dict[str, float]]:
    """Scene → step → seconds, the mean over systems; a step that was not done is left out."""
    found: dict[str, dict[str, list[float]]] = {}
    for system in results.systems:
        for name, scene in system.scenes.items():
            if scene.record.audited is None or scene.record.audited.file is None:
                continue
            for step, seconds in _seconds(scene):
                found.setdefault(name, {}).setdefault(step, []).append(seconds)
    return {name: {step: fmean(several) for step, several in steps.items()} for name, steps in found.items()}


def _seconds(scene: Scored) -> Iterator[tuple[str, float]]:
    """What a system took itself is in its minutes: it may have worked in several sessions."""
    record = scene.record
    if record.produced is not None:
        minutes = record.produced.minutes
        yield "produced", record.produced.seconds if minutes is None else minutes * 60
    for step, part in (("audited", record.audited), ("framed", record.framed), ("judged", record.judged)):
        if part is not None and part.why is None:
            yield step, part.seconds


def _of(spec: Spec, times: dict[str, dict[str, float]]) -> dict[str, float]:
    """Of each step, what was measured of the scene, or else the mean of its category, or of all; 0 where of none."""
    kin = [each for name, each in times.items() if name.partition("_")[0] == spec.category]
    found: dict[str, float] = {}
    for step in STEPS:
        nearest = ([times.get(spec.id, {})], kin, times.values())
        known = ([each[step] for each in several if step in each] for several in nearest)
        found[step] = fmean(next((seconds for seconds in known if seconds), [0.0]))
    return found
