"""Code in any text is found as chains of steps; nothing that is typed makes the reader stumble."""

from __future__ import annotations

import random
import string
import time

import pytest

from kb_serve.recognise.chains.chains import MAX_QUERY, ChainStep, find_chains


def steps(text: str) -> list[tuple[str, str]]:
    (chain,) = find_chains(text)
    return [(step.kind, step.text) for step in chain.steps]


@pytest.mark.parametrize(
    ("text", "root", "expected"),
    [
        ("obj", "obj", []),
        ("obj.name", "obj", [("attr", "name")]),
        ("obj . name", "obj", [("attr", "name")]),
        ("obj->name", "obj", [("attr", "name")]),
        ("a.b .c", "a", [("attr", "b"), ("attr", "c")]),
        ("Settings -> use_x", "Settings", [("attr", "use_x")]),
        ("Obj::name", "Obj", [("attr", "name")]),
        ('a["Key"]', "a", [("key", "Key")]),
        ("a['Key']", "a", [("key", "Key")]),
        ('a[u"Key"]', "a", [("key", "Key")]),
        ("a[ 'Ke]y' ]", "a", [("key", "Ke]y")]),
        ("a[0]", "a", [("index", "0")]),
        ("a[i + 1]", "a", [("index", "i + 1")]),
        ("a[f(x)[0]].b", "a", [("index", "f(x)[0]"), ("attr", "b")]),
        ("a()", "a", [("call", "")]),
        ("a.b(c, d=(1, 2)).e", "a", [("attr", "b"), ("call", "c, d=(1, 2)"), ("attr", "e")]),
        ("a.b(", "a", [("attr", "b"), ("call", "")]),
        ('a["unclosed', "a", [("index", '"unclosed')]),
        ("größe.länge", "größe", [("attr", "länge")]),
        (r'a["say \"x\""]', "a", [("key", r"say \"x\"")]),
    ],
)
def test_steps_are_read_as_python_reads_them(text: str, root: str, expected: list[tuple[str, str]]) -> None:
    (chain,) = find_chains(text)
    assert (chain.root, chain.source) == (root, text)
    assert steps(text) == expected


def test_every_expression_of_a_text_is_found_in_order() -> None:
    text = "Why does `bpy.context.object.location` not follow obj.parent['x'] in Blender?"
    found = [chain.source for chain in find_chains(text) if chain.steps]
    assert found == ["bpy.context.object.location", "obj.parent['x']"]


@pytest.mark.parametrize(
    ("text", "code"),
    [("cloth", False), ("Cloth", False), ("use_self", True), ("ClothSettings", True), ("a.b", True), ("f()", True),
     ("_", False), ("__init__", False), ("UV", False), ("qualitySteps", True)],
)  # fmt: skip
def test_a_lone_word_of_prose_is_no_code(text: str, code: bool) -> None:
    assert find_chains(text)[0].is_code is code


def test_the_dotted_part_ends_at_the_first_call_or_index() -> None:
    (chain,) = find_chains('bpy.data.objects["Cube"].modifiers.new(name="x")')
    assert chain.dotted == "bpy.data.objects"
    assert chain.attributes == ("data", "objects", "modifiers", "new")


def test_a_full_stop_between_sentences_is_no_attribute() -> None:
    assert [chain.steps for chain in find_chains("It is a cube. 3 faces")] == [()] * 5
    for text in ("Add a camera. Then render", "a camera.How do I", "ob.  it moves", "a sphere.\nplease help"):
        assert not any(chain.steps for chain in find_chains(text)), text
    (chain,) = (one for one in find_chains("Set ob.location. Then render.") if one.steps)
    assert chain.source == "ob.location"


@pytest.mark.parametrize("text", ["save as .blend file", "noise texture -> color ramp", "Texture → Color"])
def test_neither_an_ending_nor_an_arrow_between_words_leads_to_a_member(text: str) -> None:
    assert not any(chain.steps for chain in find_chains(text))


@pytest.mark.parametrize(
    ("text", "dotted"),
    [
        ("ob->data->vertices", "ob.data.vertices"),
        ("Scene → frame_end", "Scene.frame_end"),
        ("bpy.context.object -> None", "bpy.context.object"),
        ("mesh.vertices → IndexError: no elements", "mesh.vertices"),
        ("fcurve.keyframe_points -> list of keys", "fcurve.keyframe_points"),
    ],
)
def test_an_arrow_leads_to_a_member_but_not_to_what_a_line_came_to(text: str, dotted: str) -> None:
    assert find_chains(text)[0].dotted == dotted


def test_a_page_of_code_is_read_up_to_a_limit_and_fast() -> None:
    code = "\n".join(f"obj{n}.modifiers['M{n}'].settings.quality = {n}" for n in range(5_000))
    start = time.process_time()
    found = find_chains(code)
    assert len(found) <= MAX_QUERY
    assert len([chain for chain in found if chain.is_code]) <= 12
    assert time.process_time() - start < 1


@pytest.mark.parametrize(
    "piece", ["(", "[", '["', "a(", "a[", "a.", "a->", "'", '"', "\\", "a['\\", ")", "]", "(((["]
)
def test_brackets_without_end_take_no_time_of_note(piece: str) -> None:
    start = time.process_time()
    find_chains(piece * 10_000)
    assert time.process_time() - start < 2


def test_any_text_is_read() -> None:
    chance = random.Random(1)
    alphabet = string.printable + "éß→🎨\x00\ud800"
    for _ in range(2_000):
        text = "".join(chance.choices(alphabet, k=60))
        for chain in find_chains(text):
            assert chain.source in text
            assert all(isinstance(step, ChainStep) for step in chain.steps)
