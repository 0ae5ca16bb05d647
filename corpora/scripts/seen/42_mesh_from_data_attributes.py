"""Terrain mesh from numpy data with vertex colours, a float attribute per face and custom normals."""
import bpy
import numpy as np

n = 64
xs, ys = np.meshgrid(np.linspace(-5, 5, n), np.linspace(-5, 5, n))
zs = np.sin(xs) * np.cos(ys) + 0.3 * np.sin(3 * xs + ys)
coords = np.column_stack((xs.ravel(), ys.ravel(), zs.ravel())).astype(np.float32)

idx = np.arange(n * n).reshape(n, n)
quads = np.column_stack((idx[:-1, :-1].ravel(), idx[:-1, 1:].ravel(),
                         idx[1:, 1:].ravel(), idx[1:, :-1].ravel())).astype(np.int32)

me = bpy.data.meshes.new("Terrain")
me.vertices.add(len(coords))
me.vertices.foreach_set("co", coords.ravel())
me.loops.add(quads.size)
me.loops.foreach_set("vertex_index", quads.ravel())
me.polygons.add(len(quads))
me.polygons.foreach_set("loop_start", np.arange(0, quads.size, 4, dtype=np.int32))
me.polygons.foreach_set("loop_total", np.full(len(quads), 4, dtype=np.int32))
me.polygons.foreach_set("use_smooth", np.ones(len(quads), dtype=bool))
me.update(calc_edges=True)
me.validate(verbose=True)

h = (zs.ravel() - zs.min()) / (zs.max() - zs.min())
col = me.color_attributes.new(name="Height", type='FLOAT_COLOR', domain='POINT')
rgba = np.column_stack((h, 0.5 + 0.3 * h, 1 - h, np.ones_like(h))).astype(np.float32)
col.data.foreach_set("color", rgba.ravel())
me.color_attributes.active_color = col

vcol = me.vertex_colors.new(name="LoopColor")
for poly in me.polygons:
    for li in poly.loop_indices:
        v = h[me.loops[li].vertex_index]
        vcol.data[li].color = (v, v, v, 1.0)

slope = me.attributes.new("slope", 'FLOAT', 'FACE')
normals = np.empty(len(me.polygons) * 3, dtype=np.float32)
me.polygons.foreach_get("normal", normals)
slope.data.foreach_set("value", 1.0 - normals.reshape(-1, 3)[:, 2])

me.calc_normals_split()
me.normals_split_custom_set_from_vertices([v.normal for v in me.vertices])

ob = bpy.data.objects.new("Terrain", me)
bpy.context.collection.objects.link(ob)
for a in me.attributes:
    print(a.name, a.domain, a.data_type, len(a.data))
