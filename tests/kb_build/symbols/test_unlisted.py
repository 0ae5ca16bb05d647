"""An operator that a build may lack is known by its name."""

from __future__ import annotations

import pytest

from kb_build.symbols.unlisted import OPTIONS, option_of

_ALL = ("alembic", "haru", "image_dds", "image_hdr", "usd", "xr_openxr")


@pytest.mark.parametrize(
    ("operator", "option"),
    [
        ("bpy.ops.wm.alembic_import", "alembic"),
        ("bpy.ops.wm.xr_navigation_grab", "xr_openxr"),
        ("bpy.ops.wm.gpencil_export_pdf", "haru"),
        ("bpy.ops.wm.gpencil_export_svg", ""),
        ("bpy.ops.node.image_add", ""),  # of several options
        ("bpy.types.Scene.alembic_export", ""),
        ("bpy.ops.wm.usd_export(filepath)", ""),
    ],
)
def test_an_operator_needs_what_its_name_begins_with(operator: str, option: str) -> None:
    assert option_of(operator, _ALL) == (OPTIONS + option if option else "")
