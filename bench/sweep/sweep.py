"""A sweep: all scenes by one system, done by whoever does them, then judged; and the same again for what is there."""

from __future__ import annotations

from collections import Counter
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from agents.blender.run_folder import locked
from bench.scenes.spec import BadSpec, spec_of
from bench.sweep.executor import Crew, Done
from bench.sweep.judging import Judge, judge_all
from bench.sweep.records import NAME, BadRecord, SystemInfo, read_record, scene_folders
from bench.sweep.scene_task import Task, is_done
from bench.sweep.steps import STEPS
from bench.sweep.systems.folder import Folder
from bench.sweep.systems.simworlds_runs import Make, Replay
from bench.sweep.systems.system import NotReady

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bench.audit.untrusted_blend import BlenderOptions
    from bench.frames.clip_frames import RenderQuality
    from bench.scenes.spec import Spec
    from bench.sweep.sweep_view import View
    from bench.sweep.systems.system import System


@dataclass(frozen=True)
class How:
    """How scenes are scored, whatever the system: see Task."""

    means: BlenderOptions
    look: RenderQuality
    frames: bool = True
    from_video: bool = True


@dataclass(frozen=True)
class Summary:
    """What became of the scenes: how many were ``asked`` for, ``scored``, ``judged``; why others were not (counted).

    ``faults``: scenes that could not be done at all here (scene, why), which the next sweep tries again.
    """

    asked: int
    scored: int
    judged: int
    why_not_scored: dict[str, int]
    why_not_judged: dict[str, int]
    faults: tuple[tuple[str, str], ...]


def tasks_of(system: System, specs: Sequence[Spec], out: Path, how: How) -> list[Task]:
    """A task a scene, below ``out``. Raises NotReady where other settings' results lie there; BadRecord."""
    steps = tuple(name for name in STEPS if name != "frames" or how.frames)
    folder = out / system.info.name
    for spec in specs:
        _check_same(folder / spec.id, system)
    return [
        Task(spec, system, folder / spec.id, how.means, how.look, steps, how.from_video) for spec in specs
    ]


def sweep(tasks: Sequence[Task], judge: Judge, crew: Crew, view: View) -> Summary:
    """Does the tasks, then judges; all results are on the disk whenever it ends.

    Raises Refusal where another sweep works in the folder, BadRecord, OSError.
    """
    folder = tasks[0].folder.parent
    folder.mkdir(parents=True, exist_ok=True)
    faults: list[tuple[str, str]] = []
    with locked(folder), view:
        standing = [task for task in tasks if is_done(task)]
        for task in standing:
            view.done(Done(task, read_record(task.folder)))
        due = [task for task in tasks if task not in standing]
        with closing(crew.work(due, view.doing)) as work:
            for done in work:
                view.done(done)
                if done.record is None:
                    faults.append((done.task.spec.id, done.fault))
        framed = [task for task in tasks if "frames" in task.steps and (task.folder / NAME).is_file()]
        for task, record in judge_all(framed, judge):
            if record.judged is not None and record.judged.key:  # somebody was asked
                view.judged(task, record)
    return _summary(tasks, faults)


def _summary(tasks: Sequence[Task], faults: list[tuple[str, str]]) -> Summary:
    records = [record for task in tasks if (record := read_record(task.folder)) is not None]
    audits = [record.audited for record in records if record.audited is not None]
    judgements = [record.judged for record in records if record.judged is not None]
    return Summary(
        len(tasks),
        sum(audit.why is None for audit in audits),
        sum(one.why is None for one in judgements),
        dict(Counter(audit.why for audit in audits if audit.why is not None)),
        dict(Counter(one.why for one in judgements if one.why is not None)),
        tuple(faults),
    )


def _check_same(folder: Path, system: System) -> None:
    """What a system made is not overwritten by what it makes with other settings."""
    record = read_record(folder)
    if record is None or record.produced is None or system.source is not None:
        return
    before, now = (
        {"kind": one.kind, "ablations": one.ablations, **one.settings} for one in (record.system, system.info)
    )
    other = [
        f"{name} {before.get(name)} (now {now.get(name)})"
        for name in sorted({*before, *now})
        if before.get(name) != now.get(name)
    ]
    if other:
        raise NotReady(
            f"{folder.parent} holds results of other settings: {', '.join(other)}. Give these a --name of their own, "
            "or another --out."
        )


# Once more, without the systems


def tasks_again(out: Path, how: How) -> list[list[Task]]:
    """Tasks for all that lies below ``out``, system by system, that run no system again. Raises BadRecord."""
    found: dict[str, list[Task]] = {}
    for folder in scene_folders(out):
        record = read_record(folder)
        assert record is not None
        try:
            spec = spec_of(record.scene)
        except BadSpec as error:
            raise BadRecord(f"{folder / NAME}: {error}") from error
        system = system_again(record.system)
        takes = system.source is not None and system.source.is_dir()
        steps = tuple(
            name for name in STEPS if (name != "produce" or takes) and (name != "frames" or how.frames)
        )
        task = Task(spec, system, folder, how.means, how.look, steps, how.from_video)
        found.setdefault(str(folder.parent), []).append(task)
    return list(found.values())


def system_again(info: SystemInfo) -> System:
    """A system by what the results know of it; it is not run again."""
    if info.kind == "folder":
        return Folder(info, Path(str(info.settings.get("folder", ""))))
    return Replay(info) if info.kind == "replay" else Make(info)
