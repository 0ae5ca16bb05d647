"""What attacks are aimed at, and hosts that are attacked."""

from __future__ import annotations

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
def attackers(outside: Outside, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Attackers]:
    """Hosts of any kind, started when they are first attacked."""
    made = Attackers(tmp_path_factory.mktemp("attacks"), outside)
    yield made
    made.close()
