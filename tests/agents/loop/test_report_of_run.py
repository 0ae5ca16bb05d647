"""The report is one page that stands alone, tells all of a run, and lets nothing out that is hostile."""

from __future__ import annotations

import base64
import json
import re
from contextlib import closing
from typing import TYPE_CHECKING, Any

import pytest
from bs4 import BeautifulSoup
from domino_run import domino_plan, dominoes, finding
from PIL import Image
from sample_runs import Tape, write
from whole import IS_WHOLE

from agents.views.report.media import LARGEST_VIDEO, Media, MediaItem
from agents.views.report.page import NAME, write_report

if TYPE_CHECKING:
    from pathlib import Path

    from bs4 import Tag

EVIL = "<script>alert(1)</script><img src=x onerror=alert(2)>\"'>{{ 7*7 }}\x1b[2J\x00\u202e\ud800"


def report_of(tape: Tape, folder: Path) -> BeautifulSoup:
    write(tape, folder)
    return BeautifulSoup(write_report(folder).read_bytes(), "lxml")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("run")
    write(dominoes(made), made)
    (made / "video.mp4").write_bytes(b"\0\0\0 ftypisom")
    (made / "scene.blend").write_bytes(b"BLENDER")
    return made


@pytest.fixture(scope="module")
def page(folder: Path) -> BeautifulSoup:
    return BeautifulSoup(write_report(folder).read_bytes(), "lxml")


def words(tag: Tag | None) -> str:
    assert tag is not None
    return " ".join(tag.get_text(" ").split())


def stage(page: BeautifulSoup, title: str) -> Tag:
    return next(one for one in page.select("section.stage") if words(one.h2).startswith(title))


def test_it_says_what_was_asked_and_what_came_of_it(page: BeautifulSoup) -> None:
    assert words(page.h1) == "Twelve dominoes"
    assert "the cascade runs to the end" in words(page.select_one(".prompt"))
    assert words(page.select_one(".badge")) == "done"
    assert "5 min 47 s in 2 sessions" in words(page.select_one("header"))
    assert page.select_one('header a[href="./scene.blend"]')


def test_it_needs_nothing_but_itself(page: BeautifulSoup) -> None:
    for tag in page.select("[src], [href], [poster]"):
        for name in ("src", "href", "poster"):
            value = str(tag.get(name, "#"))
            assert value.startswith(("data:image/webp;base64,", "data:video/mp4;base64,", "#", "./")), value
    assert not page.select("link, iframe, object, embed, base")
    style = words(page.style)
    assert "url(" not in style
    assert "@import" not in style


def test_only_its_own_script_may_run(page: BeautifulSoup) -> None:
    assert len(page.select("script")) == 1
    policy = str(page.select_one("meta[http-equiv]")["content"])  # type: ignore[index]
    assert "default-src 'none'" in policy
    assert "script-src 'sha256-" in policy


def test_a_small_video_is_in_the_page_with_key_frames_below(page: BeautifulSoup) -> None:
    source = str(page.select_one("video")["src"])  # type: ignore[index]
    assert base64.b64decode(source.partition(",")[2]) == b"\0\0\0 ftypisom"
    assert len(page.select("#result .rendering")) == 2
    assert len(page.select("#result .strip")[0].select("img")) == 5


def test_the_graph_folds_what_is_alike(page: BeautifulSoup) -> None:
    graph = page.select_one("svg.graph")
    assert graph
    assert len(graph.select("g.card")) == 4
    text = words(graph)
    for shown in (
        "Domino.01 … Domino.12 (12)",
        "SupportedBy ×12",
        "NextTo ×11",
        "sets off ×11",
        "Distributed",
    ):
        assert shown in text
    kinds = {name for pill in graph.select("g.pill") for name in pill["class"]}
    assert {"c-contact", "c-placement", "c-arrangement", "c-motion"} <= kinds


def test_the_timeline_has_every_phase_and_its_cause(page: BeautifulSoup) -> None:
    timeline = page.select_one("svg.timeline")
    assert timeline
    assert len(timeline.select("rect.bar")) == 13
    assert len(timeline.select("path.cause")) == 12
    starts = [float(str(bar["x"])) for bar in timeline.select("rect.bar")]
    assert starts == sorted(starts)


def test_the_phases_of_an_actor_share_a_lane(tmp_path: Path) -> None:
    plan = domino_plan()
    plan["motion"]["phases"].append(
        {"name": "rest", "actor": "Domino.03", "kind": "settle", "start": 40, "end": 96}
    )
    tape = Tape()
    tape.add("plan", plan=plan)
    timeline = report_of(tape, tmp_path).select_one("svg.timeline")
    assert timeline
    assert len(timeline.select("text.actor")) == 13
    heights = {words(bar.parent): str(bar["y"]) for bar in timeline.select("rect.bar")}
    own = {height for told, height in heights.items() if "Domino.03," in told}
    assert len(own) == 1
    assert sum(height in own for height in heights.values()) == 2


def test_objects_that_are_alike_share_a_row(page: BeautifulSoup) -> None:
    table = page.select_one("#plan table")
    assert table
    rows = [words(row) for row in table.select("tbody tr")]
    assert len(rows) == 4
    assert "Domino.01 … Domino.12 (12) rigid 0.012 × 0.05 × 0.1 Wood" in rows[3]


def test_relations_that_say_alike_share_a_row(page: BeautifulSoup) -> None:
    table = next(one for one in page.select("#plan table") if "Terms" in words(one))
    assert [words(row) for row in table.select("tbody tr")] == [
        "SupportedBy Table Floor",
        "SupportedBy ×12 Domino.01 … Domino.12 (12) Table/Top",
        "Upright ×12 Domino.01 … Domino.12 (12)",
        "NextTo ×11 Domino.02 … Domino.12 (11) Domino.01 … Domino.11 (11) 20 mm to 40 mm apart",
        "Distributed Domino.01 … Domino.12 (12) line, every 50 mm",
        "NextTo Finger Domino.01 0 mm to 50 mm apart",
        "Above Finger Table as the world has it",
    ]


def test_an_attempt_that_was_sent_back_says_why(page: BeautifulSoup) -> None:
    first, second = stage(page, "Modeling").select("article.attempt")
    text = words(first)
    assert "sent back: 12 hard findings, 1 hard rule undecided, the reviewer blocks" in text
    assert "V1 contact hard ×12 Domino.01 … Domino.12 (12) · Table 20–31 mm 2 mm" in text
    assert "→ Lower it until it rests on the table." in text
    assert "The side view shows a gap below the dominoes." in text
    assert "What keeps the stage open: It is open." in text
    assert "Move every domino down by its gap." in text
    assert "closed the stage" in words(second)
    assert "Planner" not in words(second), "nobody had to decide"


def test_the_code_is_shown_with_what_changed_since_the_last_attempt(page: BeautifulSoup) -> None:
    first, second = stage(page, "Modeling").select("article.attempt")
    assert "primitive_domino_add" in words(first.select_one(".steps"))
    assert not first.select(".diff")
    diff = second.select_one(".diff")
    assert diff
    assert [words(one) for one in diff.select(".gi")] == [
        "+GAP = 0.05 # metres",
        "+ domino.location = (-0.275 + n * GAP, 0, 0.75 + HEIGHT / 2)",
    ]


def test_a_folded_tool_call_says_what_it_is_about(page: BeautifulSoup) -> None:
    told = [words(one) for one in stage(page, "Modeling").select(".steps summary")]
    assert "blender_docs primitive_cube_add size checkpoint 1 · 2.0 s" in told
    assert "blender_execute 11 lines failed 2.0 s" in told


def test_pictures_are_there_once_and_steps_lead_to_them(page: BeautifulSoup) -> None:
    figures = {str(one["id"]) for one in page.select("figure")}
    assert figures == {f"picture-{number}" for number in range(1, len(figures) + 1)}
    links = {str(one["href"])[1:] for one in page.select(".steps a")}
    assert links == figures


def test_costs_are_told_by_role_and_stage(page: BeautifulSoup) -> None:
    rows = [words(row) for row in page.select("#costs tbody tr")]
    assert rows[0].startswith("Scene plan $0.21")
    assert any(row.startswith("Modeling") and row.endswith("1 min 14 s") for row in rows)
    assert "$1.28" in words(page.select_one("#costs tfoot"))


def test_live_answers_are_not_excused(page: BeautifulSoup) -> None:
    assert not page.select(".source")


def test_answers_that_were_not_live_are_said_not_to_be(tmp_path: Path) -> None:
    page = report_of(dominoes(live=False), tmp_path)
    assert "No model was asked in this run: its answers were written beforehand" in words(
        page.select_one(".source")
    )
    assert "hand-written answers" in words(page.select_one(".badges"))
    assert "recorded" in words(page.select_one("#costs"))
    assert "$" not in words(page.select_one("#costs tbody"))


def test_a_run_that_was_given_up_says_so(tmp_path: Path) -> None:
    tape = Tape()
    tape.began()
    tape.add("stage.began", stage="modeling")
    tape.ended("aborted", "The stage modeling could not be closed.")
    page = report_of(tape, tmp_path)
    assert words(page.select_one(".badge")) == "aborted"
    assert words(page.select_one(".notice")) == "The stage modeling could not be closed."
    assert "There is no result to show." in words(page.select_one("#result"))
    assert "not reached yet" in words(stage(page, "Motion"))


def test_a_run_without_anything_has_a_report_too(tmp_path: Path) -> None:
    assert "unfinished" in words(report_of(Tape(), tmp_path).select_one(".badge"))


def test_every_beginning_of_a_run_has_a_report(tmp_path: Path) -> None:
    rows = dominoes().rows
    for end in range(0, len(rows), 7 if IS_WHOLE else 23):
        tape = Tape()
        tape.rows = rows[:end]
        assert report_of(tape, tmp_path).h1


def test_an_edit_tells_every_data_block_and_warns_of_those_outside(tmp_path: Path) -> None:
    tape = Tape()
    tape.began("Dim the lamp", mode="edit", file="scene.blend")
    task = {"kind": "modify", "stage": "light", "targets": ["Key"], "instruction": "Dim it."}
    plan = {"title": "Dimmer", "tasks": [task], "stays": "All else.", "render": {"kind": "still"}}
    tape.add("plan", edit=plan)
    tape.add(
        "edited", added=["Light Fill"], removed=[], changed=["Light Key", "Mesh Cube"],
        unchanged=["Object Cube", "World World"], outside=["Mesh Cube"],
    )  # fmt: skip
    page = report_of(tape, tmp_path)
    assert "Dim it." in words(page.select_one("#plan"))
    changes = page.select_one("#changes")
    assert "1 data-block changed that the plan does not name: Mesh Cube" in words(changes)
    rows = [words(row) for row in page.select("#changes tbody tr")]
    assert rows == ["Light Fill added", "Light Key changed", "Mesh Cube changed outside the request"]
    assert "Object Cube, World World" in words(changes)


def test_what_a_planner_said_is_there_also_where_no_plan_came_of_it(tmp_path: Path) -> None:
    tape = Tape()
    tape.began()
    tape.says("planner", "", "I cannot plan this.")
    tape.says("planner", "", "Nor now.")
    tape.ended("failed", "The planner gave no answer of the requested form.")
    planning = report_of(tape, tmp_path).select_one("#planning")
    assert "I cannot plan this. Nor now." in words(planning)
    assert planning
    assert planning.select_one("details[open]")


def test_a_film_says_how_many_of_its_frames_were_rendered(tmp_path: Path) -> None:
    tape = Tape()
    tape.began()
    tape.add("plan", plan=domino_plan())
    fitted = {"width": 640, "height": 360, "samples": 4, "seconds": 60.0, "minutes": 1.0}
    tape.add("film.fitted", round=1, frames=64, **fitted)
    tape.add("rendered", round=1, kind="animation", path="video.mp4", frames=47, samples=4, seconds=59.0)
    told = words(report_of(tape, tmp_path).select_one("#result .rendering"))
    assert "animation of 64 frames, 47 of them rendered and the others repeated, 4 samples" in told


# Hostile journals


def evil(value: Any) -> Any:
    """Every text replaced, but for those that say what a thing is."""
    if isinstance(value, dict):
        kept = (
            "type",
            "t",
            "role",
            "kind",
            "stage",
            "severity",
            "outcome",
            "taken",
            "transition",
            "verdict",
            "engine",
        )
        return {key: one if key in kept else evil(one) for key, one in value.items()}
    if isinstance(value, list):
        return [evil(one) for one in value]
    return EVIL if isinstance(value, str) else value


def test_nothing_that_a_journal_says_becomes_markup(tmp_path: Path) -> None:
    tape = Tape()
    tape.rows = [evil(row) for row in dominoes().rows]
    plan = domino_plan()
    plan["title"] = plan["objects"][1]["description"] = plan["lighting"][0]["name"] = EVIL
    plan["objects"][1]["material"]["texture"] = EVIL.replace("\x00", "")
    next(row for row in tape.rows if row["type"] == "plan")["plan"] = plan
    tape.add("run.ended", outcome=EVIL, why=EVIL, file=EVIL, video=EVIL)
    path = tmp_path / "journal.jsonl"
    path.write_text("".join(json.dumps(row) + "\n" for row in tape.rows))
    data = write_report(tmp_path).read_bytes()
    page = BeautifulSoup(data, "lxml")
    assert len(page.select("script")) == 1
    assert not [tag.name for tag in page.find_all(True) for name in tag.attrs if name.startswith("on")]
    assert not page.select("img[src=x]")
    assert "alert(1)" in words(page.h1)
    assert "7*7" in words(page.h1)
    assert not re.search("[\x00-\x08\x0b-\x1f\x7f\u202e]", data.decode())


@pytest.mark.parametrize(
    "name",
    [
        "../secret.png",
        "/etc/passwd",
        "a/../../secret.png",
        "link.png",
        "folder",
        "",
        "a\0b",
        "x" * 5000,
        "no.png",
    ],
)
def test_only_files_of_the_run_are_read(tmp_path: Path, name: str) -> None:
    run = tmp_path / "run"
    (run / "folder").mkdir(parents=True)
    Image.new("RGB", (4, 4)).save(tmp_path / "secret.png")
    (run / "link.png").symlink_to(tmp_path / "secret.png")
    with closing(Media(run)) as media:
        assert media.picture(name) is None
        assert media.video(name) is None
        assert media.link(name) == ""


def picture_of(run: Path, name: str) -> MediaItem | None:
    with closing(Media(run)) as media:
        return media.picture(name)


@pytest.mark.parametrize(
    "content", [b"", b"no picture", b"<svg onload='alert(1)'/>", b"%!PS-Adobe-3.0 EPSF-3.0\n"]
)
def test_what_is_no_picture_is_left_out(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.png").write_bytes(content)
    assert picture_of(tmp_path, "a.png") is None


def test_a_large_picture_is_made_small_and_leads_to_the_whole_one(tmp_path: Path) -> None:
    Image.new("RGB", (4000, 2000)).save(tmp_path / "a b#.png")
    shown = picture_of(tmp_path, "a b#.png")
    assert shown
    assert (shown.width, shown.height, shown.link) == (1280, 640, "./a%20b%23.png")


def test_a_picture_of_too_many_pixels_is_left_out(tmp_path: Path) -> None:
    Image.new("1", (20_000, 20_000)).save(tmp_path / "a.png")
    assert picture_of(tmp_path, "a.png") is None


def test_a_large_video_is_linked(tmp_path: Path) -> None:
    with (tmp_path / "video.mp4").open("wb") as file:
        file.truncate(LARGEST_VIDEO + 1)
    shown = Media(tmp_path).video("video.mp4")
    assert shown
    assert shown.src == "./video.mp4"


def test_a_graph_that_nobody_could_read_is_a_table(tmp_path: Path) -> None:
    plan = domino_plan()
    for number in range(300):
        letters = "".join(chr(97 + number // 26**place % 26) for place in range(3))
        plan["objects"].append(
            {
                "name": f"Thing {letters}",
                "systems": ["actors"],
                "dimensions": [1, 1, 1],
                "position": [0, 0, 0],
            }
        )
    tape = Tape()
    tape.add("plan", plan=plan)
    page = report_of(tape, tmp_path)
    assert not page.select("svg.graph")
    assert "too large to be drawn" in words(page.select_one("#plan"))


def test_relations_in_a_circle_are_drawn(tmp_path: Path) -> None:
    plan = domino_plan()
    plan["relations"] = [
        {"kind": "StableAgainst", "child": "Table", "parent": "Finger"},
        {"kind": "StableAgainst", "child": "Finger", "parent": "Table"},
        {"kind": "SupportedBy", "child": "Domino.01", "parents": ["Nobody"]},
    ]
    plan["motion"] = {"phases": []}
    tape = Tape()
    tape.add("plan", plan=plan)
    graph = report_of(tape, tmp_path).select_one("svg.graph")
    assert graph
    assert len(graph.select("path.line")) == 4


def test_the_same_journal_gives_the_same_report(folder: Path) -> None:
    first = write_report(folder).read_bytes()
    assert write_report(folder).read_bytes() == first
    assert [path.name for path in folder.glob("*report*")] == [NAME], "nothing is left behind"


def test_a_finding_of_many_objects_lists_only_some(tmp_path: Path) -> None:
    tape = Tape()
    tape.add("stage.began", stage="uv")
    found = [finding("W1", f"Lamp {chr(97 + n)}", "It lights nothing.", severity="soft") for n in range(20)]
    tape.add("verified", stage="uv", attempt=1, ok=True, findings=found)
    assert "and 16 more" in words(report_of(tape, tmp_path).select_one(".findings .objects"))
