"""``blender_bake`` in the open Blender: fluids are baked in the copy, the rest in slices in the window."""

from __future__ import annotations

from dataclasses import replace
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any

from pydantic import RootModel

from agents.blender.files.saved_files import copy_from_workspace
from agents.blender.tools import bake
from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.replies import Name

if TYPE_CHECKING:
    from pathlib import Path

    from agents.blender.attached.tools.base import AttachedContext
    from agents.blender.supervisor import Supervisor
    from agents.blender.tools.bake import BakeArguments
    from agents.blender.tools.base import Call, Result

BAKES = "bakes"  # in the run's folder: the frames of fluids
_SECONDS = 60.0
TOOL = bake.TOOL


class _Fluids(RootModel[list[Name]]):
    """The domains among what is to be baked."""


def run(context: AttachedContext, arguments: BakeArguments, call: Call) -> Result:
    """Bakes, and checks the caches; or frees bakes. Raises BlenderError."""
    chosen = {"objects": arguments.objects}
    if arguments.free:
        return context.open.call(
            "free_bake",
            chosen,
            bake.read_freed,
            timeout=_SECONDS,
            changes=True,
            after="after freeing bakes",
            cancelled=call.cancelled,
        ).value
    fluids = context.open.call(
        "fluids", chosen, _Fluids.model_validate, timeout=_SECONDS, cancelled=call.cancelled
    ).value.root
    brought: dict[str, str] = {}
    took: dict[str, float] = {}
    if fluids:
        # What fluids depend on is baked in the copy, too: it has to move there.
        copied = context.of_twin(call)
        result = bake.run(copied, arguments, call)
        if result.failed:
            text = f"**Nothing was done in the open Blender.** This is of the bake in a copy:\n{result.text}"
            return replace(result, text=text)
        for cache in result.data["caches"]:
            if cache["kind"] == "fluid":
                brought[cache["object"]] = str(_taken(copied.blender, cache))
                took[cache["label"]] = cache["seconds"]
    return context.open.call(
        "bake",
        {**arguments.model_dump(exclude={"timeout", "free"}), "brought": brought},
        lambda data: bake.read_baked(_with_seconds(data, took)),
        timeout=arguments.timeout,
        what="the bake",
        changes=True,
        after="after bake",
        progress=call.progress,
        cancelled=call.cancelled,
        stops=True,
    ).value


def _taken(blender: Supervisor, cache: dict[str, Any]) -> Path:
    """The folder to which the frames of a fluid were brought, which the copy's Blender cannot reach. Raises Refusal."""
    workspace = blender.folder.workspace
    inside = workspace.from_blender(str(cache["folder"]))
    if inside is None:
        raise Refusal(f"The frames of {cache['label']} are not in the copy's workspace.")
    target = blender.folder.root / BAKES / PurePosixPath(inside).parent.name
    target.mkdir(parents=True, exist_ok=True)
    number = 1 + max((int(path.name) for path in target.iterdir() if path.name.isdigit()), default=0)
    target /= f"{number:04d}"
    files = [(f"{inside}/{name}", name) for name in workspace.files_below(inside)]
    copy_from_workspace(blender.folder, files, target)
    return target


def _with_seconds(data: Any, took: dict[str, float]) -> Any:
    """Blender's reply, with how long the fluids took where they were baked."""
    for cache in data["caches"]:
        cache["seconds"] = took.get(cache["label"], cache["seconds"])
    data["seconds"] += sum(took.values())
    return data
