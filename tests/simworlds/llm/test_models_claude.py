"""Claude over the real client, against a server on this machine."""

from __future__ import annotations

import base64
import threading
from itertools import pairwise

import pytest
from asks import LOOK, MESSAGES, OPUS, ask, png
from fake_messages_api import Reply, Stall, Status

from simworlds.llm.apis.attempts import Settings
from simworlds.llm.apis.claude import Claude
from simworlds.llm.errors import CutShort, Declined, Rejected, TooLong
from simworlds.llm.messages import Kept, Message, Picture, Text, Tool, ToolResult, ToolUse, Usage, user
from simworlds.llm.prices import Price, Prices

CALL = {
    "type": "tool_use",
    "id": "toolu_1",
    "name": "blender_execute",
    "input": {"code": 'print("Straße 🙂")\n', "timeout": 1.5, "more": {"deep": [None, True, []]}},
}
THOUGHT = {"type": "thinking", "thinking": "First the table, then what stands on it."}


def test_words_come_while_they_are_written_and_whole_in_the_end(api, claude):
    api.answer = lambda params: Reply("Twelve dominoes stand on the table. Schön, 🙂!")
    heard: list[str] = []
    turn = claude.answer(ask(), heard.append)
    assert turn.text == "Twelve dominoes stand on the table. Schön, 🙂!" == "".join(heard)
    assert len(heard) > 3
    assert (turn.stop_reason, turn.model, turn.live) == ("end_turn", OPUS, True)


class WaitedFor(threading.Event):
    """An event that knows whether it came while the last who waited for it did."""

    was_in_time = False

    def wait(self, timeout: float | None = None) -> bool:
        self.was_in_time = super().wait(timeout)
        return self.was_in_time


def test_the_first_words_are_heard_before_the_last_are_sent(api, claude):
    go = WaitedFor()
    api.fail(MESSAGES, Stall(after=700, seconds=60, go=go))
    api.answer = lambda params: Reply("A long answer. " * 20)
    turn = claude.answer(ask(), lambda text: go.set())
    assert turn.text == "A long answer. " * 20
    assert go.was_in_time


def test_calls_come_with_their_arguments_as_the_model_wrote_them(api, claude):
    api.answer = lambda params: Reply(
        content=({"type": "text", "text": "I begin."}, CALL), stop_reason="tool_use"
    )
    turn = claude.answer(ask())
    assert turn.content == (Text("I begin."), ToolUse("toolu_1", "blender_execute", CALL["input"]))
    assert turn.calls == (ToolUse("toolu_1", "blender_execute", CALL["input"]),)
    assert turn.stop_reason == "tool_use"


def test_a_call_without_arguments_has_none(api, claude):
    api.answer = lambda params: Reply(content=({**CALL, "input": {}},), stop_reason="tool_use")
    assert claude.answer(ask()).calls[0].input == {}


def test_a_model_that_says_nothing_gives_an_empty_turn(api, claude):
    api.answer = lambda params: Reply("")
    turn = claude.answer(ask())
    assert (turn.content, turn.text, turn.stop_reason) == ((), "", "end_turn")
    claude.answer(ask("Begin.", turn.message(), "Go on."))  # the API takes no empty message


def test_thinking_is_shown_and_goes_back_as_it_came(api, claude):
    api.answer = lambda params: Reply(content=(THOUGHT, CALL), stop_reason="tool_use")
    heard: list[str] = []
    turn = claude.answer(ask(), heard.append)
    assert "".join(heard) == THOUGHT["thinking"]
    assert isinstance(turn.content[0], Kept)
    assert turn.text == ""
    api.answer = lambda params: Reply("Done.")
    done = claude.answer(ask("Begin.", turn.message(), user(ToolResult("toolu_1", (Text("ok"),)))))
    assert done.text == "Done."  # the server checks the signature
    assert api.requests[-1].body["thinking"] == {"type": "adaptive", "display": "summarized"}


@pytest.mark.parametrize("model", ["claude-sonnet-4-6", "claude-haiku-4-5-20251001", "some-other-model"])
def test_older_models_get_no_thinking_parameter(api, claude, model):
    claude.answer(ask(model=model))
    assert "thinking" not in api.requests[-1].body


def test_pictures_reach_the_model_alone_and_in_results(api, claude):
    used = Message("assistant", (ToolUse("t1", LOOK.name, {"name": "Chair"}),))
    shown = user(ToolResult("t1", (Text("The chair."), Picture(png()))), Picture(png(8, 8)), "And this?")
    claude.answer(ask("Show the chair.", used, shown))
    result, alone, _ = api.requests[-1].body["messages"][-1]["content"]
    assert base64.b64decode(result["content"][1]["source"]["data"]) == png()
    assert alone["source"]["media_type"] == "image/png"


def test_invalid_content_is_adapted_to_the_api(api, claude):
    used = Message(
        "assistant", (Text(" \n"), ToolUse("t1", LOOK.name, {}), ToolUse("t2", "blender_execute", {}))
    )
    results = user(
        ToolResult("t1", (Text("It broke: half a character \ud83d."), Picture(png())), failed=True),
        ToolResult("t2", (Text(" "),), failed=True),
        "  ",
    )
    claude.answer(ask("Begin.", used, results, system=("", "Be brief.")))
    sent = api.requests[-1].body["messages"]
    assert [block["type"] for block in sent[1]["content"]] == ["tool_use", "tool_use"]
    broken, empty = sent[2]["content"]
    assert broken["content"][0]["text"] == "It broke: half a character ?."
    assert (empty["is_error"], empty["content"]) == (True, [{"type": "text", "text": "(nothing)"}])


def test_the_prompt_is_kept_and_read_again_at_every_turn(api, claude):
    api.answer = lambda params: Reply(content=(CALL,), stop_reason="tool_use", input_tokens=None)
    messages = [user("Build a table. " * 40)]
    usages = []
    for number in range(4):
        call = {**CALL, "id": f"toolu_{number}"}
        api.answer = lambda params, call=call: Reply(
            content=(call,), stop_reason="tool_use", input_tokens=None
        )
        turn = claude.answer(ask(*messages))
        usages.append(turn.usage)
        messages += [turn.message(), user(*(ToolResult(use.id, (Text("done " * 50),)) for use in turn.calls))]
    assert usages[0].cache_read == 0 < usages[0].cache_write
    for before, after in pairwise(usages):
        assert after.cache_read == before.prompt  # all of the last request
        assert after.input == 0 < after.cache_write


def test_marks_stand_behind_tools_system_prompt_and_the_last_two_messages_of_the_user(api, claude):
    said = Message("assistant", (Text("Yes."),))
    claude.answer(ask("One.", said, "Two.", said, "Three."))
    body = api.requests[-1].body
    marked = ["cache_control" in message["content"][-1] for message in body["messages"]]
    assert marked == [False, False, True, False, True]
    assert ["cache_control" in tool for tool in body["tools"]] == [False, True]
    assert ["cache_control" in part for part in body["system"]] == [False, True]


def test_tokens_and_cost_are_reported_by_kind(api, claude):
    api.answer = lambda params: Reply(
        input_tokens=1000, output_tokens=500, cache_read_tokens=20_000, cache_write_tokens=4000
    )
    turn = claude.answer(ask())
    assert turn.usage == Usage(input=1000, output=500, cache_read=20_000, cache_write=4000)
    assert turn.cost == pytest.approx((1000 * 4 + 500 * 20 + 20_000 * 0.2 + 4000 * 5) / 1e6)


def test_a_model_without_a_known_price_has_no_cost_but_tokens(make_claude):
    unknown = make_claude().answer(ask(model="llama-of-mine"))
    assert (unknown.cost, unknown.usage.output) == (None, 20)
    priced = make_claude(prices=Prices({"llama-of-mine": Price(1, 2)})).answer(ask(model="llama-of-mine"))
    assert priced.cost == pytest.approx(140e-6)


def test_a_refusal_keeps_the_text_and_the_reason(api, claude):
    why = {"type": "refusal", "category": "cyber", "explanation": "It asks for malware."}
    api.answer = lambda params: Reply("I would rather", stop_reason="refusal", stop_details=why)
    with pytest.raises(Declined, match=r"declined.*cyber: It asks for malware") as refused:
        claude.answer(ask())
    assert refused.value.turn.text == "I would rather"
    assert refused.value.turn.usage.output == 20


@pytest.mark.parametrize("reason", ["max_tokens", "model_context_window_exceeded"])
def test_a_cut_off_answer_keeps_its_complete_blocks(api, claude, reason):
    half = {**CALL, "id": "toolu_2", "input": '{"code": "import bp'}
    content = ({"type": "text", "text": "I begin."}, CALL, half)
    api.answer = lambda params: Reply(content=content, stop_reason=reason)
    with pytest.raises(CutShort, match="after 20 tokens") as cut:
        claude.answer(ask())
    assert [type(block) for block in cut.value.turn.content] == [Text, ToolUse]
    assert cut.value.turn.live


def test_stop_reasons_that_are_not_known_yet_are_passed_on(api, claude):
    api.answer = lambda params: Reply("Well.", stop_reason="tired")
    assert claude.answer(ask()).stop_reason == "tired"


def test_unknown_blocks_are_kept(api, claude):
    new = {"type": "hologram", "data": "…"}
    api.answer = lambda params: Reply(content=(new, {"type": "text", "text": "Look."}))
    assert claude.answer(ask()).content == (Kept(new), Text("Look."))


def test_a_missing_key_is_an_error(monkeypatch):
    with pytest.raises(Rejected, match="ANTHROPIC_API_KEY"):
        Claude()
    monkeypatch.setenv("ANTHROPIC_API_KEY", "sk\n-x")
    with pytest.raises(Rejected, match="Copy the key again"):
        Claude()


@pytest.mark.parametrize("url", ["ftp://somewhere", "http://", "http://[::1", "somewhere"])
def test_an_invalid_address_is_an_error(url):
    with pytest.raises(Rejected, match="address"):
        Claude(Settings(api_key="key", base_url=url))


def test_key_and_address_come_from_the_environment(api, monkeypatch):
    monkeypatch.setenv("ANTHROPIC_BASE_URL", api.base_url)
    monkeypatch.setenv("ANTHROPIC_AUTH_TOKEN", "token")
    one = Claude()
    one.answer(ask())
    one.close()
    assert api.requests[-1].headers["authorization"] == "Bearer token"
    assert one.address.startswith(api.base_url)


def test_an_invalid_request_is_not_retried(api, claude):
    with pytest.raises(Rejected, match=r"tools\.0") as rejected:
        claude.answer(ask(tools=(Tool("a tool", "", {}),)))
    assert rejected.value.status == 400
    assert len(api.requests) == 1


def test_too_long_a_conversation_has_its_own_error(api, claude):
    body = '{"type": "error", "error": {"type": "invalid_request_error", "message": "prompt is too long: 2 > 1"}}'
    api.fail(MESSAGES, Status(400, body=body), Status(413))
    for _ in range(2):
        with pytest.raises(TooLong, match="too long"):
            claude.answer(ask())


def test_a_form_is_a_structured_output(api, claude):
    schema = {"type": "object", "properties": {"ok": {"type": "boolean"}}, "required": ["ok"]}
    claude.answer(ask(form=Tool("verdict", "Whether it is right.", schema)))
    told = api.received(MESSAGES)[0].body["output_config"]["format"]
    assert (told["type"], told["schema"]["required"]) == ("json_schema", ["ok"])
