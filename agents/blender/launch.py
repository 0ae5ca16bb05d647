"""The Blender of a run: the worker that runs in it, and the folders that it gets."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from simworlds.sandbox.confined_command import Sandbox, best_sandbox
from simworlds.sandbox.launch import PRIVATE, Launch, find_blender
from simworlds.sandbox.program import SHARED, Program
from simworlds.settings import home_folder

if TYPE_CHECKING:
    from simworlds.sandbox.runtime import Runtime

# In Blender the package has a name of its own: executed code may bring modules named ``agents`` or ``blender``.
WORKER = Program("simworlds_worker.worker", {**SHARED, "simworlds_worker": Path(__file__).parent / "inside"})


def runs_folder() -> Path:
    """Where runs lie that were given no folder of their own."""
    return home_folder() / "runs"


def make_launch(
    workspace: Path,
    *,
    version: str | None = None,
    blender_exe: Path | None = None,
    sandbox: Sandbox | None = None,
    read: tuple[Path, ...] = (),
) -> Launch:
    """Finds the Blender (an executable, this environment's bpy, or one made for ``version``). Raises CannotStart."""
    return launch_in(workspace, find_blender(version, blender_exe), sandbox=sandbox, read=read)


def launch_in(
    workspace: Path, runtime: Runtime, *, sandbox: Sandbox | None = None, read: tuple[Path, ...] = ()
) -> Launch:
    """A worker of a Blender that was found; the workspace is made."""
    workspace.mkdir(parents=True, exist_ok=True)
    workspace = workspace.resolve()
    return Launch(runtime, workspace, workspace.with_name(PRIVATE), sandbox or best_sandbox(), WORKER, read)
