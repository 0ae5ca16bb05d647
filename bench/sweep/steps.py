"""The steps of a scene: when each is due, and what it leaves in the record."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from bench.audit.audit import audit
from bench.audit.untrusted_blend import NotScored
from bench.frames.clip_frames import SECONDS, kind_of, take_frames
from bench.sweep.content_hash import digest_of, digest_of_bytes, digest_of_file
from bench.sweep.provenance import code_of, code_of_audit, code_of_frames
from bench.sweep.records import AUDIT, FINAL, FRAMES, WORK, Audited, File, Framed, Produced
from simworlds.files import write_whole

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from bench.frames.clip_frames import FrameSet
    from bench.sweep.records import Record
    from bench.sweep.records import Step as Part
    from bench.sweep.scene_task import Task, Tell


@dataclass(frozen=True, slots=True)
class Due:
    """A step is to be done: the key of its inputs, the digest of its code, the Blender that it will use.

    ``content``: digest of the files that a system's result is taken from, "" for one that makes its own.
    """

    key: str
    code: str
    blender: str | None = None
    content: str = ""


@dataclass(frozen=True, slots=True)
class Step:
    """``due``: what it is to be done from, None if its result stands. ``do``: what the record's part is made of."""

    field: str
    part: type[Part]
    due: Callable[[Task, Record], Due | None]
    do: Callable[[Task, Record, Due, Tell], dict[str, Any]]


# What the system makes


def _produce_due(task: Task, record: Record) -> Due | None:
    system = task.system
    depends_on = system.depends_on(task.spec)
    key = digest_of({"system": system.info.model_dump(mode="json"), "on": depends_on})
    before = record.produced
    if before is not None and before.key == key and before.outcome in FINAL:
        return None
    return Due(
        key,
        code_of("bench.sweep.steps"),
        content=digest_of(depends_on) if system.source is not None else "",
    )


def _produce(task: Task, record: Record, due: Due, tell: Tell) -> dict[str, Any]:
    del record
    made = task.system.produce(task.spec, task.folder / WORK / due.key[:12], tell)
    return {
        "outcome": made.outcome,
        "why": made.why,
        "prompt": made.prompt,
        "blend": _file(task, made.blend),
        "beside": due.content,
        "video": _file(task, made.video),
        "models": made.models,
        "cost": made.cost,
        "minutes": made.minutes,
        "tokens": made.tokens,
    }


def _file(task: Task, path: Path | None) -> File | None:
    if path is None:
        return None
    source = task.system.source
    return File(
        path=path.relative_to(source or task.folder).as_posix(),
        sha256=digest_of_file(path),
        bytes=path.stat().st_size,
        source=source is not None,
    )


# What the audit finds


def _audit_due(task: Task, record: Record) -> Due | None:
    before, blend = record.audited, _blend(task, record)
    code = code_of_audit()
    if blend is None:
        return (
            None
            if before is not None and (_is_gone(record) or before.why == _no_file(record))
            else Due("", code)
        )
    assert record.produced is not None
    blender = task.means.runtime().version
    on = {"blend": digest_of_file(blend), "beside": record.produced.beside}
    key = digest_of({**on, "spec": _spec(task), "code": code, "blender": blender})
    if before is not None and before.key == key and before.why is None and _are_whole(task, before.file):
        return None
    return Due(key, code, blender)


def _audit(task: Task, record: Record, due: Due, tell: Tell) -> dict[str, Any]:
    del due
    blend = _blend(task, record)
    if blend is None:
        return {"why": _no_file(record), "spec": _spec(task)}
    found = audit(blend, task.spec, task.means, tell)
    content = found.as_json().encode() + b"\n"
    write_whole(task.folder / AUDIT, content)
    file = File(path=AUDIT, sha256=digest_of_bytes(content), bytes=len(content))
    return {"why": found.not_scored, "spec": _spec(task), "mpr": found.mpr, "spr": found.spr, "file": file}


def _spec(task: Task) -> str:
    return digest_of(task.spec.model_dump(mode="json"))


# What is to be seen


def _frames_due(task: Task, record: Record) -> Due | None:
    before, blend, video = record.framed, _blend(task, record), _video(task, record)
    code = code_of_frames()
    if blend is None:
        return (
            None
            if before is not None and (_is_gone(record) or before.why == _no_file(record))
            else Due("", code)
        )
    assert record.produced is not None
    blender = task.means.runtime().version
    on = {"source": digest_of_file(video or blend), "static": task.is_static, "code": code}
    if video is None:
        on |= {"beside": record.produced.beside, "blender": blender}
        on |= {"pixels": task.look.pixels, "samples": task.look.samples}
    key = digest_of(on)
    if before is not None and before.key == key and before.why is None and _are_whole(task, *before.frames):
        return None
    return Due(key, code, blender)


def _frames(task: Task, record: Record, due: Due, tell: Tell) -> dict[str, Any]:
    del due
    blend = _blend(task, record)
    if blend is None:
        return {"why": _no_file(record)}
    tell("taking frames")
    try:
        taken = _taken(task, blend, _video(task, record))
    except NotScored as error:
        return {"why": str(error)}
    frames = tuple(
        File(path=f"{FRAMES}/{path.name}", sha256=digest_of_file(path), bytes=path.stat().st_size)
        for path in taken.paths
    )
    seed = 0 if taken.source == "blend" else None
    return {"why": None, "origin": taken.source, "frames": frames, "notes": taken.notes, "seed": seed}


def _video(task: Task, record: Record) -> Path | None:
    """The system's own video, or its picture of a static scene, if frames are to be of that."""
    file = record.produced.video if record.produced is not None else None
    if file is None or not task.from_video:
        return None
    path = task.path(file)
    return path if path.is_file() and (task.is_static or kind_of(path) == "video") else None


def _taken(task: Task, blend: Path, video: Path | None) -> FrameSet:
    """Of the video; where that cannot be had, of the .blend. Raises NotScored."""
    folder = task.folder / FRAMES
    means = replace(task.means, seconds=max(task.means.seconds, SECONDS))
    if video is None:
        return take_frames(blend, task.is_static, folder, task.look, means)
    try:
        return take_frames(video, task.is_static, folder)
    except NotScored as error:
        taken = take_frames(blend, task.is_static, folder, task.look, means)
        return replace(taken, notes=(f"rendered, for the video cannot be had: {error}", *taken.notes))


# The file that was produced


def _blend(task: Task, record: Record) -> Path | None:
    """None where there is none, or none any more."""
    file = record.produced.blend if record.produced is not None else None
    path = task.path(file) if file is not None else None
    return path if path is not None and path.is_file() else None


def _is_gone(record: Record) -> bool:
    """Of a scene without a file: whether there was one. What was found of that stays."""
    return record.produced is not None and record.produced.blend is not None


def _no_file(record: Record) -> str:
    if record.produced is None:
        return "nothing was produced yet"
    if _is_gone(record):
        return "the file is gone"
    return record.produced.why or f"no file: the system's run {record.produced.outcome}"


def _are_whole(task: Task, *files: File | None) -> bool:
    """Whether files of the results are there as they were written."""
    try:
        return all(file is not None and digest_of_file(task.path(file)) == file.sha256 for file in files)
    except OSError:
        return False


STEPS: dict[str, Step] = {
    "produce": Step("produced", Produced, _produce_due, _produce),
    "audit": Step("audited", Audited, _audit_due, _audit),
    "frames": Step("framed", Framed, _frames_due, _frames),
}
