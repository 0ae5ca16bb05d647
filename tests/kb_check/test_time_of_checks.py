"""Checks of scripts that are four times as long do about four times the work.

The work is counted, not timed: the lines of Python that are come to.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType

    from _typeshed import TraceFunction

    from kb_check.checker import Checker

_FEW, _TIMES = 30, 4
_MOST_GROWTH = 5.0
_NODES = """
tree = bpy.data.materials.new("A").node_tree
zones = bpy.data.node_groups.new("A", "GeometryNodeTree")
"""
# Kind of script → what it begins with, and what it repeats, with a number for `#`.
_KINDS = {
    "settings of nodes": (
        _NODES,
        """
        mix# = tree.nodes.new("ShaderNodeMix")
        mix#.data_type = "RGBA"
        tree.links.new(mix#.outputs[0], mix#.inputs[6])
        """,
    ),
    "settings of nodes that one name stands for": (
        _NODES,
        """
        mix = tree.nodes.new("ShaderNodeMix")
        mix.data_type = "RGBA"
        tree.links.new(mix.outputs[0], mix.inputs[6])
        """,
    ),
    "zones": (
        _NODES,
        """
        first# = zones.nodes.new("GeometryNodeSimulationInput")
        last# = zones.nodes.new("GeometryNodeSimulationOutput")
        first#.pair_with_output(last#)
        first#.inputs["Geometry"]
        """,
    ),
}


@pytest.mark.parametrize("kind", _KINDS)
def test_a_script_that_is_four_times_as_long_takes_about_four_times_the_work(
    checker: Checker, kind: str
) -> None:
    begin, part = _KINDS[kind]
    lines = [line.strip() if line.startswith("        ") else line for line in part.splitlines()]

    def work(times: int) -> int:
        parts = ("\n".join(lines).replace("#", str(number)) for number in range(times))
        code = "\n".join(["import bpy, bmesh", begin, *parts])
        return _counted(lambda: checker.check(code))

    work(_FEW)  # what is kept of the base
    few, many = work(_FEW), work(_FEW * _TIMES)
    assert many < few * _MOST_GROWTH, f"{few:,} steps, and {many:,} for four times the script"


def _counted(run: Callable[[], object]) -> int:
    """The lines that Python comes to meanwhile, each turn of a loop anew."""
    steps, before = 0, sys.gettrace()

    def count(_frame: FrameType, _event: str, _value: object) -> TraceFunction:
        nonlocal steps
        steps += 1
        return count

    sys.settrace(count)
    try:
        run()
    finally:
        sys.settrace(before)
    return steps
