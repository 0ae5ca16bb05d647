"""Which map of a texture set a file's name stands for."""

from __future__ import annotations

import pytest

from agents.blender.assets.map_names import map_of, texture_sets


@pytest.mark.parametrize(
    ("stem", "kind", "name"),
    [
        ("oak_albedo", "base_color", "oak"),
        ("Bricks076_2K-JPG_Color", "base_color", "Bricks076"),
        ("Bricks076_2K-JPG_NormalGL", "normal", "Bricks076"),
        ("Bricks076_2K-JPG_NormalDX", "normal_directx", "Bricks076"),
        ("Bricks076_2K-JPG_AmbientOcclusion", "ambient_occlusion", "Bricks076"),
        ("Metal032_1K-PNG_Metalness", "metallic", "Metal032"),
        ("Metal032_1K-PNG_Roughness", "roughness", "Metal032"),
        ("rock_wall_08_diff_4k", "base_color", "rock_wall_08"),
        ("rock_wall_08_nor_gl_4k", "normal", "rock_wall_08"),
        ("rock_wall_08_nor_dx_4k", "normal_directx", "rock_wall_08"),
        ("rock_wall_08_arm_4k", "occlusion_roughness_metallic", "rock_wall_08"),
        ("rock_wall_08_disp_4k", "displacement", "rock_wall_08"),
        ("woodFloorBaseColor", "base_color", "wood_Floor"),
        ("tiles base color", "base_color", "tiles"),
        ("leaf-opacity", "alpha", "leaf"),
        ("lamp.emissive", "emission", "lamp"),
        ("steel_gloss", "glossiness", "steel"),
        ("portrait", "", "portrait"),
        ("color", "", "color"),
        ("holiday_2019_beach", "", "holiday_2019_beach"),
    ],
)
def test_names_that_are_common_are_recognised(stem: str, kind: str, name: str) -> None:
    assert map_of(stem)[0] == kind
    assert map_of(stem)[1] == name


def test_maps_of_one_name_in_one_folder_are_a_set() -> None:
    names = [
        "wood/oak_albedo_2k.jpg",
        "wood/oak_normal_2k.png",
        "wood/oak_normal_4k.png",
        "stone/oak_albedo_2k.jpg",
        "stone/lone_roughness.png",
        "stone/notes_color.txt",
        "photo.jpg",
    ]
    assert texture_sets(names) == {
        "wood/oak": {"base_color": "wood/oak_albedo_2k.jpg", "normal": "wood/oak_normal_2k.png"},
        "stone/oak": {"base_color": "stone/oak_albedo_2k.jpg"},
    }
