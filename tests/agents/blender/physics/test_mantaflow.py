"""Fluids in the bpy module, which its own ``manta`` cannot simulate."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from agents.blender.fluid_support import FluidCheck, check_fluids
from agents.blender.launch import make_launch
from simworlds.sandbox.blender_process import BlenderProcess
from simworlds.sandbox.hostile_ground import HostileGround
from simworlds.sandbox.replies import unread

if TYPE_CHECKING:
    from pathlib import Path

    from live_session import LiveSession

pytestmark = pytest.mark.blender

POUR = """
bpy.ops.mesh.primitive_cube_add(size=2)
box = bpy.context.object
domain = box.modifiers.new("Fluid", "FLUID")
domain.fluid_type = "DOMAIN"
domain.domain_settings.domain_type = "LIQUID"
domain.domain_settings.resolution_max = 16
domain.domain_settings.cache_type = "ALL"
domain.domain_settings.cache_frame_end = 3
bpy.ops.mesh.primitive_ico_sphere_add(radius=0.5)
flow = bpy.context.object.modifiers.new("Fluid", "FLUID")
flow.fluid_type = "FLOW"
flow.flow_settings.flow_type = "LIQUID"
bpy.context.view_layer.objects.active = box
bpy.ops.fluid.bake_all()
bpy.context.scene.frame_set(3)
len(box.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices)
"""


@pytest.mark.whole  # the next ones bake one too
def test_executed_code_may_bake_a_fluid(own_session: LiveSession) -> None:
    assert own_session.run(POUR) > 100


def test_code_that_speaks_of_manta_early_or_drops_it_does_no_harm(own_session: LiveSession) -> None:
    own_session.run("compile('from manta import *', 'x', 'exec')\nfrom manta import *")
    assert own_session.run(POUR) > 100
    own_session.run("import sys\ndel sys.modules['manta']\nbpy.ops.wm.read_factory_settings(use_empty=True)")
    assert own_session.run(POUR) > 100


def test_the_self_test_tells_that_fluids_work_and_what_this_version_needs(tmp_path: Path) -> None:
    launch = make_launch(HostileGround(tmp_path))
    try:
        found = check_fluids(launch)
    finally:
        launch.clean()
    assert found.fault is None
    # Of these versions it is known; for a later one, this says that the remedy may go.
    assert found.needs_remedy is (found.version.startswith(("4.", "5.0", "5.1", "5.2", "5.3")))
    assert found.version in str(found)


def test_a_process_that_has_run_a_fluid_ends_in_peace(tmp_path: Path) -> None:
    launch = make_launch(HostileGround(tmp_path))
    process = BlenderProcess(launch)
    process.call("fluid_self_test", {"remedy": True}, unread, timeout=60)
    process.close()
    launch.clean()
    assert process._process.returncode == 0


def test_describes_all_results_of_the_fluid_check() -> None:
    assert "the repair that it needs" in str(FluidCheck("5.1.2", None, needs_remedy=True))
    assert "no longer needed" in str(FluidCheck("9.0.0", None, needs_remedy=False))
    assert str(FluidCheck("5.1.2", None, needs_remedy=None)) == "Blender 5.1.2 simulates fluids."
    assert "does not" in str(FluidCheck("5.1.2", "it aborts", needs_remedy=None))
