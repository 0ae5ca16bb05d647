"""A furnished room of 20 objects in which everything is right."""

from __future__ import annotations

from typing import TYPE_CHECKING

from valid_parts import an_object, checked

if TYPE_CHECKING:
    from agents.plan.scene import ScenePlan

ROOM = """
thing("Floor", box("Slab", (-2.6, -2, -0.1), (2.5, 2.1, 0)), system_name="ground", at=(0, 0, 0))

def with_opening(name, outer, inner, y):
    (x0, z0, x1, z1), (u0, w0, u1, w1) = outer, inner
    flat = [(x0, z0), (x1, z0), (x1, z1), (x0, z1), (u0, w0), (u1, w0), (u1, w1), (u0, w1)]
    points = [(x, depth, z) for depth in y for x, z in flat]
    faces = []
    for k in range(4):
        n = (k + 1) % 4
        faces += [(k, n, 4 + n, 4 + k), (8 + k, 12 + k, 12 + n, 8 + n)]
        faces += [(k, 8 + k, 8 + n, n), (4 + k, 4 + n, 12 + n, 12 + k)]
    return mesh(name, points, faces)

wall = thing("Back wall", with_opening("Back", (-2.6, 0, 2.5, 2.6), (0.4, 1.0, 1.6, 2.0), (2.0, 2.1)),
             system_name="room", at=(0, 2.05, 0))
thing("Left wall", box("Left", (-2.6, -2, 0), (-2.5, 2, 2.6)), system_name="room", at=(-2.55, 0, 0))
thing("Window", box("Pane", (0.402, 2.03, 1.002), (1.598, 2.07, 1.998)), system_name="room", at=(1, 2.05, 1.002))

thing("Rug", box("Carpet", (-0.7, -0.5, 0), (0.7, 0.5, 0.01), at=(1.6, -1.2, 0)), at=(1.6, -1.2, 0))

at = (-0.3, -0.2, 0)
top = box("Table top", (-0.6, -0.6, 0.7), (0.6, 0.6, 0.74), at=at)
thing("Table", top, *legs("Table", (0.55, 0.55), 0.06, 0.7, at=at), at=at)

for number, name in enumerate(("Chair east", "Chair north", "Chair west", "Chair south")):
    turn = math.radians(90 * number)
    place = (at[0] + 0.95 * math.cos(turn), at[1] + 0.95 * math.sin(turn), 0)
    where = {"at": place, "turn": (0, 0, 90 * number - 90)}
    thing(
        name,
        box(f"{name} seat", (-0.21, -0.21, 0.42), (0.21, 0.21, 0.46), **where),
        box(f"{name} back", (-0.21, 0.17, 0.46), (0.21, 0.21, 0.95), **where),
        *legs(name, (0.19, 0.19), 0.04, 0.42, **where),
        **where,
    )

at = (-0.2, -0.1, 0.74)
profile = [(0, 0), (0.07, 0), (0.16, 0.09), (0.15, 0.09), (0.06, 0.01), (0, 0.01)]
thing("Bowl", lathe("Dish", profile, at=at), at=at)
thing("Apple", ball("Fruit", 0.035, at=(-0.2, -0.1, 0.785)), at=(-0.2, -0.1, 0.75))
touches("Fruit", "Dish")

at = (-2.35, -0.6, 0)
sides = [box(f"Shelf side {k}", (-0.15, y, 0), (0.15, y + 0.02, 1.8), at=at) for k, y in enumerate((-0.6, 0.58))]
boards = [
    box(f"Board {k}", (-0.13, -0.58, z), (0.15, 0.58, z + 0.02), at=at) for k, z in enumerate((0.1, 0.6, 1.1, 1.78))
]
thing("Bookshelf", *sides, *boards, box("Shelf back", (-0.15, -0.58, 0), (-0.13, 0.58, 1.8), at=at), at=at)
for number, name in enumerate(("Atlas", "Novel", "Cookbook")):
    place = (-2.3, -0.9 + 0.12 * number, 0.62)
    thing(name, box(f"{name} cover", (-0.09, -0.02, 0), (0.09, 0.02, 0.26), at=place), at=place)

at = (-2.2, 0.4, 0)
pole = [(0, 0), (0.15, 0), (0.15, 0.03), (0.015, 0.03), (0.015, 1.5), (0, 1.5)]
shade = [(0, 1.5), (0.2, 1.5), (0.15, 1.75), (0, 1.75)]
thing("Lamp", lathe("Pole", pole, at=at, segments=24), lathe("Shade", shade, at=at, segments=24), at=at)
touches("Pole", "Slab")

root = thing("Picture", box("Canvas", (-1.2, 1.97, 1.3), (-0.4, 2.0, 1.9)), at=(-0.8, 2.0, 1.6))
link = root.constraints.new("CHILD_OF")
link.target, link.inverse_matrix = wall, wall.matrix_world.inverted()

for name, x in (("Speaker left", 0.1), ("Speaker right", 1.9)):
    thing(name, box(f"{name} case", (-0.15, -0.15, 0), (0.15, 0.15, 0.9), at=(x, 1.7, 0)), at=(x, 1.7, 0))
    touches(f"{name} root", "Floor root")

stage((1.6, -4.6, 2.6), (-0.2, 0.4, 0.8), 26)
"""

_CHAIRS = ("Chair east", "Chair north", "Chair west", "Chair south")
_BOOKS = ("Atlas", "Novel", "Cookbook")


def room_plan() -> ScenePlan:
    """A furnished room of 20 objects."""
    chairs = [
        an_object(name, (0.42, 0.42, 0.95), at, rotation=(0, 0, turn))
        for name, at, turn in zip(
            _CHAIRS,
            [(0.65, -0.2, 0), (-0.3, 0.75, 0), (-1.25, -0.2, 0), (-0.3, -1.15, 0)],
            (-90, 0, 90, 180),
            strict=True,
        )
    ]
    books = [
        an_object(name, (0.18, 0.04, 0.26), (-2.3, y, 0.62))
        for name, y in zip(_BOOKS, (-0.9, -0.78, -0.66), strict=True)
    ]
    return checked(
        title="A furnished room",
        systems=["ground", "room", "set", "lighting", "cameras"],
        objects=[
            an_object("Floor", (5.1, 4.1, 0.1), (0, 0, 0), "ground", role="ground"),
            an_object("Back wall", (5.1, 0.1, 2.6), (0, 2.05, 0), "room"),
            an_object("Left wall", (0.1, 4, 2.6), (-2.55, 0, 0), "room"),
            an_object("Window", (1.196, 0.04, 0.996), (1, 2.05, 1.002), "room"),
            an_object("Rug", (1.4, 1, 0.01), (1.6, -1.2, 0)),
            an_object("Table", (1.2, 1.2, 0.74), (-0.3, -0.2, 0), parts=["Table top"]),
            *chairs,
            an_object("Bowl", (0.32, 0.32, 0.09), (-0.2, -0.1, 0.74), holds_volume=True),
            an_object("Apple", (0.07, 0.07, 0.07), (-0.2, -0.1, 0.75)),
            an_object("Bookshelf", (0.3, 1.2, 1.8), (-2.35, -0.6, 0)),
            *books,
            an_object("Lamp", (0.4, 0.4, 1.75), (-2.2, 0.4, 0)),
            an_object("Picture", (0.8, 0.03, 0.6), (-0.8, 2, 1.6)),
            an_object("Speaker left", (0.3, 0.3, 0.9), (0.1, 1.7, 0)),
            an_object("Speaker right", (0.3, 0.3, 0.9), (1.9, 1.7, 0)),
        ],
        relations=[
            *(
                {"kind": "SupportedBy", "child": one, "parents": ["Floor"]}
                for one in ("Back wall", "Left wall", "Rug", "Table", "Bookshelf", *_CHAIRS)
            ),
            {"kind": "Aperture", "filler": "Window", "host": "Back wall"},
            {"kind": "FixedAttachment", "part": "Picture", "host": "Back wall"},
            {"kind": "StableAgainst", "child": "Bookshelf", "parent": "Left wall"},
            {"kind": "SupportedBy", "child": "Bowl", "parents": ["Table/Table top"]},
            {"kind": "Inside", "content": "Apple", "container": "Bowl"},
            *({"kind": "SupportedBy", "child": one, "parents": ["Bookshelf"]} for one in _BOOKS),
            {"kind": "OnTopOf", "a": "Bowl", "b": "Table"},
            {"kind": "NextTo", "a": "Lamp", "b": "Bookshelf", "gap": (0.1, 0.4)},
            {"kind": "Upright", "a": "Lamp"},
            {
                "kind": "Distributed",
                "members": _CHAIRS,
                "pattern": "circle",
                "about": "Table",
                "radius": 0.95,
                "facing": "inwards",
            },
            *({"kind": "Facing", "a": one, "b": "Table"} for one in _CHAIRS),
            {"kind": "Distributed", "members": _BOOKS, "pattern": "line", "spacing": 0.12},
            {"kind": "ParallelTo", "a": "Atlas", "b": "Bookshelf"},
            {"kind": "SymmetricAbout", "members": ["Speaker left", "Speaker right"], "point": (1, 0, 0)},
            {"kind": "LeftOf", "a": "Speaker left", "b": "Speaker right"},
            {"kind": "Above", "a": "Picture", "b": "Floor"},
            {"kind": "InFrontOf", "a": "Chair south", "b": "Table"},
            {"kind": "Behind", "a": "Chair north", "b": "Table", "frame": "camera"},
        ],
        camera={
            "position": (1.6, -4.6, 2.6),
            "target": (-0.2, 0.4, 0.8),
            "lens": 26,
            "subjects": ["Table", "Lamp", "Chair west"],
        },
        render={"kind": "still"},
    )
