"""Messages of meshes and other shapes that name nothing of the API."""

from __future__ import annotations

from kb_build.symbols.api_names import TYPES as T
from kb_serve.recognise.messages.nameless.message import NamelessMessage

_O = "bpy.ops.object."
MESHES = (
    NamelessMessage(
        ("re-sizing bpy_struct arrays isn't supported",),
        (f"{T}bpy_prop_array", f"{T}Image.pixels"),
        "Give as many values as the slice has: three for `color[:3]`, `width * height * channels` for "
        "`image.pixels[:]`.",
    ),
    NamelessMessage(
        ("Image.pixels: array length cannot be changed to ",),
        (f"{T}Image.pixels",),
        "An image has `width * height * channels` numbers, four channels for each pixel: "
        "`image.pixels.foreach_set(array.ravel())` takes them from numpy.",
    ),
    NamelessMessage(
        ("MeshPolygon.vertices: array length cannot be changed to ",),
        (f"{T}Mesh.from_pydata", f"{T}MeshPolygon.vertices"),
        "A face keeps its number of vertices: make the mesh anew (`mesh.clear_geometry()`, `mesh.from_pydata(…)`), or "
        "change its faces in a BMesh.",
    ),
    NamelessMessage(
        ("faces.new(...): face already exists",),
        ("bmesh.types.BMFaceSeq.new", "bmesh.types.BMFaceSeq.get"),
        "One set of vertices has one face, in whatever order: `face = bm.faces.get(verts) or bm.faces.new(verts)`.",
    ),
    NamelessMessage(
        ("edges.new(): this edge exists",),
        ("bmesh.types.BMEdgeSeq.new", "bmesh.types.BMEdgeSeq.get"),
        "Two vertices have one edge: `edge = bm.edges.get(verts) or bm.edges.new(verts)`.",
    ),
    NamelessMessage(
        ("VertexGroup.", "(): cannot be called while object is in edit mode"),
        (f"{T}VertexGroup.add", "bpy.ops.object.mode_set"),
        "Leave Edit Mode first: `bpy.ops.object.mode_set(mode='OBJECT')`. In it a BMesh has the weights: "
        "`layer = bm.verts.layers.deform.verify()`, then for each vertex `vert[layer][group.index] = 1.0`.",
    ),
    NamelessMessage(
        ("invalid key, must be a BMLayerItem",),
        ("bmesh.types.BMLayerCollection.verify", "bmesh.types.BMLayerCollection.active"),
        "The layer is None: `.active` and `.get(name)` give none where there is none. `bm.loops.layers.uv.verify()` "
        "gives the active one, and makes it where it lacks; so do the layers of `bm.verts`, `bm.edges`, `bm.faces`.",
    ),
    NamelessMessage(
        ("Tangent space can only be computed for tris/quads",),
        (f"{T}Mesh.calc_tangents", "bmesh.ops.triangulate"),
        "A face has more than four corners: triangulate such faces first (`bmesh.ops.triangulate`).",
    ),
    NamelessMessage(
        ("to_mesh(): Mesh '", "is in editmode"),
        ("bmesh.types.BMesh.to_mesh", "bmesh.from_edit_mesh", "bmesh.update_edit_mesh"),
        "Leave Edit Mode first (`bpy.ops.object.mode_set(mode='OBJECT')`), or change the mesh by "
        "`bmesh.from_edit_mesh(mesh)` and `bmesh.update_edit_mesh(mesh)`.",
    ),
    NamelessMessage(
        ("sequence length mismatch given",),
        (f"{T}bpy_prop_collection.foreach_set", f"{T}bpy_prop_collection.foreach_get"),
        "It wants as many numbers as elements × values of each (3 for `co`); of none, add elements first "
        "(`mesh.vertices.add(count)`). In Edit Mode the elements of attributes and layers are none: leave it first.",
    ),
    NamelessMessage(
        ("internal error setting the array",),
        (f"{T}bpy_prop_collection.foreach_set",),
        "The list has fewer numbers than elements × values of each (3 for `co`), or, for an attribute's `data`, more; "
        "rows count as one: give `array.ravel()`. `mesh.from_pydata()` wants `(x, y, z)` for each vertex.",
    ),
    NamelessMessage(
        ("Number of custom normals is not number of ",),
        (f"{T}Mesh.normals_split_custom_set", f"{T}Mesh.normals_split_custom_set_from_vertices"),
        "It wants a normal for each corner, `len(mesh.loops)`; `normals_split_custom_set_from_vertices` wants one for "
        "each vertex.",
    ),
    NamelessMessage(
        ("couldn't access the py sequence",),
        (f"{T}bpy_prop_collection.foreach_set", f"{T}bpy_prop_collection.foreach_get"),
        "It takes a flat list of plain numbers: no tuples (`[number for co in coords for number in co]`), no rows "
        "(`array.ravel()`), no texts.",
    ),
    NamelessMessage(
        ("Vertex not in group",),
        (f"{T}VertexGroup.weight", f"{T}MeshVertex.groups"),
        "Ask only for vertices that are in the group: `any(one.group == group.index for one in vertex.groups)`.",
    ),
    NamelessMessage(
        ("Curve sizes must be greater than zero",),
        (f"{T}Curves.add_curves",),
        "Each size is the number of points in a curve, 1 or more: `curves.add_curves([3, 5])`.",
    ),
    NamelessMessage(
        ("expected 'Mesh' type found 'Object' instead",),
        ("bmesh.types.BMesh.from_mesh", "bmesh.types.BMesh.to_mesh", "bmesh.from_edit_mesh"),
        "Give the data of the object: `bm.from_mesh(obj.data)`, `bm.to_mesh(obj.data)`.",
    ),
    NamelessMessage(
        ("BMElemSeq[index]: index ", " out of range"),
        ("bmesh.types.BMVertSeq", "bmesh.types.BMVertSeq.new"),
        "There are fewer elements, `len(bm.verts)`, and they are counted from 0.",
    ),
    NamelessMessage(
        ("Layer/Element type mismatch, expected ",),
        ("bmesh.types.BMLayerItem", "bmesh.types.BMLayerAccessLoop"),
        "A layer belongs to one kind of element: `bm.loops.layers.uv` to loops, so `loop[uv_layer].uv` for the loops "
        "of a face (`face.loops`) or of a vertex (`vert.link_loops`). Layers of vertices are in `bm.verts.layers`, of "
        "edges in `bm.edges.layers`, of faces in `bm.faces.layers`.",
    ),
    NamelessMessage(
        ("Key ", " is out of range"),
        (f"{T}GreasePencilDrawing.strokes", f"{T}GreasePencilDrawing.add_strokes"),
        "There are fewer strokes, or points in a stroke: `drawing.add_strokes([3])` adds a stroke of three points.",
    ),
    NamelessMessage(
        ("spline cannot have points added",),
        (f"{T}SplinePoints.add", f"{T}SplineBezierPoints.add"),
        "The points of a Bézier spline are its `bezier_points`: `spline.bezier_points.add(count)`.",
    ),
    NamelessMessage(
        ("not in edit mode, cannot add an editbone",),
        (f"{T}ArmatureEditBones.new", f"{_O}mode_set"),
        "Edit bones are there in Edit Mode: make the armature's object active, then "
        "`bpy.ops.object.mode_set(mode='EDIT')`.",
    ),
    NamelessMessage(
        ("The mesh must be in editmode",),
        ("bmesh.from_edit_mesh", "bmesh.types.BMesh.from_mesh"),
        "In Object Mode a BMesh is a copy: `bm = bmesh.new()`, `bm.from_mesh(mesh)`, and `bm.to_mesh(mesh)` when it is "
        "changed. For the mesh itself: its object active, then `bpy.ops.object.mode_set(mode='EDIT')`.",
    ),
    NamelessMessage(
        ("Cannot add ", " in edit mode"),
        ("bmesh.from_edit_mesh", f"{T}Mesh.from_pydata", f"{T}MeshVertices.add"),
        "`bpy.ops.object.mode_set(mode='OBJECT')` comes before. In Edit Mode: `bm = bmesh.from_edit_mesh(mesh)`, "
        "`bm.verts.new((0, 0, 0))`, then `bmesh.update_edit_mesh(mesh)`.",
    ),
    NamelessMessage(
        ("is outside of main database and cannot be removed from it",),
        (f"{T}Object.to_mesh_clear", f"{T}Object.to_mesh", f"{T}BlendDataMeshes.new_from_object"),
        "What `obj.to_mesh()` makes belongs to the object, and `obj.to_mesh_clear()` removes it. One to keep is made "
        "by `bpy.data.meshes.new_from_object(obj)`.",
    ),
    NamelessMessage(
        ("Object does not have geometry data",),
        (f"{T}BlendDataMeshes.new_from_object", f"{T}Object.to_mesh", f"{T}Object.type"),
        "Only some types of objects become a mesh: test `obj.type in {'MESH', 'CURVE', 'SURFACE', 'FONT', 'META'}` "
        "before.",
    ),
)
