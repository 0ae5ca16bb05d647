"""A sweep: scores and judges all scenes by one system, or rescores those that are there."""

from __future__ import annotations

from collections import Counter
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from bench.scenes.spec import BadSpec, spec_of
from bench.sweep.executor import Executor, FinishedTask
from bench.sweep.judging import SweepJudge, judge_all
from bench.sweep.records import NAME, BadSceneRecord, SystemInfo, read_record, scene_folders
from bench.sweep.run_steps import is_done
from bench.sweep.scene_task import SceneTask
from bench.sweep.steps import STEPS
from bench.sweep.systems.folder import FolderSystem
from bench.sweep.systems.simworlds_runs import ReplaySystem, SimWorldsSystem
from bench.sweep.systems.system import SystemNotReady
from simworlds.folder_lock import locked

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bench.audit.untrusted_blend import BlenderOptions
    from bench.frames.clip_frames import RenderQuality
    from bench.scenes.spec import Spec
    from bench.sweep.sweep_view import SweepView
    from bench.sweep.systems.system import SceneSystem


@dataclass(frozen=True)
class ScoringOptions:
    """How scenes are scored, for any system: see SceneTask."""

    means: BlenderOptions
    look: RenderQuality
    frames: bool = True
    from_video: bool = True


@dataclass(frozen=True)
class SweepSummary:
    """How many scenes were requested, scored and judged; why others were not, with counts. ``why_stands``: of those
    of which an earlier judgement stays, since the judge that was asked gave none.

    ``faults``: (scene, why) of scenes that could not be run here; the next sweep tries them again.
    """

    asked: int
    scored: int
    judged: int
    why_not_scored: dict[str, int]
    why_not_judged: dict[str, int]
    why_stands: dict[str, int]
    faults: tuple[tuple[str, str], ...]


def make_tasks(system: SceneSystem, specs: Sequence[Spec], out: Path, how: ScoringOptions) -> list[SceneTask]:
    """Makes a task for each scene. Raises SystemNotReady if ``out`` has results of other settings, BadSceneRecord."""
    steps = tuple(name for name in STEPS if name != "frames" or how.frames)
    folder = out / system.info.name
    for spec in specs:
        _check_same(folder / spec.id, system)
    return [
        SceneTask(spec, system, folder / spec.id, how.means, how.look, steps, how.from_video)
        for spec in specs
    ]


def sweep(tasks: Sequence[SceneTask], judge: SweepJudge, executor: Executor, view: SweepView) -> SweepSummary:
    """Runs the tasks, then judges. All results are on the disk whenever it ends.

    Raises Refusal where another sweep works in the folder, BadSceneRecord, OSError.
    """
    folder = tasks[0].folder.parent
    folder.mkdir(parents=True, exist_ok=True)
    faults: list[tuple[str, str]] = []
    with locked(folder), view:
        standing = [task for task in tasks if is_done(task)]
        for task in standing:
            view.done(FinishedTask(task, read_record(task.folder)))
        due = [task for task in tasks if task not in standing]
        with closing(executor.work(due, view.doing)) as work:
            for done in work:
                view.done(done)
                if done.record is None:
                    faults.append((done.task.spec.id, done.fault))
        framed = [task for task in tasks if "frames" in task.steps and (task.folder / NAME).is_file()]
        stands: list[str] = []
        for scene in judge_all(framed, judge):
            if scene.record.judged is not None and scene.record.judged.key:  # a judge was asked
                view.judged(scene)
            if scene.stands:
                stands.append(scene.stands)
    return _summary(tasks, faults, stands)


def _summary(
    tasks: Sequence[SceneTask], faults: list[tuple[str, str]], stands: Sequence[str]
) -> SweepSummary:
    records = [record for task in tasks if (record := read_record(task.folder)) is not None]
    audits = [record.audited for record in records if record.audited is not None]
    judgements = [record.judged for record in records if record.judged is not None]
    return SweepSummary(
        len(tasks),
        sum(audit.why is None for audit in audits),
        sum(judged.why is None for judged in judgements) - len(stands),
        dict(Counter(audit.why for audit in audits if audit.why is not None)),
        dict(Counter(judged.why for judged in judgements if judged.why is not None)),
        dict(Counter(stands)),
        tuple(faults),
    )


def _check_same(folder: Path, system: SceneSystem) -> None:
    """Refuses to overwrite results of other settings. Raises SystemNotReady."""
    record = read_record(folder)
    if record is None or record.produced is None or system.source is not None:
        return
    before, now = (
        {"kind": info.kind, "ablations": info.ablations, **info.settings}
        for info in (record.system, system.info)
    )
    other = [
        f"{name} {before.get(name)} (now {now.get(name)})"
        for name in sorted({*before, *now})
        if before.get(name) != now.get(name)
    ]
    if other:
        raise SystemNotReady(
            f"{folder.parent} holds results of other settings: {', '.join(other)}. Give these a --name of their own, "
            "or another --out."
        )


# Rescoring


def make_rescore_tasks(out: Path, how: ScoringOptions) -> list[list[SceneTask]]:
    """Makes tasks for all results below ``out``, system by system, which run no system again. Raises BadSceneRecord."""
    tasks: dict[str, list[SceneTask]] = {}
    for folder in scene_folders(out):
        record = read_record(folder)
        assert record is not None
        try:
            spec = spec_of(record.scene)
        except BadSpec as error:
            raise BadSceneRecord(f"{folder / NAME}: {error}") from error
        system = system_from_record(record.system)
        takes = system.source is not None and system.source.is_dir()
        steps = tuple(
            name for name in STEPS if (name != "produce" or takes) and (name != "frames" or how.frames)
        )
        task = SceneTask(spec, system, folder, how.means, how.look, steps, how.from_video)
        tasks.setdefault(str(folder.parent), []).append(task)
    return list(tasks.values())


def system_from_record(info: SystemInfo) -> SceneSystem:
    """The system of a record; it is not run again."""
    if info.kind == "folder":
        return FolderSystem(info, Path(str(info.settings.get("folder", ""))))
    return ReplaySystem(info) if info.kind == "replay" else SimWorldsSystem(info)
