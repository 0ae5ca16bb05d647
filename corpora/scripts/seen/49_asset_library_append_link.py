"""Mark materials and objects as assets with tags and catalog, save a library .blend, then append and link from it."""
import bpy
import os
import tempfile
import uuid

lib_dir = tempfile.mkdtemp(prefix="assetlib_")
lib_path = os.path.join(lib_dir, "props.blend")
catalog_id = str(uuid.uuid4())

with open(os.path.join(lib_dir, "blender_assets.cats.txt"), "w") as fh:
    fh.write("VERSION 1\n\n")
    fh.write(f"{catalog_id}:Props/Basic:Props-Basic\n")

bpy.ops.mesh.primitive_torus_add()
ring = bpy.context.object
ring.name = "AssetRing"
mat = bpy.data.materials.new("AssetRed")
mat.use_nodes = True
mat.node_tree.nodes["Principled BSDF"].inputs[0].default_value = (0.8, 0.05, 0.05, 1)
ring.data.materials.append(mat)

for idb in (ring, mat):
    idb.asset_mark()
    idb.asset_data.author = "Me"
    idb.asset_data.description = f"Example asset {idb.name}"
    idb.asset_data.catalog_id = catalog_id
    idb.asset_data.tags.new("example", skip_if_exists=True)
    idb.asset_generate_preview()

bpy.data.libraries.write(lib_path, {ring, mat}, fake_user=True, compress=True)
print("written", os.path.getsize(lib_path))

libs = bpy.context.preferences.filepaths.asset_libraries
if "MyTempLib" not in libs:
    bpy.ops.preferences.asset_library_add(directory=lib_dir)
    libs[-1].name = "MyTempLib"

ring.asset_clear()
bpy.data.objects.remove(ring)
bpy.data.materials.remove(mat)

with bpy.data.libraries.load(lib_path, link=False, assets_only=True) as (src, dst):
    print("available:", src.objects, src.materials)
    dst.objects = [n for n in src.objects if n.startswith("Asset")]
    dst.materials = src.materials

for ob in dst.objects:
    if ob is not None:
        bpy.context.collection.objects.link(ob)

with bpy.data.libraries.load(lib_path, link=True) as (src, dst):
    dst.objects = ["AssetRing"]
linked = dst.objects[0]
bpy.context.scene.collection.objects.link(linked)
local = linked.override_create(remap_local_usages=True)
local.location.x = 3
print("override:", local.override_library.reference.name, linked.library.filepath)

bpy.ops.wm.append(directory=lib_path + "/Material/", filename="AssetRed")
