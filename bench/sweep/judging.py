"""The judge's part of a sweep: once the frames are there, here, by one provider with one limit of cost.

That needs no Blender and hardly a processor; so it is done by threads of the sweep itself, wherever the scenes were
scored, and all results are judged by the same lists of items.
"""

from __future__ import annotations

import queue
import threading
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from bench.judge.errors import NotJudged
from bench.judge.judge import judge
from bench.judge.providers import JudgeProvider, provider_of
from bench.judge.questions import prompt_version
from bench.sweep.content_hash import digest_of, digest_of_bytes, digest_of_file
from bench.sweep.provenance import code_of
from bench.sweep.records import JUDGEMENT, File, Judged, Record, read_record, write_record
from bench.sweep.scene_task import stamp
from bench.sweep.steps import Due
from simworlds.files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from bench.judge.verdicts import Judgement
    from bench.sweep.scene_task import Task


@dataclass(frozen=True)
class Judging:
    """Who judges. ``provider`` is "anthropic", "openai", or "none"; ``max_cost`` (US dollars) is for the whole sweep.

    ``cache`` is the folder that answers are kept in.
    """

    provider: str = "none"
    model: str | None = None
    base_url: str | None = None
    max_cost: float | None = None
    cache: Path | None = None


@dataclass(frozen=True)
class Judge:
    """Who judges a sweep, or several of them under one limit; or ``why`` nobody does."""

    judging: Judging
    provider: JudgeProvider | None
    why: str = ""


def judge_of(judging: Judging) -> Judge:
    """Finds out whether there is a key, and all packages; asks nothing."""
    if judging.provider == "none":
        return Judge(judging, None, "no judge was asked for")
    try:
        provider = provider_of(
            judging.provider, model=judging.model, base_url=judging.base_url, max_cost=judging.max_cost
        )
        provider.ready()
    except (NotJudged, ValueError) as error:
        return Judge(judging, None, str(error))
    return Judge(judging, provider)


def judge_all(tasks: Sequence[Task], who: Judge, threads: int = 4) -> Iterator[tuple[Task, Record]]:
    """Judges the frames of each task's scene, and writes its record; in the order in which they are done.

    What cannot be judged says why. Raises BadRecord, OSError.
    """
    waiting: queue.SimpleQueue[Task] = queue.SimpleQueue()
    done: queue.SimpleQueue[tuple[Task, Record | BaseException]] = queue.SimpleQueue()
    for task in tasks:
        waiting.put(task)

    def work() -> None:
        while True:
            try:
                task = waiting.get_nowait()
            except queue.Empty:
                return
            try:
                done.put((task, judge_scene(task, who)))
            except BaseException as error:
                done.put((task, error))

    # Daemons: who interrupts a sweep does not wait for answers. What was answered is kept by the judge's own cache.
    for _ in range(min(threads, len(tasks))):
        threading.Thread(target=work, name="judge", daemon=True).start()
    for _ in tasks:
        task, outcome = done.get()
        if isinstance(outcome, BaseException):
            raise outcome
        yield task, outcome


def judge_scene(task: Task, who: Judge) -> Record:
    """Judges one scene's frames, unless that is done. A judgement of these frames stays until there is a new one."""
    record = read_record(task.folder) or Record(scene=task.spec.id, system=task.system.info)
    paths = [task.path(file) for file in record.framed.frames] if record.framed is not None else []
    frames = digest_of([digest_of_file(path) for path in paths])
    before, began = record.judged, time.monotonic()
    if who.provider is None or not paths:
        judged = Judged(**_stamp("", began), frames=frames, why=who.why if paths else _no_frames(record))
    else:
        key = _key(task, who.judging, who.provider, frames)
        if before is not None and before.key == key and before.why is None:
            return record
        judged = _judged(task, who.provider, paths, who.judging.cache, key).model_copy(
            update={"frames": frames}
        )
    if judged.why and before is not None and before.frames == frames and (before.why in (None, judged.why)):
        return record
    record = record.model_copy(update={"judged": judged})
    write_record(task.folder, record)
    return record


def _no_frames(record: Record) -> str:
    return f"no frames: {(record.framed.why if record.framed is not None else None) or 'none were taken'}"


def _key(task: Task, judging: Judging, provider: JudgeProvider, frames: str) -> str:
    return digest_of(
        {
            "prompt": task.spec.prompt,
            "static": task.is_static,
            "frames": frames,
            "provider": [provider.name, provider.model, judging.base_url],
            "prompts": prompt_version(),
        }
    )


def _judged(
    task: Task, provider: JudgeProvider, frames: Sequence[Path], cache: Path | None, key: str
) -> Judged:
    began = time.monotonic()
    try:
        found = judge(
            task.spec.prompt,
            frames,
            static=task.is_static,
            provider=provider,
            cache=cache,
            scene=task.spec.id,
        )
    except NotJudged as error:
        stamp = _stamp(key, began)
        return Judged(**stamp, why=f"{error.reason}: {error}", cost=error.spent.cost)
    return Judged(
        **_stamp(key, began),
        why=None,
        provider=found.provider,
        model=found.answered_by,
        prompt_version=found.prompt_version,
        score=found.score,
        scores=found.scores,
        cost=found.cost,
        items_cost=found.items_cost,
        file=_kept(task, found),
    )


def _kept(task: Task, found: Judgement) -> File:
    content = found.model_dump_json(indent=1).encode() + b"\n"
    write_whole(task.folder / JUDGEMENT, content)
    return File(path=JUDGEMENT, sha256=digest_of_bytes(content), bytes=len(content))


def _stamp(key: str, began: float) -> dict[str, Any]:
    return stamp(Due(key, code_of("bench.judge.judge", "judge/prompts/*")), began)
