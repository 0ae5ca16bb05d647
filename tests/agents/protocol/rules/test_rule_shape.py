"""R2 to R4: sizes, places, and geometry that is sound."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from scenes import a_plan, build, the_finding, verified

from agents.blender.tools.bake import TOOL as BAKE

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.plan.scene import ScenePlan

pytestmark = pytest.mark.blender

# A table of 1.2 × 0.8 × 0.7 m whose root stands on the floor, turned by 30°.
TABLE = """
where = {"at": (1, 2, 0), "turn": (0, 0, 30)}
top = box("Top", (-0.6, -0.4, 0.65), (0.6, 0.4, 0.7), **where)
leg = box("Leg", (-0.1, -0.1, 0), (0.1, 0.1, 0.65), **where)
root = thing("Table", top, leg, **where)
"""


def plan(
    size: tuple[float, float, float] = (1.2, 0.8, 0.7),
    position: tuple[float, float, float] = (1, 2, 0),
    rotation: tuple[float, float, float] = (0, 0, 30),
    **more: Any,
) -> ScenePlan:
    fields = {
        "name": "Table",
        "systems": ["set"],
        "dimensions": size,
        "position": position,
        "rotation": rotation,
    }
    return a_plan(objects=[fields | more])


# R2


@pytest.mark.parametrize("axis", range(3))
def test_an_extent_may_be_a_tenth_off(session: LiveSession, axis: int) -> None:
    build(session, TABLE)
    size = [1.2, 0.8, 0.7]
    for factor, holds in ((1 / 1.099, True), (1 / 1.101, False), (1 / 0.901, True), (1 / 0.899, False)):
        planned = list(size)
        planned[axis] = size[axis] * factor
        report = verified(session, "R2", plan((planned[0], planned[1], planned[2])))
        if holds:
            assert report.passed == ("R2",)
        else:
            found = the_finding(report)
            assert (found.rule, found.severity, found.objects) == ("R2", "hard", ("Table",))
            assert found.measured == pytest.approx(size[axis], rel=1e-5)
            assert found.tolerance == pytest.approx(planned[axis] * 0.1)
            assert f"along {'XYZ'[axis]}" in found.message


def test_a_sheet_may_have_no_thickness(session: LiveSession) -> None:
    build(session, 'thing("Table", plane("Cloth", (-0.6, -0.4), (0.6, 0.4)))')
    assert verified(session, "R2", plan((1.2, 0.8, 0.02))).passed == ("R2",)
    found = the_finding(verified(session, "R2", plan((1.2, 0.8, 0.03))))
    assert found.measured == pytest.approx(0, abs=1e-6)
    session.run('bpy.data.objects["Cloth"].data.vertices[0].co.z = 0.001')
    assert verified(session, "R2", plan((1.2, 0.8, 0.02))).findings


def test_what_particles_are_copies_of_is_no_part_of_their_system(session: LiveSession) -> None:
    shower = """
tap = plane("Tap", (-0.6, -0.4), (0.6, 0.4))
leaf = box("Leaf", (4, 4, -2), (5, 5, -1))
thing("Table", tap, leaf)
made = tap.modifiers.new("Shower", "PARTICLE_SYSTEM").particle_system.settings
"""
    build(session, shower)
    assert verified(session, "R2", plan((1.2, 0.8, 0.02))).findings
    session.run(
        'made = bpy.data.particles[0]\nmade.render_type = "OBJECT"\n'
        'made.instance_object = bpy.data.objects["Leaf"]'
    )
    assert verified(session, "R2", plan((1.2, 0.8, 0.02))).passed == ("R2",)
    session.run(
        'leaf = bpy.data.objects["Leaf"]\nleaves = bpy.data.collections.new("Leaves")\n'
        "leaves.objects.link(leaf)\nmade = bpy.data.particles[0]\n"
        'made.render_type, made.instance_collection = "COLLECTION", leaves'
    )
    assert verified(session, "R2", plan((1.2, 0.8, 0.02))).passed == ("R2",)
    session.run('bpy.data.objects["Tap"].modifiers.clear()')
    assert verified(session, "R2", plan((1.2, 0.8, 0.02))).findings


@pytest.mark.parametrize(
    "change",
    [
        "",
        'top.modifiers.new("Bevel", "BEVEL").width = 0.01',
        "root.rotation_euler = (0.3, 0.2, 1)",
        # What renders do not show is no part of the size.
        'hint = box("Hint", (-9, -9, -9), (9, 9, 9))\nhint.hide_render = True\n'
        'bpy.data.collections["Table"].objects.link(hint)',
    ],
)
def test_a_size_is_measured_along_the_objects_own_axes(session: LiveSession, change: str) -> None:
    build(session, TABLE + change)
    assert verified(session, "R2", plan()).passed == ("R2",)


@pytest.mark.parametrize(
    ("change", "measured"),
    [
        ("root.scale = (2, 1, 1)", 2.4),
        ('array = top.modifiers.new("Array", "ARRAY")\narray.count = 2', 2.4),
        ("top.data.transform(Matrix.Scale(2, 4, (1, 0, 0)))", 2.4),
    ],
)
def test_what_changes_the_size_is_found_wherever_it_is(
    session: LiveSession, change: str, measured: float
) -> None:
    build(session, TABLE + change)
    assert the_finding(verified(session, "R2", plan())).measured == pytest.approx(measured, rel=1e-5)


WORDS = """
text = bpy.data.curves.new("Words", "FONT")
text.body, text.extrude = "I", 0.1
thing("Table", bpy.data.objects.new("Words", text))
"""
GROWN = """
grown = bpy.data.collections.new("Grown")
grown.objects.link(box("Stone", (0, 0, 0), (0.3, 0.4, 0.2)))
maker = bpy.data.objects.new("Maker", None)
thing("Table", maker)
maker.instance_type, maker.instance_collection, maker.scale = "COLLECTION", grown, (2, 1, 1)
"""


@pytest.mark.parametrize(("script", "height"), [(WORDS, 0.2), (GROWN, 0.2)], ids=["text", "an instance"])
def test_sizes_are_those_of_what_is_seen(session: LiveSession, script: str, height: float) -> None:
    build(session, script)
    wide = (0.6, 0.4, height) if script is GROWN else (9.0, 9.0, height)
    found = verified(session, "R2", plan(wide)).findings
    axes = [part[0] for one in found for part in one.message.split(" along ")[1:]]
    assert axes == ([] if script is GROWN else ["X", "Y"])


@pytest.mark.parametrize(
    ("scale", "told", "remedy"),
    [
        ((2, 2, 2), "2.400 m along X (the plan says 1.2 m), 1.600 m along Y", "by 0.500 (and apply"),
        (
            (2, 1, 4),
            "2.400 m along X (the plan says 1.2 m), 2.800 m along Z",
            "by 0.500 along X, 0.250 along Z",
        ),
    ],
)
def test_a_wrong_size_is_one_finding_whatever_its_axes(
    session: LiveSession, scale: tuple[float, ...], told: str, remedy: str
) -> None:
    build(session, f"{TABLE}root.scale = {scale}")
    found = the_finding(verified(session, "R2", plan()))
    assert told in found.message
    assert remedy in found.fix
    assert found.tolerance == pytest.approx(0.12 if scale[2] == 2 else 0.07), "that of the worst axis"


def test_a_size_by_a_keyed_scale_is_not_to_be_applied(session: LiveSession) -> None:
    keyed = """root.scale = (2, 2, 2)
root.keyframe_insert("scale", frame=1)
root.scale = (1, 1, 1)
root.keyframe_insert("scale", frame=10)
"""
    build(session, TABLE + keyed)
    found = the_finding(verified(session, "R2", plan()))
    assert "The scale of 'Table root' is keyed" in found.fix
    assert "and apply" not in found.fix


# R3


@pytest.mark.parametrize(("size", "most"), [((1.2, 0.8, 0.7), 0.05 * 1.6031), ((0.05, 0.05, 0.05), 0.01)])
def test_a_root_may_be_a_little_off_its_place(
    session: LiveSession, size: tuple[float, float, float], most: float
) -> None:
    build(session, TABLE)
    assert verified(session, "R3", plan(size, (1, 2 + 0.99 * most, 0))).passed == ("R3",)
    found = the_finding(verified(session, "R3", plan(size, (1, 2 + 1.01 * most, 0))))
    assert (found.rule, found.severity, found.objects) == ("R3", "hard", ("Table", "Table root"))
    assert found.measured == pytest.approx(1.01 * most, abs=1e-5)
    assert found.tolerance == pytest.approx(most, abs=1e-5)
    assert found.at == pytest.approx((1, 2, 0))


@pytest.mark.parametrize("rotation", [(0, 0, 30 + 4.9), (4.9, 0, 30), (0, 0, 390)])
def test_a_root_may_be_turned_a_little(session: LiveSession, rotation: tuple[float, float, float]) -> None:
    build(session, TABLE)
    assert verified(session, "R3", plan(rotation=rotation)).passed == ("R3",)


@pytest.mark.parametrize(
    ("rotation", "off"), [((0, 0, 35.1), 5.1), ((0, -5.1, 30), 5.1), ((0, 0, -150), 180), ((180, 0, 30), 180)]
)
def test_a_root_that_is_turned_away_is_found(
    session: LiveSession, rotation: tuple[float, float, float], off: float
) -> None:
    build(session, TABLE)
    found = the_finding(verified(session, "R3", plan(rotation=rotation)))
    assert (found.measured, found.tolerance) == (pytest.approx(off, abs=0.02), 5)
    assert found.unit == "°"


def test_meshes_in_their_place_do_not_stand_for_the_root(session: LiveSession) -> None:
    build(
        session, TABLE + "root.location = (0, 0, 0)\nfor one in (top, leg):\n    one.location = (1.2, 1.7, 0)"
    )
    assert the_finding(verified(session, "R3", plan())).measured == pytest.approx(5**0.5, abs=1e-5)


def test_what_moves_is_where_it_is_planned_at_the_first_frame(session: LiveSession) -> None:
    build(
        session,
        TABLE + "scene.frame_start, scene.frame_end = 5, 20\nkey(root, 5, location=(1, 2, 0))\n"
        "key(root, 20, location=(4, 2, 0))\nscene.frame_set(20)",
    )
    assert verified(session, "R2,R3", plan()).passed == ("R2", "R3")
    session.run("bpy.context.scene.frame_start = 20")
    assert the_finding(verified(session, "R3", plan())).measured == pytest.approx(3, abs=1e-5)


def test_a_planned_field_has_a_place_but_no_size(session: LiveSession) -> None:
    build(
        session,
        'wind = bpy.data.objects.new("Table", None)\nscene.collection.objects.link(wind)\nwind.location = (1, 2, 3)',
    )
    planned = {"rotation": (0, 0, 0), "role": "force"}
    report = verified(session, "R2,R3", plan(position=(1, 2, 0), **planned))
    assert the_finding(report).measured == pytest.approx(3, abs=1e-6)
    session.run('bpy.data.objects["Table"].rotation_euler = (0, 1.57, 0)')  # a wind blows along its own Z
    assert verified(session, "R2,R3", plan(position=(1, 2, 3), **planned)).passed == ("R2", "R3")


def test_a_planned_field_that_is_not_made_yet_is_not_asked_for_its_place(session: LiveSession) -> None:
    build(session, 'thing("Chair", box("Seat", (0, 0, 0), (1, 1, 1)))')
    report = verified(session, "R3", plan(position=(1, 2, 3), role="force"))
    assert report.ok
    assert not report.findings


def test_what_is_not_there_is_never_in_its_place(session: LiveSession) -> None:
    build(session, 'thing("Chair", box("Seat", (0, 0, 0), (1, 1, 1)))')
    report = verified(session, "R2,R3", plan())
    assert [(one.rule, one.outcome, one.objects) for one in report.findings] == [
        ("R2", "undecided", ("Table",)),
        ("R3", "undecided", ("Table",)),
    ]
    assert not report.ok


# R4

CRATE = 'crate = box("Planks", (0, 0, 0), (1, 1, 1))\nroot = thing("Crate", crate)\n'


@pytest.mark.parametrize(
    "more",
    [
        "",
        "crate.scale = (2, 3, 4)",
        # What is not to be seen, and the domain of a fluid, is not geometry of the scene.
        "crate.data.clear_geometry()\ncrate.hide_render = True",
        'tank = crate.modifiers.new("Fluid", "FLUID")\ntank.fluid_type = "DOMAIN"\ncrate.scale = (-1, 1, 1)',
        # A path has no faces, and need not have any.
        'path = bpy.data.objects.new("Path", bpy.data.curves.new("Path", "CURVE"))\n'
        'bpy.data.collections["Crate"].objects.link(path)',
        "rigid(crate, 'PASSIVE')\ncrate.scale = (2, 2, 2)",
    ],
)
def test_geometry_that_is_sound_is_passed(session: LiveSession, more: str) -> None:
    build(session, CRATE + more)
    assert verified(session, "R4").passed == ("R4",)


@pytest.mark.parametrize(
    ("change", "objects", "measured", "why"),
    [
        ("crate.data.clear_geometry()", ("Planks",), 0, "no faces"),
        ('mask = crate.modifiers.new("Mask", "MASK")\nmask.vertex_group = crate.vertex_groups.new(name="None").name',
         ("Planks",), 0, "no faces"),
        ("crate.data.vertices[3].co.y = float('nan')", ("Planks",), None, "not finite"),
        ("crate.data.vertices[3].co.y = float('inf')", ("Planks",), None, "not finite"),
        ("crate.location.x = float('nan')", ("Planks",), None, "not finite"),
        ("crate.scale = (1, -2, 1)", ("Planks",), -2, "negative scale"),
        ("crate.scale = (-1, -1, 1)", ("Planks",), -1, "negative scale"),
        ("root.scale = (1, 1, -1)", ("Planks", "Crate root"), None, "mirrored by its parent 'Crate root'"),
        ("crate.scale = (1, 0, 1)", ("Planks",), 0, "has scale 0"),
        ("rigid(crate)\ncrate.scale = (1, 1, 1.5)", ("Planks",), 0.5, "solvers expect 1"),
        ("rigid(crate)\nroot.scale = (1.5, 1.5, 1.5)", ("Planks",), 0.5, "solvers expect 1"),
        ('crate.modifiers.new("Cloth", "CLOTH")\ncrate.scale = (0.9, 1, 1)', ("Planks",), 0.1, "solvers expect 1"),
    ],
)  # fmt: skip
def test_geometry_that_is_not_sound_is_found(
    session: LiveSession, change: str, objects: tuple[str, ...], measured: float | None, why: str
) -> None:
    build(session, CRATE + change)
    found = the_finding(verified(session, "R4"))
    assert (found.rule, found.severity, found.outcome) == ("R4", "hard", "broken")
    assert found.objects == objects
    assert found.measured == (None if measured is None else pytest.approx(measured, abs=1e-6))
    assert why in found.message


KEYED = """
{one}.scale = {scale}
{one}.keyframe_insert("scale", frame=1)
{one}.scale = (1, 1, 1)
{one}.keyframe_insert("scale", frame=10)
scene.frame_set(1)
"""


@pytest.mark.parametrize(
    ("change", "remedy"),
    [
        (KEYED.format(one="crate", scale=(0, 0, 0)), "key whether it is shown"),
        (KEYED.format(one="root", scale=(-1, 1, 1)), "mirror the mesh itself"),
        (KEYED.format(one="crate", scale=(2, 2, 2)) + "rigid(crate)", "leave the scale at 1"),
        (
            'scaled = crate.driver_add("scale", 0)\nscaled.driver.expression = "2"\nrigid(crate)\n'
            "bpy.context.view_layer.update()",
            "set by a driver",
        ),
        ("crate.scale = (2, 2, 2)\nrigid(crate)", "Apply the scale"),
    ],
)
def test_a_scale_that_changes_is_not_to_be_applied(session: LiveSession, change: str, remedy: str) -> None:
    build(session, CRATE + change)
    (fix,) = {found.fix for found in verified(session, "R4").findings}
    assert remedy in fix
    assert ("Apply" in fix) == (remedy == "Apply the scale")


# One copy of the crate for each particle, once it is born.
COPIES = (
    CRATE
    + """
scene.frame_end = 20
bpy.ops.mesh.primitive_plane_add(size=0.1, location=(0, 0, 3))
tap = bpy.context.object
tap.hide_render = True
tap.modifiers.new("Drops", "PARTICLE_SYSTEM")
drops = tap.particle_systems[0].settings
drops.count, drops.frame_end, drops.frame_start = 5, {birth} + 2, {birth}
copies = crate.modifiers.new("Copies", "PARTICLE_INSTANCE")
copies.object, copies.show_unborn = tap, False
"""
)


@pytest.mark.parametrize(("birth", "passed"), [(8, ("R4",)), (30, ())])
def test_copies_may_come_later_if_they_come(
    session: LiveSession, birth: int, passed: tuple[str, ...]
) -> None:
    build(session, COPIES.format(birth=birth))
    assert verified(session, "R4").passed == ("R4",), "nothing is stepped for it before motion is judged"
    session.use(BAKE)
    report = verified(session, "R4")
    assert report.passed == passed
    if not passed:
        assert "no faces" in the_finding(report).message


@pytest.mark.parametrize(
    ("scale", "holds"), [(1.0009, True), (1.0011, False), (0.9991, True), (0.9989, False)]
)
def test_a_simulated_body_has_the_scale_of_one(session: LiveSession, scale: float, holds: bool) -> None:
    build(session, CRATE + f"rigid(crate)\ncrate.scale = ({scale}, 1, 1)")
    report = verified(session, "R4")
    assert report.passed == (("R4",) if holds else ())
    if not holds:
        assert the_finding(report).tolerance == pytest.approx(1e-3)


OPENED = {
    "a missing face": (
        "corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]\ncrate.data.clear_geometry()\n"
        "crate.data.from_pydata(corners, [], [(0, 1, 2), (0, 1, 3), (1, 2, 3)])",
        3,
    ),
    "a face too many": (
        "shape = bmesh.new()\nshape.from_mesh(crate.data)\nshape.verts.ensure_lookup_table()\n"
        "shape.faces.new([shape.verts[0], shape.verts[1], shape.verts.new((2, 2, 2))])\nshape.to_mesh(crate.data)",
        3,
    ),
}


@pytest.mark.parametrize(("change", "edges"), OPENED.values(), ids=OPENED)
def test_what_holds_a_volume_is_closed(session: LiveSession, change: str, edges: int) -> None:
    build(session, CRATE)
    objects = [{"name": "Crate", "systems": ["set"], "dimensions": (1, 1, 1), "position": (0, 0, 0)}]
    holds = a_plan(objects=[objects[0] | {"holds_volume": True}])
    assert verified(session, "R4", holds).passed == ("R4",)
    session.empty()
    build(session, CRATE + change)
    assert verified(session, "R4", a_plan(objects=objects)).passed == ("R4",)
    found = the_finding(verified(session, "R4", holds))
    assert (found.objects, found.measured, found.tolerance) == (("Planks",), edges, 0)


def test_lengths_in_another_unit_are_not_taken_for_metres(session: LiveSession) -> None:
    build(session, CRATE + "scene.unit_settings.scale_length = 0.01")
    found = the_finding(verified(session, "R4"))
    assert (found.objects, found.outcome, found.severity) == ((), "undecided", "hard")
    assert found.measured == pytest.approx(0.01)


def test_what_is_rendered_but_not_evaluated_is_undecided(session: LiveSession) -> None:
    build(session, CRATE + "crate.hide_viewport = True")
    assert the_finding(verified(session, "R4")).outcome == "undecided"


def test_a_simulation_that_explodes_is_found_at_the_end(session: LiveSession) -> None:
    # A driver stands for the solver: it puts the body's vertices where no numbers are.
    build(
        session,
        CRATE + "scene.frame_start, scene.frame_end = 1, 10\nrigid(crate)\nscene.gravity = (0, 0, 0)\n"
        'crate.shape_key_add(name="Basis")\nblown = crate.shape_key_add(name="Blown")\n'
        "for point in blown.data:\n    point.co = (1e38, 1e38, 1e38)\nblown.slider_max = 10\n"
        "blown.value = 0\nblown.keyframe_insert('value', frame=1)\n"
        "blown.value = 10\nblown.keyframe_insert('value', frame=10)\nscene.frame_set(1)",
    )
    found = next(one for one in verified(session, "R4,T1").findings if one.rule == "R4")
    assert (found.objects, found.frame) == (("Planks",), 10)
    assert "not finite" in found.message
