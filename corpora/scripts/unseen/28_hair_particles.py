"""Grow hair particles on a sphere with clumping, children and a hair BSDF material."""
import bpy

bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=1)
ob = bpy.context.object
ob.name = "FurBall"

vg = ob.vertex_groups.new(name="HairDensity")
for v in ob.data.vertices:
    vg.add([v.index], max(0.0, v.co.z), 'REPLACE')

mat = bpy.data.materials.new("Hair")
mat.use_nodes = True
nodes = mat.node_tree.nodes
nodes.clear()
out = nodes.new("ShaderNodeOutputMaterial")
hair = nodes.new("ShaderNodeBsdfHairPrincipled")
hair.parametrization = 'MELANIN'
hair.inputs["Melanin"].default_value = 0.7
hair.inputs["Roughness"].default_value = 0.25
hair.inputs["Random Roughness"].default_value = 0.1
hair.inputs["Random Color"].default_value = 0.3
mat.node_tree.links.new(hair.outputs[0], out.inputs["Surface"])
ob.data.materials.append(mat)

bpy.ops.object.particle_system_add()
psys = ob.particle_systems[-1]
psys.name = "Fur"
psys.vertex_group_density = "HairDensity"
psys.seed = 3
st = psys.settings
st.name = "FurSettings"
st.type = 'HAIR'
st.count = 1500
st.hair_length = 0.5
st.hair_step = 6
st.use_advanced_hair = True
st.brownian_factor = 0.03
st.emit_from = 'FACE'
st.use_modifier_stack = True
st.child_type = 'INTERPOLATED'
st.child_nbr = 10
st.rendered_child_count = 50
st.clump_factor = 0.5
st.clump_shape = 0.1
st.roughness_1 = 0.02
st.roughness_endpoint = 0.05
st.kink = 'CURL'
st.kink_amplitude = 0.03
st.root_radius = 0.8
st.tip_radius = 0.0
st.radius_scale = 0.01
st.material = 1
st.display_step = 4

ob.show_instancer_for_render = True
bpy.context.scene.render.hair_type = 'STRIP'
bpy.context.scene.render.hair_subdiv = 2
print(psys.name, st.count, "hairs")
