"""The base that is measured beside ours is built without the query expansions that symbols are found by."""

from __future__ import annotations

from kb_build import store
from measurements.retrieval import without_expansions


def test_the_store_finds_no_expansions_but_those_that_weigh() -> None:
    weighing = store.load_query_expansions(plain=False)
    with without_expansions():
        assert store.load_query_expansions() == store.page_expansions({}) == {}
        assert store.load_query_expansions(plain=False) == weighing != {}
    assert store.load_query_expansions()
