"""A conversation of any length stays within its budget, and is one that the API takes."""

from __future__ import annotations

import random

import pytest
from asks import LOOK, RUN, ask, png
from fake_messages_api import Reply

from simworlds.llm import tokens
from simworlds.llm.context import GONE, ContextLimits, fit
from simworlds.llm.errors import TooLong
from simworlds.llm.messages import Kept, Message, Picture, Text, ToolResult, ToolUse, user

PLAN = "The plan: a table with twelve dominoes."
SMALL = ContextLimits(budget=8000, pictures=6, down_to=0.6, newest=2, long=400)


def exchange(number: int, *, words: int = 300, pictures: int = 0, thought: bool = False) -> list[Message]:
    """The model calls two tools and gets their results."""
    run, look = f"run_{number}", f"look_{number}"
    thinking = (Kept({"type": "thinking", "thinking": f"thought {number}", "signature": "s"}),)
    return [
        Message(
            "assistant",
            (
                *(thinking if thought else ()),
                Text(f"Step {number}."),
                ToolUse(run, RUN.name, {"code": f"step({number})"}),
                ToolUse(look, LOOK.name, {"name": f"Domino {number}"}),
            ),
        ),
        user(
            ToolResult(run, (Text(f"output {number} " + "word " * words),)),
            ToolResult(look, (Text("Seen."), *(Picture(png(280, 280)) for _ in range(pictures)))),
        ),
    ]


def conversation(count: int, **changes) -> list[Message]:
    return [
        user(f"Build it. {PLAN}"),
        *(one for number in range(count) for one in exchange(number, **changes)),
    ]


def words_of(messages) -> str:
    return repr(messages)


def paired(messages) -> bool:
    """Whether every call has its result in the next message, and every result its call before."""
    open_calls: set[str] = set()
    for message in messages:
        results = {block.id for block in message.content if isinstance(block, ToolResult)}
        if results != open_calls:
            return False
        open_calls = {block.id for block in message.content if isinstance(block, ToolUse)}
    return not open_calls


def size(messages) -> int:
    return sum(map(tokens.of_message, messages))


def test_within_the_budget_nothing_changes():
    messages = conversation(5)
    assert fit(messages, SMALL) == tuple(messages)


def test_old_outputs_become_references_that_say_how_to_see_them_again():
    messages = conversation(10, words=450)
    kept = fit(messages, SMALL)
    assert size(kept) <= SMALL.budget * SMALL.down_to
    old = kept[2].content[0].content[0].text
    assert old.startswith("output 0 word word")
    assert old.endswith(
        'more characters are left out to save space; call blender_execute("code": "step(0)") again for what it is now.]'
    )
    assert kept[-1] == messages[-1]
    assert kept[-3] == messages[-3]
    assert len(kept) == len(messages)


def test_old_pictures_go_first_and_the_newest_stay():
    messages = conversation(10, words=1, pictures=1)
    kept = fit(messages, SMALL)
    shown = [any(isinstance(one, Picture) for one in message.content[1].content) for message in kept[2::2]]
    assert shown == [False] * 7 + [True] * 3  # three are 0.6 of six, rounded down
    again = 'call blender_object_preview("name": "Domino 0") again for what it is now'
    assert kept[2].content[1].content[1] == Text(f"[A picture is left out to save space; {again}.]")


def test_then_whole_exchanges_go_and_the_task_stays():
    messages = conversation(60, words=2)
    kept = fit(messages, SMALL)
    assert size(kept) <= SMALL.budget * SMALL.down_to
    assert kept[0].content == (*messages[0].content, Text(GONE))
    assert kept[1:] == tuple(messages[-(len(kept) - 1) :])
    assert 4 < len(kept) < len(messages)
    assert paired(kept)


def test_at_last_the_newest_outputs_are_shortened():
    messages = [*conversation(3), *exchange(3, words=30_000)]
    kept = fit(messages, SMALL)
    assert size(kept) <= SMALL.budget
    assert "more characters are left out" in kept[-1].content[0].content[0].text
    assert paired(kept)


def test_the_newest_stay_whole_as_long_as_they_fit():
    messages = [*conversation(30, words=2), *exchange(30, words=1800), *exchange(31, words=1800)]
    kept = fit(messages, SMALL)
    assert kept[-4:] == tuple(messages[-4:])
    assert SMALL.budget * SMALL.down_to < size(kept) <= SMALL.budget


def test_a_conversation_that_cannot_fit_is_an_error():
    with pytest.raises(TooLong, match="does not fit into 8000 tokens"):
        fit([user("word " * 20_000)], SMALL)
    with pytest.raises(TooLong):
        fit(conversation(2), SMALL, frame=7999)


def test_pinned_texts_stay_and_are_not_repeated():
    findings = "Open: R12, Domino 7 floats."
    messages = [user("Build it."), *exchange(0), *(one for n in range(1, 80) for one in exchange(n, words=2))]
    messages[2] = user(*messages[2].content, findings)
    kept = fit(messages, SMALL, pinned=(PLAN, findings))
    assert words_of(kept).count(PLAN) == 1 == words_of(kept).count(findings)
    assert kept[-1].content[-2:] == (Text(PLAN), Text(findings))
    again = fit([*kept, *exchange(80, words=1)], SMALL, pinned=(PLAN, findings))
    assert again[: len(kept)] == kept
    assert words_of(again).count(PLAN) == 1


def test_a_conversation_only_grows_between_two_cuts():
    sent = tuple(conversation(1))
    cuts = 0
    for number in range(1, 120):
        longer = (*sent, *exchange(number, words=100, pictures=1))
        kept = fit(longer, SMALL, pinned=(PLAN,))
        cuts += kept[: len(sent)] != sent
        sent = kept
    assert 5 < cuts < 60


def test_the_same_conversation_is_always_cut_the_same():
    messages = conversation(60, pictures=1)
    assert fit(messages, SMALL) == fit(conversation(60, pictures=1), SMALL)


@pytest.mark.slow
def test_conversations_of_every_shape_stay_sound():
    chance = random.Random(3)
    for _ in range(40):
        limits = ContextLimits(
            budget=chance.choice([6000, 9000, 20_000]),
            pictures=chance.choice([2, 8]),
            newest=chance.choice([0, 1, 4]),
            long=chance.choice([300, 900]),
        )
        messages = [user(PLAN)]
        for number in range(chance.randrange(60)):
            messages += exchange(
                number, words=chance.choice([1, 50, 900]), pictures=chance.choice([0, 0, 1, 3]), thought=True
            )
            if chance.random() < 0.2:
                messages += [Message("assistant", (Text("Done."),)), user("Not yet: R7.")]
        kept = fit(messages, limits, pinned=("Open: R7.",))
        assert size(kept) <= limits.budget
        assert paired(kept)
        assert PLAN in words_of(kept[0])
        assert "Open: R7." in words_of(kept)
        assert kept[0].role == "user" == kept[-1].role


def test_a_long_run_with_a_thinking_model_is_one_that_the_api_takes(api, claude):
    def answer(params):
        number = len(api.requests)
        return Reply(
            content=(
                {"type": "thinking", "thinking": "Hm. " * 20},
                {
                    "type": "tool_use",
                    "id": f"t{number}",
                    "name": RUN.name,
                    "input": {"code": f"step({number})"},
                },
            ),
            stop_reason="tool_use",
            input_tokens=None,
        )

    api.answer = answer
    limits = ContextLimits(budget=3000, pictures=4, newest=2, long=300)
    frame = tokens.of_frame(ask().system, ask().tools)
    messages = (user("Build it."),)
    thoughts = []
    for number in range(40):
        messages = fit(messages, limits, pinned=(PLAN, f"Open: finding {number // 10}."), frame=frame)
        turn = claude.answer(ask(*messages))
        thoughts.append(sum(isinstance(block, Kept) for message in messages for block in message.content))
        results = [ToolResult(call.id, (Text("word " * 90), Picture(png(56, 56)))) for call in turn.calls]
        messages = (*messages, turn.message(), user(*results))
    assert max(thoughts) >= 3  # thinking goes back as long as nothing before it changed
    assert thoughts.count(0) > 3  # and goes when something did
    assert len(api.requests) == 40


def test_tokens_are_estimated_rather_too_high():
    assert tokens.of_text("a" * 300) == 101
    assert tokens.of_text("ü🙂") >= 2
    assert tokens.of_picture(Picture(png(280, 140))) == 50
    assert tokens.of_picture(Picture(png(9000, 10))) == 322
    assert tokens.of_picture(Picture(b"not a png")) == 4784 == tokens.of_picture(Picture(png(4000, 4000)))
