"""Macro averages, coverage, comparisons, ablations and estimates, of results whose values are known."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from bench.results.estimate import estimate, makespan
from bench.results.figures import OVERALL, ablations, comparisons, figures_of
from bench.results.tables import tables
from bench.scenes.spec import specs

if TYPE_CHECKING:
    from written_results import Written

    from bench.markdown_tables import Table
    from bench.results.figures import MacroAverage
    from bench.results.scores import Metric


def figure(results: Written, metric: Metric, category: str = OVERALL) -> MacroAverage:
    return figures_of(results.read().systems[0])[metric][category]


def named(found: list[Table], title: str) -> Table:
    return next(table for table in found if table.title == title)


def test_a_category_is_the_mean_of_its_levels_and_overall_of_all_cells(results: Written) -> None:
    for scene, mpr in (
        ("cloth_D1_01", 1.0),
        ("cloth_D1_02", 0.0),
        ("cloth_D2_01", 1.0),
        ("rigid_D1_01", 0.0),
    ):
        results.add("mine", scene, mpr, 1.0, 0.5)
    assert figure(results, "mpr", "cloth").value == 0.75
    assert figure(results, "mpr").value == 0.5
    assert (figure(results, "spr").value, figure(results, "vlm").value) == (1.0, 0.5)
    assert (figure(results, "mpr").cells, figure(results, "mpr").scenes) == (3, 4)


def test_a_static_scene_counts_for_relations_and_the_judge_alone(results: Written) -> None:
    results.add("mine", "static_D1_01", 0.0, 0.5, 1.0)
    results.add("mine", "soft_D1_01", 1.0, 1.0, 0.0)
    assert (figure(results, "mpr").value, figure(results, "mpr").asked) == (1.0, 1)
    assert (figure(results, "spr").value, figure(results, "vlm").value) == (0.75, 0.5)


def test_unscored_scenes_are_counted_and_not_zero(results: Written) -> None:
    results.add("mine", "cloth_D1_01", 1.0, 1.0, 1.0)
    results.add("mine", "cloth_D1_02", why="Blender crashed")
    found = figure(results, "mpr")
    assert (found.value, found.bound, found.scenes, found.asked) == (1.0, 0.5, 1, 2)
    told = tables(results.read())
    assert named(told, "Coverage").rows == (("mine", "2 of 50", "1 of 2", "1 of 2", "1 of 2"),)
    assert ("mine", "1", "not scored", "Blender crashed") in named(told, "Not scored").rows
    rows = {row[0]: row[1:] for row in named(told, "Results by category").rows}
    assert rows["Overall"] == ("1.00", "1.00", "1.00")
    assert rows["over cells"] == ("1 of 15", "1 of 17", "1 of 17")
    assert rows["if not scored is 0"] == ("0.50", "0.50", "0.50")


def test_without_scored_scenes_there_is_no_figure(results: Written) -> None:
    results.add("mine", "cloth_D1_01")
    found = figure(results, "mpr")
    assert (found.value, found.low, found.bound) == (None, None, None)
    assert "0.00" not in str(named(tables(results.read()), "Results by category").rows)


def test_systems_are_compared_over_the_scenes_that_both_have(results: Written) -> None:
    for number, (one, other) in enumerate(((0.5, 0.25), (1.0, 0.5), (0.75, 0.5)), 1):
        results.add("a", f"cloth_D1_0{number}", one, 1.0)
        results.add("b", f"cloth_D1_0{number}", other, 1.0)
    results.add("a", "rigid_D1_01", 0.0, 0.0)
    results.add("b", "soft_D1_01", 1.0, 1.0)
    found = comparisons(results.read(), "b")
    assert [(one.first, one.second, one.metric, one.scenes) for one in found] == [
        ("a", "b", "mpr", 3),
        ("a", "b", "spr", 3),
    ]
    mpr, spr = found
    assert mpr.difference == pytest.approx(1 / 3)
    assert (mpr.p, mpr.exact) == (0.25, True)
    assert (spr.difference, spr.p) == (0, 1.0)
    assert mpr.low is not None
    assert mpr.low <= 1 / 3 <= (mpr.high or 0)


def test_ablations_are_known_by_their_settings_and_shown_over_common_scenes(results: Written) -> None:
    same = {"model": "m"}
    for scene, full, without in (("cloth_D1_01", 1.0, 0.5), ("rigid_D1_01", 1.0, 1.0)):
        results.add("simworlds", scene, full, 1.0, 1.0, settings=same)
        results.add(
            "simworlds+no-verifier", scene, without, 0.0, 1.0, settings=same, ablations=("no-verifier",)
        )
    results.add("simworlds", "soft_D1_01", 0.0, 0.0, 0.0, settings=same)
    results.add("other", "cloth_D1_01", 0.0, 0.0, 0.0, settings={"model": "n"})
    rows = ablations(results.read())
    assert [(row.system, row.without) for row in rows] == [
        ("simworlds", ()),
        ("simworlds+no-verifier", ("no-verifier",)),
    ]
    assert [row.scores["mpr"] for row in rows] == [1.0, 0.75]
    assert [row.scores["spr"] for row in rows] == [1.0, 0.0]
    assert {row.scenes["mpr"] for row in rows} == {2}
    told = named(tables(results.read(), with_paper=True), "Ablations")
    assert ("simworlds+no-verifier", "no verifier", "0.75", "0.00", "1.00", "2") in told.rows
    assert ("SimWorlds (published in the paper)", "no stages", "0.94", "0.92", "0.76", "15") in told.rows


def test_the_papers_figures_are_marked_as_published(results: Written) -> None:
    results.add("mine", "cloth_D1_01", 1.0, 1.0, 1.0)
    found = tables(results.read(), with_paper=True)
    table = named(found, "MPR by category")
    assert table.header == (
        "category",
        "mine",
        "SimWorlds (published in the paper)",
        "VIGA (published in the paper)",
    )
    assert {row[0]: row[1:] for row in table.rows}["Overall"] == ("1.00", "0.87", "0.67")


def test_the_cost_per_scene_is_the_measured_mean(results: Written) -> None:
    results.add("mine", "cloth_D1_01", 1.0, 1.0, 1.0, minutes=10, cost=0.5, seconds=(4, 8, 2))
    results.add("mine", "cloth_D1_02", 1.0, 1.0, minutes=20, cost=1.5, seconds=(6, 10, 99), frames=1)
    ((*_, dollars, minutes, audit, frames, judge),) = named(tables(results.read()), "Cost per scene").rows
    assert (dollars, minutes, audit, frames, judge) == ("1.00", "15.0 (15.0)", "5.0", "10.0", "0.010")


# Estimates


def test_workers_take_the_next_task_when_they_are_free() -> None:
    assert makespan([3, 3, 2, 2, 2], 2) == 7
    assert makespan([5, 1, 1], 10) == 5
    assert makespan([2, 2, 2], 1) == 6


def test_unmeasured_scenes_get_the_mean_of_their_category_or_of_all(results: Written) -> None:
    results.add("mine", "cloth_D1_01", 1.0, 1.0, seconds=(10, 5, 0), minutes=1)
    results.add("mine", "rigid_D1_01", 1.0, 1.0, 1.0, seconds=(20, 5, 3), minutes=0)
    found = estimate(results.read(), systems=2, machines=25, at_a_time=2)
    assert found is not None
    others = 50 - 9 - 9
    assert found.work == {
        "produced": 9 * 60 + others * 30,
        "audited": 9 * 10 + 9 * 20 + others * 15,
        "framed": 50 * 5,
        "judged": 50 * 3,
    }
    assert (found.measured, found.scenes, found.longest) == (2, len(specs()), 60 + 10 + 5 + 3)
    assert found.together <= 2 * found.longest


def test_an_estimate_takes_the_making_time_from_the_option_or_the_minutes(results: Written) -> None:
    results.add("mine", "cloth_D1_01", 1.0, 1.0, minutes=1)
    given = estimate(results.read(), systems=1, machines=1, at_a_time=1, making=100)
    assert given is not None
    assert given.work["produced"] == 100 * len(specs())
    assert given.together == given.one


def test_without_a_measurement_there_is_no_estimate(results: Written) -> None:
    results.add("mine", "cloth_D1_01")
    assert estimate(results.read(), systems=1, machines=1, at_a_time=1) is None
