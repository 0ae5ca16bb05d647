"""Geometry nodes group that scatters an object over a plane with random rotation and scale and density exposed."""
import bpy


def build_group(instance_obj):
    ng = bpy.data.node_groups.new("ScatterGroup", 'GeometryNodeTree')
    ng.interface.new_socket("Geometry", in_out='INPUT', socket_type='NodeSocketGeometry')
    dens = ng.interface.new_socket("Density", in_out='INPUT', socket_type='NodeSocketFloat')
    dens.default_value = 10.0
    dens.min_value = 0.0
    seed = ng.interface.new_socket("Seed", in_out='INPUT', socket_type='NodeSocketInt')
    ng.interface.new_socket("Geometry", in_out='OUTPUT', socket_type='NodeSocketGeometry')

    n = ng.nodes
    gin = n.new("NodeGroupInput")
    gout = n.new("NodeGroupOutput")
    dist = n.new("GeometryNodeDistributePointsOnFaces")
    dist.distribute_method = 'RANDOM'
    inst = n.new("GeometryNodeInstanceOnPoints")
    info = n.new("GeometryNodeObjectInfo")
    info.inputs["Object"].default_value = instance_obj
    info.inputs["As Instance"].default_value = True
    rnd_rot = n.new("FunctionNodeRandomValue")
    rnd_rot.data_type = 'FLOAT_VECTOR'
    rnd_rot.inputs["Min"].default_value = (0, 0, 0)
    rnd_rot.inputs["Max"].default_value = (0, 0, 6.2831)
    rnd_scale = n.new("FunctionNodeRandomValue")
    rnd_scale.data_type = 'FLOAT'
    rnd_scale.inputs[2].default_value = 0.5
    rnd_scale.inputs[3].default_value = 1.5
    join = n.new("GeometryNodeJoinGeometry")

    l = ng.links
    l.new(gin.outputs["Geometry"], dist.inputs["Mesh"])
    l.new(gin.outputs["Density"], dist.inputs["Density"])
    l.new(gin.outputs["Seed"], dist.inputs["Seed"])
    l.new(dist.outputs["Points"], inst.inputs["Points"])
    l.new(info.outputs["Geometry"], inst.inputs["Instance"])
    l.new(rnd_rot.outputs[0], inst.inputs["Rotation"])
    l.new(rnd_scale.outputs[1], inst.inputs["Scale"])
    l.new(gin.outputs["Geometry"], join.inputs["Geometry"])
    l.new(inst.outputs["Instances"], join.inputs["Geometry"])
    l.new(join.outputs["Geometry"], gout.inputs["Geometry"])

    for i, node in enumerate(n):
        node.location = (i * 200 - 800, 0)
    return ng, dens


bpy.ops.mesh.primitive_cone_add(radius1=0.2, depth=0.8, location=(8, 0, 0))
tree = bpy.context.object
tree.name = "Tree"

bpy.ops.mesh.primitive_plane_add(size=10)
ground = bpy.context.object
ground.name = "Ground"
group, dens = build_group(tree)
mod = ground.modifiers.new("Scatter", 'NODES')
mod.node_group = group
mod[dens.identifier] = 5.0
ground.update_tag()

dg = bpy.context.evaluated_depsgraph_get()
print("instances:", sum(1 for i in dg.object_instances if i.is_instance))
