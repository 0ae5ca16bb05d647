"""What was recorded plays back without a server, and says where a conversation has left the record."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest
from asks import Scripted, ask, png
from fake_messages_api import Reply

from simworlds.llm.errors import CutShort, Declined, Drifted, Stopped, UnreadableRecord
from simworlds.llm.messages import Kept, Message, Picture, Text, ToolResult, ToolUse, Turn, Usage, user
from simworlds.llm.records.canonical import alike, form_of, normal
from simworlds.llm.records.recorded import Recorded, Recording

if TYPE_CHECKING:
    from simworlds.llm.messages import Ask


def says(text: str, **changes: Any) -> Turn:
    return Turn((Text(text),), "end_turn", Usage(10, 5), "claude-opus-5-5", cost=0.1, live=True, **changes)


def record(*calls: tuple[Ask, Turn | Exception]) -> list[dict[str, Any]]:
    """The rows of a record, as a file has them."""
    rows: list[dict[str, Any]] = []
    recording = Recording(Scripted(*(turn for _, turn in calls)), rows.append)
    for request, _ in calls:
        with suppress(Stopped):
            recording.answer(request)
    return [json.loads(json.dumps(row)) for row in rows]


USED = Message("assistant", (ToolUse("toolu_1", "blender_execute", {"code": "a = 1\nb = 2"}),))
FIRST = ask("Build a table.")
SECOND = ask("Build a table.", USED, user(ToolResult("toolu_1", (Text("Done in 0.31 s."), Picture(png())))))


def test_recorded_answers_play_back_exactly(api, claude):
    thought = {"type": "thinking", "thinking": "Hm.", "signature": "signed"}
    call = {"type": "tool_use", "id": "t1", "name": "blender_execute", "input": {"code": "print('ä')"}}
    api.answer = lambda params: Reply(content=(thought, call), stop_reason="tool_use")
    lines: list[str] = []
    live = Recording(claude, lambda row: lines.append(json.dumps(row))).answer(FIRST)
    played = Recorded(map(json.loads, lines))
    heard: list[str] = []
    turn = played.answer(FIRST, heard.append)
    assert turn == replace(live, live=False)
    assert turn.calls[0].input == {"code": "print('ä')"}
    assert played.left() == ()
    assert len(api.requests) == 1


def test_requests_and_answers_are_recorded_before_use():
    rows: list[str] = []

    class Watched:
        def answer(self, ask, on_text=None):
            assert rows == ["model.asked"]
            return says("Yes.")

    Recording(Watched(), lambda row: rows.append(row["type"])).answer(FIRST)
    assert rows == ["model.asked", "model.answered"]


def test_a_record_that_cannot_be_written_stops_the_call():
    def full(row: dict[str, Any]) -> None:
        raise OSError("No space left on device")

    model = Scripted(says("Yes."))
    with pytest.raises(OSError, match="No space"):
        Recording(model, full).answer(FIRST)
    assert model.asked == []


def test_every_text_is_written_down_once():
    rows = record((FIRST, says("a")), (SECOND, says("b")))
    asked = [row for row in rows if row["type"] == "model.asked"]
    assert len(asked[0]["texts"]) == 3  # the system prompt, the tools, the message
    assert len(asked[1]["texts"]) == 2
    assert len(asked[1]["parts"]) == 5
    assert "toolu_1" not in json.dumps(asked)


def test_a_recorded_turn_is_never_live():
    rows = record((FIRST, says("Yes.")))
    assert rows[1]["turn"]["live"] is True
    assert Recorded(rows).answer(FIRST).live is False
    again: list[dict[str, Any]] = []
    Recording(Recorded(rows), again.append).answer(FIRST)
    assert again[1]["turn"]["live"] is False


def test_turns_that_ended_badly_end_as_badly_again():
    refused = Declined("no", says("I would rather not.") and replace(says("No."), stop_reason="refusal"))
    cut = CutShort("cut", replace(says("Half"), stop_reason="max_tokens"))
    rows = record((FIRST, refused), (SECOND, cut))
    played = Recorded(rows)
    with pytest.raises(Declined):
        played.answer(FIRST)
    with pytest.raises(CutShort, match="after 5 tokens") as error:
        played.answer(SECOND)
    assert error.value.turn.live is False


def test_a_question_without_an_answer_was_not_answered():
    rows = record((FIRST, says("a")), (SECOND, says("b")))
    played = Recorded(rows[:3])
    assert played.answer(FIRST).text == "a"
    with pytest.raises(Drifted, match="no further turn for the coder"):
        played.answer(SECOND)


def test_roles_and_stages_may_come_in_another_order():
    planner, light = replace(FIRST, role="planner", stage=""), replace(FIRST, stage="light")
    played = Recorded(record((FIRST, says("1")), (planner, says("2")), (light, says("3"))))
    assert [played.answer(one).text for one in (light, planner, FIRST)] == ["3", "2", "1"]


def test_the_same_question_twice_gets_both_answers_in_order():
    played = Recorded(record((FIRST, says("1")), (FIRST, says("2"))))
    assert [played.answer(FIRST).text, played.answer(FIRST).text] == ["1", "2"]


def test_finished_parts_of_a_record_may_be_left_out():
    played = Recorded(record((FIRST, says("1")), (SECOND, says("2"))))
    assert played.answer(SECOND).text == "2"
    assert played.left() == ("call 1",)


def test_beyond_the_record_a_live_model_may_go_on():
    rows = record((FIRST, says("recorded")))
    live = Scripted(says("live"))
    model = Recorded(rows, then=live)
    assert [model.answer(FIRST).live, model.answer(SECOND).live] == [False, True]
    assert live.asked == [SECOND]


def test_a_drifted_conversation_is_not_sent_to_the_live_model():
    live = Scripted(says("live"))
    with pytest.raises(Drifted):
        Recorded(record((FIRST, says("recorded"))), then=live).answer(ask("Build a chair."))
    assert live.asked == []


@pytest.mark.parametrize(
    "other",
    [
        replace(SECOND, model="another", max_tokens=5),
        ask(
            "Build a table.  ",
            Message("assistant", (Kept({"type": "thinking"}), replace(USED.content[0], id="x9"))),
            user(ToolResult("x9", (Text("Done in 12.7 s."), Picture(png(9, 9))))),
        ),
    ],
)
def test_differences_between_runs_are_ignored(other):
    assert Recorded(record((SECOND, says("b")))).answer(other).text == "b"


def test_drift_errors_name_role_message_and_difference():
    played = Recorded(record((SECOND, says("b"))))
    code = "a = 1\nb = 3"
    other = ask("Build a table.", replace(USED, content=(ToolUse("t", "blender_execute", {"code": code}),)))
    other = replace(
        other, messages=(*other.messages, user(ToolResult("t", SECOND.messages[-1].content[0].content)))
    )
    with pytest.raises(Drifted) as error:
        played.answer(other)
    drift = error.value
    assert (drift.role, drift.stage, drift.message) == ("coder", "modeling", 2)
    assert "the coder (modeling), call 1, message 2 (assistant)" in str(drift)
    assert "-b = 2\n+b = 3" in str(drift)
    assert drift.expected.endswith("b = 2")
    assert drift.found.endswith("b = 3")


@pytest.mark.parametrize(
    ("other", "message"),
    [
        (replace(SECOND, system=("Something else.",)), 0),
        (replace(SECOND, tools=()), 0),
        (replace(SECOND, messages=SECOND.messages[:1]), 2),
        (replace(SECOND, messages=(*SECOND.messages, USED)), 4),
        (replace(SECOND, messages=(user("Build a chair."), *SECOND.messages[1:])), 1),
    ],
)
def test_every_part_of_a_request_counts(other, message):
    with pytest.raises(Drifted) as error:
        Recorded(record((SECOND, says("b")))).answer(other)
    assert error.value.message == message


def test_long_differences_are_shortened():
    long = "\n".join(f"line {number} " + "x" * 500 for number in range(200))
    with pytest.raises(Drifted) as error:
        Recorded(record((ask(long), says("b")))).answer(ask(long.replace("line", "row")))
    assert len(str(error.value)) < 8000
    assert "more lines" in str(error.value)


def test_the_last_digits_of_measures_may_differ():
    before, after = "gap 0.0421 m, tilt 12.300 deg, 3 faces", "gap 0.0422 m, tilt 12.301 deg, 3 faces"
    played = Recorded(record((ask(before), says("b"))))
    assert played.answer(ask(after)).text == "b"
    with pytest.raises(Drifted):
        Recorded(record((ask(before), says("b")))).answer(ask(after.replace("12.3", "14.3")))
    with pytest.raises(Drifted):
        Recorded(record((ask(before), says("b")))).answer(ask(after.replace("3 faces", "4 faces")))


STILL = """\
Rendered frame 48 (camera 'Camera', 480×270, Cycles on the CPU, {samples} samples, denoised) in {seconds} s: /runs/a.png
{hurry}- Frame 48: 0 % black, {burnt} % burnt out; brightness (0 to 1, as displayed) 0.2{burnt} at the 5th percentile.
- Frame 48, share of the picture (mean brightness): Water 34 % (0.4{burnt}), Curb 22 % (0.55).
- Frame 48 shows nothing of {unseen}.
{frames} frames rendered in {seconds}.2 s, 7.45 s a frame (camera 'Camera', {size}, Cycles, {samples} samples).
The film: 120 frames, {size}, {samples} samples. A frame takes about {seconds} s; 20 min are allowed.
The film's samples: {samples} planned. Its size: {size}."""
QUIET = {
    "samples": 64,
    "seconds": 21,
    "hurry": "",
    "burnt": 0,
    "unseen": "Leaf",
    "size": "480×270",
    "frames": 120,
}
BUSY = QUIET | {
    "samples": 9,
    "seconds": 45,
    "hurry": "- To keep the time budget: 9 samples instead of 64.\n",
    "burnt": 1,
    "size": "280×158",
}


def test_how_fine_a_busy_machine_renders_may_differ_and_what_it_shows_may_not():
    def played(told):
        return Recorded(record((ask(STILL.format(**QUIET)), says("b")))).answer(ask(STILL.format(**told)))

    assert played(BUSY).text == "b"
    for other in ({"unseen": "Stone"}, {"frames": 119}):
        with pytest.raises(Drifted):
            played(BUSY | other)


def test_a_record_of_a_version_with_fewer_rules_plays_as_well():
    rows = record((ask(STILL.format(**QUIET)), says("b")))
    asked = next(row for row in rows if row["type"] == "model.asked")
    asked["digest"] = "of other rules"
    asked["parts"] = [f"old {part}" for part in asked["parts"]]
    texts = {f"old {part}": text for part, text in asked["texts"].items()}
    asked["texts"] = {part: text.replace("<samples>", "64 samples") for part, text in texts.items()}
    assert Recorded(rows).answer(ask(STILL.format(**BUSY))).text == "b"


def test_several_may_play_at_once():
    asks = [ask(f"number {number}", stage=f"s{number}") for number in range(20)]
    played = Recorded(record(*((one, says(f"to {one.stage}")) for one in asks)))
    with ThreadPoolExecutor(8) as pool:
        turns = list(pool.map(played.answer, asks))
    assert [turn.text for turn in turns] == [f"to s{number}" for number in range(20)]


@pytest.mark.parametrize(
    ("lines", "says_what"),
    [
        (["{}", '{"type": "model.asked", "n": 1}'], "Row 2.*role"),
        (['{"type": "model.answered", "n": 3, "turn": {"content": [], "stop_reason": "x"}}'], "no question"),
        (['{"type": "model.answered", "n": 3, "turn": {"content": [{"type": "song"}]}}'], "Row 1"),
    ],
)
def test_an_invalid_record_is_an_error(lines, says_what):
    with pytest.raises(UnreadableRecord, match=f"(?s){says_what}"):
        Recorded(map(json.loads, lines))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("saved /data/me/runs/7/table.blend.", "saved <path>/table.blend."),
        ("in /tmp/a1/b and '/usr/share/x.png'", "in <path> and '<path>/x.png'"),
        (r"C:\Users\Me\scene.blend", "<path>/scene.blend"),
        ("1/2 and/or https://docs.blender.org/a/b.html", "1/2 and/or https://docs.blender.org/a/b.html"),
        ("previews/chair.png", "previews/chair.png"),
        ("2026-11-14T09:30:00Z, 2026-11-14, 09:30:00.123", "<time>, <time>, <time>"),
        ("run 3f2a9c1e77, 123e4567-e89b-12d3-a456-426614174000", "run <id>, <id>"),
        ("decade feedback 12345678 frames", "decade feedback 12345678 frames"),
        (
            "took 0.31 s, 12ms, 2 minutes; frame 31 stays",
            "took <duration>, <duration>, <duration>; frame 31 stays",
        ),
        ("1.2 MB, 300 bytes, 3 kiB, 3 balls", "<size>, <size>, <size>, 3 balls"),
        ("a  \r\nb\t", "a\nb"),
    ],
)
def test_volatile_text_is_replaced_by_placeholders(text, expected):
    assert normal(text) == expected


def test_folders_get_the_names_that_the_caller_gives_them():
    folders = {"/data/me": "home", "/data/me/runs/7/": "run"}
    assert normal("/data/me/runs/7/previews/a.png", folders) == "<run>/previews/a.png"
    assert normal("/data/me/my things/a.png", folders) == "<home>/my things/a.png"


def test_numbers_are_alike_within_one_percent():
    assert alike("at 1.000 and 200.0", "at 1.009 and 199.0")
    assert not alike("at 1.000", "at 1.02")
    assert not alike("at 1.0", "at 1.0 m")
    assert alike("-0.0004", "0.0003")


def test_the_form_is_the_same_for_the_same_request():
    assert form_of(SECOND).digest == form_of(replace(SECOND, stage="light")).digest
    assert form_of(SECOND).digest != form_of(replace(SECOND, role="reviewer")).digest
