"""Paint vertex colors by height and slope on a terrain mesh and use them in the shader."""
import bpy
from mathutils import noise, Vector

bpy.ops.mesh.primitive_grid_add(x_subdivisions=100, y_subdivisions=100, size=10)
terrain = bpy.context.object
terrain.name = "Terrain"
me = terrain.data

for v in me.vertices:
    h = noise.fractal(v.co * 0.4, 1.0, 2.0, 6)
    v.co.z = h * 1.5
me.update()
me.calc_normals()

if not me.vertex_colors:
    me.vertex_colors.new(name="Col")
col = me.vertex_colors["Col"]

zs = [v.co.z for v in me.vertices]
zmin, zmax = min(zs), max(zs)

grass = Vector((0.1, 0.35, 0.08))
rock = Vector((0.3, 0.28, 0.25))
snow = Vector((0.95, 0.95, 1.0))

for poly in me.polygons:
    for li in poly.loop_indices:
        v = me.vertices[me.loops[li].vertex_index]
        t = (v.co.z - zmin) / (zmax - zmin)
        slope = 1 - v.normal.z
        c = grass.lerp(snow, max(0, (t - 0.6) / 0.4)) if t > 0.6 else grass
        c = c.lerp(rock, min(1, slope * 2))
        col.data[li].color = (c.x, c.y, c.z, 1.0)
    poly.use_smooth = True

mat = bpy.data.materials.new("TerrainMat")
mat.use_nodes = True
nt = mat.node_tree
vc = nt.nodes.new("ShaderNodeVertexColor")
vc.layer_name = "Col"
vc.location = (-300, 200)
bsdf = nt.nodes["Principled BSDF"]
nt.links.new(vc.outputs["Color"], bsdf.inputs["Base Color"])
bsdf.inputs["Roughness"].default_value = 0.9
bsdf.inputs["Specular"].default_value = 0.1
me.materials.append(mat)
print(len(me.vertices), "verts,", len(col.data), "colors, z", round(zmin, 2), round(zmax, 2))
