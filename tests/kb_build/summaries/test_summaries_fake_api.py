"""The local server that stands for Anthropic's API, seen through the real client."""

from __future__ import annotations

from typing import TYPE_CHECKING

import anthropic
import pytest
from fake_messages_api import Drop, Ended, FakeMessagesAPI, Hang, Reply, Status

if TYPE_CHECKING:
    from collections.abc import Iterator

ASK = {"model": "claude-haiku-5-5", "max_tokens": 10, "messages": [{"role": "user", "content": "Hello?"}]}
MESSAGES = "POST /v1/messages"


@pytest.fixture
def api() -> Iterator[FakeMessagesAPI]:
    with FakeMessagesAPI(lambda params: Reply(f"You said {params['messages'][-1]['content']}")) as server:
        yield server


@pytest.fixture
def client(api) -> Iterator[anthropic.Anthropic]:
    with anthropic.Anthropic(base_url=api.base_url, api_key="key", max_retries=0, timeout=10) as one:
        yield one


def test_messages_are_answered_and_remembered(api, client):
    message = client.messages.create(**ASK)
    assert message.content[0].text == "You said Hello?"
    assert (message.stop_reason, message.usage.input_tokens) == ("end_turn", 100)
    assert [request.body for request in api.received(MESSAGES)] == [ASK]


def test_a_tool_call_can_be_scripted(api, client):
    use = {"type": "tool_use", "id": "toolu_1", "name": "blender_docs", "input": {"query": "cloth"}}
    api.answer = lambda params: Reply(content=(use,), stop_reason="tool_use")
    (block,) = client.messages.create(**ASK).content
    assert (block.type, block.name, block.input) == ("tool_use", "blender_docs", {"query": "cloth"})


def test_tokens_are_counted_and_models_listed(client):
    counted = client.messages.count_tokens(model=ASK["model"], messages=ASK["messages"])
    assert counted.input_tokens > 0
    assert "claude-haiku-5-5" in [model.id for model in client.models.list()]
    assert client.models.retrieve("claude-opus-5-5").lifecycle == "active"
    with pytest.raises(anthropic.NotFoundError):
        client.models.retrieve("claude-none")


@pytest.mark.parametrize(
    ("fault", "error"),
    [
        (Status(429, {"retry-after": "7"}), anthropic.RateLimitError),
        (Status(500), anthropic.InternalServerError),
        (Status(529), anthropic.OverloadedError),
        (Drop(), anthropic.APIConnectionError),
    ],
)
def test_a_scripted_fault_happens_once(api, client, fault, error):
    api.fail(MESSAGES, fault)
    with pytest.raises(error):
        client.messages.create(**ASK)
    assert client.messages.create(**ASK).content


def test_a_hanging_answer_runs_into_the_clients_timeout(api, client):
    api.fail(MESSAGES, Hang())
    with pytest.raises(anthropic.APITimeoutError):
        client.with_options(timeout=0.2).messages.create(**ASK)


def test_bad_requests_are_refused_as_the_api_does(client):
    with pytest.raises(anthropic.BadRequestError, match="max_tokens"):
        client.messages.create(**{**ASK, "max_tokens": 0})
    requests = [{"custom_id": "no spaces", "params": ASK}]
    with pytest.raises(anthropic.BadRequestError, match="custom_id"):
        client.messages.batches.create(requests=requests)


def test_a_batch_runs_ends_and_gives_its_results(api, client):
    outcomes = {"b": Ended("errored"), "c": Ended("expired")}
    api.answer = lambda params: outcomes.get(params["messages"][0]["content"], Reply("fine"))
    api.polls = 1
    requests = [
        {"custom_id": name, "params": {**ASK, "messages": [{"role": "user", "content": name}]}}
        for name in "abc"
    ]
    batch = client.messages.batches.create(requests=requests)
    assert client.messages.batches.retrieve(batch.id).processing_status == "in_progress"
    ended = client.messages.batches.retrieve(batch.id)
    counts = ended.request_counts
    assert (ended.processing_status, counts.succeeded, counts.errored, counts.expired) == ("ended", 1, 1, 1)
    results = {row.custom_id: row.result.type for row in client.messages.batches.results(batch.id)}
    assert results == {"a": "succeeded", "b": "errored", "c": "expired"}


def test_batches_are_listed_newest_first_over_several_pages(client):
    ids = [client.messages.batches.create(requests=[{"custom_id": "x", "params": ASK}]).id for _ in range(5)]
    assert [batch.id for batch in client.messages.batches.list(limit=2)] == ids[::-1]


def test_a_canceled_batch_ends_without_answers(api, client):
    api.polls = 10
    batch = client.messages.batches.create(requests=[{"custom_id": "x", "params": ASK}])
    assert client.messages.batches.cancel(batch.id).processing_status == "canceling"
    assert client.messages.batches.retrieve(batch.id).request_counts.canceled == 1
