"""What an answer says of settings that do nothing unless another is on, as Blender's panels have it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.answer.facts.conditions import condition_lines

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader

GREYED = "greyed out in Blender's panels unless "
SHOWN = "shown in Blender's panels only if "
OFFERED = "offered by Blender's panels only if "
SWITCHES = "while it is off, Blender's panels grey out or hide "


def lines(reader: BaseReader, path: str) -> list[str]:
    symbol = reader.symbol(f"bpy.types.{path}")
    assert symbol is not None
    return list(condition_lines(symbol, reader))


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("RigidBodyObject.use_start_deactivated",
         [f"{GREYED}`use_deactivation` is on (a new one has it off)", f"{SHOWN}`type` is 'ACTIVE'"]),
        ("CameraDOFSettings.focus_distance",
         [f"{GREYED}`use_dof` is on (a new one has it off) and `focus_object` is not set"]),
        ("FieldSettings.distance_max",
         [f"{GREYED}`use_max_distance` is on (a new one has it off)", f"{SHOWN}`type` is not 'NONE'"]),
        ("Light.cutoff_distance",
         [f"{GREYED}`use_custom_distance` is on (a new one has it off)", f"{SHOWN}`type` is not 'SUN'"]),
        ("RigidBodyConstraint.breaking_threshold",
         [f"{GREYED}`use_breaking` is on (a new one has it off)", f"{SHOWN}`type` is not 'MOTOR'"]),
        ("AreaLight.size_y", [f"{SHOWN}`shape` is 'ELLIPSE' or 'RECTANGLE' (a new one has `'SQUARE'`)"]),
        ("FluidDomainSettings.sndparticle_life_max",
         [f"{GREYED}`use_bubble_particles` is on or `use_foam_particles` is on or `use_spray_particles` is on "
          "(a new one has all of them off)",
          f"{SHOWN}`domain_type` is 'LIQUID' (a new one has `'GAS'`)"]),
        ("CyclesRenderSettings.rolling_shutter_type",
         [f"{GREYED}`RenderSettings.use_motion_blur` is on (a new one has it off)"]),
        ("CameraDOFSettings.use_dof",
         [f"{SWITCHES}`aperture_blades`, `aperture_fstop`, `aperture_ratio`, `aperture_rotation`, "
          "`focus_distance`, `focus_object`, `focus_subtarget`"]),
        ("Material.max_vertex_displacement",
         ["greyed out in Blender's panels when `displacement_method` is 'BUMP' (a new one has `'BUMP'`)"]),
        ("ArrayModifier.constant_offset_displace",
         ["has no effect unless `use_constant_offset` is on (a new one has it off)"]),
        ("RemeshModifier.octree_depth",
         ["has no effect unless `mode` is 'BLOCKS', 'SHARP' or 'SMOOTH' (a new one has `'VOXEL'`)"]),
        ("CastModifier.size", ["has no effect unless `use_radius_as_size` is off (a new one has it on)"]),
        ("SolidifyModifier.thickness_vertex_group", ["has no effect unless `vertex_group` is not empty"]),
        ("ArrayModifier.use_constant_offset", ["while it is off, there is no effect of `constant_offset_displace`"]),
        # Drawn in C, or by a template; without conditions; no setting.
        ("BevelModifier.width", []), ("ImageFormatSettings.color_depth", []), ("RenderSettings.fps", []),
        ("Object.users_collection", []),
    ],
)  # fmt: skip
def test_a_setting_says_what_it_depends_on(reader: BaseReader, path: str, expected: list[str]) -> None:
    assert lines(reader, path) == expected


@pytest.mark.parametrize(
    ("operator", "expected"),
    [
        ("fluid.bake_all",
         [f"{OFFERED}`FluidDomainSettings.cache_type` is 'ALL' (a new one has `'REPLAY'`) and "
          "`FluidModifier.fluid_type` is 'DOMAIN' (a new one has `'NONE'`)"]),
        ("fluid.bake_noise",
         [f"{GREYED}`FluidDomainSettings.use_noise` is on (a new one has it off)",
          f"{OFFERED}`FluidDomainSettings.cache_type` is 'MODULAR' (a new one has `'REPLAY'`) and "
          "`FluidDomainSettings.domain_type` is 'GAS'"]),
        ("rigidbody.object_add", []),  # offered everywhere
        ("wm.context_set_value", []),  # its arguments say what it does
    ],
)  # fmt: skip
def test_an_operator_says_when_panels_offer_it(
    reader: BaseReader, operator: str, expected: list[str]
) -> None:
    symbol = reader.symbol(f"bpy.ops.{operator}")
    assert symbol is not None
    assert list(condition_lines(symbol, reader)) == expected


def test_a_switch_for_several_kinds_names_each_setting_once(reader: BaseReader) -> None:
    (line,) = [line for line in lines(reader, "Light.use_shadow") if line.startswith(SWITCHES)]
    assert line.count("`shadow_filter_radius`") == 1
    assert "AreaLight" not in line


def test_a_long_list_is_cut(reader: BaseReader) -> None:
    (line,) = lines(reader, "View3DOverlay.show_overlays")
    assert line.count("`, `") == 7
    assert line.endswith(" more")


def test_every_condition_names_symbols_of_the_base(reader: BaseReader) -> None:
    rows = reader.rows("SELECT path, gate FROM setting_conditions")
    assert len(rows) > 1_500
    for path in {path for row in rows for path in row}:
        entry = reader.entry(path)
        assert entry is not None, path
        assert entry.kind in {"property", "operator"}, path
    assert all(row[1].startswith("bpy.types.") for row in rows)


def test_a_class_lists_its_settings_with_their_switch(reader: BaseReader) -> None:
    members = reader.members("bpy.types.CameraDOFSettings")
    assert "(if use_dof) — " in members["aperture_fstop"].line
    line = reader.members("bpy.types.FluidDomainSettings")["sndparticle_life_max"].line
    assert "(if use_bubble_particles or use_foam_particles or use_spray_particles) — " in line
    assert "(if " not in members["use_dof"].line
    assert (
        "(if use_bulge_max or use_bulge_min)"
        in reader.members("bpy.types.SplineIKConstraint")["bulge_smooth"].line
    )
    # Only if it is of the same class, greyed out and not hidden.
    assert "(if " not in reader.members("bpy.types.CyclesRenderSettings")["rolling_shutter_type"].line
    assert "(if " not in reader.members("bpy.types.AreaLight")["size_y"].line


def test_it_stands_in_the_answer(kb: KnowledgeBase) -> None:
    text = kb.query("bpy.types.RigidBodyConstraint.breaking_threshold").text
    assert (
        f"\n\nG{GREYED[1:]}`use_breaking` is on (a new one has it off); {SHOWN}`type` is not 'MOTOR'.\n"
        in text
    )
