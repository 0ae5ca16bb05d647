"""For every rule a scene that keeps it and its twin that breaks it, small enough to be understood at a glance.

They are tests, and what the pictures on the rules' pages show: ``look`` says how.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from scenes import a_motion, a_plan, build, verified

from agents.blender.tools.bake import TOOL as BAKE

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.plan.scene import ScenePlan
    from agents.protocol.findings import Report


# A view of the scene, a tree of its collections, what its camera renders, or how far its actors get over the frames.
Look = Literal["front", "right", "top", "three-quarter", "tree", "camera", "curve"]


@dataclass(frozen=True)
class Case:
    """``base`` builds what the two have in common, then comes ``good`` or ``bad`` (scripts for scenes.build).

    ``says`` tells what is to be seen where the rule holds. ``baked``: the good one is baked before it is judged,
    ``twin_baked``: the bad one too.
    """

    base: str
    good: str
    bad: str
    says: str
    look: Look = "tree"
    plan: ScenePlan | None = None
    baked: bool = False
    twin_baked: bool = False


FLOOR = 'thing("Floor", box("Slab", (-1, -1, -0.05), (1, 1, 0)), system_name="ground")\n'
CHAIR = 'thing("Chair", box("Seat", (-0.2, -0.2, 0), (0.2, 0.2, 0.4)), system_name="furniture")\n'
CUP = 'thing("Cup", lathe("Mug", [(0, 0), (0.04, 0), (0.04, 0.09), (0.035, 0.09), (0.035, 0.005), (0, 0.005)]{}))\n'
SHELF = 'thing("Shelf", box("Board", (-0.25, -0.12, -0.02), (0.25, 0.12, 0)), system_name="ground")\n'

LAYOUT: dict[str, Case] = {
    "C1": Case(
        FLOOR + CHAIR,
        "",
        'chair = bpy.data.collections["Chair"]\n'
        'system("furniture").children.unlink(chair)\n'
        "scene.collection.children.link(chair)",
        "Chair is in the system furniture.",
    ),
    "C2": Case(
        FLOOR + CHAIR,
        "",
        'scene.collection.children.unlink(system("furniture"))\nsystem("ground").children.link(system("furniture"))',
        "Both systems are directly in the scene.",
    ),
    "C3": Case(
        FLOOR + CHAIR,
        "",
        'bpy.data.collections["Floor"].objects.link(bpy.data.objects["Seat"])',
        "Each mesh is in one object.",
    ),
    "C4": Case(
        FLOOR + CHAIR,
        "",
        'bpy.data.objects.remove(bpy.data.objects["Chair root"])',
        "Each object has one root Empty.",
    ),
    "C5": Case(
        FLOOR + CHAIR,
        CHAIR.replace("Chair", "Stool").replace("Seat", "Top"),
        CHAIR.replace("Chair", "Chair.001").replace("Seat", "Top"),
        "Each object is called after what it is.",
    ),
    "C6": Case(
        CHAIR,
        FLOOR,
        FLOOR.replace("ground", "house"),
        "The floor's object is in the system ground.",
    ),
    "G1": Case(
        FLOOR + CHAIR,
        "",
        'bpy.data.objects["Seat"].parent = None',
        "The seat hangs on the root of its object.",
    ),
    "G2": Case(
        FLOOR + CHAIR,
        "",
        'bpy.data.objects["Chair root"].parent = bpy.data.objects["Floor root"]',
        "The roots hang on nothing.",
    ),
    "G3": Case(
        FLOOR + CHAIR,
        "",
        'bpy.data.collections["Chair"].objects.unlink(bpy.data.objects["Chair root"])\n'
        'system("furniture").objects.link(bpy.data.objects["Chair root"])',
        "The chair's root is in the chair's own collection.",
    ),
    "W3": Case(
        FLOOR + CHAIR + 'bulb = bpy.data.objects.new("Bulb", bpy.data.lights.new("Bulb", "POINT"))',
        'system("lighting").objects.link(bulb)',
        'bpy.data.collections["Chair"].objects.link(bulb)',
        "The light is in a system of its own.",
    ),
    "W4": Case(FLOOR, "camera((3, -3, 2), (0, 0, 0))", "", "There is a camera."),
}

LAMP = """
lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "AREA"))
lamp.data.energy, lamp.location = 60, (0.5, -0.5, 1.5)
system("lighting").objects.link(lamp)
"""
SURFACES: dict[str, Case] = {
    "V1": Case(
        SHELF,
        CUP.format("") + 'bpy.data.objects["Mug"]["contact_with"] = ["Board"]',
        CUP.format(", at=(0, 0, 0.012)") + 'bpy.data.objects["Mug"]["contact_with"] = ["Board"]',
        "The cup, which is to touch the board, does.",
        "front",
    ),
    "V2": Case(
        SHELF,
        'thing("Ball", ball("Sphere", 0.06, at=(0, 0, 0.06)))',
        'thing("Ball", ball("Sphere", 0.06, at=(0, 0, 0.045)))',
        "The ball lies on the board.",
        "front",
    ),
    "W1": Case(
        SHELF + CUP.format(", at=(-0.1, 0, 0)") + 'bpy.data.objects["Mug"]["contact_with"] = ["Board"]\n',
        'thing("Ball", ball("Sphere", 0.05, at=(0.1, 0, 0.05)))\n'
        'bpy.data.objects["Sphere"]["contact_with"] = ["Board"]',
        'thing("Ball", ball("Sphere", 0.05, at=(0.1, 0, 0.2)))',
        "Cup and ball are declared to touch the board, which is of the ground.",
        "front",
    ),
    "W2": Case(
        SHELF,
        CUP.format("").replace(")\n", ', box("Handle", (0.039, -0.01, 0.03), (0.07, 0.01, 0.07)))', 1),
        CUP.format("").replace(")\n", ', box("Handle", (0.06, -0.01, 0.03), (0.09, 0.01, 0.07)))', 1),
        "Mug and handle touch.",
        "front",
    ),
    "W5": Case(
        FLOOR + CHAIR + "camera((1.6, -1.6, 1.3), (0, 0, 0.15), lens=40)",
        LAMP,
        "",
        "A lamp lights the scene.",
        "camera",
    ),
}


def planned(*objects: dict[str, Any], **more: Any) -> ScenePlan:
    """A plan of objects that stand where they are built."""
    common = {"systems": ["set"], "position": (0, 0, 0)}
    return a_plan(objects=[{**common, **one} for one in objects], **more)


STOOL = 'thing("{0}", box("{0} top", (-0.15, -0.15, 0), (0.15, 0.15, 0.45), at={1}), at={1})\n'
TABLE = """
thing("Table", box("Top", (-0.4, -0.3, 0.38), (0.4, 0.3, 0.42)), box("Post", (-0.05, -0.05, 0), (0.05, 0.05, 0.38)))
"""
TWO = ({"name": "Table", "dimensions": (0.8, 0.6, 0.42)}, {"name": "Stool", "dimensions": (0.3, 0.3, 0.45)})
BESIDE = {"name": "Stool", "dimensions": (0.3, 0.3, 0.45), "position": (0.7, 0, 0)}
RING = """
for number in range(6):
    turn = math.radians(60 * number + (extra if number == 1 else 0))
    radius = 1 + (shift if number == 4 else 0)
    place = (radius * math.cos(turn), radius * math.sin(turn), 0)
    thing(f"Stone {number}", ball(f"Rock {number}", 0.16, at=place), at=place)
"""
ROW = """
for number in range(5):
    place = (0.5 * number + (shift if number == 3 else 0), 0, 0)
    thing(f"Post {number}", box(f"Pole {number}", (-0.06, -0.06, 0), (0.06, 0.06, 0.6), at=place), at=place)
"""
BOWL = (
    'thing("Bowl", lathe("Dish", [(0, 0), (0.07, 0), (0.16, 0.09), (0.15, 0.09), (0.06, 0.01), (0, 0.01)]))\n'
)
WALL = """
points = [(x, y, z) for y in (0, 0.1) for x, z in
          [(-1, 0), (1, 0), (1, 1.6), (-1, 1.6), (-0.4, 0.5), (0.4, 0.5), (0.4, 1.2), (-0.4, 1.2)]]
faces = []
for k in range(4):
    n = (k + 1) % 4
    faces += [(k, n, 4 + n, 4 + k), (8 + k, 12 + k, 12 + n, 8 + n)]
    faces += [(k, 8 + k, 8 + n, n), (4 + k, 4 + n, 12 + n, 12 + k)]
thing("Wall", mesh("Bricks", points, faces))
"""
BLOCK = 'thing("{0}", box("{0} block", (-0.1, -0.1, 0), (0.1, 0.1, 0.2), at={1}), at={1})\n'
FRONT = """
nose = box("Nose", (-0.03, -0.25, 0.3), (0.03, -0.15, 0.36), at={1}, turn={2})
thing("{0}", box("{0} body", (-0.15, -0.15, 0), (0.15, 0.15, 0.45), at={1}, turn={2}), nose, at={1}, turn={2})
"""
JAR = 'jar = box("Glass", (-0.1, -0.1, 0), (0.1, 0.1, 0.25))\n'
OPEN = """
shape = bmesh.new()
shape.from_mesh(jar.data)
shape.faces.ensure_lookup_table()
bmesh.ops.delete(shape, geom=[max(shape.faces, key=lambda one: one.calc_center_median().x)], context="FACES_ONLY")
shape.to_mesh(jar.data)
shape.free()
"""
VIEW = FLOOR + CHAIR + LAMP + "scene.render.resolution_x, scene.render.resolution_y = 320, 240\n"

POST = 'thing("Post", box("Pole", (-0.12, -0.1, 0), (0.12, 0.1, 0.6), at=({0}, -1, 0)), at=({0}, -1, 0))'
BALLS = (
    FLOOR
    + LAMP
    + """
scene.render.resolution_x, scene.render.resolution_y, scene.frame_end = 320, 240, 20
camera((0, -3, 0.4), (0, 0, 0.15), lens=60)
for name, x in (("Cue", -0.15), ("Eight", 0.15)):
    thing(name, ball(name + " ball", 0.15, at=(x, 0, 0.15)), at=(x, 0, 0))
"""
)
PLANNED: dict[str, Case] = {
    "R1": Case(
        TABLE,
        STOOL.format("Stool", "(0.7, 0, 0)"),
        "",
        "Table and stool are planned; both are there.",
        plan=planned(*TWO),
    ),
    "R2": Case(
        TABLE,
        STOOL.format("Stool", "(0.7, 0, 0)"),
        STOOL.format("Stool", "(0.7, 0, 0)").replace("0.45", "0.75"),
        "The stool is 0.45 m high, as planned.",
        "front",
        planned(TWO[0], BESIDE),
    ),
    "R3": Case(
        TABLE,
        STOOL.format("Stool", "(0.7, 0, 0)"),
        STOOL.format("Stool", "(1.0, 0, 0)"),
        "The stool's root is 0.7 m beside the table's.",
        "front",
        planned(TWO[0], BESIDE),
    ),
    "R4": Case(
        JAR,
        'thing("Jar", jar)',
        f'{OPEN}\nthing("Jar", jar)',
        "The jar, which is to hold a volume, is closed.",
        "three-quarter",
        planned({"name": "Jar", "dimensions": (0.2, 0.2, 0.25), "holds_volume": True}),
    ),
    "R5": Case(
        BLOCK.format("Base", "(0, 0, 0)"),
        BLOCK.format("Brick", "(0.05, 0, 0.2)"),
        BLOCK.format("Brick", "(0.12, 0, 0.2)"),
        "The brick's centre of mass is over what bears it.",
        "front",
        a_plan({"kind": "SupportedBy", "child": "Brick", "parents": ["Base"]}),
    ),
    "R6": Case(
        'thing("Wall", box("Bricks", (-0.5, 0, 0), (0.5, 0.08, 1)))\n',
        'thing("Picture", box("Frame", (-0.2, -0.03, 0.4), (0.2, 0, 0.8)))',
        'thing("Picture", box("Frame", (-0.2, -0.06, 0.4), (0.2, -0.03, 0.8)))',
        "The picture hangs at the wall.",
        "right",
        a_plan({"kind": "StableAgainst", "child": "Picture", "parent": "Wall"}),
    ),
    "R7": Case(
        'door = thing("Door", box("Leaf", (0, 0, 0), (0.3, 0.05, 0.4)))\n',
        'thing("Handle", box("Brass", (0.22, -0.04, 0.15), (0.26, 0, 0.25))).parent = door',
        'thing("Handle", box("Brass", (0.22, -0.07, 0.15), (0.26, -0.03, 0.25)))',
        "The handle touches the door and is parented to it.",
        "right",
        a_plan({"kind": "FixedAttachment", "part": "Handle", "host": "Door"}),
    ),
    "R8": Case(
        WALL,
        'thing("Window", box("Pane", (-0.4, 0.03, 0.5), (0.4, 0.07, 1.2)))',
        'thing("Window", box("Pane", (-0.4, 0.03, 0.5), (0.34, 0.07, 1.2)))',
        "The window fills its opening.",
        "front",
        a_plan({"kind": "Aperture", "filler": "Window", "host": "Wall"}),
    ),
    "R9": Case(
        BOWL,
        'thing("Apple", ball("Fruit", 0.04, at=(0, 0, 0.05)))',
        'thing("Apple", ball("Fruit", 0.04, at=(0.2, 0, 0.04)))',
        "The apple is inside the bowl.",
        "front",
        a_plan({"kind": "Inside", "content": "Apple", "container": "Bowl"}),
    ),
    "R10": Case(
        TABLE,
        BLOCK.format("Lamp", "(0.1, 0, 0.42)"),
        BLOCK.format("Lamp", "(0.55, 0, 0.42)"),
        "The lamp is over the table.",
        "front",
        a_plan({"kind": "OnTopOf", "a": "Lamp", "b": "Table"}),
    ),
    "R11": Case(
        TABLE,
        STOOL.format("Stool", "(0.75, 0, 0)"),
        STOOL.format("Stool", "(1.3, 0, 0)"),
        "Stool and table are 0.2 m apart; up to 0.3 m are planned.",
        "front",
        a_plan({"kind": "NextTo", "a": "Stool", "b": "Table", "gap": (0.1, 0.3)}),
    ),
    "R12": Case(
        TABLE,
        STOOL.format("Stool", "(-0.7, 0, 0)"),
        STOOL.format("Stool", "(0.7, 0, 0)"),
        "The stool is left of the table.",
        "front",
        a_plan({"kind": "LeftOf", "a": "Stool", "b": "Table"}),
    ),
    "R13": Case(
        BLOCK.format("Lamp", "(0, -1, 0)"),
        FRONT.format("Robot", "(0, 0, 0)", "(0, 0, 0)"),
        FRONT.format("Robot", "(0, 0, 0)", "(0, 0, 60)"),
        "The robot's front, with the nose, is turned to the lamp.",
        "top",
        a_plan({"kind": "Facing", "a": "Robot", "b": "Lamp"}),
    ),
    "R14": Case(
        VIEW,
        "camera((1.6, -1.6, 1.3), (0, 0, 0.15), lens=40)",
        "camera((1.6, -1.6, 1.3), (-0.65, -0.9, 0.4), lens=40)",
        "The chair is in the picture, and large enough.",
        "camera",
        planned(
            {"name": "Chair", "dimensions": (0.4, 0.4, 0.4)},
            camera={"position": (1.6, -1.6, 1.3), "target": (0, 0, 0), "subjects": ("Chair",)},
        ),
    ),
    "R16": Case(
        "",
        f"extra, shift = 0, 0\n{RING}",
        f"extra, shift = 14, 0.2\n{RING}",
        "Six stones stand evenly on a circle.",
        "top",
        a_plan({"kind": "Distributed", "members": [f"Stone {n}" for n in range(6)], "pattern": "circle"}),
    ),
    "R17": Case(
        "",
        f"shift = 0\n{ROW}",
        f"shift = 0.15\n{ROW}",
        "Five posts stand evenly in a row.",
        "front",
        a_plan({"kind": "Distributed", "members": [f"Post {n}" for n in range(5)], "pattern": "line"}),
    ),
    "W6": Case(
        BALLS,
        POST.format(0.45),
        POST.format(0.1),
        "The post stands beside the ball that is hit.",
        "camera",
        a_motion(
            {"actor": "Cue", "kind": "roll", "start": 1, "end": 8},
            {"actor": "Eight", "kind": "roll", "start": 8, "end": 20, "cause": "Cue 0"},
            last=20,
            camera={"position": (0, -3, 0.4), "target": (0, 0, 0.15), "subjects": ("Cue", "Eight")},
        ),
    ),
}

TIME = "scene.frame_start, scene.frame_end = 1, {}\n"
BALL = 'root = thing("Ball", ball("Sphere", 0.1, at=(0, 0, {0})), at=(0, 0, {0}))\n'
# A rolling ball, keyframed evenly from one frame and place to another.
ROLL = """
def roll(name, start, end, begin, way, y=0):
    one = thing(name, ball(f"{name} ball", 0.1, at=(begin, y, 0.1)), at=(begin, y, 0.1))
    key(one, start, location=(begin, y, 0.1))
    key(one, end, location=(begin + way, y, 0.1))
    linear(one)
    return one

"""
FALL = """
one = thing("Ball", ball("Sphere", 0.1, at=(0, 0, 2)), at=(0, 0, 2))
for frame in range(1, {last} + 1):
    key(one, frame, location=(0, 0, 2 - 0.5 * {gravity} * ((frame - 1) / 24) ** 2))
linear(one)
"""
SETTLE = """
one = thing("Ball", ball("Sphere", 0.1, at=(0, 0, 0.1)), at=(0, 0, 0.1))
for frame in range(1, 61):
    swing = 0.3 * math.exp(-{damping} * frame) * abs(math.cos(frame / 4))
    key(one, frame, location=(0, 0, 0.1 + swing))
linear(one)
"""
CLOTH = """
scene.frame_start, scene.frame_end = 1, 12
flag = mesh("Sheet", [(x / 8, y / 8, 1) for y in range(9) for x in range(9)],
            [(9 * y + x, 9 * y + x + 1, 9 * y + x + 10, 9 * y + x + 9) for y in range(8) for x in range(8)])
thing("Flag", flag)
bpy.data.collections["Flag"]["deformation_kind"] = "sim_cloth"
bpy.data.collections["Flag"]["motion_kind"] = "bake"
"""
CART = """
cart = thing("Cart", box("Bed", (-0.4, -0.2, 0.1), (0.4, 0.2, 0.2)))
crate = thing("Crate", box("Case", (-0.1, -0.1, 0.2), (0.1, 0.1, 0.4)))
crate.parent = cart
key(cart, 1, location=(0, 0, 0))
key(cart, 40, location=(2, 0, 0))
linear(cart)
"""

SMOKE = """
domain = box("Domain", (-0.5, -0.5, 0.3), (0.5, 0.5, 1.6))
source = box("Source", (-0.1, -0.1, 0.45), (0.1, 0.1, 0.55))
source.hide_render = True
thing("Smoke", domain, source, at=(0, 0, 0.5))
kinds = bpy.data.collections["Smoke"]
kinds["deformation_kind"], kinds["motion_kind"] = "sim_fluid", "bake"
for one, kind in ((domain, "DOMAIN"), (source, "FLOW")):
    one.modifiers.new("Fluid", "FLUID").fluid_type = kind
settings = domain.modifiers["Fluid"].domain_settings
settings.domain_type, settings.resolution_max = "GAS", 16
flow = source.modifiers["Fluid"].flow_settings
flow.flow_type, flow.flow_behavior = "SMOKE", "INFLOW"
"""

MOVING: dict[str, Case] = {
    "R15": Case(
        CLOTH,
        'flag.modifiers.new("Cloth", "CLOTH")',
        'flag.shape_key_add(name="Basis")\n'
        'shape = flag.shape_key_add(name="Blown")\n'
        "for point in shape.data:\n"
        "    point.co.z -= point.co.x ** 2\n"
        "for frame, value in ((1, 0), (12, 1)):\n"
        "    shape.value = value\n"
        '    shape.keyframe_insert("value", frame=frame)',
        "The flag is declared a cloth, and the cloth solver moves it.",
    ),
    "R19": Case(
        CLOTH + 'flag.modifiers.new("Cloth", "CLOTH")\n',
        "",
        "",
        "The flag is declared to be baked, and it is.",
        baked=True,
    ),
    "R18": Case(
        TIME.format(40) + CART,
        "",
        "key(crate, 15, location=(0, 0, 0))\nkey(crate, 40, location=(-0.5, 0, 0))",
        "The crate travels with the cart.",
        "curve",
        a_motion(
            {"actor": "Cart", "kind": "translate", "start": 1, "end": 40},
            last=40,
            roles={"Crate": "keyframed"},
            relations=({"kind": "CoMoves", "a": "Crate", "b": "Cart"},),
        ),
    ),
    "T1": Case(
        ROLL + 'roll("Ball", 10, 60, 0, 2)\n',
        TIME.format(60),
        TIME.format(40),
        "The scene's frames are the planned ones.",
        "curve",
        a_motion({"actor": "Ball", "kind": "roll", "start": 10, "end": 60}),
    ),
    "T2": Case(
        TIME.format(60) + ROLL,
        'roll("Ball", 20, 50, 0, 2)',
        'roll("Ball", 32, 50, 0, 2)',
        "The ball begins to roll when planned.",
        "curve",
        a_motion({"actor": "Ball", "kind": "roll", "start": 20, "end": 50}),
    ),
    "T3": Case(
        TIME.format(60) + ROLL + 'roll("Cue", 1, 50, -2, 3.675)\n',
        'roll("Eight", 25, 50, 0, 2)',
        'roll("Eight", 15, 50, 0, 0.6)',
        "The second ball moves when the first one touches it.",
        "curve",
        a_motion(
            {"actor": "Cue", "kind": "roll", "start": 1, "end": 50},
            {"actor": "Eight", "kind": "roll", "start": 25, "end": 50, "cause": "Cue 0"},
        ),
    ),
    "T4": Case(
        TIME.format(60) + ROLL,
        'roll("Ball", 10, 50, 0, 2)',
        'roll("Ball", 10, 50, 0, 1.2)',
        "The ball rolls 2 m, as planned.",
        "curve",
        a_motion(
            {"actor": "Ball", "kind": "roll", "start": 10, "end": 50, "extent": 2, "direction": (1, 0, 0)}
        ),
    ),
    "T6": Case(
        TIME.format(14),
        FALL.format(last=14, gravity=9.81),
        FALL.format(last=14, gravity=4),
        "The ball falls as fast as gravity makes it.",
        "curve",
        a_motion({"actor": "Ball", "kind": "fall", "start": 1, "end": 14}, last=14),
    ),
    "T8": Case(
        TIME.format(18) + SMOKE,
        "",
        "settings.alpha = settings.beta = 0",
        "The smoke rises from its source.",
        "curve",
        a_motion({"actor": "Smoke", "kind": "flow", "start": 1, "end": 18}, last=18),
        baked=True,
        twin_baked=True,
    ),
    "T7": Case(
        TIME.format(60),
        SETTLE.format(damping=0.15),
        SETTLE.format(damping=0.015),
        "The ball has come to rest in its last second.",
        "curve",
        a_motion({"actor": "Ball", "kind": "settle", "start": 1, "end": 60}),
    ),
}
CASES: dict[str, Case] = LAYOUT | SURFACES | PLANNED | MOVING


def judge(session: LiveSession, rule: str, case: Case, *, good: bool) -> Report:
    """Builds one of the two, and has the rule judge it."""
    build(session, f"{case.base}\n{case.good if good else case.bad}")
    if case.baked if good else case.twin_baked:
        session.use(BAKE)
    return verified(session, rule, case.plan)
