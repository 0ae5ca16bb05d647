"""What a reviewer is shown: which motion sheets, how far pictures are apart, and which stages there are to judge."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pytest
from PIL import Image
from small_plan import small_plan

from agents.loop.algorithm import stages_of
from agents.loop.edit.comparison import photometric_loss
from agents.loop.film.telling_frames import MeasuredMotion
from agents.loop.options import Options
from agents.loop.review.evidence import evidence, motion_sheets
from agents.loop.running.tool_client import ToolOutcome
from agents.loop.task import RunTask
from agents.plan.motion import MotionPhase
from agents.plan.scene import ScenePlan
from bench.blenderbench import photometric
from simworlds.llm.messages import Picture

if TYPE_CHECKING:
    from agents.loop.running.run import Run
    from agents.plan.part import Stage


def phase(actor: str, start: int, end: int, name: str = "falls") -> MotionPhase:
    return MotionPhase(name=f"{actor} {name}", actor=actor, kind="fall", start=start, end=end)


def test_actors_whose_phases_do_not_overlap_share_a_sheet() -> None:
    sheets = motion_sheets(["A", "B", "C"], [phase("A", 1, 10), phase("B", 5, 15), phase("C", 10, 20)])
    assert [sheet["actors"] for sheet in sheets] == [["A", "C"], ["B"]]
    assert sheets[0]["phases"] == [
        {"name": "A falls", "start": 1, "end": 10},
        {"name": "C falls", "start": 10, "end": 20},
    ]


def test_every_actor_is_on_a_sheet_with_phases_or_without() -> None:
    actors = [f"Domino {at}" for at in range(30)]
    sheets = motion_sheets(actors, [phase(actor, 1 + 2 * at, 9 + 2 * at) for at, actor in enumerate(actors)])
    assert sorted(name for sheet in sheets for name in sheet["actors"]) == sorted(actors)
    assert len(sheets) <= 6
    assert all(len(sheet["actors"]) <= 8 for sheet in sheets)


def test_actors_without_a_phase_are_measured_over_the_whole() -> None:
    sheets = motion_sheets(["A", "B"], [phase("A", 1, 10), phase("B", 4, 4)])
    assert sheets[1] == {"actors": ["B"]}


def test_the_photometric_loss_is_that_of_the_benchmark() -> None:
    random = np.random.default_rng(7)
    one, other, large = (
        Image.fromarray(random.integers(0, 256, size, dtype=np.uint8))
        for size in ((20, 30, 3), (20, 30, 3), (40, 60, 3))
    )
    assert photometric_loss(one, one) == 0
    assert photometric_loss(one, other) == pytest.approx(photometric.photometric_loss(other, one), rel=1e-5)
    assert photometric_loss(one, large) == pytest.approx(photometric.photometric_loss(large, one), rel=1e-5)


def test_without_a_texture_there_is_no_uv_stage() -> None:
    data = small_plan() | {"opt_out": []}
    for planned in data["objects"]:
        planned["material"] = {"name": "Plain", "base_color": [0.5, 0.5, 0.5]}
    assert "uv" not in stages_of(ScenePlan.model_validate(data))
    data["objects"][0]["material"]["texture"] = "a printed label"
    assert "uv" in stages_of(ScenePlan.model_validate(data))


class Asked:
    """Stands for a run whose tools show nothing: what they were asked."""

    def __init__(self) -> None:
        self.options = Options(mode="make", prompt="A mug.")
        self.stills: tuple[()] = ()
        self.motion = MeasuredMotion()
        self.tools = self
        self.calls: dict[str, dict[str, Any]] = {}

    def use(
        self, _role: str, _stage: str, name: str, asked: dict[str, Any], known: dict[str, Any] | None = None
    ) -> ToolOutcome:
        self.calls[name] = {**(known or {}), **asked}
        return ToolOutcome(())


def test_of_an_edit_the_materials_of_what_it_does_not_name_are_not_shown() -> None:
    asked = Asked()
    edited = RunTask("", edit=True, targets=("Mug", "Glaze"), old=("Mug", "Table"))
    evidence(cast("Run", asked), "texture", edited)
    shown = asked.calls["blender_material_preview"]
    assert shown == {"first": ["Mug", "Glaze"], "only_first": True, "old": ["Mug", "Table"]}
    evidence(cast("Run", asked), "texture", RunTask(""))
    assert asked.calls["blender_material_preview"] == {}


def test_of_an_edit_motion_is_shown_in_its_stage_alone() -> None:
    for stage, is_shown in (("motion", True), ("camera", False), ("light", False)):
        asked = Asked()
        evidence(cast("Run", asked), cast("Stage", stage), RunTask("", actors=("Mug",), edit=True))
        assert ("blender_motion_sheet_preview" in asked.calls) == is_shown


@pytest.mark.parametrize(
    ("planned", "asked_for", "shown"), [(8, None, 16), (48, None, 48), (512, None, 64), (64, 32, 32)]
)
def test_stills_have_the_samples_of_the_film_as_far_as_they_tell(
    planned: int, asked_for: int | None, shown: int
) -> None:
    plan = ScenePlan.model_validate(small_plan() | {"render": {"kind": "still", "samples": planned}})
    asked = Asked()
    asked.options = Options(mode="make", prompt="A mug.", samples=asked_for)
    evidence(cast("Run", asked), "light", RunTask("", plan))
    still = asked.calls["blender_render"]
    assert (still["samples"], still["denoise"]) == (shown, True)
    assert still["time_budget"] <= 60, "and take no longer for it"
    edited = RunTask("", edit=True, goal=Picture(b"", "image/png"), before_samples=40)
    evidence(cast("Run", asked), "light", edited)
    assert asked.calls["blender_render"]["samples"] == 40, "as many as the file's had as it was"
