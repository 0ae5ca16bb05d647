"""Answers: what they say of a symbol, a page, candidates; within the budget, in parts, with nothing lost."""

from __future__ import annotations

import random
import re
from typing import TYPE_CHECKING

import pytest
from asking import SEED, classes, of_data, paths

from kb_build.pages.page import Page, Section
from kb_build.store import Contents, write_base
from kb_serve.answer.budget import AnswerBlock, tokens
from kb_serve.answer.composer import AnswerComposer
from kb_serve.answer.hit_answers import _names_before_long
from kb_serve.answer.hit_lines import NAMES
from kb_serve.answer.next_call import next_call
from kb_serve.answer.pages import MANUALS_WORDS
from kb_serve.errors import BadQuery
from kb_serve.knowledge_base import KnowledgeBase
from kb_serve.query_limits import LEAST_TOKENS, LIMIT, MAX_LIMIT, MAX_TOKENS

if TYPE_CHECKING:
    from pathlib import Path

    from kb_serve.answer.docs_answer import DocsAnswer
    from kb_serve.reader import BaseReader

QUERIES = (
    "bpy.types.Object", "bpy.types.ID", "bpy.ops.object.modifier_add", "bpy.types", "mathutils.Matrix", "bpy.ops.mesh",
    "bpy.types.Action.fcurves", "bpy.types.ClothSettings.qualiti", "cloth", "rigid body",
    "physics/cloth/settings/index",
    "how do I stop cloth from passing through its collider?", "Subdivision Surface", "templates_py/operator_modal",
    'mat.node_tree.nodes["Principled BSDF"].inputs["Specular"]', "rna_enum_icon_items", "xyzzy plugh",
    "AttributeError: 'Action' object has no attribute 'fcurves'", "bpy.types.UILayout.label", "EEVEE bloom",
    "add a cube, give it cloth and render it",
)  # fmt: skip
FOOTER = re.compile(r"\n\n_Parts? \d+(?: to \d+)? of \d+\. Left: .*\. Next: .*_$", re.DOTALL)


def body(answer: DocsAnswer) -> str:
    """What an answer says, without the footer behind it; white space left out."""
    return "".join(FOOTER.sub("", answer.text).split())


def whole(kb: KnowledgeBase, query: str, max_tokens: int) -> list[DocsAnswer]:
    """An answer and those to the calls that its footers name."""
    answers = [kb.query(query, max_tokens=max_tokens)]
    while answers[-1].next_part:
        answers.append(kb.query(query, max_tokens=max_tokens, part=answers[-1].next_part))
    return answers


@pytest.mark.parametrize("query", QUERIES)
def test_answers_fit_the_budget_and_are_complete_together(kb: KnowledgeBase, query: str) -> None:
    chance = random.Random(query)
    everything = kb.query(query, max_tokens=1_000_000)
    assert everything.next_part == 0
    for budget in (LEAST_TOKENS, *(chance.randrange(LEAST_TOKENS, 3_000) for _ in range(4))):
        answers = whole(kb, query, budget)
        assert max(tokens(answer.text) for answer in answers) <= budget
        assert "".join(map(body, answers)) == body(everything)
        assert {(answer.kind, answer.hits, answer.notes, answer.parts) for answer in answers} == {
            (everything.kind, everything.hits, everything.notes, everything.parts)
        }


@pytest.mark.parametrize("query", QUERIES)
def test_a_part_is_the_same_for_every_budget(kb: KnowledgeBase, query: str) -> None:
    part = 1 + kb.query(query).parts // 2
    small, large = (kb.query(query, max_tokens=budget, part=part) for budget in (LEAST_TOKENS, 2_000))
    assert small.parts == large.parts
    assert body(large).startswith(body(small))


def test_the_budget_holds_for_any_symbol_and_any_budget(kb: KnowledgeBase, reader: BaseReader) -> None:
    chance = random.Random(SEED)
    sample = paths(reader, "class", 60) + paths(reader, "operator", 60) + of_data(reader, "property", 60)
    sample += paths(reader, "module", 40) + [f"{path}x" for path in of_data(reader, "property", 40)]
    for query in sample:
        budget = chance.randrange(LEAST_TOKENS, 1_500)
        answer = kb.query(query, max_tokens=budget)
        assert tokens(answer.text) <= budget
        last = kb.query(query, max_tokens=budget, part=answer.parts)
        assert tokens(last.text) <= budget


@pytest.mark.parametrize("query", QUERIES)
def test_the_footer_names_what_is_left_and_the_call_that_fetches_it(kb: KnowledgeBase, query: str) -> None:
    first = kb.query(query, max_tokens=LEAST_TOKENS)
    if not first.next_part:
        assert "_Part" not in first.text
        return
    assert f" of {first.parts}. Left: " in first.text
    assert first.text.endswith(f". Next: {next_call(query, first.next_part)}_")
    last = kb.query(query, max_tokens=LEAST_TOKENS, part=first.parts)
    assert "_Part" not in last.text


def test_the_footers_call_repeats_a_short_query(kb: KnowledgeBase) -> None:
    first = kb.query("bpy.types.Object", max_tokens=300)
    match = re.search(r'Next: `blender_docs\("(.+)", part=(\d+)\)`_$', first.text)
    assert match is not None
    assert kb.query(match[1], max_tokens=300, part=int(match[2])).part == first.next_part


@pytest.mark.parametrize(
    "query", ["bpy.types.Object", "bpy.types.ClothSettings.quality", "how to bake cloth"]
)
def test_a_part_beyond_the_last_is_refused_with_the_number_there_is(kb: KnowledgeBase, query: str) -> None:
    parts = kb.query(query).parts
    with pytest.raises(BadQuery, match=f"part={parts + 1} does not exist: this answer has {parts} part"):
        kb.query(query, part=parts + 1)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"limit": 0}, "limit=0"), ({"limit": -1}, "limit=-1"), ({"part": 0}, "part=0"), ({"part": -3}, "part=-3"),
        ({"max_tokens": 149}, "150 or more"), ({"max_tokens": 0}, "max_tokens=0"), ({"max_tokens": -5},
        "max_tokens=-5"),
    ],
)  # fmt: skip
def test_numbers_out_of_range_are_refused_with_advice(
    kb: KnowledgeBase, arguments: dict[str, int], said: str
) -> None:
    with pytest.raises(BadQuery, match=said):
        kb.query("cloth", **arguments)


@pytest.mark.parametrize("limit", [1, 2, 8, MAX_LIMIT, 10_000])
def test_hits_keep_the_limit_and_are_unique(kb: KnowledgeBase, limit: int) -> None:
    for query in ("quality", "cloth", "modifier", "how to bake a simulation", "bpy.types.Object.location"):
        hits = kb.query(query, limit=limit).hits
        assert len(hits) <= min(limit, MAX_LIMIT)
        assert len({hit.id for hit in hits}) == len(hits)


def test_hits_are_ranked_and_exist(kb: KnowledgeBase, reader: BaseReader) -> None:
    for query in QUERIES:
        answer = kb.query(query, limit=MAX_LIMIT)
        assert (answer.kind == "none") == (answer.hits == ())
        for hit in answer.hits:
            assert reader.entry(hit.id) or reader.manual.page_entry(hit.id), hit.id
            assert hit.title
            assert 0 <= hit.score <= 1
        if answer.hits:
            assert answer.hits[0].id in answer.text or answer.hits[0].title in answer.text


@pytest.mark.parametrize(
    ("query", "kind"),
    [
        ("bpy.types.ClothSettings.quality", "schema"), ("physics/cloth/settings/index", "page"), ("cloth", "page"),
        ("how do I make the simulation finer", "candidates"), ("qwrtzpsdfg xkcdvbn", "none"),
        ("SoftBodySettings.use_self_colision", "schema"),
    ],
)  # fmt: skip
def test_the_kind_tells_what_sort_of_answer_it_is(kb: KnowledgeBase, query: str, kind: str) -> None:
    assert kb.query(query).kind == kind


def test_candidates_show_the_best_and_list_the_others(kb: KnowledgeBase) -> None:
    answer = kb.query("stop the cloth from passing through the floor", max_tokens=3_000)
    assert answer.kind == "candidates"
    assert answer.text.index("**In Python**") < answer.text.index("**Pages**")
    for hit in answer.hits[1:]:
        assert f"`{hit.id}`" in answer.text


@pytest.mark.parametrize(
    ("query", "name"),
    [
        ("keep the foot above the ground", "**Nearest**\n- `offset` float"),
        ("wind for cloth", "`bpy.types.EffectorWeights` Effector weights for physics simulation — nearest:"),
    ],
)
def test_a_class_that_was_found_is_told_with_the_members_that_were(
    kb: KnowledgeBase, query: str, name: str
) -> None:
    assert name in kb.query(query).text


def test_a_method_that_was_found_is_told_with_what_makes_its_instance(kb: KnowledgeBase) -> None:
    answer = kb.query("check if two meshes overlap")
    assert answer.hits[0].id == "mathutils.bvhtree.BVHTree.overlap"
    assert "`mathutils.bvhtree.BVHTree.FromObject(object, depsgraph)`" in answer.text


def test_an_argument_that_is_named_comes_first(kb: KnowledgeBase) -> None:
    answer = kb.query("bpy.ops.wm.usd_export selected_objects_only")
    assert answer.text.startswith(
        "**Asked for**, of `bpy.ops.wm.usd_export`\n- `selected_objects_only` (boolean"
    )
    assert not answer.notes
    assert "Asked for" not in kb.query("bpy.ops.wm.usd_export").text


def test_corrections_come_before_the_answer(kb: KnowledgeBase) -> None:
    answer = kb.query("ClothSettings.qualiti")
    assert answer.text.startswith("> `qualiti` does not exist; read as `quality`.")
    assert kb.query("ClothSettings.qualiti").notes == answer.notes


def test_asking_twice_or_with_other_blanks_gives_the_same(kb: KnowledgeBase) -> None:
    for query in QUERIES:
        assert kb.query(query) == kb.query(f"  {query.replace(' ', '   ')}\n")


def test_a_long_note_does_not_crowd_out_the_answer(kb: KnowledgeBase) -> None:
    code = "\n".join(f"obj.rigid_body.no_such_thing_{n} = {n}" for n in range(30))
    answer = kb.query(code, max_tokens=LEAST_TOKENS)
    assert tokens(answer.text) <= LEAST_TOKENS
    assert "RigidBodyObject" in answer.text


def test_classes_of_the_interface_are_answered_too(kb: KnowledgeBase, reader: BaseReader) -> None:
    for path in classes(reader, "ui", 30) + classes(reader, "operator", 30):
        assert kb.query(path).hits[0].id == path


@pytest.mark.parametrize(
    "query", ["cycles property group settings", "scale vectors of verts bmesh", "gpu devices"]
)
def test_every_further_hit_says_something(kb: KnowledgeBase, query: str) -> None:
    lines = kb.query(query, limit=30, max_tokens=100_000).text.partition("**In Python**\n")[2].split("\n")
    assert lines
    assert not [
        line for line in lines if line.startswith("- ") and line.endswith("`") and line.count("`") == 2
    ]


def test_each_part_of_a_question_is_answered_in_brief_and_no_name_twice(kb: KnowledgeBase) -> None:
    answer = kb.query(
        "add a modifier to the object, make cloth collide with itself and set the render engine"
    )
    parts = [line for line in answer.text.split("\n") if re.match(r"\*\*\d\. ", line)]
    assert parts == [
        "**1. add a modifier to the object**",
        "**2. make cloth collide with itself**",
        "**3. set the render engine**",
    ]
    assert "3 parts" in answer.notes[0]
    assert answer.kind == "candidates"
    first, second, third = (part.split("\n")[1:] for part in re.split(r"\n\n\*\*\d\. ", answer.text)[1:])
    assert any("modifier" in line for line in first)
    assert any("use_self_collision" in line for line in second)
    assert any("RenderSettings.engine" in line for line in third)
    named = [line.split("`")[1] for line in (*first, *second, *third) if line.startswith("- ")]
    assert len(named) == len({*named})
    assert {hit.id for hit in answer.hits} <= {*named}


def test_an_operator_of_which_blender_says_nothing_is_listed_with_its_call(kb: KnowledgeBase) -> None:
    lines = kb.query("which camera is rendered python").text.splitlines()
    (line,) = (line for line in lines if line.startswith("- `bpy.ops.render.render`"))
    assert line.startswith("- `bpy.ops.render.render` `render(animation=False, write_still=False, ")


def test_the_code_of_a_query_is_checked_once_for_all_parts_of_its_answer(kb: KnowledgeBase) -> None:
    checked: list[str] = []

    def note(_: BaseReader, query: str) -> tuple[str]:
        checked.append(query)
        return ("Blender refuses it.",)

    composer = AnswerComposer(kb.reader, note)
    query = "bpy.types.Object\n"
    first, second = (composer.answer(query, LIMIT, MAX_TOKENS, part) for part in (1, 2))
    assert checked == [query]
    assert first.text.startswith("> Blender refuses it.")
    assert first.notes == second.notes
    assert not second.text.startswith(">")


@pytest.mark.parametrize(
    "code",
    [
        "sc.frame_set(1.5)",
        "bpy.ops.wm.open_mainfile('a.blend')",
        "layout.box(True)",
        "d = ob.driver_add('location', 0).driver\nv = d.variables.new('var')",
    ],
)
def test_what_is_wrong_with_a_call_is_said_once(kb: KnowledgeBase, code: str) -> None:
    assert len(kb.query(code).notes) == 1


def test_a_short_page_is_shown_to_its_end_without_what_says_nothing(tmp_path: Path) -> None:
    slug = "shader_nodes/particle_info"
    sections = (
        Section("top", "Particle Info Node", 1, "It gives data of the particle that made an instance. " * 12),
        Section("inputs", "Inputs", 2, "This node has no inputs."),
        Section("outputs", "Outputs", 2, "**Random**\n  A random value of each particle. " * 9),
    )
    pages = [
        Page(slug, "manual", "5.1", "Particle Info Node", sections),
        Page("other", "manual", "5.1", "Other", (Section("top", "Other", 1, "An instance of a particle."),)),
    ]
    write_base(tmp_path / "base.sqlite", Contents([], pages, (), {}))
    with KnowledgeBase(tmp_path / "base.sqlite") as own:
        found = own.query("data of the particle that made each instance")
        assert found.hits[0].id == slug
        assert "A random value of each particle" in found.text
        assert "This node has no inputs" not in found.text
        assert "This node has no inputs" in own.query(slug).text


def test_the_footer_says_where_the_last_line_goes_on(kb: KnowledgeBase) -> None:
    query = "bpy.ops.object.modifier_add"
    numbers = range(1, 1 + kb.query(query, max_tokens=LEAST_TOKENS).parts)
    parts = [kb.query(query, max_tokens=LEAST_TOKENS, part=number) for number in numbers]
    everything = body(kb.query(query, max_tokens=1_000_000))
    cut = [part for part in parts if "Left: the rest of the last line, " in part.text]
    assert cut
    lines = {"".join(line.split()) for line in kb.query(query, max_tokens=1_000_000).text.split("\n")}
    for part in cut:
        last = FOOTER.sub("", part.text).split("\n")[-1]
        assert "".join(last.split()) not in lines
        assert "".join(last.split()) in everything


def test_other_names_go_before_a_long_text_of_the_manual_and_behind_a_short_one() -> None:
    head, values = AnswerBlock("## `deform_method`"), AnswerBlock("**Values**", "values")
    names, found = AnswerBlock("**In Python**", NAMES), AnswerBlock("**Pages**", "further pages")
    for length, order in (
        (1_000, [head, values, names, "text", found]),
        (10, [head, "text", values, names, found]),
    ):
        text = AnswerBlock("word " * length, MANUALS_WORDS)
        wanted = [text if one == "text" else one for one in order]
        assert [*_names_before_long([head, text, values], [names, found])] == wanted
    alone = AnswerBlock("word " * 1_000, MANUALS_WORDS)
    assert [*_names_before_long([head, alone, values], [])] == [head, alone, values]


def test_the_arguments_that_words_ask_of_a_named_function_come_first(kb: KnowledgeBase) -> None:
    told = kb.query("StringProperty with search callback").text
    heading, arguments = told.index("## `bpy.props.StringProperty`"), told.index("**Asked for**")
    assert heading < arguments < told.index("edit_text") < told.index("**Other parameters**")
    assert told.count("- `search` (") == 1
    assert "**Asked for**" not in kb.query("bpy.props.StringProperty").text
    assert "**Asked for**" not in kb.query("bpy.props.StringProperty(name='search')").text


def test_a_method_is_told_as_code_calls_it(kb: KnowledgeBase) -> None:
    text = kb.query(
        "add a modifier to the object, make cloth collide with itself and link a new collection"
    ).text
    assert "`bpy.types.BlendDataCollections.new`" in text
    assert "`bpy.data.collections.new(…)`" in text
