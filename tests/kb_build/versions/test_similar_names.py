"""Which symbols of this version are offered for those that it lacks."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from kb_build.blender.extract_reader import read_extract
from kb_build.versions.history import ApiHistory
from kb_build.versions.similar_names import KEPT, SimilarNames, find_similar_names
from simworlds.releases import minor_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_build.symbols.records import Symbol

CASES = Path(__file__).parent / "similar_name_cases.jsonl"
JUDGED_FOR = "5.1"


@pytest.fixture(scope="module")
def symbols(base: Path) -> Sequence[Symbol]:
    file = next((base.parent.parent / "extracts").glob("*.jsonl"))
    extract = read_extract(file)
    if minor_of(extract.version) != JUDGED_FOR:
        pytest.skip(f"the cases are about Blender {JUDGED_FOR}, this environment has {extract.version}")
    return extract.symbols


@pytest.fixture(scope="module")
def history() -> ApiHistory:
    return ApiHistory.load()


@pytest.fixture(scope="module")
def finder(symbols: Sequence[Symbol], history: ApiHistory) -> SimilarNames:
    return SimilarNames(symbols, history, JUDGED_FOR)


@pytest.mark.blender
@pytest.mark.parametrize(
    ("missing", "closest"),
    [
        ("bpy.types.Action.fcurves", "bpy.types.ActionChannelbag.fcurves"),
        ("bpy.types.Scene.node_tree", "bpy.types.Scene.compositing_node_group"),
        ("bpy.types.SceneEEVEE.use_bloom", 'bpy.types.CompositorNodeGlare.inputs["Type"]'),
        ("bpy.types.SequenceEditor.sequences", "bpy.types.SequenceEditor.strips"),
        ("bpy.ops.export_mesh.stl", "bpy.ops.wm.stl_export"),
        (
            'bpy.types.ShaderNodeBsdfPrincipled.inputs["Specular"]',
            'bpy.types.ShaderNodeBsdfPrincipled.inputs["Specular IOR Level"]',
        ),
        (
            "bpy.types.RenderSettings.engine:BLENDER_EEVEE_NEXT",
            "bpy.types.RenderSettings.engine:BLENDER_EEVEE",
        ),
        (
            "bpy.types.ShaderNodeTexSky.sky_type:NISHITA",
            "bpy.types.ShaderNodeTexSky.sky_type:MULTIPLE_SCATTERING",
        ),
        ("bpy.types.LineartGpencilModifier", "bpy.types.GreasePencilLineartModifier"),
        ("bpy.types.NodeTreeInputs", "bpy.types.NodeTreeInterface"),
        ("bpy.types.NodeTreeInputs.new", "bpy.types.NodeTreeInterface.new_socket"),
        ("bpy.types.MeshEdge.crease", "bpy.types.Mesh.edge_creases"),
    ],
)
def test_the_closest_symbol_is_offered_for_what_was_removed(
    finder: SimilarNames, missing: str, closest: str
) -> None:
    assert closest in [path for path, _ in finder.near(missing)]


@pytest.mark.blender
@pytest.mark.parametrize(
    ("missing", "far"),
    [
        ("bpy.types.GreasePencil.use_adaptive_uv", "bpy.types.BlendData.volumes"),
        ("bpy.types.GreasePencil.edit_line_color", "bpy.types.ID.is_editable"),
    ],
)
def test_what_is_elsewhere_and_called_otherwise_is_not_offered(
    finder: SimilarNames, missing: str, far: str
) -> None:
    assert far in [path for path, _ in finder.closest(missing)]
    assert far not in [path for path, _ in finder.near(missing)]


@pytest.mark.blender
def test_five_of_six_judged_cases_are_among_the_closest(finder: SimilarNames) -> None:
    cases = [json.loads(line) for line in CASES.read_text(encoding="utf-8").splitlines()]
    missed = [
        case["missing"]
        for case in cases
        if not {path for path, _ in finder.near(case["missing"])} & set(case["closest"])
    ]
    assert len(missed) <= len(cases) / 6, missed


@pytest.mark.blender
def test_similar_names_exist_and_the_missing_ones_do_not(
    symbols: Sequence[Symbol], history: ApiHistory
) -> None:
    rows = list(find_similar_names(symbols, history, JUDGED_FOR))
    known = {symbol.path for symbol in symbols}
    assert len({path for path, _, _ in rows}) > 1000
    for missing, target, score in rows:
        assert target.partition(":")[0] in known
        assert not history.exists(missing, JUDGED_FOR)
        assert score > 0


@pytest.mark.blender
def test_at_most_five_are_offered_best_first(symbols: Sequence[Symbol], history: ApiHistory) -> None:
    offered: dict[str, list[float]] = {}
    for missing, _, score in find_similar_names(symbols, history, JUDGED_FOR):
        offered.setdefault(missing, []).append(score)
    assert max(map(len, offered.values())) == KEPT
    assert all(scores == sorted(scores, reverse=True) for scores in offered.values())


@pytest.mark.blender
def test_a_version_that_the_history_does_not_know_gets_none(
    symbols: Sequence[Symbol], history: ApiHistory
) -> None:
    assert list(find_similar_names(symbols, history, "9.9")) == []


@pytest.mark.blender
def test_a_history_extended_by_an_unknown_version_tells_what_that_one_lacks(
    symbols: Sequence[Symbol], history: ApiHistory
) -> None:
    paths = [symbol.path for symbol in symbols if symbol.path != "bpy.types.Scene.compositing_node_group"]
    extended = history.including("9.9.0", paths)
    gone = {span.path for span in extended.removed_from("9.9")}
    assert extended.versions[-1] == "9.9"
    assert "bpy.types.Scene.compositing_node_group" in gone
    assert "bpy.types.Object" not in gone
