"""Names of Blender's API that much else is spelled with."""

TYPES = "bpy.types."
OPERATORS = "bpy.ops."

STRUCT = f"{TYPES}bpy_struct"
COLLECTION = f"{TYPES}bpy_prop_collection"
GROUPS = f"{TYPES}bpy_prop_collection_idprop"
ID = f"{TYPES}ID"
NODE = f"{TYPES}Node"
OBJECT = f"{TYPES}Object"

# Where a node has its sockets.
SIDES = ("inputs", "outputs")
