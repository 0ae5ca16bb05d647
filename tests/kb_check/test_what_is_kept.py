"""What was found about a script is gone with it: servers check scripts for weeks."""

from __future__ import annotations

import gc
import weakref
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kb_check.checker import Checker

# Has the rules ask in which bodies its statements stand: that leads to the tree as a whole.
_SCRIPT = """
import bpy
bpy.data.objects["Cube"].location.x = 1
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.data.objects["Cube"].location.x = 1
"""


def test_a_script_that_was_checked_is_not_kept(checker: Checker) -> None:
    read = checker.read(_SCRIPT)
    tree = weakref.ref(read.tree)
    assert checker.check(read)
    del read
    gc.collect()
    assert tree() is None
