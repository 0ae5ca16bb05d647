"""A film: fitted to its time, drafted, looked at by the planner before it is rendered, and stopped within seconds."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from threading import Event
from typing import TYPE_CHECKING, Any

import crates
import pytest
import teams
from run_sessions import answered, asked_of, go_on, seat, sit
from team import DONE, NEEDS_FIX, Team, call, run, whose

from agents.loop.film import allotted_time, draft
from agents.loop.film.film_limits import FilmLimits
from agents.loop.film.fitting import FilmSettings, FrameTime, TimedFrame, fitted
from agents.loop.film.rendering import quality_of
from agents.loop.options import Options, RunLimits
from agents.loop.record.events import SceneRendered
from agents.loop.record.journal import Journal
from agents.loop.record.reducer import read_run_state
from agents.loop.running.deadline import Deadline
from agents.plan.scene import RenderSettings
from agents.views.report.page import write_report

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from fake_messages_api import FakeMessagesAPI
    from run_sessions import Played

PLANNED = FilmSettings(960, 540, 64, 100, 0.0)


# Fitting


def test_a_film_that_fits_is_left_as_it_is_planned() -> None:
    film = fitted(PLANNED, FrameTime(0.0, 0.5, 0.05), 600)
    assert (film.width, film.height, film.samples, film.lowered) == (960, 540, 64, "")
    assert film.seconds == pytest.approx(370)


def test_samples_are_lowered_first_and_that_is_said() -> None:
    film = fitted(PLANNED, FrameTime(0.2, 0.3, 0.1), 300)
    assert (film.width, film.samples) == (960, 22)
    assert film.lowered == "22 samples instead of 64"
    assert film.seconds <= 300


def test_then_the_picture_gets_smaller_and_stays_even() -> None:
    film = fitted(PLANNED, FrameTime(0.0, 1.0, 0.2), 150)
    assert film.samples == 16
    assert 480 < film.width < 960
    assert film.width % 2 == film.height % 2 == 0
    assert f"{film.width}×{film.height} instead of 960×540" in film.lowered
    assert film.seconds <= 150


def test_what_fits_at_no_size_says_that_frames_will_be_left_out() -> None:
    film = fitted(PLANNED, FrameTime(0.0, 20.0, 5.0), 100)
    assert (film.width, film.height, film.samples) == (480, 270, 4)
    assert film.lowered.endswith("about 10 of 100 frames, the others repeated")
    assert film.seconds == 100


def test_no_pixels_or_samples_are_given_up_where_that_saves_little() -> None:
    film = fitted(PLANNED, FrameTime(10.0, 1.0, 0.015), 600)
    assert (film.width, film.height, film.samples) == (960, 540, 64)
    assert film.lowered == "about 50 of 100 frames, the others repeated"
    assert film.seconds == 600


def test_samples_that_take_most_of_the_time_are_lowered_though_the_picture_is_not() -> None:
    film = fitted(PLANNED, FrameTime(10.0, 0.5, 0.2), 1000)
    assert (film.width, film.samples) == (960, 16)
    assert film.lowered == "16 samples instead of 64, about 72 of 100 frames, the others repeated"


def test_a_busy_moment_costs_no_quality_that_there_is_time_for() -> None:
    quiet = FrameTime(0.0, 1.0, 0.1)
    film = fitted(PLANNED, quiet, 400)
    assert fitted(PLANNED, quiet, 400, quiet.times(2.5)) == film, "the fewest samples have time yet"
    smaller = fitted(PLANNED, quiet, 400, quiet.times(4))
    assert smaller.width < film.width
    assert film.samples < smaller.samples < PLANNED.samples, "of which some give way while it is rendered"
    assert quiet.times(4).seconds(4, smaller.width / PLANNED.width) * PLANNED.frames <= 400


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
    assert FrameTime.of(TimedFrame(*few), TimedFrame(*more)).seconds(64) == pytest.approx(cost)


@pytest.mark.parametrize(
    "time", [FrameTime(7.0, 0.5, 0.3), FrameTime(0.2, 7.0, 0.3), FrameTime(3.0, 3.0, 0.0)]
)
def test_a_small_frame_tells_what_is_fixed(time: FrameTime) -> None:
    few, more = (TimedFrame(samples, time.seconds(samples)) for samples in (4, 12))
    told = FrameTime.of(few, more, TimedFrame(4, time.seconds(4, 0.25), 1 / 16))
    if time.per_sample:
        assert told.seconds(32, 0.5) == pytest.approx(time.seconds(32, 0.5))
        assert told.fixed == pytest.approx(time.fixed)
    else:
        assert told.seconds(12) == pytest.approx(time.seconds(12)), "all of it may be the samples'"


def test_a_small_frame_of_a_busy_moment_takes_no_longer_than_a_whole_one() -> None:
    told = FrameTime.of(TimedFrame(4, 2.0), TimedFrame(12, 4.0), TimedFrame(4, 30.0, 1 / 16))
    assert (told.fixed, told.per_picture) == (1.0, 0.0)


# Its time


@dataclass
class Limited:
    """What of a run tells how long its film may take, and how it was begun."""

    deadline: Deadline
    film_limits: FilmLimits
    journal: Journal | None = None

    def minutes(self, ahead: float = 0.0, share: float = 1.0) -> float:
        return allotted_time.minutes_of(self, ahead, share)  # type: ignore[arg-type]


def limited(
    max_minutes: float | None = None, left: float | None = None, film_limits: FilmLimits | None = None
) -> Limited:
    """A run with so many seconds ``left`` of its limit."""
    deadline = Deadline(Event(), max_minutes)
    if left is not None:
        worked = (deadline.seconds_left or 0.0) - left
        deadline = replace(deadline, began=deadline.began - worked)
    return Limited(deadline, film_limits or FilmLimits())


def test_a_film_has_what_the_limit_leaves_but_for_the_review() -> None:
    assert limited().minutes() == 20
    assert limited(85, 43 * 60).minutes() == 40
    assert limited(85, 43 * 60).minutes(120, 0.5) == 19
    assert limited(10, 6 * 60).minutes() == 5
    assert limited(10, -5).minutes() == 1, "a film of few frames, rather than none"
    assert limited(85, 43 * 60, FilmLimits(minutes=7)).minutes() == 7


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


@pytest.fixture
def journal(tmp_path: Path) -> Iterator[Journal]:
    journal = Journal(tmp_path / "journal.jsonl")
    yield journal
    journal.close()


def test_a_film_is_not_mended_where_the_limit_leaves_too_little_and_that_stays_so(journal: Journal) -> None:
    def is_time(left: float | None, number: int = 1) -> bool:
        run = replace(limited(None if left is None else 85, left), journal=journal)
        return allotted_time.is_time_to_mend(run, number)  # type: ignore[arg-type]

    for number in (1, 2):
        journal.note(SceneRendered(round=number, kind="animation", seconds=1000.0))
    assert is_time(None)
    assert not is_time(600)
    assert not is_time(6000), "a session that resumes finds what was decided"
    assert is_time(6000, 2)
    assert is_time(600, 3), "no film"


def test_a_film_goes_on_as_it_was_begun_unless_the_session_is_told_otherwise(journal: Journal) -> None:
    def settled(film: FilmSettings, minutes: float, **limits: float) -> FilmSettings:
        told = FilmLimits.of(Options(prompt="A film."), RunLimits.model_validate(limits), journal)
        run = replace(limited(film_limits=told), journal=journal)
        return draft.settled_film(run, film, 1, minutes)  # type: ignore[arg-type]

    begun = FilmSettings(764, 430, 16, 84, 1000.0, "16 samples instead of 32")
    other = FilmSettings(480, 270, 8, 84, 170.0)
    assert settled(begun, 31.4) == begun
    assert settled(other, 20) == begun
    assert settled(other, 3, render_minutes=3) == other
    journal.note(SceneRendered(round=1, kind="animation"))
    assert settled(begun, 40, render_minutes=40) == other, "it is made"
    assert [row["minutes"] for row in journal.rows if row["type"] == "film.fitted"] == [31.4, 3]


# In a run


def moving(**more: Any) -> crates.Plan:
    """A film of four frames, by Cycles, of a crate that only stands."""
    settings = {"kind": "animation", "engine": "CYCLES", "resolution": [64, 36], "samples": 6}
    return crates.standing(frame_end=4, render=settings, **more)


DARKER = """\
import bpy
bpy.data.materials["Paint"].diffuse_color = (0.1, 0.1, 0.1, 1)
"""
PAINTED = 'planks.data.materials.append(bpy.data.materials.new("Paint"))\n'
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
    timing, stills, preview, film = asked[:3], asked[3:7], asked[7], asked[-1]
    assert [(one["width"], one["samples"]) for one in timing] == [(64, 4), (64, 6), (16, 4)]
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


@pytest.mark.blender
def test_after_a_mend_that_may_cost_time_frames_are_timed_anew_and_one_is_shown(drafted: Played) -> None:
    after = renders(drafted)[8:-1]
    assert [(one["name"], one.get("step")) for one in after] == [
        *[("timing", None)] * 3,
        ("draft 3", None),
        ("draft", 1),
    ]
    first, second = drafted.of("drafted")
    assert (len(first["pictures"]), len(second["pictures"])) == (4, 1)


@pytest.mark.blender
def test_a_film_has_what_the_limit_leaves_and_a_colour_does_not_change_what_it_takes(
    home: Path, tmp_path: Path
) -> None:
    mend = {"transition": "mend", "reason": "Too pale.", "instructions": "Make the crate darker."}
    team = Team(
        plan=moving(),
        code={**CODE, "modeling": CODE["modeling"] + PAINTED},
        film=mend,
        coder={"render": (run(DARKER), DONE)},
        final=(NEEDS_FIX,),
    )
    with answered(home, team):
        played = sit(tmp_path / "run", seat(RunLimits(max_minutes=30)))
    assert played.ended.how == "done", played.ended.why
    first, again = played.of("film.fitted")
    assert 20 < first["minutes"] < 25
    changed = [row["data"]["changed"] for row in played.of("tool.answered", role="coder", stage="render")]
    assert changed[0] == {"materials": {"changed": ["Paint"]}}
    assert played.the("mend.weighed")["is_time"]
    asked = renders(played)
    assert [one.get("name") for one in asked[8:11]] == ["timing", "draft 3", "draft"]
    assert asked[11]["time_budget"] == pytest.approx(60 * first["minutes"])
    assert again["minutes"] <= first["minutes"]


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
