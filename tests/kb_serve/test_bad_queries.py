"""Whatever is typed: an answer within its budget, or a refusal that says what to do. Never anything else."""

from __future__ import annotations

import random
import string
import time
from typing import TYPE_CHECKING

import pytest

from kb_serve.answer.budget import tokens
from kb_serve.errors import BadQuery

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

NASTY = {
    "nul": "\x00", "nul in a name": "Cloth\x00Settings.quality", "nul before a name": "\x00bpy.types.Object",
    "emoji": "🎨🧵 cloth 🧵", "only emoji": "🎨", "flags": "🇩🇪🇫🇷", "right to left": "\u202ecloth\u202c",
    "bom": "\ufeffcloth",
    "lone surrogate": "\ud800", "surrogate in a name": "bpy.types.Cl\udfffothSettings",
    "surrogates": "\ud83d \ude00" * 50,
    "combining": "c\u0301\u0302\u0303loth" * 50, "control": "".join(map(chr, range(32))), "delete": "\x7f" * 10,
    "quote": '"', "quotes": "'\"`" * 40, "unclosed": "obj.modifiers[\"Cloth", "star": "*", "cloth star": "cloth*",
    "near": "NEAR(cloth quality, 5)", "column": "path:cloth", "col": "col:", "and": "cloth AND NOT quality OR (",
    "minus": "-cloth", "caret": "^cloth", "match": "symbols MATCH 'x'", "sql": "'; DROP TABLE symbols; --",
    "union": "' UNION SELECT path FROM symbols --", "percent": "%", "underscore": "_", "like": "%cloth_%",
    "comment": "/* */ --", "question mark": "?", "parameter": "?1 :name @x $y", "backslash": "\\",
    "backslashes": "\\" * 99,
    "parent folder": "../../../../etc/passwd", "absolute": "/etc/passwd", "windows": "C:\\Windows\\System32",
    "file url": "file:///etc/passwd", "slug climbing": "physics/../physics/cloth/index", "encoded": "%2e%2e%2f",
    "slug with nul": "physics/cloth\x00/index", "slashes": "/" * 200, "dots": "." * 500, "dotted": "a." * 500,
    "brackets": "[" * 500, "parentheses": "(" * 500, "closed": ")]}" * 200, "call": "f(" * 300 + ")" * 300,
    "index": "a" + "[0]" * 400, "keys": "a" + '["x"]' * 400, "number": "1234567890", "float": "1e309",
    "minus one": "-1",
    "html": "<script>alert(1)</script>", "markdown": "```\n# x\n```", "template": "{{ 7 * 7 }} ${x} {0} %s %n",
    "long word": "x" * 10_000, "long words": "cloth " * 1_700, "long name": "a_" * 5_000, "long dotted": "bpy." * 2_500,
    "long capitals": "AB_" * 3_300, "long quoted": "'" + "x" * 9_000 + "'", "long camel": "Cloth" * 2_000,
    "regex": "(a+)+$" * 500, "quoted items": "'A' " * 2_500, "long error": "'X' object has no attribute 'y' " * 300,
    "long enum": 'enum "A" not found in (' + "'B', " * 2_000 + ")", "newlines": "\n" * 5_000 + "x", "tabs": "\tcloth\t",
    "old mac": "cloth\rquality", "line separator": "cloth\u2028quality", "no-break": "cloth\u00a0quality",
    "url": "https://docs.blender.org/manual/en/5.1/../../etc/passwd.html",
    "api url": "https://docs.blender.org/api/current/",
    "bad url": "https://docs.blender.org/manual/en/latest/%00.html#" + "x" * 3_000, "python": "import os; os._exit(1)",
    "format": "%(path)s", "json": '{"query": "cloth"}', "xml": "<?xml version='1.0'?>", "turkish": "İıŞş",
    "sharp s": "STRASSE ß",
    "math": "𝒄𝒍𝒐𝒕𝒉", "full width": "ＣｌｏｔｈＳｅｔｔｉｎｇｓ", "cyrillic a": "Cloth" + "\u0430",
    "getattr of nothing": 'getattr(ob..data, "name")', "getattr of a number": 'getattr(ob.3, "name")',
    "prop of much": f"layout.prop({'.'.join('a' * 30)}, 'name')",
    "zero width": "Cl\u200both",
}  # fmt: skip
EMPTY = ["", " ", "\n\t ", "\x00", "\x00\x00 \x00", "\u2003", "\x1f\x1e"]


def ask(kb: KnowledgeBase, query: str, max_tokens: int = 1_500) -> None:
    """Fails unless every part of the answer keeps its budget, or the query is refused in words."""
    try:
        answer = kb.query(query, max_tokens=max_tokens)
    except BadQuery:
        return
    assert answer.kind in {"schema", "page", "candidates", "none"}
    assert tokens(answer.text) <= max_tokens
    assert answer.text.strip()
    assert tokens(kb.query(query, max_tokens=max_tokens, part=answer.parts).text) <= max_tokens
    with pytest.raises(BadQuery):
        kb.query(query, max_tokens=max_tokens, part=answer.parts + 1)


@pytest.mark.parametrize("name", NASTY)
def test_a_nasty_query_is_answered_or_refused(kb: KnowledgeBase, name: str) -> None:
    start = time.process_time()
    ask(kb, NASTY[name])
    ask(kb, NASTY[name], 150)
    assert time.process_time() - start < 5


@pytest.mark.parametrize("query", EMPTY, ids=ascii)
def test_an_empty_query_is_refused_with_an_example(kb: KnowledgeBase, query: str) -> None:
    with pytest.raises(BadQuery, match=r"empty.*ClothSettings\.quality"):
        kb.query(query)


@pytest.mark.parametrize("name", ["nul in a name", "surrogate in a name", "zero width"])
def test_characters_outside_names_do_not_hide_a_name(kb: KnowledgeBase, name: str) -> None:
    assert any("Cloth" in hit.id or "cloth" in hit.id for hit in kb.query(NASTY[name], limit=20).hits)


@pytest.mark.parametrize(
    "query", ["cloth*", '"cloth" AND quality', "NEAR(cloth quality)", "title:cloth", "-cloth ^self"]
)
def test_search_syntax_is_taken_as_words(kb: KnowledgeBase, query: str) -> None:
    assert any("cloth" in hit.id.lower() for hit in kb.query(query, limit=20).hits)


@pytest.mark.parametrize("seed", range(12))
def test_random_text_with_random_budgets(kb: KnowledgeBase, seed: int) -> None:
    chance = random.Random(seed)
    names = [
        "bpy",
        "types",
        "ClothSettings",
        "quality",
        "obj",
        "modifiers",
        "Cloth",
        "how",
        "to",
        "EMITTER",
        "nodes",
        "C",
    ]
    marks = [
        '["',
        '"]',
        "(",
        ")",
        ".",
        " ",
        "'",
        "\n",
        "=",
        ":",
        "/",
        "->",
        "🎨",
        "\x00",
        "\ud83d",
        "é",
        "_",
        "#",
        ",",
    ]
    for _ in range(25):
        pieces = chance.choices(
            [*names, *marks, *string.punctuation, chr(chance.randrange(1, 0x10FFFF))], k=30
        )
        ask(kb, "".join(pieces[: chance.randrange(1, 30)]), chance.randrange(150, 3_000))


def test_raw_records_of_nasty_names_are_simply_absent(kb: KnowledgeBase) -> None:
    for text in NASTY.values():
        assert kb.symbol(text) is None
        assert kb.page(text) is None
