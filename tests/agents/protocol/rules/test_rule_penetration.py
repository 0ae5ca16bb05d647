"""V2: nothing goes through anything undeclared."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from scenes import a_plan, build, the_finding, verified

from agents.blender.tools.bake import TOOL as BAKE
from agents.blender.tools.group import TOOL as GROUP

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

FLOORS = {
    "a slab": 'thing("Floor", box("Ground", (-5, -5, -0.5), (5, 5, 0)), system_name="ground")\n',
    "a sheet": 'thing("Floor", plane("Ground", (-5, -5), (5, 5)), system_name="ground")\n',
}
FLOOR = FLOORS["a slab"]
CRATE = (
    'crate = box("Planks", ({0}, {0}, 0), (-{0}, -{0}, {1}), at=(0, 0, -{2}))\nroot = thing("Crate", crate)\n'
)


def crate(depth: float, side: float = 0.2) -> str:
    return CRATE.format(-side / 2, side, depth)


# Noise is 1 mm, or 1 % of the smallest dimension of either: a slab of 0.5 m, a sheet without a thickness.
@pytest.mark.parametrize(
    ("floor", "side", "noise"),
    [
        ("a slab", 0.05, 0.001),
        ("a slab", 0.2, 0.002),
        ("a slab", 1.0, 0.005),
        ("a sheet", 0.2, 0.001),
        ("a sheet", 1.0, 0.001),
    ],
)
def test_a_depth_is_noise_up_to_the_tolerance(
    session: LiveSession, floor: str, side: float, noise: float
) -> None:
    build(session, FLOORS[floor] + crate(0.95 * noise, side))
    assert verified(session, "V2").passed == ("V2",)
    session.empty()
    build(session, FLOORS[floor] + crate(1.05 * noise, side))
    found = the_finding(verified(session, "V2"))
    assert (found.rule, found.severity, found.outcome) == ("V2", "hard", "broken")
    assert set(found.objects) == {"Planks", "Ground"}
    assert found.measured == pytest.approx(1.05 * noise, abs=3e-5)
    assert found.tolerance == pytest.approx(noise, rel=1e-5)
    assert found.unit == "m"
    assert found.at is not None
    assert found.at[2] == pytest.approx(0, abs=2 * noise)


def test_a_plan_may_ask_for_less(session: LiveSession) -> None:
    build(session, FLOOR + crate(0.0015))
    assert verified(session, "V2").passed == ("V2",)
    plan = a_plan(
        {"kind": "Upright", "a": "Crate"}, tolerances={"penetration": 5e-4, "penetration_share": 0.001}
    )
    assert the_finding(verified(session, "V2", plan)).tolerance == pytest.approx(5e-4)


@pytest.mark.parametrize("floor", FLOORS.values(), ids=FLOORS)
@pytest.mark.parametrize(
    "shape",
    [
        'thing("Ball", ball("Sphere", 0.3, at=(0, 0, 0.3)))',
        'thing("Crate", box("Planks", (-1, -1, 0), (1, 1, 1), turn=(0, 0, 37)))',
        'thing("Tent", box("Ridge", (-1, -1, -1), (1, 1, 1), at=(0, 0, 2 ** 0.5), turn=(45, 0, 0)))',
        'thing("Card", plane("Paper", (-0.1, -0.1), (0.1, 0.1), at=(0, 0, 0.1), turn=(90, 0, 20)))',
    ],
    ids=["a point", "a face", "an edge", "a rim"],
)
def test_what_just_touches_does_not_go_through(session: LiveSession, floor: str, shape: str) -> None:
    build(session, floor + shape)
    assert verified(session, "V2").passed == ("V2",)


@pytest.mark.parametrize(
    "said",
    [
        'crate["contact_with"] = "Ground"',
        'bpy.data.objects["Floor root"]["contact_with"] = ["Crate root"]',
    ],
)
def test_what_is_declared_may_be_in_each_other(session: LiveSession, said: str) -> None:
    build(session, FLOOR + crate(0.05) + said)
    assert verified(session, "V2").passed == ("V2",)


@pytest.mark.parametrize(
    ("relation", "is_declared"),
    [
        ({"kind": "SupportedBy", "child": "Crate", "parents": ("Floor",)}, True),
        ({"kind": "EmbeddedIn", "part": "Crate", "host": "Floor", "depth": 0.05}, True),
        ({"kind": "Inside", "content": "Crate", "container": "Floor"}, True),
        ({"kind": "NextTo", "a": "Crate", "b": "Floor"}, False),
        ({"kind": "OnTopOf", "a": "Crate", "b": "Floor"}, False),
    ],
)
def test_relations_that_join_declare_it(
    session: LiveSession, relation: dict[str, object], is_declared: bool
) -> None:
    build(session, FLOOR + crate(0.05))
    report = verified(session, "V2", a_plan(relation))
    assert report.passed == (("V2",) if is_declared else ())


def test_parts_of_one_object_are_no_exception(session: LiveSession) -> None:
    build(
        session,
        'thing("Cup", box("Mug", (0, 0, 0), (0.1, 0.1, 0.1)), box("Handle", (0.095, 0.04, 0.02), (0.15, 0.06, 0.08)))',
    )
    found = the_finding(verified(session, "V2"))
    assert set(found.objects) == {"Mug", "Handle"}
    assert found.measured == pytest.approx(0.005, abs=3e-5)


def test_parts_that_reach_into_each_other_are_one_finding_until_their_object_names_itself(
    session: LiveSession,
) -> None:
    build(
        session,
        'logs = [box(f"Log_{k}", (0, 0, 0), (0.2, 1, 0.2), at=(0.15 * k, 0, 0)) for k in range(4)]\n'
        'thing("Pile", *logs)',
    )
    found = the_finding(verified(session, "V2"))
    assert set(found.objects) == {"Log_0", "Log_1", "Log_2", "Log_3"}
    assert found.measured == pytest.approx(0.05, abs=1e-4)
    assert "Parts of 'Pile' reach into each other" in found.message
    assert "contact_with=[…, 'Pile']" in found.fix
    session.use(GROUP, groups=[{"object": "Pile", "contact_with": ["Pile"]}])
    assert verified(session, "V1,V2").findings == ()
    session.run("bpy.data.objects['Log_3'].location.x = 9")  # they may, and need not
    assert verified(session, "V1,V2").findings == ()
    session.run("for k in range(3): bpy.data.objects[f'Log_{k}'].hide_render = True")  # one is left
    assert verified(session, "V1,V2").findings == ()


@pytest.mark.parametrize(
    "hidden",
    ["crate.hide_render = True", 'bpy.data.collections["Crate"].hide_render = True',
     'bpy.context.view_layer.layer_collection.children["set"].exclude = True'],
)  # fmt: skip
def test_what_no_render_shows_is_in_nothings_way(session: LiveSession, hidden: str) -> None:
    build(session, FLOOR + crate(0.05) + hidden)
    assert set(verified(session, "V2").not_applicable) == {"V2"}


def test_what_is_rendered_but_not_evaluated_is_undecided(session: LiveSession) -> None:
    build(session, FLOOR + crate(0.05) + "crate.hide_viewport = True")
    found = the_finding(verified(session, "V2"))
    assert (found.objects, found.outcome, found.severity) == (("Planks",), "undecided", "hard")


# A mesh that hangs lower than its body by as much as the body would sink in.
LAID = """
scene.frame_start, scene.frame_end = 1, 30
ground, crate = bpy.data.objects["Ground"], bpy.data.objects["Planks"]
rigid(ground, "PASSIVE", collision_shape="BOX")
crate.location.z += 0.02
rigid(crate, mesh_source="BASE")
low = crate.modifiers.new("Low", "DISPLACE")
low.direction, low.mid_level, low.strength = "Z", 0, -{0}
"""
LOWERED = """
scene.frame_start, scene.frame_end = 1, 30
for frame, z in ((1, 0.1), (30, -{0})):
    key(root, frame, location=(0, 0, z))
scene.frame_set(1)
"""


@pytest.mark.parametrize(
    ("script", "depth", "noise"),
    [(LAID, 0.0017, None), (LAID, 0.004, 0.002), (LOWERED, 0.0017, 0.001)],
)
def test_what_the_solver_has_laid_down_may_sink_in_as_far_as_contact_goes(
    session: LiveSession, script: str, depth: float, noise: float | None
) -> None:
    build(session, FLOORS["a sheet"] + crate(0) + script.format(depth))
    if script == LAID:
        session.use(BAKE)
    report = verified(session, "V2")
    if noise is None:
        assert report.passed == ("V2",)
        return
    found = the_finding(report)
    assert (found.tolerance, found.frame) == (pytest.approx(noise, rel=1e-5), 30)
    assert found.measured == pytest.approx(depth, abs=5e-4)


@pytest.mark.parametrize("kind", ["box", "ball", "plane"])
def test_something_that_is_there_twice_is_found(session: LiveSession, kind: str) -> None:
    made = {
        "box": 'box("{}", (-0.2, -0.2, 0), (0.2, 0.2, 0.4))',
        "ball": 'ball("{}", 0.2)',
        "plane": 'plane("{}", (-0.2, -0.2), (0.2, 0.2), turn=(10, 20, 0))',
    }[kind]
    build(session, f'thing("One", {made.format("A")})\nthing("Other", {made.format("B")})')
    found = the_finding(verified(session, "V2"))
    assert set(found.objects) == {"A", "B"}
    if kind == "plane":
        assert found.outcome == "undecided"
        assert "may be a duplicate" in found.message
    else:
        assert found.measured == pytest.approx(0.4, rel=0.02)


ROOM = """
shell = box("Shell", (-3, -3, 0), (3, 3, 3))
{turned}
thing("Room", shell)
thing("Chair", box("Seat", (-0.2, -0.2, 0.4), (0.2, 0.2, 0.9)))
thing("Picture", box("Frame", (-1, 2.95, 1), (1, 3, 2), at=(0, {through}, 0)))
"""
INSIDE_OUT = "shell.data.flip_normals()"


@pytest.mark.parametrize("turned", [INSIDE_OUT, "camera((2, -2, 1.5), (0, 0, 1))"])
def test_a_room_made_of_one_box_is_hollow(session: LiveSession, turned: str) -> None:
    build(session, ROOM.format(turned=turned, through=0))
    assert verified(session, "V2").passed == ("V2",)
    session.empty()
    build(session, ROOM.format(turned=turned, through=0.02))
    found = the_finding(verified(session, "V2"))
    assert set(found.objects) == {"Shell", "Frame"}
    assert found.measured == pytest.approx(0.02, abs=3e-5)


def test_what_is_hidden_in_something_solid_is_found(session: LiveSession) -> None:
    build(session, ROOM.format(turned="", through=0))
    found = verified(session, "V2").findings
    assert {frozenset(one.objects) for one in found} == {
        frozenset(("Shell", "Seat")),
        frozenset(("Shell", "Frame")),
    }


MOVING = """
scene.frame_start, scene.frame_end = 1, 20
key(root, 1, location=(0, 0, {0}))
key(root, 20, location=(0, 0, {1}))
thing("Post", box("Wood", (2, 2, -0.2), (2.1, 2.1, 1)))
"""


@pytest.mark.parametrize(("first", "last", "frame"), [(0.3, -0.05, 20), (-0.05, 0.3, 1)])
def test_what_moves_is_looked_at_at_both_ends_of_the_timeline(
    session: LiveSession, first: float, last: float, frame: int
) -> None:
    build(session, FLOOR + crate(0) + MOVING.format(first, last) + "scene.frame_set(10)")
    report = verified(session, "V2")
    # What stands still is told once.
    by_name = {frozenset(one.objects): one for one in report.findings}
    assert set(by_name) == {frozenset(("Wood", "Ground")), frozenset(("Planks", "Ground"))}
    assert by_name[frozenset(("Wood", "Ground"))].frame is None
    moving = by_name[frozenset(("Planks", "Ground"))]
    assert moving.frame == frame
    assert moving.measured == pytest.approx(0.05, abs=3e-5)
    assert session.run("bpy.context.scene.frame_current") == 10


def test_a_fluids_domain_is_around_what_is_in_it(session: LiveSession) -> None:
    build(
        session,
        FLOOR + 'tank = box("Tank", (-1, -1, -0.2), (1, 1, 1))\nthing("Water", tank)\n'
        'domain = tank.modifiers.new("Fluid", "FLUID")\ndomain.fluid_type = "DOMAIN"',
    )
    assert verified(session, "V2").passed == ("V2",)


def test_particles_are_no_surface_of_what_emits_them(session: LiveSession) -> None:
    build(
        session,
        FLOOR + 'lawn = plane("Lawn", (-1, -1), (1, 1))\nthing("Garden", lawn)\n'
        'blade = box("Blade", (0, 0, -0.1), (0.01, 0.01, 0.1), at=(9, 9, 1))\nthing("Grass", blade)\n'
        'lawn.modifiers.new("Hair", "PARTICLE_SYSTEM")\nsettings = lawn.particle_systems[0].settings\n'
        'settings.type, settings.count, settings.render_type = "HAIR", 50, "OBJECT"\nsettings.instance_object = blade',
    )
    assert verified(session, "V2").passed == ("V2",)


def test_one_mesh_alone_goes_through_nothing(session: LiveSession) -> None:
    build(session, FLOOR)
    assert set(verified(session, "V2").not_applicable) == {"V2"}
