"""``blender_export``: objects as a file of another program's format, imported again to see what it has kept."""

from __future__ import annotations

import secrets
import shutil
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from agents.blender.exchange.comparison import differences, not_kept
from agents.blender.exchange.formats import Format, format_of
from agents.blender.exchange.replies import ExportedFile, ImportedFile
from agents.blender.files.saved_files import copy_from_workspace, staging
from agents.blender.formatting import format_size
from agents.blender.second_blender import second_blender
from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, ToolContext
from agents.blender.tools.import_file import describe_facts
from simworlds.counting import format_list
from simworlds.sandbox.errors import BlenderError, Refusal
from simworlds.sandbox.replies import nothing

if TYPE_CHECKING:
    from simworlds.sandbox.launch import Launch

_MOST_OBJECTS = 200
_LISTED = 8
_STEM_MOST = 80


class ExportArguments(Arguments):
    """The arguments of ``blender_export``."""

    name: str = Field(
        min_length=1,
        max_length=400,
        description="File in the run's folder; its ending is the format: 'tower.glb', 'out/tower.usdz', 'tower.fbx'.",
    )
    objects: list[Annotated[str, Field(min_length=1, max_length=255)]] = Field(
        default_factory=list[str],
        max_length=_MOST_OBJECTS,
        description="Objects, with what is parented to them, and collections. Default: all that are not hidden.",
    )
    animation: bool = Field(
        default=True, description="With motion over the scene's frames, where the format has it."
    )
    verify: bool = Field(default=True, description="Import the file in a second Blender, and compare.")
    timeout: float = Field(default=300.0, ge=1, le=3600, description="Seconds.")


DESCRIPTION = """\
Write objects to a glTF, USD, FBX, OBJ, Alembic or STL file in the run's folder, modifiers applied. A format of \
several files (.gltf, .obj, .usd, .usda, .usdc) gets a folder: tower.obj becomes tower_obj/tower.obj. A second Blender \
imports the file again; the reply says what the format cannot keep, and where counts, bounds, motion or textures \
differ. The scene is not changed."""


@dataclass(frozen=True, slots=True)
class _Place:
    """Where an export of a ``kind`` goes: ``target`` is the file, or the folder in which the file ``main`` is."""

    kind: str
    target: Path
    main: str
    in_folder: bool


def run(context: ToolContext, arguments: ExportArguments, call: Call) -> Result:
    """Exports and compares. Raises BlenderError."""
    blender = context.blender
    known = format_of(arguments.name)
    place = _place(context, arguments.name, known)
    replaced = place.target.exists()
    with blender.alone(), staging(blender.folder) as folder:
        sent, staged = _write(context, arguments, call, place, folder)
        main = staged / place.main if place.in_folder else staged
        back = None
        if arguments.verify:
            back = _import_again(blender.launch, main, known, sent, timeout=arguments.timeout)
        files = [path for path in staged.rglob("*") if path.is_file()] if place.in_folder else [main]
        size = sum(path.stat().st_size for path in files)
        _put_in_place(staged, place.target, folder / "before@")  # no name of an export
    path = place.target / place.main if place.in_folder else place.target
    differs = differences(sent, back, known) if isinstance(back, ImportedFile) else []
    lost = not_kept(sent, known)
    instead = ", instead of the one before" if replaced else ""
    lines = [f"Exported {path} ({known.label}, {known.units}, {format_size(size)}{instead}):"]
    lines += describe_facts(sent)
    if place.in_folder:
        names = sorted(name for name in sent.files if name != place.main)
        others = f"; beside it: {format_list(names, _LISTED)}" if names else ""
        lines.append(f"- {place.target.name}/ belongs together{others}")
    lines += [f"- note: {note}" for note in sent.notes]
    if sent.missing:
        lines.append(f"- **image files that are missing here too: {format_list(sent.missing, _LISTED)}**")
    if lost:
        lines.append(f"- {known.label} keeps no {', '.join(lost)}")
    failed = bool(differs) or isinstance(back, str)
    if isinstance(back, str):
        lines.append(f"**A second Blender could not import it again: {back}**")
    elif differs:
        lines.append("A second Blender imports it again, **with differences**:")
        lines += [f"- {difference}" for difference in differs]
    elif back is not None:
        lines.append(
            "A second Blender imports it again: counts, bounds and what else the format keeps agree."
        )
    data: dict[str, Any] = {
        **sent.model_dump(),
        "path": str(path),
        "bytes": size,
        "not_kept": lost,
        "verified": back.model_dump() if isinstance(back, ImportedFile) else back,
        "differences": differs,
    }
    return Result("\n".join(lines), data, failed=failed)


def _place(context: ToolContext, name: str, known: Format) -> _Place:
    ending = PurePosixPath(name).suffix.lower()
    target = context.blender.folder.place_for(name, ending)
    if len(target.stem) > _STEM_MOST:
        raise Refusal(f"{target.stem[:40]!r}… is too long a name: use at most {_STEM_MOST} characters.")
    if ending not in known.folders:
        if target.is_dir():
            raise Refusal(f"{target.name} is a folder of this run; choose another name.")
        return _Place(known.kind, target, target.name, in_folder=False)
    folder = target.with_name(f"{target.stem}_{ending[1:]}")
    if folder.exists() and not (folder / target.name).is_file():
        raise Refusal(
            f"{folder.name} is there already, and is not an export of that name; choose another name than "
            f"{target.name}."
        )
    return _Place(known.kind, folder, target.name, in_folder=True)


def _write(
    context: ToolContext, arguments: ExportArguments, call: Call, place: _Place, folder: Path
) -> tuple[ExportedFile, Path]:
    """Lets Blender write, and moves all that it has written out of the workspace. Raises BlenderError."""
    blender = context.blender
    workspace = blender.folder.workspace
    name = f".export-{secrets.token_hex(8)}"
    try:
        reply = blender.call(
            "export_file",
            {
                "kind": place.kind,
                "path": workspace.for_blender(f"{name}/{place.main}"),
                "folder": workspace.for_blender(name),
                "objects": arguments.objects,
                "animation": arguments.animation,
            },
            ExportedFile.model_validate,
            timeout=arguments.timeout,
            what=f"exporting {place.main}",
            progress=call.progress,
            cancelled=call.cancelled,
        )
        sent = reply.value
        if place.main not in sent.files:
            raise Refusal(f"Blender wrote {format_list(sent.files, 3)}, but not {place.main}.")
        taken = sent.files if place.in_folder else [place.main]
        staged = folder / place.target.name
        below = staged if place.in_folder else folder
        copy_from_workspace(
            blender.folder, [(f"{name}/{file}", file) for file in dict.fromkeys(taken)], below
        )
    finally:
        workspace.remove(name)
        workspace.remove(f"{name}.images")
    return sent, staged


def _import_again(
    launch: Launch, main: Path, known: Format, sent: ExportedFile, *, timeout: float
) -> ImportedFile | str:
    """What a second Blender finds in the file; or why it finds nothing."""
    try:
        with second_blender(launch, main.parent) as (process, ground):
            workspace = ground.for_blender()
            process.call("open", {"path": None, "folder": workspace}, nothing, timeout=timeout)
            request: dict[str, Any] = {
                "kind": known.kind,
                "path": str(main),
                "root": str(main.parent),
                "workspace": workspace,
                "collection": main.stem,
                "scale": 1.0,
                "up": None,
                "frames": [pose.frame for pose in sent.poses],
                "timing": list(sent.timing),
            }
            return process.call("import_file", request, ImportedFile.model_validate, timeout=timeout).value
    except BlenderError as error:
        return str(error)


def _put_in_place(staged: Path, target: Path, before: Path) -> None:
    """Moves a file or folder to its place; on failure the old one stays. Raises Refusal."""
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        if target.exists():
            target.rename(before)
        staged.rename(target)
    except OSError as error:
        if before.exists():
            shutil.rmtree(target, ignore_errors=True)
            before.rename(target)
        raise Refusal(f"{target} cannot be written: {error.strerror or error}.") from error


TOOL = BlenderTool(
    "blender_export",
    "Export to a file",
    DESCRIPTION,
    ExportArguments,
    run,
    destructive=True,
    profile="all",
)
