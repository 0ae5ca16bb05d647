"""Tests whether a Blender can simulate fluids, and whether it needs the repair in mantaflow.py."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from simworlds.sandbox.blender_process import BlenderProcess
from simworlds.sandbox.errors import BlenderError, Died
from simworlds.sandbox.replies import Claim, Name

if TYPE_CHECKING:
    from simworlds.sandbox.launch import Launch

_TEST_SECONDS = 60.0


@dataclass(frozen=True, slots=True)
class FluidCheck:
    """The result for a Blender ``version``. ``fault``: why fluids do not work, None if they do.

    ``needs_remedy``: whether they work only with simworlds/sandbox/inside/mantaflow.py; None where that never runs.
    """

    version: str
    fault: str | None
    needs_remedy: bool | None

    def __str__(self) -> str:
        if self.fault is not None:
            return f"Blender {self.version} does not simulate fluids: {self.fault}"
        if self.needs_remedy is None:
            return f"Blender {self.version} simulates fluids."
        if self.needs_remedy:
            return f"bpy {self.version} simulates fluids, with the repair that it needs."
        return f"bpy {self.version} simulates fluids; the repair is no longer needed for it."


class _TestResult(Claim):
    """``works``: a drop of liquid was baked; ``hooked``: the repair was needed in it."""

    version: Name
    works: bool
    hooked: bool


def check_fluids(launch: Launch) -> FluidCheck:
    """Bakes a drop of liquid in separate processes, with and without the repair. Raises CannotStart."""
    process = BlenderProcess(launch)
    try:
        result = process.call(
            "fluid_self_test", {"remedy": True}, _TestResult.model_validate, timeout=_TEST_SECONDS
        ).value
    except BlenderError as error:
        return FluidCheck(launch.runtime.version, str(error), None)
    finally:
        process.kill()
    if not result.works:
        return FluidCheck(result.version, "a baked drop of liquid has no surface.", None)
    return FluidCheck(result.version, None, _dies_without(launch) if result.hooked else None)


def _dies_without(launch: Launch) -> bool:
    process = BlenderProcess(launch)
    try:
        reply = process.call(
            "fluid_self_test", {"remedy": False}, _TestResult.model_validate, timeout=_TEST_SECONDS
        )
    except Died:
        return True
    finally:
        process.kill()
    return not reply.value.works
