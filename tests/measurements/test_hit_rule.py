"""When a query counts as answered."""

from __future__ import annotations

import pytest

from measurements.retrieval import Outcome, Query, is_hit, share
from measurements.setting import percentile


def labelled(*symbols: str, pages: tuple[str, ...] = ()) -> Query:
    return Query("q-1", "any words", "natural", symbols, pages)


CLOTH = labelled("bpy.types.ClothSettings.quality", pages=("physics/cloth/settings/index",))
TYPE = labelled("bpy.types.ParticleSettings.type")
NODE = labelled("bpy.types.ShaderNodeBsdfPrincipled")


@pytest.mark.parametrize(
    ("query", "identifier"),
    [
        (CLOTH, "bpy.types.ClothSettings.quality"),
        (CLOTH, "physics/cloth/settings/index"),
        (CLOTH, "physics/cloth/settings/index#quality-steps"),
        (TYPE, "bpy.types.ParticleSettings.type:EMITTER"),
        (NODE, 'bpy.types.ShaderNodeBsdfPrincipled.inputs["Specular IOR Level"]'),
        (NODE, 'bpy.types.ShaderNodeBsdfPrincipled.outputs["BSDF"]'),
        (NODE, 'bpy.types.ShaderNodeBsdfPrincipled.inputs["Socket: #2"]'),
    ],
)
def test_an_id_that_the_label_names_or_contains_is_a_hit(query: Query, identifier: str) -> None:
    assert is_hit(query, [identifier])


@pytest.mark.parametrize(
    ("query", "identifier"),
    [
        (CLOTH, "bpy.types.ClothSettings"),
        (CLOTH, "bpy.types.ClothSettings.quality_steps"),
        (CLOTH, "physics/cloth/settings"),
        (TYPE, "bpy.types.ParticleSettings"),
        (NODE, "bpy.types.ShaderNodeBsdfPrincipled.distribution"),
        (NODE, 'bpy.types.ShaderNodeBsdfDiffuse.inputs["Color"]'),
    ],
)
def test_a_similar_id_is_not_a_hit(query: Query, identifier: str) -> None:
    assert not is_hit(query, [identifier])


def test_a_label_may_name_an_enum_item_itself() -> None:
    assert is_hit(labelled("bpy.types.ParticleSettings.type:HAIR"), ["bpy.types.ParticleSettings.type:HAIR"])
    assert not is_hit(labelled("bpy.types.ParticleSettings.type:HAIR"), ["bpy.types.ParticleSettings.type"])


def test_counts_only_the_first_ids() -> None:
    outcome = Outcome(CLOTH, ("a", "b", "bpy.types.ClothSettings.quality"), 1.0)
    assert not outcome.hit(1)
    assert not outcome.hit(2)
    assert outcome.hit(3)


def test_the_share_is_of_queries() -> None:
    right, wrong = Outcome(NODE, ("bpy.types.ShaderNodeBsdfPrincipled",) * 2, 1.0), Outcome(NODE, (), 1.0)
    assert share([right, wrong, wrong, wrong], 5) == 0.25


def test_no_answer_is_not_a_hit() -> None:
    assert not is_hit(CLOTH, [])


@pytest.mark.parametrize(("part", "value"), [(0.5, 3.0), (0.95, 5.0), (1.0, 5.0), (0.0, 1.0), (0.2, 1.0)])
def test_percentiles_are_measured_values(part: float, value: float) -> None:
    assert percentile([5.0, 1.0, 4.0, 2.0, 3.0], part) == value
