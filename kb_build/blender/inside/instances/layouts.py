# SPDX-License-Identifier: GPL-3.0-or-later
"""What there is to read in the instances of a class."""

from ..classes.rna import ancestry, default_of, path_of, read_items

LONGEST_ARRAY = 32
# Blender 4.5 crashes when an unpaired node is asked for its pair.
NOT_ASKED = frozenset({"rna_type", "paired_output"})
# Names and places that whoever makes the thing chooses, and what depends on the machine.
CHOSEN = frozenset({
    "co", "co_ui", "handle_left", "handle_right", "matrix", "matrix_local", "matrix_world", "matrix_basis",
    "matrix_parent_inverse", "view_matrix", "texspace_location", "texspace_size", "head", "tail", "data_path",
    "name_display", "action_slot_handle", "last_slot_identifier", "target_id_type", "generated_width",
    "generated_height", "child_number", "frame_number", "rotation_estimate", "scale_estimate", "empty_image_offset",
    "material_slot", "threads",
})  # fmt: skip
CHOSEN_OF = frozenset({
    ("CurveMapPoint", "location"), ("CurveProfilePoint", "location"), ("FModifierEnvelopeControlPoint", "frame"),
    ("FieldSettings", "seed"), ("TimelineMarker", "frame"), ("ColorRampElement", "position"),
    ("ColorRampElement", "color"), ("ColorRampElement", "alpha"), ("Driver", "expression"), ("Object", "dimensions"),
    ("EditBone", "length"), ("NodeTreeInterfaceSocket", "socket_type"), ("NodeSocket", "type"),
    ("NodeSocket", "display_shape"), ("NodeSocket", "link_limit"),
})  # fmt: skip
# … of an item of a node.
CHOSEN_OF_ITEMS = frozenset({"socket_type", "data_type"})
# Kinds that the makers of new things go through: (class, name) → the label of what was made without saying which.
KIND_UNASKED = {
    ("Light", "type"): "", ("Texture", "type"): "", ("Spline", "type"): "", ("ActionSlot", "target_id_type"): "",
    ("MetaElement", "type"): "ball meta element", ("FieldSettings", "type"): "force field of a mesh object",
    ("RigidBodyObject", "type"): "active rigid body", ("RigidBodyConstraint", "type"): "rigid body constraint",
    ("ParticleSettings", "type"): "particle system's settings",
}  # fmt: skip
# When these begin and end is up to whoever makes them.
TIMED = frozenset({"Strip", "Sequence", "NlaStrip"})
# What the machine decides, and bytes, of which JSON has none.
UNREAD = frozenset({"FILE_PATH", "DIR_PATH", "FILE_NAME", "BYTE_STRING"})
# Setting these makes another thing of the instance, which is made by itself; some of the old ones are then freed.
KINDS = frozenset({
    ("Light", "type"), ("Texture", "type"), ("FluidModifier", "fluid_type"),
    ("NodeTreeInterfaceSocket", "socket_type"), ("ActionSlot", "target_id_type"), ("Spline", "type"),
    ("NodeSocket", "type"),
})  # fmt: skip


def is_data_block(rna):
    """Whether the class of a pointer's target is an ID, of which scripts make one and assign it."""
    return "ID" in ancestry(rna)


class Field:
    """A property of a class whose value can be compared."""

    def __init__(self, rna, prop):
        self.name = prop.identifier
        self.path = path_of(rna, prop.identifier)
        self.default = default_of(prop)
        self.is_enum = prop.type == "ENUM"
        self.is_flag = self.is_enum and prop.is_enum_flag
        self.is_many = self.is_flag or getattr(prop, "is_array", False)
        cls = self.path.split(".")[-2]
        self.unasked = KIND_UNASKED.get((cls, self.name), "")
        self.is_chosen = (
            self.name in CHOSEN
            or (cls, self.name) in KIND_UNASKED
            or (cls, self.name) in CHOSEN_OF
            or (cls.endswith("Item") and self.name in CHOSEN_OF_ITEMS)
            # Each node gives its sockets values of its own.
            or (cls.startswith("NodeSocket") and self.name == "default_value")
            or (
                cls in TIMED
                and not self.name.startswith("select")
                and any(word in self.name for word in ("frame", "handle", "content", "channel", "duration"))
            )
        )
        self.static = (
            [row["identifier"] for row in read_items(prop.enum_items_static)] if self.is_enum else []
        )
        # Blender makes its items from what there is.
        self.is_unlisted = self.is_enum and len(self.static) < 2
        self.is_mode = self.is_enum and not self.is_flag and (cls, self.name) not in KINDS

    def is_listed_wrongly(self, value):
        """Whether an enumeration of which an instance has this value takes others than the items that RNA lists."""
        is_one = self.is_enum and not self.is_flag and isinstance(value, str)
        return self.is_unlisted or (is_one and value not in {"", *self.static})


def computed_choices(rna):
    """(path, name, argument, other required arguments) of functions with a choice of which RNA lists one at most."""
    for function in rna.functions:
        given = [item for item in function.parameters if not item.is_output]
        names = [item.identifier for item in given if item.is_required and item.type == "STRING"]
        needs_more = any(item.is_required and item.type != "STRING" for item in given)
        for item in given if not needs_more else ():
            if item.type == "ENUM" and not item.is_required and len(item.enum_items) < 2:
                path = f"bpy.types.{rna.identifier}.{function.identifier}"
                yield path, function.identifier, item.identifier, names


def asked_pointers(rna):
    """Name → path where it is declared, of the pointers that instances are asked for."""
    return {
        prop.identifier: path_of(rna, prop.identifier)
        for prop in rna.properties
        if prop.type == "POINTER" and prop.identifier not in NOT_ASKED
    }


class Layout:
    """What there is to read in the instances of a class, with these ``pointers``; ``collections``: name → path where it
    is declared. ``unassigned`` are the pointers to what a script cannot make by itself and assign, ``writable`` all
    that RNA lets be assigned.
    """

    def __init__(self, rna, pointers):
        named = rna.name_property.identifier if rna.name_property else "name"
        left_out = {named, "name"}
        self.fields = []
        self.pointers = pointers
        self.unassigned = {}
        self.collections = {}
        self.writable = {}
        for prop in rna.properties:
            name = prop.identifier
            if not (prop.is_readonly or prop.is_registered or prop.type == "COLLECTION"):
                self.writable[name] = path_of(rna, name)
            if prop.type == "POINTER":
                if name in pointers and (prop.is_readonly or not is_data_block(prop.fixed_type)):
                    self.unassigned[name] = pointers[name]
            elif prop.type == "COLLECTION":
                if name not in NOT_ASKED:
                    self.collections[name] = path_of(rna, name)
            elif (
                not prop.is_readonly
                and (name not in left_out or prop.type == "ENUM")
                and not name.startswith("bl_")
                and prop.subtype not in UNREAD
                and not (getattr(prop, "is_array", False) and not 0 < prop.array_length <= LONGEST_ARRAY)
            ):
                self.fields.append(Field(rna, prop))
        self.choices = list(computed_choices(rna))
        self.keep(self.fields)

    def keep(self, fields):
        """Has these fields be read, and no others."""
        self.fields = fields
        self.enums = [field for field in fields if field.is_enum]
        self.modes = [field for field in fields if field.is_mode]
