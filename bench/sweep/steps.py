"""The steps of a scene: when each is due, and what it adds to the record."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from bench.audit.audit import audit
from bench.audit.untrusted_blend import NotScored
from bench.frames.clip_frames import SECONDS, kind_of, take_frames
from bench.sweep.content_hash import digest_of, digest_of_bytes
from bench.sweep.provenance import code_of, code_of_audit, code_of_frames
from bench.sweep.records import AUDIT, FINAL, FRAMES, WORK, Audited, File, Framed, Produced
from simworlds.files import sha256_of_file, write_whole

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from bench.frames.clip_frames import FrameSet
    from bench.sweep.records import SceneRecord, StepResult
    from bench.sweep.scene_task import SceneTask, Tell


@dataclass(frozen=True, slots=True)
class DueStep:
    """A step to run: the key of its inputs, the digest of its code, the Blender that it will use.

    ``content``: digest of the files that a result is taken from, "" for a system that makes its own.
    """

    key: str
    code: str
    blender: str | None = None
    content: str = ""


@dataclass(frozen=True, slots=True)
class ScoringStep:
    """``due`` returns None if the step's result is still valid. ``do`` returns the fields of the record's part."""

    field: str
    part: type[StepResult]
    due: Callable[[SceneTask, SceneRecord], DueStep | None]
    do: Callable[[SceneTask, SceneRecord, DueStep, Tell], dict[str, Any]]


# Production by the system


def _produce_due(task: SceneTask, record: SceneRecord) -> DueStep | None:
    system = task.system
    depends_on = system.depends_on(task.spec)
    key = digest_of({"system": system.info.model_dump(mode="json"), "on": depends_on})
    before = record.produced
    if before is not None and before.key == key and before.outcome in FINAL:
        return None
    return DueStep(
        key,
        code_of("bench.sweep.steps"),
        content=digest_of(depends_on) if system.source is not None else "",
    )


def _produce(task: SceneTask, record: SceneRecord, due: DueStep, tell: Tell) -> dict[str, Any]:
    del record
    output = task.system.produce(task.spec, task.folder / WORK / due.key[:12], tell)
    return {
        "outcome": output.outcome,
        "why": output.why,
        "prompt": output.prompt,
        "blend": _file(task, output.blend),
        "beside": due.content,
        "video": _file(task, output.video),
        "models": output.models,
        "cost": output.cost,
        "minutes": output.minutes,
        "tokens": output.tokens,
    }


def _file(task: SceneTask, path: Path | None) -> File | None:
    if path is None:
        return None
    source = task.system.source
    return File(
        path=path.relative_to(source or task.folder).as_posix(),
        sha256=sha256_of_file(path),
        bytes=path.stat().st_size,
        source=source is not None,
    )


# Audit


def _audit_due(task: SceneTask, record: SceneRecord) -> DueStep | None:
    code = code_of_audit()

    def inputs(blend: Path, beside: str, blender: str) -> dict[str, Any]:
        on = {"blend": sha256_of_file(blend), "beside": beside}
        return {**on, "spec": _spec(task), "code": code, "blender": blender}

    return _due(task, record, record.audited, code, inputs)


def _audit(task: SceneTask, record: SceneRecord, due: DueStep, tell: Tell) -> dict[str, Any]:
    del due
    blend = _blend(task, record)
    if blend is None:
        return {"why": _no_file(record), "spec": _spec(task)}
    result = audit(blend, task.spec, task.means, tell)
    content = result.as_json().encode() + b"\n"
    write_whole(task.folder / AUDIT, content)
    file = File(path=AUDIT, sha256=digest_of_bytes(content), bytes=len(content))
    return {"why": result.not_scored, "spec": _spec(task), "mpr": result.mpr, "spr": result.spr, "file": file}


def _spec(task: SceneTask) -> str:
    return digest_of(task.spec.model_dump(mode="json"))


# Frames


def _frames_due(task: SceneTask, record: SceneRecord) -> DueStep | None:
    code = code_of_frames()

    def inputs(blend: Path, beside: str, blender: str) -> dict[str, Any]:
        video = _video(task, record)
        on = {"source": sha256_of_file(video or blend), "static": task.is_static, "code": code}
        if video is None:
            on |= {"beside": beside, "blender": blender}
            on |= {"pixels": task.look.pixels, "samples": task.look.samples}
        return on

    return _due(task, record, record.framed, code, inputs)


def _frames(task: SceneTask, record: SceneRecord, due: DueStep, tell: Tell) -> dict[str, Any]:
    del due
    blend = _blend(task, record)
    if blend is None:
        return {"why": _no_file(record)}
    tell("taking frames")
    try:
        taken = _taken(task, blend, _video(task, record), tell)
    except NotScored as error:
        return {"why": str(error)}
    frames = tuple(
        File(path=f"{FRAMES}/{path.name}", sha256=sha256_of_file(path), bytes=path.stat().st_size)
        for path in taken.paths
    )
    seed = 0 if taken.source == "blend" else None
    return {"why": None, "origin": taken.source, "frames": frames, "notes": taken.notes, "seed": seed}


def _video(task: SceneTask, record: SceneRecord) -> Path | None:
    """The system's own video, or picture of a static scene, if frames are to be taken from it."""
    file = record.produced.video if record.produced is not None else None
    if file is None or not task.from_video:
        return None
    path = task.path(file)
    return path if path.is_file() and (task.is_static or kind_of(path) == "video") else None


def _taken(task: SceneTask, blend: Path, video: Path | None, tell: Tell) -> FrameSet:
    """Takes frames of the video; if that fails, of the .blend. Raises NotScored."""
    folder = task.folder / FRAMES
    means = replace(task.means, seconds=max(task.means.seconds, SECONDS))
    if video is None:
        return take_frames(blend, task.is_static, folder, task.look, means, tell=tell)
    try:
        return take_frames(video, task.is_static, folder)
    except NotScored as error:
        taken = take_frames(blend, task.is_static, folder, task.look, means, tell=tell)
        return replace(taken, notes=(f"rendered, as the video cannot be read: {error}", *taken.notes))


# The file that was produced


def _due(
    task: SceneTask,
    record: SceneRecord,
    before: Audited | Framed | None,
    code: str,
    inputs: Callable[[Path, str, str], dict[str, Any]],
) -> DueStep | None:
    """A step on the produced file, unless its result ``before`` still stands.

    ``inputs`` returns what the result depends on, for the file, its caches' digest and the Blender version.
    """
    blend = _blend(task, record)
    if blend is None:
        stands = before is not None and (_is_gone(record) or before.why == _no_file(record))
        return None if stands else DueStep("", code)
    assert record.produced is not None
    blender = task.means.runtime().version
    key = digest_of(inputs(blend, record.produced.beside, blender))
    if before is not None and before.key == key and before.why is None and _is_unchanged(task, before):
        return None
    return DueStep(key, code, blender)


def _blend(task: SceneTask, record: SceneRecord) -> Path | None:
    """The produced file; None if there is none, or none any more."""
    file = record.produced.blend if record.produced is not None else None
    path = task.path(file) if file is not None else None
    return path if path is not None and path.is_file() else None


def _is_gone(record: SceneRecord) -> bool:
    """Whether a scene without a file had one before. Its results are then kept."""
    return record.produced is not None and record.produced.blend is not None


def _no_file(record: SceneRecord) -> str:
    if record.produced is None:
        return "nothing was produced yet"
    if _is_gone(record):
        return "the file is gone"
    return record.produced.why or f"no file: the system's run {record.produced.outcome}"


def _is_unchanged(task: SceneTask, result: Audited | Framed) -> bool:
    """Whether the files of a result are as they were written."""
    files = result.frames if isinstance(result, Framed) else (result.file,)
    try:
        return all(file is not None and sha256_of_file(task.path(file)) == file.sha256 for file in files)
    except OSError:
        return False


STEPS: dict[str, ScoringStep] = {
    "produce": ScoringStep("produced", Produced, _produce_due, _produce),
    "audit": ScoringStep("audited", Audited, _audit_due, _audit),
    "frames": ScoringStep("framed", Framed, _frames_due, _frames),
}
