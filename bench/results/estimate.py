"""Estimates how long a sweep of many systems takes on many machines, from measured times."""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from statistics import fmean
from typing import TYPE_CHECKING

from bench.scenes.spec import specs

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from bench.results.scores import ResultSet, SceneResult
    from bench.scenes.spec import Spec

STEPS = ("produced", "audited", "framed", "judged")


@dataclass(frozen=True, slots=True)
class SweepEstimate:
    """Times in seconds. ``work``: by step, over all scenes of one system; ``one``: their sum, one after the other.

    ``measured``: how many scenes have measured times; the others get the mean of their category, or else of all.
    ``together``: from start to end, all systems on all machines. ``longest``: of one scene.
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
    results: ResultSet, *, systems: int, machines: int, at_a_time: int, making: float | None = None
) -> SweepEstimate | None:
    """The estimate for all scenes by ``systems`` systems, ``at_a_time`` on each machine; None without measured times.

    ``making``: seconds that a system takes for a scene, instead of the measured ones.
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
    return SweepEstimate(
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
    """When the last of ``workers`` is done, if each takes the next task in order when it is free."""
    free = [0.0] * min(workers, max(1, len(tasks)))
    for seconds in tasks:
        heapq.heapreplace(free, free[0] + seconds)
    return max(free)


def _measured(results: ResultSet) -> dict[str, dict[str, float]]:
    """Scene → step → seconds, the mean over systems; steps that were not done are left out."""
    times: dict[str, dict[str, list[float]]] = {}
    for system in results.systems:
        for name, scene in system.scenes.items():
            audited = scene.record.audited
            if audited is None or audited.file is None or audited.why is not None:
                continue
            for step, seconds in _seconds(scene):
                times.setdefault(name, {}).setdefault(step, []).append(seconds)
    return {
        name: {step: fmean(seconds_list) for step, seconds_list in steps.items()}
        for name, steps in times.items()
    }


def _seconds(scene: SceneResult) -> Iterator[tuple[str, float]]:
    """Step → seconds. A system's own time is in its minutes, since it may have worked in several sessions."""
    record = scene.record
    if record.produced is not None:
        minutes = record.produced.minutes
        yield "produced", record.produced.seconds if minutes is None else minutes * 60
    for step, part in (("audited", record.audited), ("framed", record.framed), ("judged", record.judged)):
        if part is not None and part.why is None:
            yield step, part.seconds


def _of(spec: Spec, times: dict[str, dict[str, float]]) -> dict[str, float]:
    """Step → seconds: as measured for the scene, or else the mean of its category, or of all scenes, or 0."""
    category_times = [each for name, each in times.items() if name.partition("_")[0] == spec.category]
    seconds_of: dict[str, float] = {}
    for step in STEPS:
        nearest = ([times.get(spec.id, {})], category_times, times.values())
        known = ([each[step] for each in several if step in each] for several in nearest)
        seconds_of[step] = fmean(next((seconds for seconds in known if seconds), [0.0]))
    return seconds_of
