"""Skips tests whose sandbox does not work on this machine."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from simworlds.sandbox import confine_self
from simworlds.sandbox.confined_command import bubblewrap_fault
from simworlds.sandbox.worker_user import worker_id

if TYPE_CHECKING:
    from simworlds.sandbox.confined_command import Kind


def skip_unless_it_works(kind: Kind) -> Kind:
    """The same kind; skips the test if that sandbox does not work here."""
    if kind == "bubblewrap" and (fault := bubblewrap_fault()):
        pytest.skip(f"bubblewrap does not work here: {fault}")
    if kind == "landlock" and not confine_self.landlock_abi():
        pytest.skip("this kernel has no Landlock")
    if kind == "landlock" and worker_id() is not None:
        pytest.skip("root's files are closed to the worker's user; tests/attacks tries Landlock as a user")
    return kind
