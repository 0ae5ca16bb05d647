"""The call that goes on with an answer: whole, quoted, or described."""

from __future__ import annotations

import json
import shlex

import pytest

from kb_serve.answer.next_call import next_call

QUERIES = ("cloth", 'mod["Socket_2"] = 5.0', "don't", "a $HOME \\ b", "-x", "größe", "!", '"')


@pytest.mark.parametrize("query", QUERIES)
def test_a_shell_reads_the_query_as_it_was(query: str) -> None:
    call = next_call(query, 7, "simworlds docs").strip("`")
    words = shlex.split(call)
    assert query in words
    assert words[words.index("--part") + 1] == "7"


@pytest.mark.parametrize("query", QUERIES)
def test_the_tools_argument_is_escaped(query: str) -> None:
    call = next_call(query, 7).strip("`")
    assert json.loads(call.removeprefix("blender_docs(").removesuffix(", part=7)")) == query


@pytest.mark.parametrize("query", ["word " * 60, "a `b`"])
def test_what_cannot_be_written_out_is_described(query: str) -> None:
    assert next_call(query, 7) == "the same query with `part=7`"
    assert next_call(query, 7, "simworlds docs") == "the same command with `--part 7`"
