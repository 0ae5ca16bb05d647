"""Results as they lie on the disk, read for a report: for each system and scene three scores, or why there is none."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, TypeAlias

from bench.scenes.spec import BadSpec, spec_of
from bench.sweep.records import BadRecord, Record, SystemInfo, read_record, scene_folders

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from bench.scenes.spec import Spec

Metric: TypeAlias = Literal["mpr", "spr", "vlm"]
METRICS: tuple[Metric, ...] = ("mpr", "spr", "vlm")
TITLES: dict[Metric, str] = {"mpr": "MPR", "spr": "SPR", "vlm": "VLM"}


@dataclass(frozen=True, slots=True)
class Scored:
    """One scene by one system."""

    spec: Spec
    record: Record
    folder: Path

    def asks(self, metric: Metric) -> bool:
        """Whether the scene counts for this score: a static one has no mechanism to pass."""
        if metric == "mpr":
            return self.spec.category != "static"
        return metric != "spr" or bool(self.spec.relations)

    def score(self, metric: Metric) -> float | None:
        """From 0 to 1; None where it was not scored, or does not count."""
        if not self.asks(metric):
            return None
        if metric == "vlm":
            judged = self.record.judged
            return judged.score if judged is not None and judged.why is None else None
        audited = self.record.audited
        if audited is None or audited.why is not None:
            return None
        return audited.mpr if metric == "mpr" else audited.spr

    def why_not(self, metric: Metric) -> str:
        """Why there is no score, in words; "" where there is one, or it does not count."""
        if not self.asks(metric) or self.score(metric) is not None:
            return ""
        step = self.record.judged if metric == "vlm" else self.record.audited
        if step is None:
            return "not looked at yet"
        return step.why or "nothing of it could be measured"


@dataclass(frozen=True, slots=True)
class SystemResults:
    """All scenes that a system was asked for, in the benchmark's order."""

    info: SystemInfo
    scenes: dict[str, Scored] = field(default_factory=dict[str, Scored])

    @property
    def name(self) -> str:
        """What it is called."""
        return self.info.name


@dataclass(frozen=True, slots=True)
class Results:
    """Systems, in the order of the folders that were named; ``faults``: what could not be read, in words."""

    systems: tuple[SystemResults, ...]
    faults: tuple[str, ...] = ()

    def system(self, name: str) -> SystemResults | None:
        """The system of that name."""
        return next((one for one in self.systems if one.name == name), None)


def read_results(folders: Iterable[Path]) -> Results:
    """The results below these folders. Of two of a scene by one name, the first counts, the other is a fault."""
    systems: dict[str, SystemResults] = {}
    faults: list[str] = []
    for folder in (found for each in folders for found in scene_folders(each)):
        try:
            record = read_record(folder)
            assert record is not None
            scored = Scored(spec_of(record.scene), record, folder)
        except (BadRecord, BadSpec) as error:
            faults.append(f"{folder}: {error}")
            continue
        system = systems.setdefault(record.system.name, SystemResults(record.system))
        if record.scene in system.scenes:
            faults.append(
                f"{folder}: {record.system.name} has another result for {record.scene}; it is left out"
            )
        else:
            system.scenes[record.scene] = scored
    return Results(tuple(systems.values()), tuple(faults))
