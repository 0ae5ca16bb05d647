"""Sessions that a person wrote."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from asks import ask
from hypothesis import given
from hypothesis import strategies as st

from simworlds.llm.errors import CutShort, Declined, Drifted, UnreadableRecord, raise_for_stop
from simworlds.llm.messages import Message, Text, ToolResult, ToolUse, Turn, user
from simworlds.llm.records.recorded import Recorded
from simworlds.llm.records.transcript import read_turn, write_turn

if TYPE_CHECKING:
    from pathlib import Path

PLAN = """\
role: planner
expects: Twelve wooden dominoes
---
Here is the plan.

```json
{"title": "Dominoes"}
```
"""
BUILD = """\
role: coder
stage: modeling
expects: Twelve wooden
  dominoes
"""
CODE = """\
role: coder
stage: modeling
---
I begin with the table.

```python call blender_execute code timeout=90 on_error=restore
import bpy

bpy.ops.mesh.primitive_cube_add()
```

Now I look at it.

```json call blender_object_preview
{"name": "Table", "views": ["front", "top"]}
```
"""
FIX = """\
role: coder
stage: modeling
expects: R12
expects: Domino 7   floats
rejects: Table stands
---
It floats; I put it down.
"""


@pytest.fixture
def session(tmp_path: Path) -> Path:
    (tmp_path / "README.md").write_text("How this was made.")
    (tmp_path / "01-plan.md").write_text(PLAN)
    (tmp_path / "02-code.md").write_text(CODE)
    (tmp_path / "03-fix.md").write_text(FIX)
    return tmp_path


def test_a_session_plays_turn_by_turn(session: Path):
    played = Recorded(session)
    plan = played.answer(ask("Make this: Twelve wooden\n dominoes stand.", role="planner", stage=""))
    assert plan.text == 'Here is the plan.\n\n```json\n{"title": "Dominoes"}\n```'
    assert (plan.stop_reason, plan.model, plan.live, plan.calls) == ("end_turn", "hand-written", False, ())
    code = played.answer(ask("Begin."))
    begin, run, look, preview = code.content
    assert (begin, look) == (Text("I begin with the table."), Text("Now I look at it."))
    assert isinstance(run, ToolUse)
    assert run.input == {
        "code": "import bpy\n\nbpy.ops.mesh.primitive_cube_add()",
        "timeout": 90,
        "on_error": "restore",
    }
    assert isinstance(preview, ToolUse)
    assert (preview.name, preview.input) == (
        "blender_object_preview",
        {"name": "Table", "views": ["front", "top"]},
    )
    assert run.id != preview.id
    assert code.stop_reason == "tool_use"
    assert played.left() == ("03-fix.md",)
    results = user(
        ToolResult(run.id, (Text("R12: Domino 7 floats."),), failed=True), ToolResult(preview.id, ())
    )
    assert played.answer(ask("Begin.", code.message(), results)).text == "It floats; I put it down."


@pytest.mark.parametrize(
    ("said", "misfit"),
    [
        ("R12: Domino 8 floats.", "it should contain: Domino 7   floats"),
        ("R12: Domino 7 floats, the Table stands.", "it should not contain: Table stands"),
    ],
)
def test_an_unexpected_request_is_a_drift(session: Path, said, misfit):
    played = Recorded(session)
    played.answer(ask("Begin."))
    with pytest.raises(Drifted, match=r"coder \(modeling\) is not the one that 03-fix\.md answers") as error:
        played.answer(ask("Begin.", Message("assistant", (Text("x"),)), said))
    assert misfit in str(error.value)
    assert said in str(error.value)
    assert (error.value.message, error.value.found) == (3, said)
    assert played.left() == ("01-plan.md", "03-fix.md")


def test_turns_may_end_badly():
    assert read_turn("1.md", "role: coder\nstop: refusal\n---\nNo.").turn.stop_reason == "refusal"
    for stop, error in (("refusal", Declined), ("max_tokens", CutShort)):
        turn = read_turn("1.md", f"role: coder\nstop: {stop}\n---\nNo.").turn
        with pytest.raises(error):
            raise_for_stop(turn)


def test_longer_fences_hold_shorter_ones():
    text = (
        "role: coder\n---\n````python call blender_execute code\nprint('''\n```python call x y\n```\n''')\n````\n"
        "````markdown\n```python call blender_execute code\n```\n````\n"
    )
    call, said = read_turn("1.md", text).turn.content
    assert isinstance(call, ToolUse)
    assert call.input == {"code": "print('''\n```python call x y\n```\n''')"}
    assert said == Text("````markdown\n```python call blender_execute code\n```\n````")


def test_an_answer_may_hold_lines_of_dashes_and_nothing_at_all():
    assert read_turn("1.md", "role: coder\n---\nA\n\n---\n\nB\n").turn.text == "A\n\n---\n\nB"
    assert read_turn("1.md", "role: coder\n---\n").turn.content == ()
    assert read_turn("1.md", "role: coder\n---\n```x call save\n```").turn.calls[0].input == {}


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("role: coder\nHello", "no line of dashes"),
        ("stage: uv\n---\n", "whose turn"),
        ("role: coder\nrole: planner\n---\n", "occurs twice"),
        ("role: coder\nexpects:\n---\n", "expects is empty"),
        ("role: coder\nwants: x\n---\n", "'wants: x' is not a line of a head"),
        (BUILD + "---\n", "'dominoes' is not a line of a head"),
        ("role: coder\n---\n```python call run code\nx", "not closed"),
        ("role: coder\n---\n```python call run code more\nx\n```", "only one argument of run"),
        ("role: coder\n---\n```python call run 'code\nx\n```", "cannot be read"),
        ("role: coder\n---\n```json call run\n{x}\n```", "not valid JSON"),
        ("role: coder\n---\n```json call run\n[1]\n```", "not a JSON object"),
    ],
)
def test_mistakes_are_reported_with_their_file(text, says):
    with pytest.raises(UnreadableRecord, match=says) as error:
        read_turn("07-x.md", text)
    assert str(error.value).startswith("07-x.md: ")


def test_empty_folders_and_unreadable_files_are_errors(tmp_path: Path):
    with pytest.raises(UnreadableRecord, match="has no turns"):
        Recorded(tmp_path)
    (tmp_path / "01-x.md").write_bytes(b"\xff\xfe")
    with pytest.raises(UnreadableRecord, match="cannot be read"):
        Recorded(tmp_path)


ARGUMENTS = st.dictionaries(
    st.from_regex(r"[a-z_]{1,12}", fullmatch=True),
    st.none() | st.booleans() | st.integers() | st.text() | st.lists(st.text(), max_size=3),
    max_size=4,
)
CALLS = st.builds(ToolUse, st.just("1"), st.sampled_from(["blender_execute", "blender_docs"]), ARGUMENTS)
CODES = st.lists(st.sampled_from(["import bpy", "", "```", "~~~~", "x = 'it\\'s'"]), min_size=2).map(
    "\n".join
)
WORDS = st.sampled_from(["I begin.", "A list:\n\n- one\n- two", "```json\n{}\n```", "---"])


@given(st.lists(WORDS.map(Text) | CALLS, max_size=3))
def test_what_is_written_is_read_the_same(blocks: list[Text | ToolUse]) -> None:
    said: list[Text | ToolUse] = []
    for block in blocks:  # words that follow each other are one text
        if not (isinstance(block, Text) and said and isinstance(said[-1], Text)):
            said.append(block)
    turn = Turn(tuple(said), "tool_use")
    again = read_turn("01-coder.md", write_turn("coder", "motion", turn))
    assert (again.role, again.stage) == ("coder", "motion")
    assert [told(block) for block in again.turn.content] == [told(block) for block in said]


def told(block: object) -> object:
    return (block.name, block.input) if isinstance(block, ToolUse) else block


@given(CODES, st.text())
def test_code_stands_as_it_is(code: str, title: str) -> None:
    call = ToolUse("1", "blender_execute", {"code": code, "title": title, "timeout": 90})
    text = write_turn("coder", "", Turn((call,), "tool_use"))
    assert [told(block) for block in read_turn("01-coder.md", text).turn.content] == [told(call)]
    if not title.splitlines()[1:]:
        assert code in text


def test_words_that_would_become_a_call_are_refused() -> None:
    turn = Turn((Text("```json call blender_verify\n{}\n```"),), "end_turn")
    with pytest.raises(UnreadableRecord, match="read the same"):
        write_turn("coder", "motion", turn)
