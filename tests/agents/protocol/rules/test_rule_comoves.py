"""R18: what travels with something, measured against where it was when both set off."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from scenes import a_motion, a_plan, build, the_finding, verified

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.plan.scene import ScenePlan

pytestmark = pytest.mark.blender

# A cart of 2 m that drives 5 m and turns by a right angle, and a crate on it that is parented to it.
CART = """
scene.frame_start, scene.frame_end = 1, 41
cart = thing("Cart", box("Bed", (-1, -0.5, 0.2), (1, 0.5, 0.4)))
crate = thing("Crate", box("Case", (-0.2, -0.2, 0.4), (0.2, 0.2, 0.8)))
crate.parent = cart
key(cart, 1, location=(0, 0, 0), rotation_euler=(0, 0, 0))
key(cart, 41, location=(5, 0, 0), rotation_euler=(0, 0, 1.5708))
"""
RIDES = {"kind": "CoMoves", "a": "Crate", "b": "Cart"}


def plan(*phases: dict[str, Any], relation: dict[str, Any] = RIDES) -> ScenePlan:
    phases = phases or ({"actor": "Cart", "kind": "translate", "start": 1, "end": 41},)
    return a_motion(
        *phases, last=41, roles={"Cart": "keyframed", "Crate": "keyframed"}, relations=(relation,)
    )


def test_what_is_parented_travels_along(session: LiveSession) -> None:
    build(session, CART)
    assert verified(session, "R18", plan()).passed == ("R18",)


@pytest.mark.parametrize(
    ("size", "shift", "most", "holds"),
    [
        (0.2, 0.0095, 0.01, True),
        (0.2, 0.0105, 0.01, False),
        (0.4, 0.0133, 0.0139, True),
        (0.4, 0.0144, 0.0139, False),
    ],
)
def test_a_rider_may_shift_by_a_centimetre_or_a_fiftieth_of_its_diagonal(
    session: LiveSession, size: float, shift: float, most: float, holds: bool
) -> None:
    script = f"key(crate, 11, location=(0, 0, 0))\nkey(crate, 31, location=(0, {shift}, 0))"
    script = f"bpy.data.objects['Case'].data.transform(Matrix.Scale({size / 0.4}, 4))\n{script}"
    build(session, CART + script)
    found = verified(session, "R18", plan())
    assert (found.passed == ("R18",)) == holds
    if not holds:
        finding = the_finding(found)
        assert finding.objects == ("Crate", "Cart")
        assert finding.measured == pytest.approx(shift, abs=1e-4)
        assert finding.tolerance == pytest.approx(most, abs=1e-4)


@pytest.mark.parametrize(("turn", "holds"), [(2.9, True), (3.1, False)])
def test_a_rider_may_turn_by_three_degrees(session: LiveSession, turn: float, holds: bool) -> None:
    script = (
        "key(crate, 11, rotation_euler=(0, 0, 0))\n"
        f"key(crate, 31, rotation_euler=(0, 0, math.radians({turn})))"
    )
    build(session, CART + script)
    found = verified(session, "R18", plan())
    assert (found.passed == ("R18",)) == holds
    if not holds:
        assert (the_finding(found).measured, the_finding(found).unit) == (pytest.approx(turn, abs=0.02), "°")


def test_what_is_left_behind_is_told_with_how_far(session: LiveSession) -> None:
    build(session, CART + "crate.parent = None")
    shift, turn = verified(session, "R18", plan()).findings
    assert (shift.measured, shift.frame) == (pytest.approx(5, abs=0.01), 41)
    assert turn.measured == pytest.approx(90, abs=0.1)


def test_before_its_host_sets_off_a_rider_may_come_aboard(session: LiveSession) -> None:
    aboard = "crate.parent = None\ncrate.constraints.new('CHILD_OF').target = cart\n" + (
        "key(crate, 1, location=(0, 3, 0))\nkey(crate, 20, location=(0, 0, 0))\n"
        "cart.animation_data_clear()\nkey(cart, 21, location=(0, 0, 0))\nkey(cart, 41, location=(5, 0, 0))\n"
    )
    build(session, CART + aboard)
    late = {"actor": "Cart", "kind": "translate", "start": 21, "end": 41}
    assert verified(session, "R18", plan(late)).passed == ("R18",)
    early = {"actor": "Cart", "kind": "translate", "start": 1, "end": 41}
    assert the_finding(verified(session, "R18", plan(early))).measured == pytest.approx(3, abs=0.01)


def test_a_rider_is_held_to_the_part_of_its_host_that_is_next_to_it(session: LiveSession) -> None:
    # The wheels turn, and the mast at the other end bends; the crate stays on the bed.
    script = """
wheel = lathe("Wheel", [(0, -0.05), (0.2, -0.05), (0.2, 0.05), (0, 0.05)], at=(-0.9, 0, 0.2))
mast = box("Mast", (0.9, -0.05, 0.4), (1, 0.05, 2.4))
for one in (wheel, mast):
    bpy.data.collections["Cart"].objects.link(one)
    one.parent = cart
key(wheel, 1, rotation_euler=(0, 0, 0))
key(wheel, 41, rotation_euler=(0, 0, 20))
key(mast, 1, rotation_euler=(0, 0, 0))
key(mast, 41, rotation_euler=(0.5, 0, 0))
"""
    build(session, CART + script)
    assert verified(session, "R18", plan()).passed == ("R18",)


def test_a_body_that_friction_does_not_hold_slides_on_its_cart(session: LiveSession) -> None:
    script = """
scene.frame_start, scene.frame_end = 1, 41
bed = box("Bed", (-1, -0.5, -0.1), (1, 0.5, 0.1), at=(0, 0, 0.3))
case = box("Case", (-0.2, -0.2, -0.2), (0.2, 0.2, 0.2), at=(0, 0, 0.6))
cart, crate = thing("Cart", bed), thing("Crate", case)
rigid(bed, "PASSIVE", kinematic=True, friction=FRICTION)
rigid(case, friction=FRICTION)
key(cart, 1, location=(0, 0, 0))
key(cart, 41, location=(1, 0, 0))
"""
    build(session, script.replace("FRICTION", "1"))
    assert verified(session, "R18", plan()).passed == ("R18",)
    session.empty()
    build(session, script.replace("FRICTION", "0"))
    finding = the_finding(verified(session, "R18", plan()))
    assert finding.measured == pytest.approx(1, abs=0.05)


def test_a_part_travels_with_its_own_object(session: LiveSession) -> None:
    build(session, CART + "bpy.data.collections['Cart'].objects.link(bpy.data.objects['Case'])")
    own = {"kind": "CoMoves", "a": "Cart/Case", "b": "Cart"}
    plan_of = a_plan(own, frame_end=41)
    assert verified(session, "R18", plan_of).passed == ("R18",)


def test_what_is_not_there_is_undecided(session: LiveSession) -> None:
    build(session, CART)
    finding = the_finding(
        verified(session, "R18", plan(relation={"kind": "CoMoves", "a": "Dog", "b": "Cart"}))
    )
    assert (finding.outcome, finding.objects) == ("undecided", ("Dog", "Cart"))
    assert "no object is named 'Dog'" in finding.message
