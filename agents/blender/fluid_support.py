"""Whether a Blender can simulate fluids, and whether it needs help for it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from simworlds.sandbox.blender_process import BlenderProcess
from simworlds.sandbox.errors import BlenderError, Died

if TYPE_CHECKING:
    from simworlds.sandbox.launch import Launch

_TEST_SECONDS = 60.0


@dataclass(frozen=True, slots=True)
class FluidCheck:
    """``version``: Blender's. ``fault``: why fluids do not work, None if they do.

    ``needs_remedy``: whether they work only with what inside/mantaflow.py does; None for a Blender that never gets it.
    """

    version: str
    fault: str | None
    needs_remedy: bool | None

    def __str__(self) -> str:
        if self.fault is not None:
            return f"Blender {self.version} does not simulate fluids: {self.fault}"
        if self.needs_remedy is None:
            return f"Blender {self.version} simulates fluids by itself."
        if self.needs_remedy:
            return f"bpy {self.version} simulates fluids, with the remedy that it still needs."
        return f"bpy {self.version} simulates fluids by itself: the remedy is no longer needed for it."


def check_fluids(launch: Launch) -> FluidCheck:
    """Bakes a drop of liquid in processes of its own, with the remedy and without. Raises CannotStart."""
    process = BlenderProcess(launch)
    try:
        found: dict[str, Any] = process.call("fluid_self_test", {"remedy": True}, timeout=_TEST_SECONDS).value
    except BlenderError as error:
        return FluidCheck(launch.runtime.version, str(error), None)
    finally:
        process.kill()
    if not found["works"]:
        return FluidCheck(found["version"], "a baked drop of liquid has no surface.", None)
    return FluidCheck(found["version"], None, _dies_without(launch) if found["hooked"] else None)


def _dies_without(launch: Launch) -> bool:
    process = BlenderProcess(launch)
    try:
        reply = process.call("fluid_self_test", {"remedy": False}, timeout=_TEST_SECONDS)
    except Died:
        return True
    finally:
        process.kill()
    return not reply.value["works"]
