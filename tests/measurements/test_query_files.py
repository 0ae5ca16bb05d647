"""The labelled query sets, and what reading a broken one says."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_build.base_file import read_meta
from kb_build.errors import StoreError
from measurements.retrieval import KINDS, BadQueries, read_queries, unknown_labels
from measurements.setting import BLENDER, QUERIES
from simworlds.settings import base_path, home_folder

if TYPE_CHECKING:
    from pathlib import Path

# Lines of old scripts are judged by what they say is gone (measurements/old_code.py, history.py), questions for several
# names by all of them (compound.py), tasks by what code needs (recipes.py), not by ids.
_OTHERWISE = {"old_code", "removed", "compound", "compound_kept", "tasks", "tasks_kept"}
SETS = sorted(path for path in QUERIES.glob("*.jsonl") if path.stem not in _OTHERWISE)


@pytest.mark.parametrize("path", SETS, ids=lambda path: path.stem)
def test_every_query_is_labelled_and_named_once(path: Path) -> None:
    queries = read_queries(path)
    assert len({query.id for query in queries}) == len(queries)
    assert len({query.query for query in queries}) == len(queries)
    assert [query.id for query in queries if not query.query.strip()] == []
    assert [query.id for query in queries if not query.expect_any + query.expect_pages] == []
    assert {query.kind for query in queries} <= set(KINDS)


def test_no_query_is_in_two_sets() -> None:
    texts = [{query.query for query in read_queries(path)} for path in SETS]
    assert len(set().union(*texts)) == sum(map(len, texts))
    assert len(SETS) >= 2


@pytest.mark.parametrize("path", SETS, ids=lambda path: path.stem)
def test_every_label_is_in_the_base_that_was_built(path: Path) -> None:
    base = base_path(home_folder(), BLENDER)
    try:
        sources = read_meta(base).get("sources", "")
    except StoreError as error:
        pytest.skip(f"no usable base of Blender {BLENDER} on this machine: {error}")
    if '"manual"' not in sources:
        pytest.skip("the base on this machine has no manual")
    assert unknown_labels(read_queries(path), base) == []


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("{", "line 2"),
        ("[]", "line 2"),
        ('{"id": "x", "query": "y", "kind": "natural", "expect_any": []}', "expect_pages"),
        ('{"id": "x", "query": "y", "kind": "natural", "expect_any": null, "expect_pages": []}', "line 2"),
    ],
)
def test_names_a_broken_line(tmp_path: Path, line: str, said: str) -> None:
    file = tmp_path / "set.jsonl"
    file.write_text(f"\n{line}\n", encoding="utf-8")
    with pytest.raises(BadQueries, match=said):
        read_queries(file)


def test_names_a_missing_or_empty_file(tmp_path: Path) -> None:
    with pytest.raises(BadQueries, match=r"absent\.jsonl: cannot be read"):
        read_queries(tmp_path / "absent.jsonl")
    empty = tmp_path / "empty.jsonl"
    empty.touch()
    with pytest.raises(BadQueries, match="holds no queries"):
        read_queries(empty)
