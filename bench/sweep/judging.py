"""Judges the frames of a sweep's scenes, by one provider within one limit of cost.

That needs no Blender and little processor time, so threads of the sweep do it, wherever the scenes were scored. All
results are judged by the same lists of items.
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
from bench.sweep.content_hash import digest_of, digest_of_bytes
from bench.sweep.provenance import code_of
from bench.sweep.records import JUDGEMENT, File, Judged, SceneRecord, read_record, write_record
from bench.sweep.run_steps import step_fields
from bench.sweep.steps import DueStep
from simworlds.files import sha256_of_file, write_whole

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from bench.judge.verdicts import Judgement
    from bench.sweep.scene_task import SceneTask
    from simworlds.llm.prices import Price

_NO_JUDGE = "none"


@dataclass(frozen=True, slots=True)
class JudgedScene:
    """What came of judging one scene. ``stands``: why an earlier judgement stays, where there is no new one."""

    task: SceneTask
    record: SceneRecord
    stands: str = ""


@dataclass(frozen=True)
class JudgeOptions:
    """The judge to use. ``provider``: "anthropic", "openai" or "none"; ``max_cost`` (US dollars): of the whole sweep.

    ``cache``: the folder of kept answers; ``price``: of a model without a list price.
    """

    provider: str = _NO_JUDGE
    model: str | None = None
    base_url: str | None = None
    max_cost: float | None = None
    cache: Path | None = None
    price: Price | None = None


@dataclass(frozen=True)
class SweepJudge:
    """The judge of one or several sweeps under one limit; without a provider, ``why`` there is none."""

    options: JudgeOptions
    provider: JudgeProvider | None
    why: str = ""

    def close(self) -> None:
        """Closes the provider's connections."""
        if self.provider is not None:
            self.provider.close()


def judge_of(options: JudgeOptions) -> SweepJudge:
    """Checks that the key and all packages are there; sends nothing."""
    if options.provider == _NO_JUDGE:
        return SweepJudge(options, None, "no judge was requested (--judge none)")
    try:
        provider = provider_of(
            options.provider,
            model=options.model,
            base_url=options.base_url,
            max_cost=options.max_cost,
            price=options.price,
        )
        provider.ready()
    except (NotJudged, ValueError) as error:
        return SweepJudge(options, None, str(error))
    return SweepJudge(options, provider)


def judge_all(tasks: Sequence[SceneTask], who: SweepJudge, threads: int = 4) -> Iterator[JudgedScene]:
    """Judges the frames of each task's scene and writes its record; yields them in the order in which they end.

    A record of a scene that was not judged says why. Raises BadSceneRecord, OSError.
    """
    waiting: queue.SimpleQueue[SceneTask] = queue.SimpleQueue()
    done: queue.SimpleQueue[JudgedScene | BaseException] = queue.SimpleQueue()
    for task in tasks:
        waiting.put(task)

    def work() -> None:
        while True:
            try:
                task = waiting.get_nowait()
            except queue.Empty:
                return
            try:
                done.put(judge_scene(task, who))
            except BaseException as error:
                done.put(error)

    # Daemons: an interrupt does not wait for answers. Those that have arrived are kept in the judge's cache.
    for _ in range(min(threads, len(tasks))):
        threading.Thread(target=work, name="judge", daemon=True).start()
    for _ in tasks:
        outcome = done.get()
        if isinstance(outcome, BaseException):
            raise outcome
        yield outcome


def judge_scene(task: SceneTask, who: SweepJudge) -> JudgedScene:
    """Judges one scene's frames, if they are not judged yet. A judgement stays until there is a new one."""
    record = read_record(task.folder) or SceneRecord(scene=task.spec.id, system=task.system.info)
    paths = [task.path(file) for file in record.framed.frames] if record.framed is not None else []
    frames = digest_of([sha256_of_file(path) for path in paths])
    before, began = record.judged, time.monotonic()
    if who.provider is None or not paths:
        judged = Judged(
            **_step_fields("", began), frames=frames, why=who.why if paths else _no_frames(record)
        )
    else:
        key = _key(task, who.provider, frames)
        if before is not None and before.key == key and before.why is None:
            return JudgedScene(task, record)
        judged = _judged(task, who.provider, paths, who.options.cache, key).model_copy(
            update={"frames": frames}
        )
    if judged.why and before is not None and before.frames == frames and (before.why in (None, judged.why)):
        is_asked = before.why is None and who.options.provider != _NO_JUDGE
        return JudgedScene(task, record, judged.why if is_asked else "")
    record = record.model_copy(update={"judged": judged})
    write_record(task.folder, record)
    return JudgedScene(task, record)


def _no_frames(record: SceneRecord) -> str:
    return f"no frames: {(record.framed.why if record.framed is not None else None) or 'none were taken'}"


def _key(task: SceneTask, provider: JudgeProvider, frames: str) -> str:
    return digest_of(
        {
            "prompt": task.spec.prompt,
            "static": task.is_static,
            "frames": frames,
            "provider": provider.identity,
            "prompts": prompt_version(),
        }
    )


def _judged(
    task: SceneTask, provider: JudgeProvider, frames: Sequence[Path], cache: Path | None, key: str
) -> Judged:
    began = time.monotonic()
    try:
        judgement = judge(
            task.spec.prompt,
            frames,
            static=task.is_static,
            provider=provider,
            cache=cache,
            scene=task.spec.id,
        )
    except NotJudged as error:
        step_fields = _step_fields(key, began)
        return Judged(**step_fields, why=f"{error.reason}: {error}", cost=error.spent.cost)
    return Judged(
        **_step_fields(key, began),
        why=None,
        provider=judgement.provider,
        model=judgement.answered_by,
        prompt_version=judgement.prompt_version,
        score=judgement.score,
        scores=judgement.scores,
        cost=judgement.cost,
        items_cost=judgement.items_cost,
        file=_write_judgement(task, judgement),
    )


def _write_judgement(task: SceneTask, judgement: Judgement) -> File:
    content = judgement.model_dump_json(indent=1).encode() + b"\n"
    write_whole(task.folder / JUDGEMENT, content)
    return File(path=JUDGEMENT, sha256=digest_of_bytes(content), bytes=len(content))


def _step_fields(key: str, began: float) -> dict[str, Any]:
    return step_fields(DueStep(key, code_of("bench.judge.judge", "bench/judge/prompts/*")), began)
