"""Geometry nodes simulation zone that moves points every frame with noise, instanced as small spheres."""
import bpy

ng = bpy.data.node_groups.new("SimPoints", 'GeometryNodeTree')
ng.interface.new_socket("Geometry", in_out='INPUT', socket_type='NodeSocketGeometry')
ng.interface.new_socket("Geometry", in_out='OUTPUT', socket_type='NodeSocketGeometry')
nodes, links = ng.nodes, ng.links

gin = nodes.new("NodeGroupInput")
gout = nodes.new("NodeGroupOutput")
dist = nodes.new("GeometryNodeDistributePointsOnFaces")
dist.inputs["Density"].default_value = 20

sim_in = nodes.new("GeometryNodeSimulationInput")
sim_out = nodes.new("GeometryNodeSimulationOutput")
sim_in.pair_with_output(sim_out)

setpos = nodes.new("GeometryNodeSetPosition")
noise = nodes.new("ShaderNodeTexNoise")
noise.noise_dimensions = '4D'
noise.inputs["Scale"].default_value = 0.7
time = nodes.new("GeometryNodeInputSceneTime")
sub = nodes.new("ShaderNodeVectorMath")
sub.operation = 'SUBTRACT'
sub.inputs[1].default_value = (0.5, 0.5, 0.5)
scl = nodes.new("ShaderNodeVectorMath")
scl.operation = 'SCALE'
mul = nodes.new("ShaderNodeMath")
mul.operation = 'MULTIPLY'
mul.inputs[1].default_value = 2.0

ico = nodes.new("GeometryNodeMeshIcoSphere")
ico.inputs["Radius"].default_value = 0.04
inst = nodes.new("GeometryNodeInstanceOnPoints")

links.new(gin.outputs[0], dist.inputs["Mesh"])
links.new(dist.outputs["Points"], sim_in.inputs["Geometry"])
links.new(sim_in.outputs["Geometry"], setpos.inputs["Geometry"])
links.new(time.outputs["Seconds"], noise.inputs["W"])
links.new(noise.outputs["Color"], sub.inputs[0])
links.new(sub.outputs["Vector"], scl.inputs[0])
links.new(sim_in.outputs["Delta Time"], mul.inputs[0])
links.new(mul.outputs["Value"], scl.inputs["Scale"])
links.new(scl.outputs["Vector"], setpos.inputs["Offset"])
links.new(setpos.outputs["Geometry"], sim_out.inputs["Geometry"])
links.new(sim_out.outputs["Geometry"], inst.inputs["Points"])
links.new(ico.outputs["Mesh"], inst.inputs["Instance"])
links.new(inst.outputs["Instances"], gout.inputs[0])

bpy.ops.mesh.primitive_plane_add(size=4)
ob = bpy.context.object
mod = ob.modifiers.new("Sim", 'NODES')
mod.node_group = ng

scene = bpy.context.scene
for f in range(1, 25):
    scene.frame_set(f)
dg = bpy.context.evaluated_depsgraph_get()
pts = [i.matrix_world.translation.copy() for i in dg.object_instances if i.is_instance]
print(len(pts), "points")
