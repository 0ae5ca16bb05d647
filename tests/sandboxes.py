"""The sandboxes that work on this machine, and tests that are skipped where one does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from simworlds.sandbox.confinement import confine_self
from simworlds.sandbox.confinement.confined_command import Sandbox, best_sandbox, bubblewrap_fault
from simworlds.sandbox.confinement.worker_user import worker_id

if TYPE_CHECKING:
    from simworlds.sandbox.confinement.confined_command import Kind
    from simworlds.sandbox.confinement.resource_limits import ResourceLimits


def skip_unless_it_works(kind: Kind) -> Kind:
    """The same kind; skips the test if that sandbox does not work here."""
    if kind == "bubblewrap" and (fault := bubblewrap_fault()):
        pytest.skip(f"bubblewrap does not work here: {fault}")
    if kind == "landlock" and not confine_self.landlock_abi():
        pytest.skip("this kernel has no Landlock")
    return kind


def sandbox_of(kind: Kind, limits: ResourceLimits | None = None) -> Sandbox:
    """The sandbox of this kind, with the user of the tests where root's Python cannot be reached by the worker's."""
    keeps_user = kind == "landlock" and worker_id() is not None
    return best_sandbox(kind, limits, frozenset({"uid"} if keeps_user else ()))
