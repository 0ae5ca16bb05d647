"""What the local server streams is what the package's own reader of streams takes for a message."""

from __future__ import annotations

import anthropic
import pytest
from asks import MESSAGES
from fake_messages_api import Reply, StreamError, Truncate

ASK = {"model": "claude-opus-5-5", "max_tokens": 10, "messages": [{"role": "user", "content": "Hello?"}]}
CONTENT = (
    {"type": "thinking", "thinking": "They greet me, as people do.", "signature": "signed"},
    {"type": "text", "text": "Good day. 🙂"},
    {"type": "tool_use", "id": "toolu_1", "name": "wave", "input": {"hand": "left", "times": [1, 2, 3]}},
)


@pytest.fixture
def client(api):
    with anthropic.Anthropic(base_url=api.base_url, api_key="key", max_retries=0, timeout=10) as one:
        yield one


def test_a_streamed_message_is_the_one_that_is_not_streamed(api, client):
    api.answer = lambda params: Reply(content=CONTENT, stop_reason="tool_use", cache_read_tokens=7)
    with client.messages.stream(**ASK) as stream:
        streamed = stream.get_final_message()
    whole = client.messages.create(**ASK)
    assert streamed.to_dict() | {"id": ""} == whole.to_dict() | {"id": ""}
    assert streamed.usage.cache_read_input_tokens == 7


def test_the_events_come_in_the_apis_order(api, client):
    api.answer = lambda params: Reply("Good day.")
    kinds = [event.type for event in client.messages.create(**ASK, stream=True)]
    assert kinds == [
        "message_start",
        "content_block_start",
        "content_block_delta",
        "content_block_stop",
        "message_delta",
        "message_stop",
    ]


def test_stream_faults_raise_the_packages_errors(api, client):
    api.fail(MESSAGES, StreamError(3), Truncate(300))
    with pytest.raises(anthropic.APIStatusError, match="Overloaded"):
        list(client.messages.create(**ASK, stream=True))
    with pytest.raises(Exception, match="incomplete chunked read"):
        list(client.messages.create(**ASK, stream=True))


USE = {"type": "tool_use", "id": "t1", "name": "wave", "input": {}}
RESULT = {"type": "tool_result", "tool_use_id": "t1", "content": "ok"}
MARK = {"cache_control": {"type": "ephemeral"}}
IMAGE = {"type": "image", "source": {"type": "base64", "media_type": "image/png", "data": "!"}}


@pytest.mark.parametrize(
    ("messages", "problem"),
    [
        ([("user", ""), ("assistant", [USE]), ("user", "Go on.")], "non-empty|non-whitespace"),
        ([("user", "Hi."), ("assistant", [USE]), ("user", "Go on.")], "without `tool_result`"),
        ([("user", "Hi."), ("assistant", "Yes?"), ("user", [RESULT])], "unexpected `tool_use_id`"),
        ([("user", []), ("assistant", "Yes?"), ("user", "Hi.")], "non-empty content"),
        ([("user", [{"type": "text", "text": "x", **MARK}] * 5)], "maximum of 4"),
        ([("user", [IMAGE])], "base64"),
        ([("user", [USE])], "can not be in `user`"),
        (
            [
                ("user", "Hi."),
                ("assistant", [USE]),
                ("user", [{**RESULT, "content": [{**IMAGE}], "is_error": True}]),
            ],
            "is_error",
        ),
    ],
)
def test_conversations_that_the_api_would_not_take_are_not_taken(client, messages, problem):
    sent = [{"role": role, "content": content} for role, content in messages]
    with pytest.raises(anthropic.BadRequestError, match=problem):
        client.messages.create(**{**ASK, "messages": sent})


def test_thinking_is_bound_to_the_conversation_before_it(api, client):
    api.answer = lambda params: Reply(content=({"type": "thinking", "thinking": "Hm."},))
    said = client.messages.create(**ASK).content[0].to_dict()
    again = [*ASK["messages"], {"role": "assistant", "content": [said]}, {"role": "user", "content": "And?"}]
    client.messages.create(**{**ASK, "messages": again})
    changed = [{"role": "user", "content": "Hello!"}, *again[1:]]
    with pytest.raises(anthropic.BadRequestError, match="bound to a different conversation"):
        client.messages.create(**{**ASK, "messages": changed})
