"""Breaches of what stands still: places, rotations, sizes, and the tree of collections and objects."""

from __future__ import annotations

import math

from mutation import Aim, Mutation, diagonal, names_of

from agents.plan.relations import SupportedBy
from agents.protocol.tolerances import TOLERANCES

# Places, rotations, sizes


def move(aim: Aim) -> Mutation:
    """The root of any object, in any direction, by a multiple of what R3 lets through."""
    one, factor = aim.thing(), aim.factor()
    far = factor * max(TOLERANCES.place, TOLERANCES.place_share * diagonal(one))
    way = tuple(far * part for part in aim.way())
    code = f"move(root({one.name!r}), {way})"
    told = f"{one.name} by {far * 1000:.0f} mm ({factor:.1f} × R3)"
    return Mutation("move", aim.name, code, told, ("R3",), names_of(one))


def lift(aim: Aim) -> Mutation:
    """Off what bears it, by a multiple of the gap that is still contact: less than R3 would notice."""
    # The last tile lies flat on the table in the end: however it began, that bears it.
    but = {"Tablecloth", "Domino 8"}
    rests = [one for one in aim.scene.plan.relations if isinstance(one, SupportedBy) and one.child not in but]
    relation, factor = aim.random.choice(rests), aim.factor()
    child = aim.scene.plan.object(relation.child)
    bearer = aim.scene.plan.object(relation.parents[0].partition("/")[0])
    assert child is not None
    assert bearer is not None
    far = factor * TOLERANCES.contact_gap(min(diagonal(child), diagonal(bearer)))
    # What is simulated is where its bake has it: its mesh is lifted, not its place.
    code = f"""
for one in meshes({child.name!r}):
    one.data.transform(Matrix.Translation((one.matrix_world.to_3x3().inverted() @ Vector((0, 0, {far})))))
"""
    told = f"{child.name} {far * 1000:.1f} mm off {bearer.name} ({factor:.1f} × ε)"
    return Mutation("move (lift)", aim.name, code, told, ("V1", "R5"), names_of(child))


_PARTS = {  # mesh → (its object, the way in which it comes off)
    "room": {
        **{
            f"{name} leg {k}": (name, (0, 0, -1))
            for name in ("Table", "Chair north", "Chair west")
            for k in range(4)
        },
        "Shade": ("Lamp", (0, 0, 1)),
    },
    "dominoes": {
        "Nose": ("Pusher", (1, 0, 0)),
        **{f"Table leg {k}": ("Table", (0, 0, -1)) for k in range(4)},
    },
    "cloth": {f"Table leg {k}": ("Table", (0, 0, -1)) for k in range(4)},
}


def take_off(aim: Aim) -> Mutation:
    """A mesh off the rest of its object, by a multiple of the gap that is still contact."""
    mesh, (name, way) = aim.random.choice(sorted(_PARTS[aim.name].items()))
    owner, factor = aim.scene.plan.object(name), aim.factor()
    assert owner is not None
    far = factor * TOLERANCES.contact_gap(diagonal(owner))  # which is no less than that of a part
    code = f"take_off(bpy.data.objects[{mesh!r}], Vector({way}) * {far})"
    told = f"{mesh} {far * 1000:.1f} mm off ({factor:.1f} × ε)"
    return Mutation("move (part)", aim.name, code, told, ("W2",), frozenset({mesh, name}))


def rotate(aim: Aim) -> Mutation:
    """The root of any object, about any axis, by a multiple of what R3 lets through."""
    one, factor = aim.thing(), aim.factor()
    turn = factor * TOLERANCES.turn
    code = f"turn(root({one.name!r}), {math.radians(turn)}, {aim.way()})"
    told = f"{one.name} by {turn:.0f}° ({factor:.1f} × R3)"
    return Mutation("rotate", aim.name, code, told, ("R3",), names_of(one))


def scale(aim: Aim) -> Mutation:
    """Any object along any axis on which R2 can tell, or along all, by a multiple of what it lets through."""
    one, factor = aim.thing(), aim.factor()
    share = TOLERANCES.dimension_share
    axes = [axis for axis in range(3) if share * one.dimensions[axis] >= TOLERANCES.contact]
    chosen = aim.random.choice([*((axis,) for axis in axes), tuple(range(3))])
    by = 1 + aim.random.choice((1, -1)) * share * factor
    scale = tuple(by if axis in chosen else 1.0 for axis in range(3))
    # The solver sets where a body is, and not its root: such a mesh is scaled itself.
    simulated = one.role in {"rigid", "cloth"}
    target = f"meshes({one.name!r})[0]" if simulated else f"root({one.name!r})"
    told = (
        f"{one.name} × {by:.2f} along {'XYZ' if len(chosen) == 3 else 'XYZ'[chosen[0]]} ({factor:.1f} × R2)"
    )
    owners = ("R2", "R4") if simulated else ("R2",)
    names = names_of(one) | ({f"Tile {one.name.split()[-1]}", "Sheet"} if simulated else frozenset())
    return Mutation("scale", aim.name, f"{target}.scale = {scale}", told, owners, names)


# The tree


def unparent(aim: Aim) -> Mutation:
    """A mesh of any object is let go of; it stays where it is."""
    one, pick = aim.thing(), aim.random.random()
    code = f"""
every = meshes({one.name!r})
one = every[int({pick} * len(every))]
there = one.matrix_world.copy()
one.parent = None
one.matrix_world = there
"""
    return Mutation("unparent", aim.name, code, f"a mesh of {one.name}", ("G1",), names_of(one))


_TAGGED = {  # objects that contact_with names → the objects that name them
    "room": {
        "Slab": ("Pole",),
        "Dish": ("Fruit",),
        "Floor root": ("Speaker left root", "Speaker right root"),
    },
    "dominoes": {"Slab": ("Crate body", "Chest body"), "Table top": ("Rod",)},
    "cloth": {"Slab": ("Stool body", "Basket body")},
}


def rename(aim: Aim) -> Mutation:
    """An object's collection, or an object that another one's contact_with names."""
    if aim.random.random() < 0.5:
        one = aim.thing()
        new = one.name + aim.random.choice((" old", "_copy", " 2"))
        code = f"bpy.data.collections[{one.name!r}].name = {new!r}"
        return Mutation("rename", aim.name, code, f"{one.name} → {new}", ("R1",), frozenset({one.name}))
    name, by = aim.random.choice(sorted(_TAGGED[aim.name].items()))
    code = f"bpy.data.objects[{name!r}].name = {name + ' new'!r}"
    return Mutation("rename", aim.name, code, f"{name}, which {by[0]} names", ("V1",), frozenset({name}))


def delete_contact(aim: Aim) -> Mutation:
    """The tag that alone tells what an object stands on."""
    name = aim.random.choice(sorted(name for by in _TAGGED[aim.name].values() for name in by))
    code = f"del bpy.data.objects[{name!r}]['contact_with']"
    owners = {"Fruit": "Apple", "Pole": "Lamp", "Rod": "Pusher"}
    owner = owners.get(name) or name.removesuffix(" root").removesuffix(" body")
    return Mutation("delete a contact", aim.name, code, f"of {name}", ("W1",), frozenset({owner}))


def add_light(aim: Aim) -> Mutation:
    """A lamp in the collection of any object."""
    one, kind = aim.thing(), aim.random.choice(("POINT", "SPOT", "AREA", "SUN"))
    code = f"of({one.name!r}).link(bpy.data.objects.new('Bulb', bpy.data.lights.new('Bulb', {kind!r})))"
    return Mutation(
        "add a light to an object", aim.name, code, f"{kind} in {one.name}", ("W3",), frozenset({"Bulb"})
    )


def hide(aim: Aim) -> Mutation:
    """All meshes of any object, from renders."""
    one = aim.thing()
    code = f"for one in meshes({one.name!r}):\n    one.hide_render = True"
    return Mutation("hide", aim.name, code, one.name, ("R1",), names_of(one))


def duplicate(aim: Aim) -> Mutation:
    """An object with its collection, a mesh of it, or its root: what duplicating by accident leaves behind."""
    one, what = aim.thing(), aim.random.choice(("object", "mesh", "root"))
    copies = f"""
def copy(one, into):
    made = one.copy()
    into.objects.link(made)
    return made
source = bpy.data.collections[{one.name!r}]
"""
    if what == "object":
        code = f"""{copies}
made = source.copy()
for one in list(made.objects):
    made.objects.unlink(one)
next(above for above in bpy.data.collections if source.name in above.children).children.link(made)
new = copy(root({one.name!r}), made)
for one in meshes({one.name!r}):
    copy(one, made).parent = new
"""
        return Mutation(
            "duplicate with .001", aim.name, code, one.name, ("C5",), frozenset({f"{one.name}.001"})
        )
    if what == "root":
        code = f"{copies}copy(root({one.name!r}), source)"
        names = frozenset({one.name})
        return Mutation("duplicate with .001", aim.name, code, f"the root of {one.name}", ("C4",), names)
    code = f"{copies}copy(meshes({one.name!r})[0], source)"
    return Mutation("duplicate with .001", aim.name, code, f"a mesh of {one.name}", ("V2",))
