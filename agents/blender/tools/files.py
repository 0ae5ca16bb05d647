"""``blender_save`` and ``blender_load``: the scene as a file that opens elsewhere, and back again."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import Field

from agents.blender.files.checkpoints import KEPT
from agents.blender.files.saved_files import (
    COPY_NAME,
    CacheReport,
    ExternalFile,
    FileContents,
    LoadedFile,
    SavedCopy,
    cache_faults,
    caches_folder,
    copy_from_workspace,
    describe_saved_files,
    find_blend_file,
    lent_to_blender,
    open_elsewhere,
    put_in_place,
    staging,
)
from agents.blender.formatting import format_size
from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, ToolContext
from simworlds.counting import counted, format_list
from simworlds.sandbox.errors import Refusal, ToolBroke

if TYPE_CHECKING:
    from pathlib import Path


_OPEN_SECONDS = 60.0
_LISTED = 10
_TIMEOUT = Field(default=300.0, ge=1, le=3600, description="Seconds.")


class SaveArguments(Arguments):
    """The arguments of ``blender_save``."""

    name: str | None = Field(
        default=None,
        max_length=400,
        description="As 'tower', 'saves/tower.blend'.",
    )
    pack: bool = Field(default=True, description="Images, sounds and fonts.")
    verify: bool = Field(default=True, description="In the second Blender.")
    timeout: float = _TIMEOUT


SAVE_DESCRIPTION = """\
Save the scene as a .blend in the run's folder that opens elsewhere: images, sounds and fonts are packed, caches on \
disk (fluids, point caches) copied to `blendcache_NAME` beside it; keep both together. A file of that name is \
replaced. A second Blender opens the copy to check that caches are baked there too. Without a name: a checkpoint, for \
blender_load."""


class LoadArguments(Arguments):
    """The arguments of ``blender_load``."""

    path: str | None = Field(
        default=None,
        max_length=4096,
        description="Relative to the run's folder, or absolute.",
    )
    checkpoint: int | None = Field(default=None, ge=1, description="Its number.")
    timeout: float = _TIMEOUT


LOAD_DESCRIPTION = """\
Open a .blend, or go back to a checkpoint; the open scene is kept as a checkpoint first. Files are in the run's \
folder or where the user allows; the original is never changed, its scripts do not run. If it cannot be opened, the \
scene stays. Without arguments: list checkpoints and files. Checkpoints hold no caches on disk (fluids): those stay \
as last baked."""


# Saving


def save(context: ToolContext, arguments: SaveArguments, call: Call) -> Result:
    """Saves a file, or makes a checkpoint where no name is given."""
    blender = context.blender
    if arguments.name is None:
        return _checkpoint(context)
    target = blender.folder.place_for(arguments.name, ".blend")
    if target.is_dir():
        raise Refusal(f"{target.name} is a folder of this run; choose another name.")
    replaced = target.exists()
    with blender.alone(), staging(blender.folder) as folder:
        blender.keep("before saving")
        staged = folder / target.name
        try:
            copy = _write(context, arguments, call, staged)
            beside = caches_folder(staged)
            count, size = copy_from_workspace(blender.folder, copy.files, beside)
            more = copy_from_workspace(blender.folder, copy.loose, beside, may_be_gone=True)
            count, size = count + more[0], size + more[1]
            opened = None
            if arguments.verify:
                opened = open_elsewhere(blender.launch, staged, timeout=min(arguments.timeout, _OPEN_SECONDS))
            put_in_place(staged, target)
        except Refusal as error:
            old = " The older file of that name is unchanged." if replaced else ""
            raise Refusal(f"{target.name} was not saved: {str(error).rstrip('.')}.{old}") from error
        checkpoint = blender.keep(f"saved as {target.name}")
    faults = cache_faults(copy, opened)
    data: dict[str, Any] = {
        **copy.model_dump(exclude={"files", "loose"}),
        "path": str(target),
        "beside": {"path": str(caches_folder(target)), "files": count, "bytes": size} if count else None,
        "opened": opened.model_dump() if opened else None,
        "faults": faults,
        "checkpoint": checkpoint.number,
    }
    lines = [f"Saved {target} ({format_size(copy.bytes)}, {counted(copy.objects, 'object')})."]
    if count:
        files = f"{counted(count, 'file')}, {format_size(size)}"
        lines.append(f"- beside it, to be kept with it: {caches_folder(target).name}/ ({files})")
    if copy.packed:
        lines.append(f"- packed into it: {format_list(copy.packed, _LISTED)}")
    if copy.rescued:
        lines.append(
            f"- images in no file, packed into it and the open scene: {format_list(copy.rescued, _LISTED)}"
        )
    if copy.unused:
        listed = format_list(copy.unused, _LISTED)
        lines.append(
            f"- **not in the file, since nothing uses it: {listed}** (use it, or set its use_fake_user, to keep it)"
        )
    lines += _file_lines(copy.external, copy.caches, faults)
    if opened and not faults:
        whole = ", every baked cache complete" if any(cache.baked for cache in opened.caches) else ""
        lines.append(f"A second Blender opens it: {counted(opened.objects, 'object')}{whole}.")
    lines.append(f"The scene is at {checkpoint}.")
    return Result("\n".join(lines), data, failed=bool(faults))


def _write(context: ToolContext, arguments: SaveArguments, call: Call, staged: Path) -> SavedCopy:
    """Lets Blender write the copy, and moves it out of the workspace to ``staged``."""
    blender = context.blender
    workspace = blender.folder.workspace
    workspace.remove(COPY_NAME)
    try:
        reply = blender.call(
            "save",
            {
                "path": workspace.for_blender(COPY_NAME),
                "beside": caches_folder(staged).name,
                "workspace": workspace.for_blender(),
                "pack": arguments.pack,
            },
            SavedCopy.model_validate,
            timeout=arguments.timeout,
            changes=True,
            after=f"after saving {staged.name}",
            progress=call.progress,
            cancelled=call.cancelled,
        )
        workspace.take(COPY_NAME, staged)
    finally:
        for name in (COPY_NAME, f"{COPY_NAME}@"):
            workspace.remove(name)
    return reply.value


def _checkpoint(context: ToolContext) -> Result:
    last = context.blender.checkpoints.last
    checkpoint = context.blender.keep("asked for")
    new = last is None or checkpoint.number != last.number
    text = (
        f"The scene is at {checkpoint}{'' if new else '; nothing has changed since'}. Go back to it with "
        f"blender_load(checkpoint={checkpoint.number}) while it is among the newest {KEPT}; to keep the scene for "
        "good, save it under a name."
    )
    return Result(text, {"checkpoint": checkpoint.number, "new": new})


# Loading


def load(context: ToolContext, arguments: LoadArguments, call: Call) -> Result:
    """Opens a file or a checkpoint; lists them when none is named."""
    if arguments.path is not None and arguments.checkpoint is not None:
        raise Refusal("Give a path or a checkpoint, not both.")
    if arguments.checkpoint is not None:
        return _go_back(context, arguments.checkpoint)
    if arguments.path is not None:
        return _open(context, arguments, arguments.path, call)
    checkpoints = context.blender.checkpoints.newest_first()
    text = "Checkpoints, newest first:\n" + "\n".join(f"- {checkpoint}" for checkpoint in checkpoints)
    text += f"\n\n{describe_saved_files(context.blender.folder)}"
    return Result(text, {"checkpoints": [checkpoint.number for checkpoint in checkpoints]})


def _go_back(context: ToolContext, number: int) -> Result:
    blender = context.blender
    with blender.alone():
        # A checkpoint of the present would push the oldest one out.
        if [checkpoint.number for checkpoint in blender.checkpoints.newest_first()[-1:]] != [number]:
            blender.keep("before going back")
        restored = blender.restore(number)
        now = blender.call("kept_caches", {}, FileContents.model_validate, timeout=_OPEN_SECONDS).value
    lines = [f"The scene is back at {restored}."]
    if on_disk := [cache for cache in now.caches if cache.where == "disk"]:
        lines.append("Caches on disk are not part of a checkpoint; these are as they were last baked:")
        lines += _file_lines([], on_disk, cache_faults(now, None))
    last = blender.checkpoints.last
    return Result("\n".join(lines), {"checkpoint": last.number if last else number, **now.model_dump()})


def _open(context: ToolContext, arguments: LoadArguments, name: str, call: Call) -> Result:
    blender = context.blender
    blend_file = find_blend_file(name, blender.folder, blender.launch.read)
    with blender.alone():
        before = blender.keep("before loading")
        try:
            with lent_to_blender(blend_file, blender.folder) as path:
                reply = blender.call(
                    "load",
                    {"path": path, "workspace": blender.folder.workspace.for_blender()},
                    LoadedFile.model_validate,
                    timeout=arguments.timeout,
                    changes=True,
                    always_keep=True,
                    after=f"after loading {blend_file.path.name[:40]}",
                    progress=call.progress,
                    cancelled=call.cancelled,
                )
            loaded = reply.value
        except (Refusal, ToolBroke) as error:
            blender.restore(before.number)
            raise Refusal(f"{str(error).rstrip('.')}. The scene is unchanged, at {before}.") from error
        checkpoint = blender.checkpoints.last
    data: dict[str, Any] = {
        **loaded.model_dump(),
        "path": str(blend_file.path),
        "checkpoint": checkpoint and checkpoint.number,
    }
    objects = counted(loaded.objects, "object")
    lines = [f"Opened {blend_file.path}: {objects}, saved by Blender {loaded.version}."]
    if loaded.scripts:
        lines.append("- it has scripts or scripted drivers; they do not run")
    lines += _file_lines(loaded.external, loaded.caches, cache_faults(loaded, None))
    lines.append(f"The scene is at {checkpoint}. To undo: blender_load(checkpoint={before.number}).")
    return Result("\n".join(lines), data)


# Replies


def _file_lines(external: list[ExternalFile], caches: list[CacheReport], faults: list[str]) -> list[str]:
    lines = [
        f"- not in the file, used by {file.what}: {file.path}{' (missing)' if file.missing else ''}"
        for file in external
    ]
    if len(lines) > _LISTED:
        lines[_LISTED:] = [f"- not in the file: {len(lines) - _LISTED} more files"]
    return [*lines, *(f"- {_cache(cache)}" for cache in caches), *(f"- **{fault}**" for fault in faults)]


def _cache(cache: CacheReport) -> str:
    first, last = cache.range
    state = f"{'baked' if cache.baked else 'not baked'}{', outdated' if cache.outdated else ''}"
    where = f"{counted(cache.frames, 'frame')} {'in the file' if cache.where == 'memory' else 'on disk'}"
    return f"{cache.label}: {state}, frames {first}–{last}, {where}"


SAVE = BlenderTool(
    "blender_save",
    "Save the scene",
    SAVE_DESCRIPTION,
    SaveArguments,
    save,
    destructive=True,
    habit="when a stage is done",
)
LOAD = BlenderTool(
    "blender_load",
    "Open a file",
    LOAD_DESCRIPTION,
    LoadArguments,
    load,
    destructive=True,
    profile="look",
)
