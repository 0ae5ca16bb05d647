"""Reads results from disk for a report: for each system and scene three scores, or why there is none."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, TypeAlias

from bench.scenes.spec import BadSpec, spec_of
from bench.sweep.records import BadSceneRecord, SceneRecord, SystemInfo, read_record, scene_folders

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from bench.scenes.spec import Spec

Metric: TypeAlias = Literal["mpr", "spr", "vlm"]
METRICS: tuple[Metric, ...] = ("mpr", "spr", "vlm")
TITLES: dict[Metric, str] = {"mpr": "MPR", "spr": "SPR", "vlm": "VLM"}


@dataclass(frozen=True, slots=True)
class SceneResult:
    """One scene by one system."""

    spec: Spec
    record: SceneRecord
    folder: Path

    def asks(self, metric: Metric) -> bool:
        """Whether the scene counts for this score: static scenes have no MPR, scenes without relations no SPR."""
        if metric == "mpr":
            return self.spec.category != "static"
        return metric != "spr" or bool(self.spec.relations)

    def score(self, metric: Metric) -> float | None:
        """From 0 to 1; None if it was not scored, or does not count."""
        if not self.asks(metric):
            return None
        if metric == "vlm":
            judged = self.record.judged
            return judged.score if judged is not None and judged.why is None else None
        audited = self.record.audited
        if audited is None or audited.why is not None:
            return None
        return audited.mpr if metric == "mpr" else audited.spr

    @property
    def judge(self) -> str:
        """Who judged it, with which prompts; "" if nobody did."""
        judged = self.record.judged
        if judged is None or judged.why is not None:
            return ""
        return f"{judged.provider}/{judged.model}, prompts {judged.prompt_version}"

    def why_not(self, metric: Metric) -> str:
        """Why there is no score, in words; "" if there is one, or it does not count."""
        if not self.asks(metric) or self.score(metric) is not None:
            return ""
        step = self.record.judged if metric == "vlm" else self.record.audited
        if step is None:
            return "not done yet"
        return step.why or "no check or relation could be scored"


@dataclass(frozen=True, slots=True)
class SystemResults:
    """All scenes that a system was given, in the benchmark's order."""

    info: SystemInfo
    scenes: dict[str, SceneResult] = field(default_factory=dict[str, SceneResult])

    @property
    def name(self) -> str:
        """Its name."""
        return self.info.name


@dataclass(frozen=True, slots=True)
class ResultSet:
    """Systems, in the order of their folders; ``faults``: results that could not be read, in words."""

    systems: tuple[SystemResults, ...]
    faults: tuple[str, ...] = ()

    def system(self, name: str) -> SystemResults | None:
        """The system of that name."""
        return next((system for system in self.systems if system.name == name), None)


def read_results(folders: Iterable[Path]) -> ResultSet:
    """Reads the results below these folders. If a system has two results for a scene, the second is a fault."""
    systems: dict[str, SystemResults] = {}
    faults: list[str] = []
    for folder in (scene_folder for parent in folders for scene_folder in scene_folders(parent)):
        try:
            record = read_record(folder)
            assert record is not None
            scored = SceneResult(spec_of(record.scene), record, folder)
        except (BadSceneRecord, BadSpec) as error:
            faults.append(f"{folder}: {error}")
            continue
        system = systems.setdefault(record.system.name, SystemResults(record.system))
        if record.scene in system.scenes:
            faults.append(
                f"{folder}: {record.system.name} has another result for {record.scene}; this one is ignored"
            )
        else:
            system.scenes[record.scene] = scored
    return ResultSet(tuple(systems.values()), tuple(faults))
