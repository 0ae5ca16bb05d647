"""Every way of attack on a Blender behind bubblewrap."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from columns import assert_held, cells

if TYPE_CHECKING:
    from attack import Attackers
    from hosts import Who
    from way import Way

pytestmark = pytest.mark.blender


@pytest.mark.parametrize(("way", "who"), cells("bubblewrap"))
def test_bubblewrap_holds(way: Way, who: Who, attackers: Attackers) -> None:
    assert_held(attackers, way, "bubblewrap", who)
