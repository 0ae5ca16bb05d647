"""A second Blender beside the run's, which has nothing but the files that it is to look at."""

from __future__ import annotations

import tempfile
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from simworlds.sandbox.blender_process import BlenderProcess
from simworlds.sandbox.hostile_ground import HostileGround
from simworlds.sandbox.launch import PRIVATE

if TYPE_CHECKING:
    from collections.abc import Generator

    from simworlds.sandbox.launch import Launch


@contextmanager
def second_blender(launch: Launch, *files: Path) -> Generator[tuple[BlenderProcess, HostileGround]]:
    """A Blender like ``launch`` that may read ``files`` (or folders) as well, and its workspace; ended afterwards.

    Raises BlenderError.
    """
    with tempfile.TemporaryDirectory(prefix="simworlds-look-", ignore_cleanup_errors=True) as folder:
        root = Path(folder).resolve()
        workspace = HostileGround(root / "workspace").make()
        read = (*launch.read, *(path for path in files if path.exists()))
        second = replace(launch, workspace=workspace, private=workspace.beside(PRIVATE), read=read, lent=None)
        process = BlenderProcess(second)
        try:
            yield process, workspace
        finally:
            process.kill()
