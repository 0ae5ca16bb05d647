"""How a run's Blender is started: its worker and its folders."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from simworlds.sandbox.confinement.confined_command import Sandbox, best_sandbox
from simworlds.sandbox.launch import LENT, PRIVATE, Launch, find_blender
from simworlds.sandbox.program import SHARED, Program
from simworlds.settings import home_folder

if TYPE_CHECKING:
    from simworlds.sandbox.hostile_ground import HostileGround
    from simworlds.sandbox.runtime import Runtime

# In Blender the package has a name of its own: executed code may bring modules named ``agents`` or ``blender``.
WORKER = Program("simworlds_worker.worker", {**SHARED, "simworlds_worker": Path(__file__).parent / "inside"})


def runs_folder() -> Path:
    """The folder of runs for which no other was chosen."""
    return home_folder() / "runs"


def make_launch(
    workspace: HostileGround,
    *,
    version: str | None = None,
    blender_exe: Path | None = None,
    sandbox: Sandbox | None = None,
    read: tuple[Path, ...] = (),
) -> Launch:
    """Finds a Blender (an executable, this environment's bpy, or one installed for ``version``). Raises CannotStart."""
    return launch_in(workspace, find_blender(version, blender_exe), sandbox=sandbox, read=read)


def launch_in(
    workspace: HostileGround, runtime: Runtime, *, sandbox: Sandbox | None = None, read: tuple[Path, ...] = ()
) -> Launch:
    """The launch of the worker in ``runtime``; the workspace is made."""
    ground = workspace.make()
    return Launch(
        runtime,
        ground,
        ground.beside(PRIVATE),
        sandbox or best_sandbox(),
        WORKER,
        read,
        ground.beside(LENT),
    )
