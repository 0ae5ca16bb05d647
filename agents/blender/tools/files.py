"""``blender_save`` and ``blender_load``: the scene as a file that opens elsewhere, and back again."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import Field

from agents.blender.checkpoints import KEPT
from agents.blender.saved_files import (
    WRITTEN,
    Cache,
    External,
    Loaded,
    Seen,
    Written,
    beside,
    checked,
    clear,
    faults,
    find,
    lent,
    look_afresh,
    put_in_place,
    saved_files,
    staging,
    take_all,
)
from agents.blender.tools.base import Arguments, Call, Result, Session, Tool
from simworlds.sandbox.errors import Refusal, ToolBroke

if TYPE_CHECKING:
    from pathlib import Path


_LOOK_SECONDS = 60.0
_LISTED = 10
_TIMEOUT = Field(
    default=300.0, ge=1, le=3600, description="Seconds after which Blender is stopped and put back."
)


class Save(Arguments):
    """The arguments of ``blender_save``."""

    name: str | None = Field(
        default=None,
        max_length=400,
        description="File in the run's folder, as 'tower' or 'saves/tower.blend'. Without one, a checkpoint is made.",
    )
    pack: bool = Field(default=True, description="Put images, sounds and fonts into the file.")
    verify: bool = Field(
        default=True, description="Open the copy in a second Blender before it replaces an older one."
    )
    timeout: float = _TIMEOUT


SAVE_DESCRIPTION = """\
Save the scene as a .blend in the run's folder that opens elsewhere: images, sounds and fonts are packed into it, \
caches on disk (fluids, point caches) are copied into the folder `blendcache_NAME` beside it, which belongs to it. A \
file of that name is replaced, as a whole or not at all. The copy is opened by a second Blender, which has nothing \
else, to see that every baked cache is baked there too. The scene goes on as it is. Without a name, a checkpoint is \
made, to which blender_load goes back."""


class Load(Arguments):
    """The arguments of ``blender_load``."""

    path: str | None = Field(
        default=None,
        max_length=4096,
        description="A .blend: relative to the run's folder, or absolute in a folder that may be read.",
    )
    checkpoint: int | None = Field(
        default=None, ge=1, description="The number of a checkpoint to go back to."
    )
    timeout: float = _TIMEOUT


LOAD_DESCRIPTION = """\
Open a .blend, or go back to a checkpoint; the scene as it is gives way (it is kept as a checkpoint first). Files come \
from the run's folder or from folders that the user has opened for reading; the original is never changed. Scripts in \
the file do not run. What cannot be opened is refused, and the scene stays. Without arguments: which checkpoints and \
saved files there are. Checkpoints do not hold caches on disk (fluids): those stay as they were last baked."""


# Saving


def save(session: Session, asked: Save, call: Call) -> Result:
    """Saves; tells what is in the file, what lies beside it, and what is outside."""
    blender = session.blender
    if asked.name is None:
        return _checkpoint(session)
    target = blender.folder.place_for(asked.name, ".blend")
    if target.is_dir():
        raise Refusal(f"{target.name} is a folder of this run; choose another name.")
    replaced = target.exists()
    with blender.alone(), staging(blender.folder) as place:
        blender.keep("before saving")
        staged = place / target.name
        try:
            written = _written(session, asked, call, staged)
            count, size = take_all(blender.folder, written.files, beside(staged))
            found = None
            if asked.verify:
                found = look_afresh(blender.launch, staged, timeout=min(asked.timeout, _LOOK_SECONDS))
            put_in_place(staged, target)
        except Refusal as error:
            whole = " What was saved there before is untouched." if replaced else ""
            raise Refusal(f"{target.name} was not saved: {str(error).rstrip('.')}.{whole}") from error
        kept = blender.keep(f"saved as {target.name}")
    wrong = faults(written, found)
    data: dict[str, Any] = {
        **written.model_dump(exclude={"files"}),
        "path": str(target),
        "beside": {"path": str(beside(target)), "files": count, "bytes": size} if count else None,
        "opened": found.model_dump() if found else None,
        "faults": wrong,
        "checkpoint": kept.number,
    }
    lines = _saved(written, target)
    if count:
        lines.insert(
            1,
            f"- beside it, and to be kept with it: {beside(target).name}/ ({_count(count, 'file')}, {_size(size)})",
        )
    lines += [f"- **{one}**" for one in wrong]
    if found and not wrong:
        lines.append(
            f"Another Blender, with nothing but these, opens it: {_count(found.objects, 'object')}"
            f"{', every baked cache whole' if any(one.baked for one in found.caches) else ''}."
        )
    lines.append(f"The scene stands at {kept}.")
    return Result("\n".join(lines), data, failed=bool(wrong))


def _written(session: Session, asked: Save, call: Call, staged: Path) -> Written:
    """Lets Blender write the copy, and takes it out of the workspace."""
    blender = session.blender
    workspace = blender.folder.workspace
    arguments: dict[str, Any] = {
        "path": str(workspace / WRITTEN),
        "beside": beside(staged).name,
        "workspace": str(workspace),
        "pack": asked.pack,
    }
    clear(workspace / WRITTEN)
    try:
        reply = blender.call(
            "save",
            arguments,
            timeout=asked.timeout,
            changes=True,
            after=f"after saving {staged.name}",
            progress=call.progress,
            given_up=call.given_up,
        )
        blender.folder.take(WRITTEN, staged)
    finally:
        for name in (WRITTEN, f"{WRITTEN}@"):
            clear(workspace / name)
    return checked(Written, reply.value)


def _checkpoint(session: Session) -> Result:
    last = session.blender.checkpoints.last
    kept = session.blender.keep("asked for")
    new = last is None or kept.number != last.number
    text = f"The scene stands at {kept}" + ("." if new else "; nothing has changed since.")
    text += (
        f" Go back to it with blender_load(checkpoint={kept.number}) while it is among the newest {KEPT}; "
    )
    text += "a file of your own that stays is made with a name."
    return Result(text, {"checkpoint": kept.number, "new": new})


def _saved(written: Written, target: Path) -> list[str]:
    lines = [f"Saved {target} ({_size(written.bytes)}, {_count(written.objects, 'object')})."]
    if written.packed:
        lines.append(f"- packed into it: {_listed(written.packed)}")
    if written.rescued:
        lines.append(
            f"- pixels that no file held, packed into it and into the open scene: {_listed(written.rescued)}"
        )
    return [*lines, *_outside(written.external), *(f"- {_cache(cache)}" for cache in written.caches)]


# Loading


def load(session: Session, asked: Load, call: Call) -> Result:
    """Opens a file or a checkpoint; lists them when none is named."""
    if asked.path is not None and asked.checkpoint is not None:
        raise Refusal("Give a path or a checkpoint, not both.")
    if asked.checkpoint is not None:
        return _gone_back(session, asked.checkpoint)
    if asked.path is not None:
        return _opened(session, asked, asked.path, call)
    kept = session.blender.checkpoints.newest_first()
    text = "Checkpoints, newest first:\n" + "\n".join(f"- {one}" for one in kept)
    text += f"\n\n{saved_files(session.blender.folder)}"
    return Result(text, {"checkpoints": [one.number for one in kept]})


def _gone_back(session: Session, number: int) -> Result:
    blender = session.blender
    with blender.alone():
        # A checkpoint of the present would push the oldest one out.
        if [one.number for one in blender.checkpoints.newest_first()[-1:]] != [number]:
            blender.keep("before going back")
        went = blender.restore(number)
        now = checked(Seen, blender.call("kept_caches", {}, timeout=_LOOK_SECONDS).value)
    text = f"The scene is back at {went}."
    disk = [cache for cache in now.caches if cache.where == "disk"]
    if disk:
        text += "\nCaches on disk are not part of a checkpoint; these are as they were last baked:\n"
        text += "\n".join(
            [*(f"- {_cache(cache)}" for cache in disk), *(f"- **{one}**" for one in faults(now, None))]
        )
    last = blender.checkpoints.last
    return Result(text, {"checkpoint": last.number if last else number, **now.model_dump()})


def _opened(session: Session, asked: Load, path: str, call: Call) -> Result:
    blender = session.blender
    found = find(path, blender.folder, blender.launch.read)
    name = found.path.name
    with blender.alone():
        before = blender.keep("before loading")
        try:
            with lent(found, blender.folder) as (readable, is_copy):
                reply = blender.call(
                    "load",
                    {"path": str(readable), "workspace": str(blender.folder.workspace), "lent": is_copy},
                    timeout=asked.timeout,
                    changes=True,
                    always_keep=True,
                    after=f"after loading {name[:40]}",
                    progress=call.progress,
                    given_up=call.given_up,
                )
            loaded = checked(Loaded, reply.value)
        except (Refusal, ToolBroke) as error:
            blender.restore(before.number)
            raise Refusal(f"{str(error).rstrip('.')}. The scene stands as before, at {before}.") from error
        kept = blender.checkpoints.last
    data: dict[str, Any] = {
        **loaded.model_dump(),
        "path": str(found.path),
        "checkpoint": kept and kept.number,
    }
    lines = [f"Opened {found.path}: {_count(loaded.objects, 'object')}, saved by Blender {loaded.version}."]
    if loaded.scripts:
        lines.append("- it has scripts or scripted drivers; they do not run")
    lines += [*_outside(loaded.external), *(f"- {_cache(cache)}" for cache in loaded.caches)]
    lines += [f"- **{one}**" for one in faults(loaded, None)]
    lines.append(f"The scene stands at {kept}. Before it: blender_load(checkpoint={before.number}).")
    return Result("\n".join(lines), data)


# In words


def _cache(cache: Cache) -> str:
    first, last = cache.range
    state = f"{'baked' if cache.baked else 'not baked'}{', outdated' if cache.outdated else ''}"
    where = f"{_count(cache.frames, 'frame')} {'in the file' if cache.where == 'memory' else 'on disk'}"
    return f"{cache.label}: {state}, frames {first}–{last}, {where}"


def _outside(external: list[External]) -> list[str]:
    told = [
        f"- outside, used by {one.what}: {one.path}{' (missing)' if one.missing else ''}" for one in external
    ]
    return [*told[:_LISTED], f"- outside: {len(told) - _LISTED} more files"] if len(told) > _LISTED else told


def _listed(names: list[str]) -> str:
    more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
    return ", ".join(names[:_LISTED]) + more


def _count(number: int, word: str) -> str:
    return f"{number:,} {word}{'' if number == 1 else 's'}"


def _size(count: float) -> str:
    for unit in ("bytes", "kB", "MB"):
        if count < 1000:
            return f"{count:.0f} {unit}" if unit == "bytes" else f"{count:.1f} {unit}"
        count /= 1000
    return f"{count:.1f} GB"


SAVE = Tool("blender_save", "Save the scene", SAVE_DESCRIPTION, Save, save, destructive=True)
LOAD = Tool("blender_load", "Open a file or a checkpoint", LOAD_DESCRIPTION, Load, load, destructive=True)
