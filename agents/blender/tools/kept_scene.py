"""Keeps the scene before it is changed, and goes back to it if Blender refuses the change."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from simworlds.sandbox.errors import Refusal, ToolBroke

if TYPE_CHECKING:
    from collections.abc import Generator

    from agents.blender.files.checkpoints import Checkpoint
    from agents.blender.supervisor import Supervisor


@contextmanager
def kept_scene(blender: Supervisor, why: str) -> Generator[Checkpoint]:
    """The checkpoint of the scene as it is; ``why`` it is kept.

    What is refused or breaks within is undone. Raises Refusal then, which says so.
    """
    before = blender.keep(why)
    try:
        yield before
    except (Refusal, ToolBroke) as error:
        blender.restore(before.number)
        raise Refusal(f"{str(error).rstrip('.')}. The scene is unchanged, at {before}.") from error
