"""A film: fitted to its time, drafted, looked at by the planner before it is rendered, and stopped within seconds."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import crates
import pytest
import teams
from run_sessions import answered, asked_of, go_on, seat, sit
from team import DONE, Team, call, run, whose

from agents.loop import draft
from agents.loop.film_settings import FilmSettings, FrameTime, fitted
from agents.loop.options import RunLimits
from agents.loop.reducer import read_run_state
from agents.loop.rendering import quality_of
from agents.plan.scene import RenderSettings
from agents.views.report.page import write_report

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from fake_messages_api import FakeMessagesAPI
    from run_sessions import Played

PLANNED = FilmSettings(960, 540, 64, 100, 0.0)


# Fitting


def test_a_film_that_fits_is_left_as_it_is_planned() -> None:
    film = fitted(PLANNED, FrameTime(0.5, 0.05), 600)
    assert (film.width, film.height, film.samples, film.lowered) == (960, 540, 64, "")
    assert film.seconds == pytest.approx(370)


def test_samples_are_lowered_first_and_that_is_said() -> None:
    film = fitted(PLANNED, FrameTime(0.5, 0.1), 300)
    assert (film.width, film.samples) == (960, 22)
    assert film.lowered == "22 samples instead of 64"
    assert film.seconds <= 300


def test_then_the_picture_gets_smaller_and_stays_even() -> None:
    film = fitted(PLANNED, FrameTime(1.0, 0.2), 150)
    assert film.samples == 16
    assert 480 < film.width < 960
    assert film.width % 2 == film.height % 2 == 0
    assert f"{film.width}×{film.height} instead of 960×540" in film.lowered
    assert film.seconds <= 150


def test_what_fits_at_no_size_says_that_frames_will_be_left_out() -> None:
    film = fitted(PLANNED, FrameTime(20.0, 5.0), 100)
    assert (film.width, film.height, film.samples) == (480, 270, 4)
    assert "one frame in " in film.lowered
    assert film.seconds == 100


@pytest.mark.parametrize(
    ("few", "more", "cost"),
    [
        ((4, 2.0), (12, 4.0), 17.0),
        ((4, 9.0), (12, 4.0), 64 / 3),
        ((1, 2.0), (1, 1.0), 64.0),
        ((4, 0.0), (12, 0.0), 0.0),
    ],
)
def test_two_frames_tell_what_samples_cost(
    few: tuple[int, float], more: tuple[int, float], cost: float
) -> None:
    assert FrameTime.of(few, more).seconds(64) == pytest.approx(cost)


def test_a_film_planned_in_eevee_is_drawn_by_what_drew_its_stills() -> None:
    assert draft.asked_of(RenderSettings(kind="animation", engine="BLENDER_EEVEE")) == {}
    assert draft.asked_of(RenderSettings(kind="animation", engine="CYCLES")) == {
        "engine": "cycles",
        "denoise": True,
    }


@pytest.mark.parametrize(
    ("film", "asked", "made", "told"),
    [
        (FilmSettings(960, 540, 32, 84, 0.0), None, 32, "32 planned. Its size: 960×540."),
        (
            FilmSettings(480, 270, 13, 84, 0.0),
            16,
            4,
            "32 planned, 16 asked for by the run's options, 13 fitted to the time, 4 in some frames, since frames "
            "took longer than expected. Its size: 480×270 instead of 960×540. What time has lowered is not held "
            "against the scene.",
        ),
    ],
)
def test_one_sentence_tells_how_a_films_samples_came_about(
    film: FilmSettings, asked: int | None, made: int, told: str
) -> None:
    plan = RenderSettings(kind="animation", engine="CYCLES", samples=32, resolution=(960, 540))
    assert quality_of(film, plan, asked, made) == f"The film's samples: {told}"


# In a run


def moving(**more: Any) -> crates.Plan:
    """A film of four frames, by Cycles, of a crate that only stands."""
    settings = {"kind": "animation", "engine": "CYCLES", "resolution": [64, 36], "samples": 6}
    return crates.standing(frame_end=4, render=settings, **more)


CODE = {**crates.CODE, "modeling": crates.STANDING + "\nscene.frame_end = 4\n"}


def renders(played: Played) -> list[dict[str, Any]]:
    return [
        row["input"] for row in played.of("tool.called", role="runner", stage="render", name="blender_render")
    ]


@pytest.fixture(scope="module")
def drafted(home: Path, tmp_path_factory: pytest.TempPathFactory) -> Played:
    """A run whose planner mends something before the film."""
    mend = {"transition": "mend", "reason": "Too low.", "instructions": "Put the sun higher."}
    team = Team(plan=moving(), code=CODE, film=mend, coder={"render": (run(teams.HIGHER), DONE)})
    with answered(home, team) as api:
        played = sit(tmp_path_factory.mktemp("drafted") / "run", render_minutes=5)
        played.requests = asked_of(api)
        return played


@pytest.mark.blender
def test_before_a_film_frames_are_timed_and_shown_as_the_film_will_be(drafted: Played) -> None:
    assert drafted.ended.how == "done"
    asked = renders(drafted)
    timing, stills, preview, film = asked[:2], asked[2:6], asked[6], asked[-1]
    assert [one["samples"] for one in timing] == [4, 6]
    assert [one["frame"] for one in stills] == [1, 2, 3, 4]
    kind = ("engine", "denoise", "width", "height", "samples")
    assert {tuple(one[name] for name in kind) for one in (*stills, film)} == {("cycles", True, 64, 36, 6)}
    assert (preview["kind"], film["kind"], film["time_budget"]) == ("animation", "animation", 300)
    assert (drafted.root / "draft.mp4").stat().st_size > 0


@pytest.mark.blender
def test_the_planner_sees_the_stills_once_and_may_have_something_mended(drafted: Played) -> None:
    asked_for = [whose(one) for one in drafted.requests]
    assert asked_for.count(("planner", "render")) == 1, asked_for
    asked = drafted.requests[asked_for.index(("planner", "render"))]
    last = json.dumps(asked["messages"][-1])
    assert last.count('"type": "image"') == 4
    assert "A frame takes about" in last
    assert "4 frames, 64×36, 6 samples" in json.dumps(asked["messages"][-1], ensure_ascii=False)
    assert drafted.the("film.decided")["decision"]["transition"] == "mend"
    assert drafted.the("verified", stage="render", attempt=2)["ok"]
    assert [row["round"] for row in drafted.of("rendered")] == [1]


@pytest.mark.whole
@pytest.mark.blender
def test_a_run_that_is_stopped_in_its_film_shows_its_draft_and_goes_on_with_another_time(
    api: FakeMessagesAPI, tmp_path: Path
) -> None:
    api.answer = Team(plan=moving(), code=CODE)
    at, root = seat(), tmp_path / "run"

    def stop(row: Mapping[str, Any]) -> None:
        if row["type"] == "film.fitted":
            at.stop.event.set()

    at.watcher.on_row = stop  # type: ignore[attr-defined]
    first = sit(root, at)
    assert (first.ended.how, first.ended.file, first.ended.shown) == (
        "stopped",
        root / "scene.blend",
        root / "draft.mp4",
    )
    page = write_report(root).read_text()
    assert "There is no result to show" not in page
    assert "The draft before the film" in page
    assert read_run_state(root).film_seconds is not None
    second = go_on(root, seat(RunLimits(render_minutes=3, samples=5)))
    assert second.ended.how == "done"
    film = renders(second)[-1]
    assert (film["time_budget"], film["samples"]) == (180, 5)
    assert [row["minutes"] for row in second.of("film.fitted")] == [20, 3]


@pytest.mark.blender
def test_a_render_is_given_up_as_soon_as_a_stop_is_asked_for(api: FakeMessagesAPI, tmp_path: Path) -> None:
    slow = call("blender_render", samples=60_000, width=2000, height=2000, denoise=False, engine="cycles")
    api.answer = Team(code=crates.CODE, coder={"light": (run(crates.LIGHT), slow, DONE)})
    at = seat()

    def stop(row: Mapping[str, Any]) -> None:
        if (row["type"], row.get("role"), row.get("name")) == ("tool.called", "coder", "blender_render"):
            at.stop.event.set()

    at.watcher.on_row = stop  # type: ignore[attr-defined]
    played = sit(tmp_path / "run", at)
    assert played.ended.how == "stopped"
    assert [row["type"] for row in played.rows[-2:]] == ["tool.called", "run.ended"]


@pytest.mark.blender
def test_a_scene_that_cannot_be_rendered_goes_back_to_the_coder_once(
    api: FakeMessagesAPI, tmp_path: Path
) -> None:
    blind = (
        crates.LIGHT
        + "\nscene.camera = None\nfor obj in list(scene.objects):\n    if obj.type == 'CAMERA':\n"
    )
    blind += "        bpy.data.objects.remove(obj)\n"
    api.answer = Team(
        code=CODE,
        coder={"light": (run(blind), DONE), "render": (run(crates.CAMERA), DONE)},
    )
    played = sit(tmp_path / "run", verifier=False)
    assert played.ended.how == "done", played.ended.why
    first, second = played.of("tool.answered", role="runner", stage="render", name="blender_render")
    assert (first["failed"], second["failed"]) == (True, False)
    assert (played.root / "still.png").exists()
