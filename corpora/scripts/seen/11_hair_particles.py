"""Give a sphere a hair particle system with children, and a hair material."""
import bpy

bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=1, location=(0, 0, 1))
head = bpy.context.active_object
head.name = "FurryBall"
bpy.ops.object.shade_smooth()

group = head.vertex_groups.new(name="HairDensity")
for v in head.data.vertices:
    if v.co.z > -0.2:
        group.add([v.index], min(1.0, v.co.z + 0.5), 'REPLACE')

head.modifiers.new("Hair", type='PARTICLE_SYSTEM')
psys = head.particle_systems[0]
psys.vertex_group_density = "HairDensity"
psys.vertex_group_length = "HairDensity"
psys.seed = 3

st = psys.settings
st.name = "FurSettings"
st.type = 'HAIR'
st.count = 2000
st.hair_length = 0.4
st.hair_step = 5
st.use_advanced_hair = True
st.brownian_factor = 0.03
st.child_type = 'INTERPOLATED'
st.child_nbr = 10
st.rendered_child_count = 60
st.clump_factor = 0.35
st.roughness_1 = 0.02
st.roughness_endpoint = 0.04
st.kink = 'CURL'
st.kink_amplitude = 0.02
st.kink_frequency = 3
st.root_radius = 0.6
st.tip_radius = 0.05
st.radius_scale = 0.01
st.display_step = 4

skin = bpy.data.materials.new("Skin")
hair = bpy.data.materials.new("HairMat")
hair.use_nodes = True
nt = hair.node_tree
nt.nodes.clear()
out = nt.nodes.new('ShaderNodeOutputMaterial')
hp = nt.nodes.new('ShaderNodeBsdfHairPrincipled')
hp.parametrization = 'MELANIN'
hp.inputs['Melanin'].default_value = 0.6
hp.inputs['Melanin Redness'].default_value = 0.7
hp.inputs['Roughness'].default_value = 0.25
nt.links.new(hp.outputs['BSDF'], out.inputs['Surface'])
head.data.materials.append(skin)
head.data.materials.append(hair)
st.material = 2

bpy.context.scene.render.hair_type = 'STRIP'
bpy.context.scene.cycles_curves.shape = 'RIBBONS'
