"""Write mesh vertices to CSV, read them back as a point mesh, and export the scene to USD, Alembic and PLY."""
import bpy
import csv
import os
import tempfile

folder = bpy.app.tempdir or tempfile.gettempdir()
csv_path = os.path.join(folder, "points.csv")


def write_csv(ob, path):
    dg = bpy.context.evaluated_depsgraph_get()
    ev = ob.evaluated_get(dg)
    me = ev.to_mesh()
    with open(path, "w", newline="") as fh:
        w = csv.writer(fh)
        w.writerow(["x", "y", "z", "nx", "ny", "nz"])
        for v in me.vertices:
            co = ob.matrix_world @ v.co
            w.writerow([f"{c:.5f}" for c in (*co, *v.normal)])
    ev.to_mesh_clear()


def read_csv(path, name="PointsFromCSV"):
    with open(path) as fh:
        rows = list(csv.DictReader(fh))
    coords = [(float(r["x"]), float(r["y"]), float(r["z"])) for r in rows]
    me = bpy.data.meshes.new(name)
    me.from_pydata(coords, [], [])
    attr = me.attributes.new(name="source_normal", type='FLOAT_VECTOR', domain='POINT')
    for i, r in enumerate(rows):
        attr.data[i].vector = (float(r["nx"]), float(r["ny"]), float(r["nz"]))
    me.update()
    ob = bpy.data.objects.new(name, me)
    bpy.context.scene.collection.objects.link(ob)
    return ob


bpy.ops.mesh.primitive_torus_add(major_radius=1, minor_radius=0.3)
torus = bpy.context.object
write_csv(torus, csv_path)
pts = read_csv(csv_path)
pts.location.x = 4
print("points:", len(pts.data.vertices))

bpy.ops.wm.usd_export(filepath=os.path.join(folder, "scene.usdc"),
                      selected_objects_only=False, export_animation=False,
                      export_materials=True, export_textures=False,
                      visible_objects_only=True)
bpy.ops.wm.alembic_export(filepath=os.path.join(folder, "scene.abc"), start=1, end=5,
                          selected=False, flatten=False)
bpy.ops.object.select_all(action='DESELECT')
torus.select_set(True)
bpy.ops.wm.ply_export(filepath=os.path.join(folder, "torus.ply"),
                      export_selected_objects=True, ascii_format=True)
bpy.ops.wm.collada_export(filepath=os.path.join(folder, "scene.dae"))
print(sorted(os.listdir(folder)))
