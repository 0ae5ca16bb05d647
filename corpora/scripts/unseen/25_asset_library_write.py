"""Save selected materials to a library .blend, mark them as assets and link them back in."""
import bpy
import os
import tempfile

path = os.path.join(tempfile.gettempdir(), "my_materials.blend")

palette = {
    "Lib_Red": (0.8, 0.05, 0.05, 1),
    "Lib_Green": (0.05, 0.6, 0.1, 1),
    "Lib_Blue": (0.05, 0.1, 0.8, 1),
}

mats = set()
for name, col in palette.items():
    m = bpy.data.materials.new(name)
    m.use_nodes = True
    m.diffuse_color = col
    m.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = col
    m.use_fake_user = True
    m.asset_mark()
    m.asset_data.description = "Plain color " + name
    m.asset_data.tags.new("color")
    m.asset_data.author = "TD"
    mats.add(m)

bpy.data.libraries.write(path, mats, fake_user=True, compress=True)

for m in mats:
    bpy.data.materials.remove(m)

with bpy.data.libraries.load(path, link=True, assets_only=True) as (data_from, data_to):
    print("in the library:", data_from.materials)
    data_to.materials = [n for n in data_from.materials if n.startswith("Lib_")]

for i, m in enumerate(data_to.materials):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.5, location=(i * 1.5, 0, 0.5))
    ob = bpy.context.object
    ob.data.materials.append(m)
    print(ob.name, m.name, m.library.filepath)

prefs = bpy.context.preferences.filepaths
if "TempLib" not in prefs.asset_libraries:
    lib = prefs.asset_libraries.new(name="TempLib", directory=tempfile.gettempdir())
    lib.import_method = 'APPEND'
