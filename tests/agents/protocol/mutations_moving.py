"""Breaches of what is simulated or keyed."""

from __future__ import annotations

from mutation import Aim, Mutation


def drop_cache(aim: Aim) -> Mutation:
    """The bake is freed, or made to end early."""
    cloth = aim.name == "cloth"
    points = (
        "bpy.data.objects['Sheet'].modifiers['Cloth'].point_cache"
        if cloth
        else "scene.rigidbody_world.point_cache"
    )
    code = f"points = {points}\nfree(points)"
    if aim.random.random() < 0.5:
        end = aim.scene.plan.frame_end - aim.random.randint(2, 20)
        code += f"\npoints.frame_end = {end}"
    return Mutation(
        "drop a cache",
        aim.name,
        code,
        "freed" + (" and cut short" if "frame_end" in code else ""),
        ("R19", "T1"),
    )


def fake_bodies(aim: Aim) -> Mutation:
    """A tile moves as before, but by keyframes: with its body gone, kept still, or kept as it is."""
    number, how = aim.random.randint(1, 8), aim.random.choice(("removed", "kinematic", "kept"))
    name = f"Tile {number}"
    undone = {
        "removed": "without_body(one)",
        "kinematic": "one.rigid_body.kinematic = True",
        "kept": "",
    }[how]
    code = f"""
one = bpy.data.objects[{name!r}]
found = poses(one)
{undone}
for frame, there in found:
    one.matrix_world = there
    one.keyframe_insert("location", frame=frame)
    one.keyframe_insert("rotation_euler", frame=frame)
"""
    names = frozenset({name, f"Domino {number}"})
    return Mutation(
        "replace the simulation by keyframes", aim.name, code, f"{name}, body {how}", ("R15",), names
    )


def fake_cloth(aim: Aim) -> Mutation:
    """The cloth deforms as before, by shape keys; or only its object is keyed. Its modifier is gone, off, or on."""
    how = aim.random.choice(("removed", "off", "kept"))
    kind = aim.random.choice(("keyframes", "shape keys", "shape keys"))
    undone = {
        "removed": "one.modifiers.remove(one.modifiers['Cloth'])",
        "off": "one.modifiers['Cloth'].show_render = one.modifiers['Cloth'].show_viewport = False",
        "kept": "",
    }[how]
    if kind == "keyframes":
        code = f"""
one = bpy.data.objects["Sheet"]
found = [(frame, min(co.z for co in places)) for frame, places in shapes(one, 1)]
{undone}
for frame, low in found:
    root("Tablecloth").location.z = 0.8 + low
    root("Tablecloth").keyframe_insert("location", frame=frame)
"""
    else:
        code = f"""
one = bpy.data.objects["Sheet"]
found = shapes(one, 7)
{undone}
one.shape_key_add(name="Basis")
for frame, places in found:
    shape = one.shape_key_add(name=f"At {{frame}}")
    shape.points.foreach_set("co", [part for co in places for part in co])
    for value, at in ((0, frame - 7), (1, frame), (0, frame + 7)):
        shape.value = value
        shape.keyframe_insert("value", frame=at)
"""
    told = f"the cloth, modifier {how}"
    names = frozenset({"Tablecloth", "Sheet", "Tablecloth root"})
    return Mutation(f"replace the simulation by {kind}", aim.name, code, told, ("R15",), names)


def shift(aim: Aim) -> Mutation:
    """The keyed phases, or the timeline, begin earlier or later by more than T2 lets through; baked anew or not."""
    if aim.name == "cloth" or aim.random.random() < 0.3:
        by = aim.random.choice((-4, -3, -2, -1, 1, 2, 3, 4, 5))
        code = f"scene.frame_start = max(0, scene.frame_start + {by})\nscene.frame_end += {by}"
        return Mutation("shift a phase", aim.name, code, f"the timeline by {by} frames", ("T1",))
    by, again = aim.random.choice((-5, -4, -3, 3, 4, 5, 6, 8)), aim.random.random() < 0.5
    code = f"""
for curve in curves(bpy.data.objects["Pusher root"]):
    for point in curve.keyframe_points:
        point.co[0] += {by}
        point.handle_left[0] += {by}
        point.handle_right[0] += {by}
"""
    if again:
        code += """
points = scene.rigidbody_world.point_cache
free(points)
with bpy.context.temp_override(point_cache=points):
    bpy.ops.ptcache.bake(bake=True)
"""
    told = f"the push by {by} frames{', baked again' if again else ''}"
    return Mutation("shift a phase", aim.name, code, told, ("T2",))
