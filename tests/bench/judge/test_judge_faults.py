"""Whatever a model, a server or a file does: there is a whole judgement, or none and the reason why."""

from __future__ import annotations

import sys
from contextlib import closing
from typing import TYPE_CHECKING, Any

import pytest
from fake_messages_api import Drop, Raw, Status, Truncate
from judge_apis import LISTS, PROMPT, STILL, STILL_LISTS, OpenAI, verdicts
from PIL import Image

from bench.judge.errors import NotJudged
from bench.judge.judge import LONGEST_PROMPT, judge
from bench.judge.providers import provider_of
from simworlds.llm.prices import Price

if TYPE_CHECKING:
    from pathlib import Path

HTML = b"HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nContent-Length: 6\r\nConnection: close\r\n\r\n<html>"
SOON = {"retry-after-ms": "1"}


def judged(api, frames, store=None, **given):
    given = {"static": False, "provider": api.provider(), **given}
    return judge(PROMPT, frames, cache=store, **given)


# What passes


@pytest.mark.parametrize(
    "fault", [Status(429, SOON), Status(503, SOON), Status(529, SOON), Drop(), Truncate(40)], ids=str
)
def test_passing_errors_are_retried(api, frames, fault):
    api.fail(fault)
    assert judged(api, frames).score == 0.9
    assert api.stages() == ["items", "items", "verdicts"]


# What a model may get wrong

WRONG: dict[str, tuple[Any, str]] = {
    "an item is missing": (
        lambda ids: verdicts(ids[1:]),
        "'objects_present.1': the verdict for this item is missing",
    ),
    "an item is unknown": (
        lambda ids: verdicts([*ids, "objects_present.9"]),
        "'objects_present.9': there is no such",
    ),
    "an item comes twice": (
        lambda ids: verdicts([ids[0], *ids]),
        "'objects_present.1': there are 2 verdicts",
    ),
    "a frame is none": (lambda ids: verdicts(ids, frames=[2, 6]), "there is no frame 6"),
    "no frame shows it": (lambda ids: verdicts(ids, frames=[]), "no frame that shows it is named"),
    "one frame shows a motion": (
        lambda ids: verdicts(ids, frames=[3, 3]),
        "'actions_visible.1': one frame shows no",
    ),
    "the evidence is missing": (lambda ids: verdicts(ids, evidence=" "), "the evidence is missing"),
    "the evidence is a book": (lambda ids: verdicts(ids, evidence="x" * 1001), "the evidence is too long"),
    "a verdict is no yes or no": (lambda ids: verdicts(ids, holds="partly"), "verdicts[0].holds"),
    "a verdict is more than asked": (lambda ids: verdicts(ids, score=3), "verdicts[0].score"),
}


@pytest.mark.parametrize("name", WRONG)
def test_invalid_verdicts_go_back_with_their_faults(claude, frames, name):
    make, told = WRONG[name]
    claude.script.instead["verdicts"].append(lambda ids: {"verdicts": make(ids)})
    assert judged(claude, frames).score == 0.9
    assert claude.stages() == ["items", "verdicts", "verdicts"]
    assert told in claude.question(2)[0]


@pytest.mark.parametrize("text", ['{"verdicts": [', "It looks very nice.", "", '{"verdicts": NaN}'])
def test_an_answer_that_is_not_json_goes_back(api, frames, text):
    api.script.instead["verdicts"].append(text)
    assert judged(api, frames).score == 0.9
    assert api.stages() == ["items", "verdicts", "verdicts"]
    words, pictures = api.question(2)
    assert "Your answer cannot be taken as it is" in words
    assert len(pictures) == 5


def test_repeated_invalid_answers_give_no_judgement_and_count_their_cost(claude, frames, store):
    claude.script.instead["verdicts"].extend([lambda ids: {"verdicts": verdicts(ids[1:])}] * 3)
    with pytest.raises(
        NotJudged, match=r"All 3 answers were invalid\. The last: 'objects_present.1': the verdict"
    ) as caught:
        judged(claude, frames, store)
    assert caught.value.reason == "malformed"
    assert (caught.value.spent.usage.input, caught.value.spent.usage.output) == (3000, 600)
    assert caught.value.spent.cost == pytest.approx(3 * (1000 * 4 + 200 * 20) / 1e6)
    assert judged(claude, frames, store).score == 0.9  # nothing of it was kept but the items
    assert claude.stages() == ["items", *["verdicts"] * 4]


def test_a_refusal_gives_no_judgement(api, frames):
    api.script.instead["verdicts"].append(api.refusal())
    with pytest.raises(NotJudged, match="declined to answer: not this") as caught:
        judged(api, frames)
    assert caught.value.reason == "refused"
    assert caught.value.spent.usage.output == 20
    assert len(api.server.requests) == 2


def test_a_cut_off_answer_is_asked_for_again_a_few_times(api, frames):
    api.script.instead["verdicts"].append(api.cut())
    assert judged(api, frames).score == 0.9
    api.script.instead["verdicts"].extend([api.cut()] * 3)
    with pytest.raises(NotJudged, match="cut off") as caught:
        judged(api, frames)
    assert (caught.value.reason, caught.value.spent.usage.output) == ("cut short", 48_000)


BAD_LISTS: dict[str, tuple[dict[str, Any], str]] = {
    "words of nobody": (
        {"words": "a toucan", "text": "a toucan"},
        "objects[4]: the words 'a toucan' are not in",
    ),
    "words put together": (
        {"words": "two crate", "text": "a crate"},
        "objects[4]: the words 'two crate' are not in",
    ),
    "no words": ({"words": "", "text": "a crate"}, "objects[4]: the words '' are not in"),
    "words that say nothing": (
        {"words": "on a", "text": "on a thing"},
        "objects[4]: the words 'on a' are not in",
    ),
    "something else on top": ({"words": "market stall", "text": "a red awning"}, "uses none of the words"),
    "the same again": ({"words": "crate", "text": "the crate"}, "objects[4]: it is the same as objects[3]"),
    "half the prompt": ({"words": PROMPT, "text": "two parrots at noon"}, "words; quote at most 25"),
    "a text without end": ({"words": "stall", "text": "stall " * 50}, "objects[4]: the text is too long"),
}


@pytest.mark.parametrize("name", BAD_LISTS)
def test_a_list_that_the_prompt_does_not_support_goes_back(claude, frames, name):
    entry, told = BAD_LISTS[name]
    claude.script.instead["items"].append({**LISTS, "objects": [*LISTS["objects"], entry]})
    assert judged(claude, frames).score == 0.9
    assert claude.stages() == ["items", "items", "verdicts"]
    assert told in claude.question(1)[0]


@pytest.mark.parametrize(
    ("lists", "told"),
    [
        ({**LISTS, "objects": []}, "objects: the list is empty"),
        ({**LISTS, "actions": []}, "actions: the list is empty"),
        ({"objects": [], "relations": []}, "actions: Field required"),
        (
            {**LISTS, "relations": [{"words": "crate", "text": f"crate {n}"} for n in range(41)]},
            "relations: 41 items are too many; list at most 40",
        ),
    ],
)
def test_an_empty_or_too_long_list_goes_back(claude, frames, lists, told):
    claude.script.instead["items"].append(lists)
    judged(claude, frames)
    assert told in claude.question(1)[0]


def test_a_still_has_no_actions(claude, frames):
    claude.script.lists = STILL_LISTS
    action = {"words": "harp leans", "text": "the harp leans over"}
    claude.script.instead["items"].append({**STILL_LISTS, "actions": [action]})
    judge(STILL, frames[:1], static=True, provider=claude.provider(), cache=None)
    assert "actions: nothing happens in a still" in claude.question(1)[0]


def test_quotations_match_whatever_their_case_and_punctuation(claude, frames):
    entry = {"words": "MARKET  stall; the left", "text": "a market stall"}
    claude.script.instead["items"].append({**LISTS, "objects": [entry]})
    assert judged(claude, frames).dimensions["objects_present"][0].text == "a market stall"


# What does not pass


@pytest.mark.parametrize(
    ("status", "advice"), [(401, "Check the key"), (404, "Check the model's name"), (400, "")]
)
def test_a_rejected_request_is_not_repeated(api, frames, status, advice):
    api.fail(Status(status))
    with pytest.raises(NotJudged, match=f"(does not take|rejects) the request: {status}.*{advice}") as caught:
        judged(api, frames)
    assert (caught.value.reason, len(api.server.requests)) == ("rejected", 1)


def test_a_server_that_never_answers_is_given_up(api, frames):
    api.fail(*[Status(500, SOON)] * 3)
    with pytest.raises(NotJudged, match=r"No answer from http://127\.0\.0\.1.*500") as caught:
        judged(api, frames, provider=api.provider(tries=2))
    assert (caught.value.reason, len(api.server.requests)) == ("unreachable", 2)


def test_a_reply_that_is_not_the_apis_is_not_accepted(api, frames):
    api.fail(*[Raw(HTML)] * 3)
    with pytest.raises(NotJudged, match=r"No answer from|is not a valid completion") as caught:
        judged(api, frames, provider=api.provider(tries=1))
    assert caught.value.reason == "unreachable"


def test_a_refused_connection_is_reported(frames):
    api = OpenAI()
    api.server._server.server_close()
    with pytest.raises(NotJudged, match=r"No answer from http://127\.0\.0\.1.*refused"):
        judged(api, frames, provider=api.provider(tries=1))


@pytest.mark.parametrize("name", ["anthropic", "openai"])
@pytest.mark.parametrize("address", ["nonsense", "ftp://models.invalid", "http://[::1"])
def test_an_invalid_address_is_reported_before_any_request(name, address):
    with pytest.raises(NotJudged, match="The address of the model") as caught:
        provider_of(name, base_url=address).ready()
    assert caught.value.reason == "not set up"


NOWHERE = b"HTTP/1.1 302 Found\r\nLocation: http://[::1\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"


def test_a_redirect_to_an_invalid_address_gives_no_answer(api, frames):
    api.fail(Raw(NOWHERE))
    with pytest.raises(NotJudged, match="No answer from") as caught:
        judged(api, frames, provider=api.provider(tries=1))
    assert caught.value.reason == "unreachable"


def test_a_question_that_could_exceed_the_limit_is_not_asked(claude, frames):
    with pytest.raises(NotJudged, match=r"The limit of \$0.01 is reached") as caught:
        judged(claude, frames, provider=claude.provider(max_cost=0.01))
    assert (caught.value.reason, claude.server.requests) == ("over budget", [])


def test_a_limit_needs_a_price(api, frames):
    with pytest.raises(NotJudged, match="No price is known for the model 'some-model'") as caught:
        judged(api, frames, provider=api.provider(model="some-model", max_cost=5))
    assert (caught.value.reason, api.server.requests) == ("over budget", [])


def test_a_given_price_counts(api, frames):
    provider = provider_of(
        api.name, model="some-model", base_url=api.server.base_url, price=Price(10.0, 100.0), max_cost=9
    )
    with closing(provider):
        assert judged(api, frames, provider=provider).cost == pytest.approx((1000 * 10 + 200 * 100) / 1e6)


@pytest.mark.parametrize(("name", "key"), [("anthropic", "ANTHROPIC_API_KEY"), ("openai", "OPENAI_API_KEY")])
def test_without_a_key_it_says_which(frames, monkeypatch, name, key):
    monkeypatch.delenv(key)
    provider = provider_of(name)
    with pytest.raises(NotJudged, match=key) as caught:
        provider.ready()
    assert caught.value.reason == "not set up"
    with pytest.raises(NotJudged, match=key):
        judge(PROMPT, frames, static=False, provider=provider, cache=None)


@pytest.mark.parametrize("key", ["clé", "two\nlines"])
def test_an_invalid_key_is_not_sent(monkeypatch, key):
    monkeypatch.setenv("OPENAI_API_KEY", key)
    with pytest.raises(NotJudged, match="OPENAI_API_KEY contains characters that are not allowed"):
        provider_of("openai").ready()


def test_without_the_extra_it_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "openai", None)
    with pytest.raises(NotJudged, match=r"pip install 'simworlds\[openai\]'") as caught:
        provider_of("openai")
    assert caught.value.reason == "not set up"
    with closing(provider_of("anthropic")) as provider:
        provider.ready()


def test_an_unknown_provider_is_reported():
    with pytest.raises(ValueError, match=r"no provider 'gemini'\. Choose anthropic or openai"):
        provider_of("gemini")


# What is given


@pytest.mark.parametrize("prompt", ["", " \n ", "x" * (LONGEST_PROMPT + 1)])
def test_an_empty_or_too_long_prompt_is_not_judged(claude, frames, prompt):
    with pytest.raises(NotJudged) as caught:
        judge(prompt, frames, static=False, provider=claude.provider(), cache=None)
    assert (caught.value.reason, claude.server.requests) == ("prompt", [])


def _missing(path: Path) -> None:
    path.unlink()


def _half(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:90])


def _text(path: Path) -> None:
    path.write_text("no picture")


def _huge(path: Path) -> None:
    Image.new("1", (10_000, 10_000)).save(path)


@pytest.mark.parametrize("spoil", [_missing, _half, _text, _huge])
def test_unreadable_frames_are_found_before_any_request(claude, frames, spoil):
    spoil(frames[3])
    with pytest.raises(NotJudged, match=r"frame_3\.png") as caught:
        judged(claude, frames)
    assert (caught.value.reason, claude.server.requests) == ("frames", [])


@pytest.mark.parametrize(("count", "static"), [(1, False), (21, False), (0, False), (2, True), (0, True)])
def test_the_number_of_frames_is_checked(claude, frames, count, static):
    with pytest.raises(NotJudged, match=f"Give .*, not {count}") as caught:
        judge(PROMPT, frames[:1] * count, static=static, provider=claude.provider(), cache=None)
    assert caught.value.reason == "frames"
