"""What attacks are aimed at, and hosts that are attacked."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from attack import Attackers
from outside import Outside

if TYPE_CHECKING:
    from collections.abc import Iterator


@pytest.fixture(scope="session")
def outside() -> Iterator[Outside]:
    """What no attack may reach."""
    made = Outside()
    yield made
    made.close()


@pytest.fixture(scope="session")
def attackers(outside: Outside) -> Iterator[Attackers]:
    """Hosts of any kind, started when they are first attacked."""
    # Not in pytest's own folder, which others may not enter: run by root, Blender is another user.
    with tempfile.TemporaryDirectory(prefix="simworlds-hosts-", ignore_cleanup_errors=True) as folder:
        Path(folder).chmod(0o755)
        made = Attackers(Path(folder), outside)
        yield made
        made.close()
