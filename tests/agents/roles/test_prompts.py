"""The roles' prompts: whole, of files that are all used, true to the rules and plans that they tell of, and short."""

from __future__ import annotations

import json
import re
import sys
from dataclasses import fields
from itertools import product
from typing import TYPE_CHECKING, Any, get_args

import pytest

from agents.blender import docs_client
from agents.blender.checks import plan_check
from agents.blender.server import entry
from agents.blender.tool_catalogue import TOOLS
from agents.loop.algorithm import ALL_AT_ONCE
from agents.plan import relations
from agents.plan.arithmetic import doubts_of
from agents.plan.check import read_plan
from agents.plan.edit import EditPlan
from agents.plan.part import STAGES, Stage
from agents.plan.scene import ScenePlan
from agents.plan.tactical import Decision, FinalReview, Review, TacticalPlan
from agents.protocol import vocabulary
from agents.protocol.guide import format_tolerance, rules_guide
from agents.protocol.rules.catalogue import RULES, select_rules
from agents.protocol.rules_by_stage import rules_of
from agents.protocol.tolerances import TOLERANCES
from agents.roles import coder, prompts
from agents.roles.coder import is_needed, is_seen
from agents.roles.names import ROLES, Role
from agents.roles.prompts import FOLDER, protocol_text, system_prompt, team_text
from agents.roles.sheets import SOLVERS, sheet
from kb_serve.tool import tool as docs_tool
from simworlds.llm.tokens import of_text
from simworlds.schemas.json_schema import lean_arguments

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from pydantic import BaseModel

ALL = [(role, stage, edit) for role, stage, edit in product(ROLES, (None, *STAGES), (False, True))]
ANSWERS: list[tuple[Role, bool, type[BaseModel]]] = [
    ("planner", False, ScenePlan),
    ("planner", True, EditPlan),
    *(("planner", edit, model) for edit in (False, True) for model in (TacticalPlan, Decision)),
    *(("reviewer", edit, Review) for edit in (False, True)),
    *(("final_reviewer", edit, FinalReview) for edit in (False, True)),
]


# The mark of a line that only one kind of run is told.
ONE_MODE = re.compile(r"^( *(?:- |\d+\. )?)(?:Making|Editing): ", re.MULTILINE)
# What only a scene plan has, and what only an edit has, in words.
OF_SCENE_PLANS = re.compile(
    r"\brelations?\b|counted from 0|scene plan|\bphases?\b|planned (?:object|role|subject|material|field)"
    r"|plan's roles?\b|`(?:keyframed|rigid|rig|cloth|soft|fluid|emitter)`|\(L3\)|opt_out|`subjects`|tighten"
)
OF_EDITS = re.compile(
    r"\bedit(?:s|ing)?\b|EditPlan|\btasks name\b|\bactors`|was in the file before", re.IGNORECASE
)


def whole(role: Role, stage: Stage | None = None, *, edit: bool = False) -> str:
    return "\n\n".join(system_prompt(role, stage, edit=edit))


def composed() -> str:
    """Every text that any model may be given."""
    at_once = [
        *system_prompt("coder", "light", staged=False),
        *system_prompt("coder", "light", staged=False, edit=True),
    ]
    return "\n\n".join(
        [*(whole(*one[:2], edit=one[2]) for one in ALL), *at_once, team_text(), team_text(edit=True)]
    )


def own_files() -> list[Path]:
    """The texts, but for the solvers' sheets."""
    return sorted(path for path in FOLDER.rglob("*.md") if path.parent.name != "sheets")


def test_who_sets_the_camera_is_told_which_frames_its_reviewer_sees() -> None:
    for stage in ("camera", "light"):
        assert "that of the fastest motion" in whole("coder", stage)


def test_every_paragraph_of_every_file_is_used() -> None:
    files = own_files()
    assert {path.stem for path in files} == {*ROLES, *STAGES, "team", "at_once"}
    told = composed()
    for path in files:
        for line in path.read_text(encoding="utf-8").splitlines():
            part = ONE_MODE.sub(r"\1", line.partition("{{")[0]).strip()
            assert part in told, f"{path.name}: {part[:60]}"


def test_nothing_is_left_to_be_filled_in() -> None:
    assert "{{" not in composed()
    assert not ONE_MODE.search(composed())


def test_a_hole_that_nothing_fills_is_an_error() -> None:
    with pytest.raises(KeyError, match="stagse"):
        prompts._filled("The {{stagse}}.", stages="x")


@pytest.mark.parametrize(("role", "stage", "edit"), ALL)
def test_parts_come_from_what_is_shared_to_what_is_the_stages_own(
    role: Role, stage: Stage | None, edit: bool
) -> None:
    parts = system_prompt(role, stage, edit=edit)
    shared = system_prompt(role, edit=edit)
    assert parts[: len(shared)] == shared, "the prompt cache finds them again"
    assert all(part.strip() == part and part for part in parts)
    assert len(parts) - len(shared) == (0 if stage is None else 2 if role == "coder" else 1)


def test_a_coder_hears_of_the_rules_that_judge_its_stage_and_a_planner_of_all() -> None:
    modeling, motion = (whole("coder", stage) for stage in ("modeling", "motion"))
    timing = next(rule for rule in RULES if rule.id == "T1")
    sentence = timing.about.partition(". ")[0].removesuffix(".")
    assert sentence in whole("planner")
    assert sentence in motion
    assert sentence not in modeling
    assert "- V1 " in modeling
    assert "- V1 " not in whole("reviewer", "modeling")


def told_of_tools(needed: Callable[[str], bool]) -> int:
    tools = [*map(entry, TOOLS), docs_tool()]
    told = [(tool.description, lean_arguments(tool.input_schema)) for tool in tools if needed(tool.name)]
    return sum(len((words or "").encode()) + len(json.dumps(schema).encode()) for words, schema in told)


def asked_first(stage: Stage, *, staged: bool = True, verifier: bool = True, **more: Any) -> int:
    """The bytes of a coder's first request, without the plans and the readout that are put into it."""
    system = system_prompt("coder", stage, staged=staged, verifier=verifier, **more)
    tools = told_of_tools(
        lambda name: is_needed(name, stage, staged=staged) and (verifier or name != "blender_verify")
    )
    return sum(len(part.encode()) for part in (*system, coder.BEGIN)) + tools


@pytest.mark.parametrize("stage", STAGES)
@pytest.mark.parametrize("edit", [False, True])
@pytest.mark.parametrize("verifier", [False, True])
def test_a_coder_is_told_what_it_needs_and_no_more(stage: Stage, edit: bool, verifier: bool) -> None:
    longest = max(SOLVERS, key=lambda solver: len(sheet(solver)))
    assert asked_first(stage, edit=edit, verifier=verifier, solvers=[longest]) <= 22_000


@pytest.mark.parametrize("edit", [False, True])
def test_a_coder_without_stages_is_told_of_all_in_as_little(edit: bool) -> None:
    (stage,) = ALL_AT_ONCE
    assert asked_first(stage, edit=edit, staged=False) <= 22_000
    system = "\n\n".join(system_prompt("coder", stage, edit=edit, staged=False))
    assert prompts.stage_text(stage) not in system, "its stage is but a name"
    assert "no stages" in system


@pytest.mark.parametrize("stage", STAGES)
def test_a_reviewer_is_told_what_it_needs_and_no_more(stage: Stage) -> None:
    system = sum(len(part.encode()) for part in system_prompt("reviewer", stage))
    tools = told_of_tools(lambda name: ("preview" in name or "state" in name) and is_seen(name, stage))
    assert system + tools <= 14_000


def test_who_is_not_measured_hears_nothing_of_measuring() -> None:
    for stage in STAGES:
        without = "\n\n".join(system_prompt("coder", stage, verifier=False))
        assert "blender_verify" not in without
        assert "Rules are hard" not in without
        assert "blender_verify" in whole("coder", stage)


def test_the_protocol_names_every_rule_tolerance_tag_and_relation() -> None:
    text = f"{protocol_text()}\n{rules_guide()}"
    for rule in RULES:
        sentence = rule.about.partition(". ")[0].removesuffix(".")
        soft = " (soft)" if rule.severity == "soft" else ""
        assert f"\n- {rule.id}{soft} {sentence}." in text
    used = {name for rule in RULES for name in rule.tolerances}
    assert used == {field.name for field in fields(TOLERANCES)}
    for name in used - {"contact", "contact_share", "contact_most", "penetration", "penetration_share"}:
        assert text.count(f"{name} {format_tolerance(name)}") == 1
    for one in vocabulary.PROPERTIES:
        assert f"`{one.name}`" in text
        assert one.meaning in text
    for word in (*vocabulary.SYSTEMS, *vocabulary.DEFORMATION_KINDS, *vocabulary.MOTION_KINDS):
        assert word in text
    for kind in get_args(get_args(relations.Relation)[0]):
        line = next(one for one in text.splitlines() if one.startswith(f"- {_kind(kind)}("))
        for name in set(kind.model_fields) - {"kind", "when"}:  # said once, of all of them
            assert re.search(rf"[(, ]{name}[…?,)]", line), line


def _kind(model: type[BaseModel]) -> str:
    return "/".join(get_args(model.model_fields["kind"].annotation))


def test_epsilon_and_noise_are_told_as_they_are() -> None:
    assert "ε is 2 mm or 0.5 % of the smaller object's diagonal, at most 10 mm" in rules_guide()
    assert "noise is 1 mm or 1 % of the smallest dimension" in rules_guide()


@pytest.mark.parametrize(("role", "edit", "model"), ANSWERS)
def test_a_role_is_told_every_field_of_what_it_answers(
    role: Role, edit: bool, model: type[BaseModel]
) -> None:
    text = prompts.shapes_text(role, edit=edit)
    schema = model.model_json_schema()
    parts: dict[str, Any] = {model.__name__: schema, **schema.get("$defs", {})}
    for name, part in parts.items():
        block = re.search(rf"^{name} {{.*?^}}", text, re.MULTILINE | re.DOTALL)
        assert block, name
        for field, told in part["properties"].items():
            if (
                edit and f"{name}.{field}" == "TacticalPlan.relations"
            ):  # of a scene plan, which there is none of
                assert field not in block[0]
                continue
            mark = "" if field in part.get("required", ()) else r"\?"
            assert re.search(rf"^  {field}{mark}: ", block[0], re.MULTILINE), f"{name}.{field}"
            for choice in told.get("enum", ()):
                assert f'"{choice}"' in block[0]


def examples(role: Role, *, edit: bool = False) -> list[Any]:
    text = prompts.role_text(role, edit=edit)
    return [json.loads(code) for code in re.findall(r"^```json\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)]


def test_the_planners_examples_are_answers_that_are_taken() -> None:
    scene, tactic, decision = examples("planner")
    plan, faults = read_plan(scene)
    assert plan is not None
    assert (faults, doubts_of(plan)) == ([], [])
    wanted = TacticalPlan.model_validate(tactic)
    assert all(plan.object(asset.target) for asset in wanted.assets)
    assert max(wanted.relations) < len(plan.relations)
    assert Decision.model_validate(decision).instructions
    del tactic["relations"]
    assert examples("planner", edit=True) == [tactic, decision], "a file is edited by another plan"


def test_the_reviewers_example_is_an_answer_that_is_taken_and_nobody_elses() -> None:
    (review,) = examples("reviewer")
    assert Review.model_validate(review).judgements
    assert not examples("coder")
    assert not examples("final_reviewer")


@pytest.mark.parametrize("role", [*ROLES, "team"])
def test_what_is_only_for_edits_is_told_for_edits_only(role: Any) -> None:
    def text(edit: bool) -> str:
        return team_text(edit=edit) if role == "team" else prompts.role_text(role, edit=edit)

    assert "## Editing:" in text(True)
    assert "## Editing:" not in text(False)
    assert "## Making:" not in text(True)
    assert "one JSON object" in text(False) or role in {"coder", "team"}


@pytest.mark.parametrize(("role", "stage"), list(product(ROLES, (None, *STAGES))))
def test_an_edit_hears_nothing_of_scene_plans_and_the_making_of_a_scene_nothing_of_edits(
    role: Role, stage: Stage | None
) -> None:
    protocol = re.compile(r"^- (?:`|[A-Z]\d).*", re.MULTILINE)  # levels, tags and rules: a file may follow it
    edited = protocol.sub("", whole(role, stage, edit=True))
    assert OF_SCENE_PLANS.findall(edited) == []
    assert OF_EDITS.findall(whole(role, stage).replace("edit mode", "").replace("to be edited", "")) == []


def test_an_edit_is_told_of_the_rules_that_need_no_plan() -> None:
    edited, made = whole("planner", edit=True), whole("planner")
    for rule in RULES:
        assert f"\n- {rule.id} " not in edited or not rule.needs_plan
    assert "\n- R15 " in edited
    assert "\n- T2 " in made
    assert len(edited) < len(made) / 2


def test_every_stage_says_what_belongs_into_it_when_it_is_done_and_what_judges_it() -> None:
    for stage in STAGES:
        text = prompts.stage_text(stage)
        assert text.startswith(f"# {stage}: ")
        for edit in (False, True):
            text = prompts.stage_text(stage, edit=edit)
            for word in ("Belongs here: ", "\nNot here: ", "\nDone when ", "\nGoes wrong often:\n- "):
                assert text.count(word) == 1
            last = text.splitlines()[-1]
            told = last.removeprefix("Rules that judge this stage: ").removesuffix(".").split(", ")
            assert select_rules(told) == rules_of(stage, edit=edit), "as blender_verify takes them"


def test_the_planner_knows_all_stages_in_order() -> None:
    places = [prompts.role_text("planner").index(f"\n- {prompts.stage_title(stage)}") for stage in STAGES]
    assert places == sorted(places)


def test_tools_that_are_named_are_there() -> None:
    known = {*(tool.name for tool in TOOLS), docs_client.NAME, plan_check.NAME}
    assert set(re.findall(r"\bblender_\w+", composed())) <= known


def test_only_the_coder_hears_of_code_and_nobody_of_how_the_api_is_spelled() -> None:
    texts = {path: path.read_text(encoding="utf-8") for path in own_files()}
    for path, text in texts.items():
        assert not re.search(r"bpy\.(ops|types|context)|\w+\(\)|\.\w+_\w+\b", text), path.name
        assert "bpy" not in text or path.stem == "coder"


def test_prompts_stay_short() -> None:
    rows = {"the protocol": of_text(protocol_text()) + of_text(rules_guide())}
    rows |= {f"stage {stage}": of_text(prompts.stage_text(stage)) for stage in STAGES}
    rows |= {f"{role}, whole": sum(map(of_text, system_prompt(role, "motion"))) for role in ROLES}
    rows |= {f"{role}, edit": sum(map(of_text, system_prompt(role, "motion", edit=True))) for role in ROLES}
    sys.stdout.write("\n".join(f"{name:24} {tokens:6} tokens at most" for name, tokens in rows.items()))
    assert rows["the protocol"] < 3200
    assert max(rows[f"stage {stage}"] for stage in STAGES) < 1000
    assert rows.pop("planner, whole") < 10_300
    assert max(rows.values()) < 7000
