"""``blender_import``: a file of another program's format, put into the scene as a collection."""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field

from agents.blender.exchange.comparison import describe_bounds
from agents.blender.exchange.formats import describe_support, format_of
from agents.blender.exchange.lending import check_there, lent_for_import
from agents.blender.exchange.replies import AvailableFormats, ExchangeFacts, ImportedFile
from agents.blender.files.readable_files import find_readable
from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, ToolContext
from agents.blender.tools.kept_scene import kept_scene
from simworlds.counting import counted, format_list

if TYPE_CHECKING:
    from agents.blender.supervisor import Supervisor

_ASK_SECONDS = 60.0
_LISTED = 8


class ImportArguments(Arguments):
    """The arguments of ``blender_import``."""

    path: str | None = Field(
        default=None,
        max_length=4096,
        description="A file: relative to the run's folder, or absolute in a readable folder. None: list formats.",
    )
    collection: str | None = Field(
        default=None,
        min_length=1,
        max_length=60,
        description="Name of the new collection. Default: the file's.",
    )
    scale: float = Field(
        default=1.0, gt=0, le=1e6, description="Multiplies sizes: 0.01 for a file in cm that does not say so."
    )
    up: Literal["Y", "Z"] | None = Field(
        default=None, description="OBJ and STL: the upward axis. Default: Y for OBJ, Z for STL."
    )
    timeout: float = Field(default=300.0, ge=1, le=3600, description="Seconds.")


DESCRIPTION = """\
Bring a glTF, USD, FBX, OBJ, Alembic or STL file into the scene, as a new collection; images are packed. The reply \
says what came in: objects, triangles, bounds in metres, materials with their textures, missing files, odd scales and \
axes. The scene's frame range, world and selection stay. If the import fails, the scene stays as it was."""


def run(context: ToolContext, arguments: ImportArguments, call: Call) -> Result:
    """Imports a file, or lists the formats. Raises BlenderError."""
    blender = context.blender
    if arguments.path is None:
        available = ask_for_formats(blender)
        supported = {kind: support.model_dump() for kind, support in available.formats.items()}
        return Result(describe_support(available.version, supported), available.model_dump())
    known = format_of(arguments.path)
    file = find_readable(arguments.path, blender.folder, blender.launch.read)
    check_there(file, arguments.path)
    name = file.path.name
    with blender.alone(), kept_scene(blender, "before importing") as before:
        with lent_for_import(file, blender.folder) as lent:
            request: dict[str, Any] = {
                "kind": known.kind,
                **lent,
                "workspace": blender.folder.workspace.for_blender(),
                "collection": arguments.collection or PurePosixPath(name).stem[:60],
                "scale": arguments.scale,
                "up": arguments.up,
                "frames": [],
                "timing": None,
            }
            reply = blender.call(
                "import_file",
                request,
                ImportedFile.model_validate,
                timeout=arguments.timeout,
                what=f"importing {name[:80]}",
                changes=True,
                always_keep=True,
                after=f"after importing {name[:40]}",
                progress=call.progress,
                cancelled=call.cancelled,
            )
        checkpoint = blender.checkpoints.last
    came = reply.value
    lines = [f"Imported {file.path} into the collection {came.collection!r} ({known.label}, {known.units}):"]
    lines += describe_facts(came)
    lines += [f"- **{note}**" for note in _faults(came)]
    lines += [f"- note: {note}" for note in came.notes]
    lines.append(f"The scene is at {checkpoint}. To undo: blender_load(checkpoint={before.number}).")
    data = {**came.model_dump(), "path": str(file.path), "checkpoint": checkpoint and checkpoint.number}
    return Result("\n".join(lines), data)


def ask_for_formats(blender: Supervisor) -> AvailableFormats:
    """What this Blender reads and writes. Raises BlenderError."""
    read = AvailableFormats.model_validate
    return blender.call("exchange_formats", {}, read, timeout=_ASK_SECONDS).value


def _faults(came: ImportedFile) -> list[str]:
    faults: list[str] = []
    if came.missing:
        faults.append(f"missing image files: {format_list(came.missing, _LISTED)}")
    if came.outside:
        faults.append(
            f"images outside of the folder that may be read, left out: {format_list(came.outside, _LISTED)}"
        )
    return faults


def describe_facts(facts: ExchangeFacts) -> list[str]:
    """What a set of objects is made of, in lines."""
    kinds = ", ".join(f"{number:,} {kind.lower()}" for kind, number in sorted(facts.objects.items()))
    lines = [f"- objects: {kinds or 'none'}; {facts.parented:,} with a parent"]
    lines.append(f"- {counted(facts.triangles, 'triangle')}, {counted(facts.vertices, 'point')}")
    if facts.low is not None:
        lines.append(f"- bounds: {describe_bounds(facts)}")
    if facts.animated:
        frames = f", frames {facts.range[0]}–{facts.range[1]}" if facts.range is not None else ""
        lines.append(f"- animated: {counted(facts.animated, 'object')}{frames}")
    for material in facts.materials[:_LISTED]:
        images = ", ".join(f"{image.into}: {image.file}" for image in material.images)
        lines.append(f"- material {material.name!r}: {images or 'no textures'}")
    if len(facts.materials) > _LISTED:
        lines.append(f"- {len(facts.materials) - _LISTED} more materials")
    return lines


TOOL = BlenderTool(
    "blender_import",
    "Import a file",
    DESCRIPTION,
    ImportArguments,
    run,
    profile="all",
)
