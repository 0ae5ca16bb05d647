"""A prompt and frames become verdicts item by item, through the real client of each provider."""

from __future__ import annotations

import io
import shutil

import pytest
from judge_apis import LISTS, PROMPT, STILL, STILL_LISTS, film
from PIL import Image

from bench.judge import questions
from bench.judge.dimensions import CHECKLISTS, DIMENSIONS
from bench.judge.judge import judge
from bench.judge.providers import identity_of
from bench.judge.verdicts import Judgement


def judged(api, frames, store=None, **given) -> Judgement:
    given = {"static": False, "provider": api.provider(), **given}
    return judge(PROMPT, frames, cache=store, **given)


def test_each_item_has_a_verdict_with_evidence_and_the_score_is_the_mean_of_the_dimensions_shares(
    api, frames
):
    found = judged(api, frames, scene="parrots_D1_01")
    assert tuple(found.dimensions) == DIMENSIONS
    assert {name: len(items) for name, items in found.dimensions.items()} == {
        "objects_present": 4,
        "spatial_relations": 2,
        "actions_visible": 2,
        "visual_quality": 3,
        "aesthetics": 4,
    }
    assert found.scores == {
        "objects_present": 0.75,
        "spatial_relations": 1.0,
        "actions_visible": 1.0,
        "visual_quality": 1.0,
        "aesthetics": 0.75,
    }
    assert found.score == 0.9
    perch = found.dimensions["objects_present"][1]
    assert (perch.id, perch.text, perch.holds) == ("objects_present.2", "a bamboo perch", False)
    assert (perch.evidence, perch.frames) == ("Seen in the middle.", (1, 5))
    assert (found.scene, found.provider, found.model) == ("parrots_D1_01", api.name, api.model)
    assert found.answered_by.startswith(api.model)
    assert found.items_by == f"{api.name}/{found.answered_by}"


def test_a_judgement_survives_being_written_and_read(api, frames):
    found = judged(api, frames)
    again = Judgement.model_validate_json(found.model_dump_json())
    assert again == found
    assert again.score == found.score


def test_what_a_model_writes_cannot_move_a_terminals_cursor(claude, frames):
    claude.script.evidence = "Seen\x1b[2J\n  twice\u202e."
    assert judged(claude, frames).dimensions["aesthetics"][0].evidence == "Seen [2J twice ."


def test_tokens_are_reported_and_the_price_if_it_is_known(claude, frames):
    found = judged(claude, frames)
    assert (found.usage.input, found.usage.output, found.usage.cached) == (1000, 200, 0)
    assert found.cost == pytest.approx((1000 * 4 + 200 * 20) / 1e6)
    assert found.items_cost == found.cost
    unknown = judged(claude, frames, provider=claude.provider(model="some-model"))
    assert (unknown.usage.input, unknown.cost, unknown.items_cost) == (1000, None, None)


def test_the_judge_sees_the_prompt_and_the_frames_and_nothing_else(api, tmp_path):
    named = film(tmp_path / "system_simworlds", note="/runs/simworlds/cloth.blend")
    judged(api, named, scene="secret_scene")
    listing, none = api.question(0)
    words, pictures = api.question(1)
    assert PROMPT in listing
    assert none == []
    assert PROMPT in words
    assert all(secret not in listing + words for secret in ("simworlds", "secret", "frame_0", str(tmp_path)))
    assert len(pictures) == 5
    for data, path in zip(pictures, named, strict=True):
        assert b"simworlds" not in data
        with Image.open(io.BytesIO(data)) as seen, Image.open(path) as given:
            assert (seen.size, seen.tobytes()) == (given.size, given.tobytes())


def test_frames_are_labelled_with_their_place_in_the_film(api, frames):
    judged(api, frames)
    words, _ = api.question(1)
    for number, share in enumerate((0, 25, 50, 75, 100), 1):
        assert f"Frame {number} of 5, at {share} % of the film:" in words


def test_a_still_is_judged_by_one_frame_and_has_no_actions(api, frames):
    api.script.lists = STILL_LISTS
    found = judge(STILL, frames[:1], static=True, provider=api.provider(), cache=None)
    assert "actions_visible" not in found.dimensions
    assert found.scores["objects_present"] == 0.5  # objects_present.2 is scripted to fail
    assert found.score == pytest.approx((0.5 + 1 + 1 + 0.75) / 4)


def test_a_dimension_without_items_has_no_score_and_does_not_count(api, frames):
    api.script.lists = {**LISTS, "relations": []}
    found = judged(api, frames)
    assert found.dimensions["spatial_relations"] == ()
    assert found.scores["spatial_relations"] is None
    assert found.score == pytest.approx((0.75 + 1 + 1 + 0.75) / 4)


def test_json_in_the_text_is_accepted_if_no_tool_is_called(claude, frames):
    claude.script.as_text = True
    assert judged(claude, frames).score == 0.9


# What is kept


def test_all_systems_are_judged_on_the_items_of_the_first(api, frames, store, tmp_path):
    first = judged(api, frames, store)
    api.script.lists = {**LISTS, "objects": LISTS["objects"][:1]}
    second = judged(api, film(tmp_path / "other", shade=60), store)
    assert api.stages() == ["items", "verdicts", "verdicts"]
    asked = [[item.text for items in one.dimensions.values() for item in items] for one in (first, second)]
    assert asked[0] == asked[1]
    assert second.items_usage == first.items_usage


def test_a_cached_answer_is_not_asked_again_and_needs_no_key(api, frames, store, monkeypatch):
    first = judged(api, frames, store)
    monkeypatch.delenv("OPENAI_API_KEY")
    api.server.answer = None  # whoever asks breaks
    assert judged(api, frames, store) == first
    assert len(api.server.requests) == 2


def test_another_judge_judges_the_same_items(api, frames, store):
    first = judged(api, frames, store)
    other = judged(api, frames, store, provider=api.provider(model="another-model"))
    assert api.stages() == ["items", "verdicts", "verdicts"]
    assert (other.model, other.items_by) == ("another-model", first.items_by)


def test_a_model_of_one_name_on_another_server_is_another_judge(claude, frames, store):
    judged(claude, frames, store)
    other = claude.provider(said_address="https://elsewhere.example/v1")
    judged(claude, frames, store, provider=other)
    assert claude.stages() == ["items", "verdicts", "verdicts"]


def test_a_judge_is_known_by_the_server_that_the_environment_names(monkeypatch):
    monkeypatch.delenv("OPENAI_BASE_URL", raising=False)
    plain = identity_of("openai", "some-model")
    monkeypatch.setenv("OPENAI_BASE_URL", "http://localhost:11434/v1")
    assert identity_of("openai", "some-model") != plain
    assert identity_of("openai", "some-model").base_url == "http://localhost:11434/v1"
    assert identity_of("openai", "some-model", "http://other/v1").base_url == "http://other/v1"
    assert identity_of("anthropic").base_url != "http://localhost:11434/v1"


def test_a_repetition_is_asked_and_cached_separately(claude, frames, store):
    judged(claude, frames, store)
    claude.script.fails = ()
    assert judged(claude, frames, store, repetition=1).score == 1.0
    assert judged(claude, frames, store, repetition=0).score == 0.9
    assert claude.stages() == ["items", "verdicts", "verdicts"]


def test_a_frame_is_identified_by_its_pixels_not_its_metadata(claude, store, tmp_path):
    judged(claude, film(tmp_path / "a"), store)
    again = film(tmp_path / "b", note="rendered on a Tuesday in 00:01:12")
    assert [one.read_bytes() for one in again] != [one.read_bytes() for one in film(tmp_path / "a")]
    judged(claude, again, store)
    assert claude.stages() == ["items", "verdicts"]


@pytest.mark.parametrize("change", ["a pixel", "the order", "the prompt", "the wording", "a fixed item"])
def test_a_changed_input_makes_a_new_judgement(claude, store, frames, tmp_path, monkeypatch, change):
    judged(claude, frames, store)
    prompt, shown, asked = PROMPT, list(frames), ["verdicts"]
    if change == "a pixel":
        with Image.open(frames[2]) as image:
            image.putpixel((0, 0), (41, 90, 60))
            image.save(frames[2])
    elif change == "the order":
        shown.reverse()
    elif change == "the prompt":
        prompt, asked = f"{PROMPT} The crate is blue.", ["items", "verdicts"]
    elif change == "a fixed item":
        before = questions.prompt_version()
        monkeypatch.setitem(CHECKLISTS, "aesthetics", ("Something else.",))
        questions.prompt_version.cache_clear()
        asked = ["items", "verdicts"]
        assert questions.prompt_version() != before
    else:
        other = tmp_path / "prompts"
        shutil.copytree(questions.FOLDER, other)
        with (other / "verdicts.md").open("a", encoding="utf-8") as file:
            file.write("Be strict.")
        before = questions.prompt_version()
        monkeypatch.setattr(questions, "FOLDER", other)
        questions.prompt_version.cache_clear()
        questions._read.cache_clear()
        asked = ["items", "verdicts"]
        assert questions.prompt_version() != before
    try:
        judge(prompt, shown, static=False, provider=claude.provider(), cache=store)
    finally:
        questions.prompt_version.cache_clear()
        questions._read.cache_clear()
    assert claude.stages() == ["items", "verdicts", *asked]


def test_transparent_pixels_are_shown_on_black(claude, frames):
    clear = Image.new("RGBA", (64, 36), (255, 255, 255, 0))
    clear.paste((200, 30, 30, 255), (0, 0, 8, 8))
    clear.save(frames[0])
    judged(claude, frames)
    _, pictures = claude.question(1)
    with Image.open(io.BytesIO(pictures[0])) as seen:
        assert (seen.mode, seen.getpixel((20, 20)), seen.getpixel((2, 2))) == (
            "RGB",
            (0, 0, 0),
            (200, 30, 30),
        )
