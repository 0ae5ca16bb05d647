"""The report's command, and its page: every scene with its evidence, in one file, whatever the results hold."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from html.parser import HTMLParser
from typing import TYPE_CHECKING, Any

import pytest
from click.testing import CliRunner
from hostile_text import HOSTILE, steering

from bench.sweep.records import read_record, write_record
from simworlds.cli import main

if TYPE_CHECKING:
    from pathlib import Path

    from click.testing import Result
    from written_results import Written

EVIL = '<script>alert("x")</script><img src=x onerror=alert(1)>'
AUDIT: dict[str, Any] = {
    "scene": "cloth_D1_01",
    "actors": [
        {
            "name": "tablecloth",
            "role": "cloth",
            "outcome": "resolved",
            "by": "name",
            "evidence": {"objects": [f"Cloth {EVIL}"]},
            "score": 0.5,
            "checks": [
                {
                    "predicate": "renderable",
                    "wanted": "must_have",
                    "outcome": "passed",
                    "seen": {"object": "Cloth"},
                },
                {
                    "predicate": "cloth_cache_baked",
                    "wanted": "must_have",
                    "outcome": "failed",
                    "seen": {"caches": [{"frames": 12, "frames_expected": 60}], "object": EVIL},
                },
            ],
        }
    ],
    "relations": [
        {
            "type": "SupportedBy",
            "a": "tablecloth",
            "b": "table",
            "outcome": "does not hold",
            "moments": [{"when": "end", "unit": "Cloth", "outcome": "does not hold", "seen": {"gap": 0.31}}],
        }
    ],
    "blend": {"unplayed": ""},
}
JUDGEMENT: dict[str, Any] = {
    "scene": "cloth_D1_01",
    "provider": "anthropic",
    "model": "a-judge",
    "answered_by": "a-judge",
    "prompt_version": "1",
    "repetition": 0,
    "dimensions": {
        "objects_present": [
            {"id": "objects_present.1", "text": "a tablecloth", "holds": False, "evidence": f"No. {EVIL}"}
        ],
        "spatial_relations": [],
    },
    "usage": {},
    "cost": 0.01,
    "items_by": "a-judge",
    "items_usage": {},
    "items_cost": 0.01,
}


class Seen(HTMLParser):
    """What a browser would make of a page: its elements with their attributes, and its text."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self._in_script = False
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        self._in_script = tag in ("script", "style")

    def handle_endtag(self, tag: str) -> None:
        self._in_script = False

    def handle_data(self, data: str) -> None:
        if not self._in_script:
            self.text += data

    def of(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.elements if name == tag]


def reported(results: Written, *words: str) -> Result:
    return CliRunner().invoke(main, ["bench", "report", str(results.folder), *words])


def page_of(results: Written) -> Seen:
    done = reported(results)
    assert done.exit_code == 0, done.output
    return Seen((results.folder / "report.html").read_text("utf-8"))


@pytest.fixture
def full(results: Written) -> Written:
    results.add(
        "mine", "cloth_D1_01", 0.5, 0.0, 0.25, audit=AUDIT, judgement=JUDGEMENT, frames=5, prompt=EVIL
    )
    results.add("theirs", "cloth_D1_01", why=EVIL)
    results.add("mine", "static_D1_01", 1.0, 1.0)
    return results


# The page


def test_each_scene_shows_its_prompt_frames_and_failed_checks_with_values(full: Written) -> None:
    seen = page_of(full)
    assert "A red tablecloth drapes over a small round wooden table" in seen.text
    frames = [image for image in seen.of("img") if image.get("src")]
    assert [str(image["src"])[:23] for image in frames] == ["data:image/webp;base64,"] * 5
    assert all(
        f"at {share} %" in str(frames[place]["alt"]) for place, share in enumerate((0, 25, 50, 75, 100))
    )
    assert "frames 12, frames expected 60" in seen.text
    assert "end: Cloth gap 0.31" in seen.text
    assert "a tablecloth" in seen.text
    failing = [item for item in seen.of("li") if item.get("class") == "no"]
    assert len(failing) == 3


def test_a_failed_check_links_to_its_definition(full: Written) -> None:
    seen = page_of(full)
    links = {link["href"]: link.get("title") for link in seen.of("a")}
    ids = {one["id"] for one in seen.of("dt") if "id" in one}
    assert {"is-cloth_cache_baked", "is-SupportedBy"} <= ids
    assert "bak" in str(links["#is-cloth_cache_baked"])


def test_systems_are_side_by_side_with_the_reason_for_a_missing_score(full: Written) -> None:
    seen = page_of(full)
    cards = [one for one in seen.of("section") if one.get("class") == "card"]
    assert len(cards) == 4
    assert f"MPR: not scored: {EVIL}" in seen.text
    assert "this scene was not given to the system" in seen.text


def test_text_from_results_is_escaped(full: Written) -> None:
    seen = page_of(full)
    assert EVIL in seen.text
    assert len(seen.of("script")) == 1
    assert not any(name.startswith("on") for _, attributes in seen.elements for name in attributes)


def test_the_page_needs_no_network_and_runs_no_script_but_its_own(full: Written) -> None:
    seen = page_of(full)
    text = (full.folder / "report.html").read_text("utf-8")
    (policy,) = (str(one["content"]) for one in seen.of("meta") if "Content-Security-Policy" in one.values())
    script = re.search(r"<script>(.*)</script>", text, re.DOTALL)
    assert script is not None
    digest = base64.b64encode(hashlib.sha256(script[1].encode()).digest()).decode()
    assert policy.startswith("default-src 'none'")
    assert f"script-src 'sha256-{digest}'" in policy
    assert not seen.of("link")
    assert all(str(link["href"]).startswith("#") for link in seen.of("a"))


def test_scenes_can_be_filtered_by_category_level_and_failure(full: Written) -> None:
    scenes = {one["id"]: one for one in page_of(full).of("article")}
    assert scenes["cloth_D1_01"]["data-category"] == "cloth"
    assert scenes["static_D1_01"]["data-level"] == "D1"
    assert "data-failed" in scenes["cloth_D1_01"]


@pytest.mark.parametrize("path", ["../../../secret.png", "/etc/passwd", "frames/../../../../secret.png"])
def test_no_file_outside_a_scenes_folder_gets_onto_the_page(path: str, full: Written) -> None:
    folder = full.folder / "mine" / "cloth_D1_01"
    secret = full.folder.parent / "secret.png"
    secret.write_bytes((folder / "frames" / "000.png").read_bytes())
    found = read_record(folder)
    assert found is not None
    assert found.framed is not None
    frame = found.framed.frames[0].model_copy(update={"path": path})
    framed = found.framed.model_copy(update={"frames": (frame,)})
    write_record(folder, found.model_copy(update={"framed": framed}))
    seen = page_of(full)
    assert not [image for image in seen.of("img") if image.get("src")]
    assert "cloth_D1_01/record.json is not a valid record: framed.frames.0.path" in seen.text


def test_a_link_out_of_a_scenes_folder_is_not_followed(full: Written) -> None:
    frame = full.folder / "mine" / "cloth_D1_01" / "frames" / "000.png"
    frame.rename(full.folder / "secret.png")
    frame.symlink_to(full.folder / "secret.png")
    assert len([image for image in page_of(full).of("img") if image.get("src")]) == 4


@pytest.mark.parametrize("name", ["audit.json", "judgement.json", "frames/000.png"])
def test_damaged_or_missing_evidence_is_left_out(name: str, full: Written) -> None:
    path = full.folder / "mine" / "cloth_D1_01" / name
    path.write_bytes(b"[[[")
    assert "A red tablecloth" in page_of(full).text
    path.unlink()
    assert "A red tablecloth" in page_of(full).text


@pytest.mark.parametrize("objects", [5, [[1]], {"a": 1}, None])
def test_an_audit_with_values_of_other_kinds_is_left_out(objects: object, full: Written) -> None:
    actor = {**AUDIT["actors"][0], "evidence": {"objects": objects}}
    full.add("mine", "cloth_D1_01", 0.5, 0.0, audit={**AUDIT, "actors": [actor]})
    seen = page_of(full)
    assert "A red tablecloth" in seen.text
    assert "frames 12, frames expected 60" not in seen.text


def test_a_frame_with_any_name_is_shown(full: Written) -> None:
    folder = full.folder / "mine" / "cloth_D1_01"
    found = read_record(folder)
    assert found is not None
    assert found.framed is not None
    frame = found.framed.frames[0]
    path = f"frames/{'0' * 100}.png"
    (folder / frame.path).rename(folder / path)
    frames = (frame.model_copy(update={"path": path}), *found.framed.frames[1:])
    write_record(
        folder,
        found.model_copy(update={"framed": found.framed.model_copy(update={"frames": frames})}),
    )
    labels = [str(image["alt"]) for image in page_of(full).of("img") if image.get("src")]
    assert labels[:2] == ["cloth_D1_01 by mine", "cloth_D1_01 by mine at 25 %"]


def test_a_frame_that_no_file_can_be_called_is_left_out(full: Written) -> None:
    folder = full.folder / "mine" / "cloth_D1_01"
    record = (folder / "record.json").read_text()
    (folder / "record.json").write_text(record.replace("frames/000.png", f"frames/{'1' * 5000}.png"))
    assert len([image for image in page_of(full).of("img") if image.get("src")]) == 4


# The command


def test_tables_are_printed_and_written(full: Written, tmp_path: Path) -> None:
    done = reported(full, "--markdown", str(tmp_path / "a.md"), "--json", str(tmp_path / "a.json"), "--html",
                    str(tmp_path / "a.html"))  # fmt: skip
    assert done.exit_code == 0, done.output
    assert (tmp_path / "a.md").read_text() == done.stdout
    assert "## Results by category" in done.stdout
    numbers = json.loads((tmp_path / "a.json").read_text())
    assert numbers["systems"]["mine"]["figures"]["mpr"]["overall"]["value"] == 0.5
    assert numbers["systems"]["theirs"]["scenes"]["cloth_D1_01"]["why_not"]["mpr"] == EVIL
    assert numbers["bootstrap"] == {"seed": 0, "draws": 10_000, "level": 0.95}
    assert (tmp_path / "a.html").is_file()
    assert not (full.folder / "report.html").exists()


def test_text_from_results_cannot_steer_the_terminal(full: Written) -> None:
    full.add("mine", "cloth_D1_02", why=HOSTILE, prompt=HOSTILE)
    (full.folder / HOSTILE[:4] / HOSTILE.replace("/", "")).mkdir(parents=True)
    (full.folder / HOSTILE[:4] / HOSTILE.replace("/", "") / "record.json").write_text("{")
    for words in ((), ("--json", "-")):
        done = reported(full, *words)
        assert "evil" in done.output
        assert steering(done.output) == []


def test_figures_can_be_printed_as_json(full: Written) -> None:
    assert json.loads(reported(full, "--json", "-").stdout)["systems"].keys() == {"mine", "theirs"}


def test_unreadable_results_are_named_and_the_rest_is_reported(full: Written) -> None:
    (full.folder / "mine" / "static_D1_01" / "record.json").write_text("{")
    other = full.folder / "mine" / "cloth_D9_01"
    other.mkdir()
    record = (full.folder / "mine" / "cloth_D1_01" / "record.json").read_text()
    (other / "record.json").write_text(record.replace("cloth_D1_01", "cloth_D9_01"))
    done = reported(full)
    assert done.exit_code == 0
    assert "static_D1_01/record.json is not a valid record" in done.stdout
    assert "There is no scene 'cloth_D9_01'" in done.stdout


def test_a_second_result_of_a_scene_is_ignored_and_reported(full: Written, tmp_path: Path) -> None:
    second = type(full)(tmp_path / "second")
    second.add("mine", "cloth_D1_01", 1.0, 1.0)
    done = CliRunner().invoke(main, ["bench", "report", str(full.folder), str(second.folder)])
    assert "mine has another result for cloth_D1_01; this one is ignored" in done.stdout


def test_missing_results_and_unknown_systems_are_errors(full: Written, tmp_path: Path) -> None:
    done = CliRunner().invoke(main, ["bench", "report", str(tmp_path / "none")])
    assert (done.exit_code, "Make some with 'simworlds bench run'" in done.stderr) == (2, True)
    done = reported(full, "--baseline", "viga")
    assert (done.exit_code, "Choose one of: mine, theirs" in done.stderr) == (2, True)


def test_an_estimate_is_printed_as_text_and_as_json(full: Written) -> None:
    done = CliRunner().invoke(main, ["bench", "estimate", str(full.folder)])
    assert done.exit_code == 0
    assert "times measured for 2 of 50 scenes" in done.stdout
    assert "10 systems on 20 machines, 2 scenes in parallel on each" in done.stdout
    numbers = json.loads(CliRunner().invoke(main, ["bench", "estimate", str(full.folder), "--json"]).stdout)
    assert numbers["work"]["audited"] == 50
