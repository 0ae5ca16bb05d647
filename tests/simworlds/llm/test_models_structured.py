"""JSON is found however it is wrapped, and taken only if it fits."""

from __future__ import annotations

import json
from typing import Literal

import pytest
from asks import Scripted, ask
from pydantic import BaseModel, ConfigDict, Field

from simworlds.llm.errors import CutShort, Declined, Misfit, Rejected
from simworlds.llm.messages import Text, ToolResult, ToolUse, Turn, Usage
from simworlds.llm.structured import ask_for, fits, form_of, read


class Part(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)
    name: str
    size: tuple[float, float, float] = (1, 1, 1)


class Decision(BaseModel):
    model_config = ConfigDict(extra="forbid")
    decision: Literal["advance", "retry"]
    attempts: int = Field(default=0, ge=0)
    parts: list[Part] = []


GOOD = '{"decision": "retry", "parts": [{"name": "Leg", "size": [0.1, 0.1, 0.7]}]}'


def says(text: str, *calls: ToolUse) -> Turn:
    return Turn((Text(text), *calls), "end_turn", Usage(1, 9))


@pytest.mark.parametrize(
    "text",
    [
        GOOD,
        f"\n  {GOOD}\n",
        f"```json\n{GOOD}\n```",
        f"Here it is:\n\n```\n{GOOD}\n```\nI hope [it] {{helps}}.",
        f"~~~JSON\n{GOOD}\n~~~",
        f"  ```json5\n  {GOOD}\n  ```",
        f"I use {{braces}} and [brackets] in prose. {GOOD} That is all {{really}}.",
        f"```python\nx = {{}}\n```\n\n```json\n{GOOD}\n```",
        f'```json\n{{"example": 1}}\n```\nand the real one:\n```json\n{GOOD}\n```',
        f'The schema was {{"decision": "advance|retry"}}; mine: {GOOD}',
        f"```json\n{GOOD}",
    ],
)
def test_json_is_found_wherever_it_stands(text):
    found = read(text, fits(Decision))
    assert (found.decision, found.parts[0].size) == ("retry", (0.1, 0.1, 0.7))


def test_of_several_that_fit_the_last_counts():
    text = '```json\n{"decision": "retry"}\n```\nNo, rather:\n```json\n{"decision": "advance"}\n```'
    assert read(text, fits(Decision)).decision == "advance"


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "There is no JSON"),
        ("I would rather {not}.", "There is no JSON"),
        ('{"decision": "advance",}', "It is not valid JSON: .* at line 1, near"),
        ("{'decision': 'advance'}", "It is not valid JSON|There is no JSON"),
        ('{"decision": "advance" // yes\n}', "It is not valid JSON"),
        ('{"decision": "advance", "attempts": NaN}', "NaN is not a JSON number"),
        ('{"decision": "advance", "decision": "retry"}', "'decision' occurs twice"),
        ('{"decision": "retry", "parts": [{"name": "a", ', "It is not valid JSON"),
        ("[" * 100_000, "It is not valid JSON"),
        ('{"decision": "abort"}', r"decision: Input should be 'advance' or 'retry' \(it is \"abort\"\)"),
        ('{"decision": "retry", "attempts": "3"}', "attempts: Input should be a valid integer"),
        ('{"decision": "retry", "attempts": true}', "attempts: Input should be a valid integer"),
        ('{"decision": "retry", "attempts": 1.5}', "attempts"),
        ('{"decision": "retry", "attempts": -1}', "attempts: Input should be greater than or equal to 0"),
        ('{"decision": "retry", "why": "so"}', "why: Extra inputs are not permitted"),
        ('{"decision": "retry", "parts": [{}]}', r"parts\[0\]\.name: Field required"),
        ('{"decision": "retry", "parts": [{"name": "a", "size": [1, 2]}]}', r"parts\[0\]\.size"),
        ('{"decision": "retry", "parts": [{"name": "a", "size": [1, 2, 1e999]}]}', r"parts\[0\]\.size\[2\]"),
        ('[{"decision": "retry"}]', "The whole: Input should be an object"),
        ('{"decision": "\\ud800"}', "Invalid JSON"),
    ],
)
def test_problems_name_their_place(text, problem):
    with pytest.raises(Misfit, match=problem) as misfit:
        read(text, fits(Decision))
    assert misfit.value.text == text


def test_a_part_of_broken_json_is_not_taken_for_the_whole():
    with pytest.raises(Misfit, match="It is not valid JSON"):
        read('{"plan": [oops], "inner": {"decision": "advance"}}', fits(Decision))


def test_long_lists_of_problems_are_cut():
    text = json.dumps({"decision": "retry", "parts": [{"size": 1}] * 40})
    with pytest.raises(Misfit, match="… and 60 more") as misfit:
        read(text, fits(Decision))
    assert len(misfit.value.problems) == 21


def test_the_model_gets_the_problems_until_its_answer_fits():
    model = Scripted(says("Sure!"), says('{"decision": "abort"}'), says(GOOD))
    found = ask_for(model, ask("Decide."), fits(Decision))
    assert (found.value.decision, found.tries, found.turn.text) == ("retry", 3, GOOD)
    last = model.asked[-1].messages
    assert [message.role for message in last] == ["user", "assistant", "user", "assistant", "user"]
    assert "There is no JSON" in last[2].content[0].text
    assert "- decision: Input should be 'advance' or 'retry'" in last[4].content[0].text
    assert model.asked[0].messages == ask("Decide.").messages


def test_a_model_that_never_fits_is_given_up():
    model = Scripted(*[says("No.")] * 5)
    with pytest.raises(Misfit, match="There is no JSON"):
        ask_for(model, ask("Decide."), fits(Decision), tries=2)
    assert len(model.asked) == 2


def test_a_cut_off_answer_is_requested_shorter():
    cut = CutShort("cut", says('{"decision": "re'))
    model = Scripted(cut, says(GOOD))
    assert ask_for(model, ask("Decide."), fits(Decision)).tries == 2
    assert "cut off after 9 tokens" in model.asked[1].messages[-1].content[0].text
    with pytest.raises(CutShort):
        ask_for(Scripted(cut, cut), ask("Decide."), fits(Decision), tries=2)


def test_a_refusal_is_not_argued_with():
    model = Scripted(Declined("no", says("No.")))
    with pytest.raises(Declined):
        ask_for(model, ask("Decide."), fits(Decision))


def test_calls_instead_of_an_answer_are_answered_so_that_the_conversation_stays_sound():
    model = Scripted(says("I look.", ToolUse("t1", "look", {}), ToolUse("t2", "look", {})), says(GOOD))
    ask_for(model, ask("Decide."), fits(Decision))
    reply = model.asked[1].messages[-1].content
    assert [block.id for block in reply[:2] if isinstance(block, ToolResult) and block.failed] == ["t1", "t2"]


def test_a_reader_of_ones_own_may_find_more_than_the_schema():
    def even(data):
        return (data, []) if data["n"] % 2 == 0 else (None, [f"n: {data['n']} is odd."])

    model = Scripted(says('{"n": 3}'), says('{"n": 4}'))
    assert ask_for(model, ask("An even number."), even).value == {"n": 4}
    assert "- n: 3 is odd." in model.asked[1].messages[-1].content[0].text


def test_scene_plans_are_read_with_their_own_check():
    from agents.plan.check import read_plan

    with pytest.raises(Misfit, match=r"objects: It is missing\.") as misfit:
        read('{"title": "A table"}', read_plan)
    assert len(misfit.value.problems) > 1


# Answers that are held to a form


class Strict:
    """A model that answers in turn, and may not take forms."""

    def __init__(self, *texts: str, refuses: int = 0) -> None:
        self.texts, self.refuses, self.forms = list(texts), refuses, []

    def answer(self, ask, on_text=None):
        self.forms.append(ask.form and ask.form.name)
        if ask.form and self.refuses:
            raise Rejected("The schema is too complex.", self.refuses)
        return says(self.texts.pop(0))


def test_an_answer_after_one_that_did_not_fit_is_held_to_the_form():
    model = Strict("No.", "Still no.", GOOD)
    assert ask_for(model, ask(), fits(Decision), form=form_of(Decision)).value.decision == "retry"
    assert model.forms == [None, "Decision", "Decision"]


def test_a_server_that_does_not_take_the_form_is_asked_without():
    model = Strict("No.", "Still no.", GOOD, refuses=400)
    assert ask_for(model, ask(), fits(Decision), form=form_of(Decision)).tries == 3
    assert model.forms == [None, "Decision", None, None]
    with pytest.raises(Rejected):
        ask_for(Strict("No.", refuses=401), ask(), fits(Decision), form=form_of(Decision))
