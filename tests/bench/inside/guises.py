"""One scene in many guises: a cloth over a table, four dominoes on the floor, a lamp of two parts."""

import bpy
from making import add, bake, body, cloth_on, empty, finish, get, into, new, read, save

_LENGTHS = ("size", "radius", "radius1", "depth")


def scene(scale=1.0, names=None, build=None):
    """Makes the scene, lets ``build`` rearrange it, bakes."""
    called = {name: name for name in ("Tablecloth", "Table", "Floor", "Base", "Shade", *DOMINOES)} | (
        names or {}
    )
    new()

    def put(kind, name, location, **given):
        given = {key: value * scale for key, value in given.items() if key in _LENGTHS}
        return add(kind, called[name], [scale * value for value in location], **given)

    floor = put("plane", "Floor", (0, 0, 0), size=12)
    body(floor, "PASSIVE")
    table = put("cube", "Table", (0, 0, 0.5), size=1)
    table.modifiers.new("Collision", "COLLISION")
    cloth = put("grid", "Tablecloth", (0, 0, 1.1), size=2)
    cloth_on(cloth)
    for number, name in enumerate(DOMINOES):
        domino = put("cube", name, (2 + 0.3 * number, 2, 0.2), size=0.4)
        body(domino)
    put("cylinder", "Base", (-2, 2, 0.5), radius=0.1, depth=1)
    put("cone", "Shade", (-2, 2, 1.2), radius1=0.3, depth=0.4)
    if scale != 1.0:
        bpy.context.scene.unit_settings.scale_length = 1 / scale
    if build is not None:
        build()
    bake()


DOMINOES = ["Domino.001", "Domino.002", "Domino.003", "Domino.004"]
LAMP = {"Base": "Lamp base", "Shade": "Lamp shade"}


def plain():
    scene(names=LAMP)


def synonyms():
    others = {"Tablecloth": "red_linen", "Table": "SideTable", "Floor": "Ground", "Base": "lantern_A"}
    others |= {"Shade": "lantern_B"} | {name: f"tile stones {number}" for number, name in enumerate(DOMINOES)}
    scene(names=others)


def other_units():
    scene(100.0, LAMP)


def nameless():
    names = ["Tablecloth", "Table", "Floor", *DOMINOES]
    scene(names={name: f"Object.{number:03d}" for number, name in enumerate(names)} | LAMP)


def parented():
    """Empties bear the names; what simulates are their children."""

    def build():
        for name, children in (
            ("Tablecloth", ["Mesh.1"]),
            ("Table", ["Mesh.2"]),
            ("Lamp", ["Mesh.3", "Mesh.4"]),
        ):
            parent = empty(name)
            for child in children:
                get(child).parent = parent

    scene(names={"Tablecloth": "Mesh.1", "Table": "Mesh.2", "Base": "Mesh.3", "Shade": "Mesh.4"}, build=build)


def collected():
    """Collections bear the names, dominoes theirs in one."""

    def build():
        into("Dominoes", *(get(f"Cube.{number}") for number in range(4)))
        into("Table", get("Mesh.2"))
        into("Table Cloth", get("Mesh.1"))
        into("Lamp", get("Mesh.3"), get("Mesh.4"))

    others = {"Tablecloth": "Mesh.1", "Table": "Mesh.2", "Base": "Mesh.3", "Shade": "Mesh.4"}
    scene(names=others | {name: f"Cube.{number}" for number, name in enumerate(DOMINOES)}, build=build)


def duplicates():
    def build():
        for name in DOMINOES[1:]:
            get(name).data = get(DOMINOES[0]).data

    scene(names=LAMP, build=build)


def joined():
    def build():
        bpy.ops.object.select_all(action="DESELECT")
        for name in ("Base", "Shade"):
            get(name).select_set(True)
        bpy.context.view_layer.objects.active = get("Base")
        bpy.ops.object.join()
        get("Base").name = "Lamp"

    scene(build=build)


def instanced():
    """The lamp is a collection outside of the scene, shown by an empty."""

    def build():
        parts = into("Lamp parts", get("Base"), get("Shade"))
        bpy.context.scene.collection.children.unlink(parts)
        shown = empty("Lamp")
        shown.instance_type, shown.instance_collection = "COLLECTION", parts

    scene(build=build)


def two_cloths():
    """Two cloths without a name: no telling which it is."""

    def build():
        cloth_on(add("grid", "Object.9", (0, 4, 1), size=2))

    scene(names=LAMP | {"Tablecloth": "Object.8"}, build=build)


def hidden_members():
    """The lamp's collection is not rendered."""

    def build():
        into("Lamp", get("Mesh.3"), get("Mesh.4")).hide_render = True

    scene(names={"Base": "Mesh.3", "Shade": "Mesh.4"}, build=build)


def dressing():
    """Beside the lamp's collection is one of what has the lamp in its name."""

    def build():
        into("Lamp", get("Mesh.3"), get("Mesh.4"))
        into("Lamp shelf", add("cube", "Shelf board", (-4, 2, 0.5), size=0.5))

    scene(names={"Base": "Mesh.3", "Shade": "Mesh.4"}, build=build)


def flow_in_its_fluid():
    """A fluid's domain and its flow are in one collection, which has its name."""
    new()
    parts = [add("cube", name, (0, 0, 0), size=size) for name, size in (("Water box", 2), ("Water mesh", 1))]
    for part, kind in zip(parts, ("DOMAIN", "FLOW"), strict=True):
        part.modifiers.new("Fluid", "FLUID").fluid_type = kind
    parts[0].modifiers[0].domain_settings.domain_type = "LIQUID"
    parts[1].modifiers[0].flow_settings.flow_type = "LIQUID"
    into("Water", *parts)


def particles_shown_as_things():
    """What a campfire and an emitter without a speaking name give off is shown as objects that lie elsewhere."""
    new()
    for number, (name, shown) in enumerate((("Campfire", "Spark"), ("Plane", "Snowflake"))):
        emitter = add("plane", name, (4 * number, 0, 1), size=2)
        modifier = emitter.modifiers.new("Particles", "PARTICLE_SYSTEM")
        modifier.particle_system.settings.render_type = "OBJECT"
        modifier.particle_system.settings.instance_object = add("cube", shown, (0, 0, -9), size=0.1)
    bake()


GUISES = (
    *(plain, synonyms, other_units, nameless, parented, collected, duplicates, joined, instanced),
    *(two_cloths, hidden_members, dressing, flow_in_its_fluid, particles_shown_as_things),
)


def main():
    found = {}
    for make in GUISES:
        make()
        found[make.__name__] = read(save(make.__name__))
    finish(found)


main()
