"""Every kind of damage to a base is found; a sound one passes."""

from __future__ import annotations

import sqlite3
import zlib
from contextlib import closing
from typing import TYPE_CHECKING

import pytest

from kb_build.errors import KBBuildError, StoreError
from kb_build.verify import BaseVerification, verify_base

if TYPE_CHECKING:
    from pathlib import Path

    from built_base import Built

pytestmark = pytest.mark.blender


def alter(path: Path, sql: str) -> None:
    with closing(sqlite3.connect(path)) as connection:
        connection.executescript(sql)


def faults(found: BaseVerification) -> dict[str, tuple[str, ...]]:
    return {check.name: check.faults for check in found.checks if check.faults}


def inventory(path: Path, *entries: str) -> Path:
    head = b"# Sphinx inventory version 2\n# Project: API\n# Version: 5.1\n# The rest is compressed.\n"
    path.write_bytes(head + zlib.compress("".join(f"{entry}\n" for entry in entries).encode()))
    return path


def test_a_base_as_it_was_built_is_sound(built_once: Built) -> None:
    found = verify_base(built_once.path)
    assert faults(found) == {}
    assert found.sound
    assert found.blender == built_once.report.version
    looked_at = {check.name: check.looked_at for check in found.checks}
    assert looked_at["symbols"] > 20_000
    assert looked_at["links"] > 10_000
    assert looked_at["index"] > 10_000


def test_a_base_of_a_few_symbols_is_sound(small: Built) -> None:
    assert faults(verify_base(small.path)) == {}


def test_pages_that_blender_names_and_the_manual_lacks_are_listed_without_being_faults(
    built_once: Built,
) -> None:
    notes = next(check.notes for check in verify_base(built_once.path).checks if check.name == "links")
    assert any("which the manual lacks" in note for note in notes)


@pytest.mark.parametrize(
    ("damage", "check", "named"),
    [
        ("DELETE FROM sections WHERE slug = 'physics/index'", "counts", "sections"),
        ("DELETE FROM sections WHERE slug = 'physics/index'", "pages", "physics/index: no sections"),
        (
            "DELETE FROM symbols WHERE path = 'bpy.types.ClothSettings'",
            "symbols",
            "its owner bpy.types.Cloth",
        ),
        ("DELETE FROM symbols WHERE path = 'bpy.types.ClothSettings'", "links", "bpy.types.ClothSettings"),
        ("UPDATE symbols SET base = 'bpy.types.Nobody' WHERE path = 'bpy.types.Mesh'", "symbols", "Nobody"),
        (
            "UPDATE symbols SET record = x'00' WHERE path = 'bpy.types.Mesh'",
            "symbols",
            "could not be checked",
        ),
        (
            "UPDATE symbols SET record = (SELECT record FROM symbols WHERE path = 'bpy.types.ID') "
            "WHERE path = 'bpy.types.Mesh'",
            "symbols",
            "bpy.types.Mesh: its record is another symbol's",
        ),
        ("DELETE FROM names WHERE id = 'bpy.ops.mesh.bevel'", "names", "bpy.ops.mesh.bevel"),
        ("UPDATE pages SET parent = 'nowhere' WHERE slug = 'physics/index'", "pages", "nowhere"),
        ("INSERT INTO links VALUES ('bpy.types.Mesh', 'pointer', -1, 'bpy.types.Nobody')", "links", "Nobody"),
        ("UPDATE levels SET refs = 'nothing' || refs WHERE level = 0", "index", "names nothing"),
        ("UPDATE phrases SET targets = x'ffffff7f'", "index", "asks for document 2147483647"),
        ("UPDATE postings SET data = substr(data, 2) WHERE stem = 'mesh'", "index", "'mesh' are cut off"),
        ("UPDATE postings SET units = units + 1 WHERE stem = 'mesh'", "index", "'mesh' are not of"),
        ("UPDATE levels SET count = 100 WHERE level = 0", "index", "out of order or of nothing"),
        ("DROP TABLE levels", "index", "no such table: levels"),
        ("UPDATE meta SET value = '{}' WHERE name = 'counts'", "counts", "could not be checked"),
    ],
)
def test_damage_is_found_and_named(small: Built, damage: str, check: str, named: str) -> None:
    alter(small.path, damage)
    found = verify_base(small.path)
    assert not found.sound
    assert any(named in fault for fault in faults(found)[check])
    assert "FAULT" in "\n".join(found.lines())


def test_overwritten_bytes_are_found(small: Built) -> None:
    with small.path.open("r+b") as file:
        for place in range(1_000_000, 3_000_000, 100_000):
            file.seek(place)
            file.write(b"\xff" * 600)
    found = verify_base(small.path)
    assert not found.sound
    assert "file" in faults(found)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "no knowledge base here"),
        (b"", "not a knowledge base"),
        (b"not a database at all, but long enough to be one" * 50, "not readable as a knowledge base"),
    ],
)
def test_a_file_that_is_not_a_base_is_refused(tmp_path: Path, content: bytes | None, message: str) -> None:
    path = tmp_path / "blender-5.1.sqlite"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(StoreError, match=message):
        verify_base(path)


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        ("PRAGMA user_version = 99", "newer SimWorlds.*layout 99"),
        ("PRAGMA application_id = 1", "not a knowledge base"),
    ],
)
def test_bases_of_another_make_are_refused(small: Built, damage: str, message: str) -> None:
    alter(small.path, damage)
    with pytest.raises(StoreError, match=message):
        verify_base(small.path)


def test_a_base_without_its_tables_is_refused(small: Built) -> None:
    alter(small.path, "DROP TABLE symbols")
    with pytest.raises(StoreError, match=r"damaged \(no such table: symbols\).* --force"):
        verify_base(small.path)


def test_a_truncated_base_is_refused(small: Built) -> None:
    data = small.path.read_bytes()
    small.path.write_bytes(data[: len(data) - 3 * 4096])
    with pytest.raises(StoreError, match="not readable as a knowledge base"):
        verify_base(small.path)


def test_a_list_of_identifiers_is_resolved_and_the_rest_explained(built_once: Built, tmp_path: Path) -> None:
    reference = tmp_path / "identifiers.txt"
    reference.write_text(
        "# what somebody documents\n\nbpy.types.Mesh\nbpy.ops.mesh.bevel\nmathutils.Vector.lerp\n"
        "bpy.types.ClothModifier.show_viewport\nbpy.data.data\nbpy.types.mesh.Vertices\n"
        "bpy.types.VIEW3D_PT_nowhere\nbpy.types.Mesh.use_auto_smooth\nbgl.glEnable\n"
    )
    found = verify_base(built_once.path, reference)
    assert not found.sound
    assert found.reference is not None
    assert (found.reference.exact, found.reference.total) == (3, 9)
    reasons = {
        row: reason.partition(":")[0] for reason, rows in found.reference.others.items() for row in rows
    }
    assert reasons == {
        "bpy.types.ClothModifier.show_viewport → bpy.types.Modifier.show_viewport": "inherited",
        "bpy.data.data → bpy.data": "alias",
        "bpy.types.mesh.Vertices → bpy.types.Mesh.vertices": "alias",
        "bpy.types.VIEW3D_PT_nowhere": "interface",
        "bpy.types.Mesh.use_auto_smooth → bpy.types.Mesh": "removed or added",
        "bgl.glEnable": "removed or absent",
    }
    assert "3 of 9 identifiers resolve exactly (33.33%" in "\n".join(found.lines())


def test_a_sphinx_inventory_is_a_reference_too(small: Built, tmp_path: Path) -> None:
    path = inventory(
        tmp_path / "objects.inv",
        "bpy.types.Mesh py:class 1 bpy.types.Mesh.html#$ -",
        "bpy.types.Mesh.vertices py:attribute 1 bpy.types.Mesh.html#$ -",
        "bpy.ops.mesh.bevel py:function 1 bpy.ops.mesh.html#$ -",
        "info quickstart std:label -1 info_quickstart.html#x Quickstart",
    )
    found = verify_base(small.path, path)
    assert found.sound
    assert found.reference is not None
    assert (found.reference.exact, found.reference.total) == (3, 3)


def test_identifiers_of_this_versions_reference_resolve(built_once: Built, tmp_path: Path) -> None:
    """A sample of each kind of identifier, those that Blender's own tables repeat on subclasses included."""
    reference = tmp_path / "identifiers.txt"
    reference.write_text(
        "\n".join(
            [
                "bpy.context.area",
                "bpy.context.active_bone",
                "bpy.types.Context.active_bone",
                "bpy.types.Context.temp_override",
                "bpy.types.bpy_struct.keyframe_insert",
                "bpy.types.bpy_prop_collection.foreach_get",
                "bpy.types.Mesh.bl_rna_get_subclass",
                "bpy.types.MESH_UL_vgroups.draw_item",
                "bpy.types.MESH_UL_vgroups.bl_rna_get_subclass_py",
                "bpy.types.ShaderNodeMath.is_registered_node_type",
                "bpy.types.NodeSocketFloat.links",
                "bpy.types.SpaceView3D.draw_handler_add",
                "bpy.types.Gizmo.target_set_handler",
                "bpy.types.HydraRenderEngine.get_render_settings",
                "bpy.app.handlers.frame_change_post",
                "bpy.app.translations.pgettext",
                "bpy.msgbus.subscribe_rna",
                "bpy.props.FloatVectorProperty",
                "bpy.utils.units.to_value",
                "bpy.utils.previews.ImagePreviewCollection.load",
                "bpy_extras.io_utils.ImportHelper",
                "bmesh.ops.create_cube",
                "bmesh.types.BMVert.co",
                "freestyle.utils.BoundingBox",
                "freestyle.predicates.ExternalContourUP1D",
                "gpu.types.GPUBatch.draw",
                "gpu_extras.batch.batch_for_shader",
                "mathutils.kdtree.KDTree.find_range",
                "idprop.types.IDPropertyGroup.to_dict",
                "imbuf.types.ImBuf.resize",
                "aud.Sound.file",
                "rna_enum_object_modifier_type_items",
            ]
        )
    )
    found = verify_base(built_once.path, reference)
    assert found.reference is not None
    assert found.reference.others == {}


@pytest.mark.parametrize(
    "content",
    [
        b"two words\n",
        b"\xff\xfe\x00",
        b"# Sphinx inventory version 2\n#\n#\n#\nno",
        b"# Sphinx inventory version 2\n#",
    ],
)
def test_a_reference_of_an_unknown_format_is_refused(small: Built, tmp_path: Path, content: bytes) -> None:
    reference = tmp_path / "reference"
    reference.write_bytes(content)
    with pytest.raises(KBBuildError, match="neither a Sphinx inventory nor a list"):
        verify_base(small.path, reference)
