"""Build a geometry nodes modifier in Python that scatters cones on a plane with random scale."""
import bpy

bpy.ops.mesh.primitive_cone_add(radius1=0.15, depth=0.5, location=(5, 0, 0))
tree_ob = bpy.context.object
tree_ob.name = "TreeProto"

bpy.ops.mesh.primitive_grid_add(x_subdivisions=20, y_subdivisions=20, size=8)
ground = bpy.context.object
ground.name = "Ground"

ng = bpy.data.node_groups.new("Scatter", 'GeometryNodeTree')
ng.interface.new_socket(name="Geometry", in_out='INPUT', socket_type='NodeSocketGeometry')
dens_sock = ng.interface.new_socket(name="Density", in_out='INPUT', socket_type='NodeSocketFloat')
dens_sock.default_value = 4.0
dens_sock.min_value = 0.0
obj_sock = ng.interface.new_socket(name="Instance", in_out='INPUT', socket_type='NodeSocketObject')
ng.interface.new_socket(name="Geometry", in_out='OUTPUT', socket_type='NodeSocketGeometry')

n = ng.nodes
gin = n.new('NodeGroupInput')
gout = n.new('NodeGroupOutput')
dist = n.new('GeometryNodeDistributePointsOnFaces')
dist.distribute_method = 'POISSON'
dist.inputs['Distance Min'].default_value = 0.25
info = n.new('GeometryNodeObjectInfo')
info.transform_space = 'ORIGINAL'
info.inputs['As Instance'].default_value = True
inst = n.new('GeometryNodeInstanceOnPoints')
rand = n.new('FunctionNodeRandomValue')
rand.data_type = 'FLOAT'
rand.inputs[2].default_value = 0.5
rand.inputs[3].default_value = 1.6
rot = n.new('FunctionNodeRandomValue')
rot.data_type = 'FLOAT_VECTOR'
rot.inputs[0].default_value = (0, 0, 0)
rot.inputs[1].default_value = (0.2, 0.2, 6.283)
join = n.new('GeometryNodeJoinGeometry')

for i, node in enumerate((gin, dist, info, rand, rot, inst, join, gout)):
    node.location = (i * 200, 0)

link = ng.links.new
link(gin.outputs['Geometry'], dist.inputs['Mesh'])
link(gin.outputs['Density'], dist.inputs['Density Max'])
link(gin.outputs['Instance'], info.inputs['Object'])
link(dist.outputs['Points'], inst.inputs['Points'])
link(info.outputs['Geometry'], inst.inputs['Instance'])
link(rand.outputs[1], inst.inputs['Scale'])
link(rot.outputs[0], inst.inputs['Rotation'])
link(inst.outputs['Instances'], join.inputs['Geometry'])
link(gin.outputs['Geometry'], join.inputs['Geometry'])
link(join.outputs['Geometry'], gout.inputs['Geometry'])

mod = ground.modifiers.new("Scatter", 'NODES')
mod.node_group = ng
mod[obj_sock.identifier] = tree_ob
mod[dens_sock.identifier] = 6.0
ground.update_tag()

dg = bpy.context.evaluated_depsgraph_get()
count = sum(1 for i in dg.object_instances if i.is_instance)
print("instances:", count)
