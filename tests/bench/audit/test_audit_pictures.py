"""Each predicate has its picture on its page, so do the relations that have one, and pictures are small."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from audit_pictures import FOLDER, LARGEST, LARGEST_OF_ALL, PARAMS, TOLERANCES, too_large
from PIL import Image

from bench.audit.predicates.catalogue import PREDICATES
from bench.audit.relations import RELATIONS
from docs.generate.benchmark_pages import predicates_page, relations_page

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


DRAWN = {path.stem for path in FOLDER.iterdir()}


def test_every_predicate_has_a_picture_and_every_picture_its_relation_or_predicate() -> None:
    assert set(PREDICATES) <= DRAWN <= {*PREDICATES, *RELATIONS}


@pytest.mark.parametrize(("names", "page"), [(RELATIONS, relations_page), (PREDICATES, predicates_page)])
def test_each_entry_of_a_page_shows_its_own_picture(
    names: Mapping[str, object], page: Callable[[], str]
) -> None:
    text = page()
    for name in DRAWN & set(names):
        entry = text.partition(f"# `{name}`\n")[2].partition("\n#")[0]
        assert f"]({FOLDER.name}/{name}.png)" in entry, name


def test_pictures_are_small_and_can_be_opened() -> None:
    for path in FOLDER.iterdir():
        assert not list(too_large(path, LARGEST))
        with Image.open(path) as picture:
            picture.load()
            assert picture.width > picture.height
    assert not list(too_large(FOLDER, LARGEST_OF_ALL))


def test_what_a_picture_is_asked_with_fits_what_it_is_of() -> None:
    for name, params in PARAMS.items():
        PREDICATES[name].params.model_validate(params)
    assert set(TOLERANCES) <= set(RELATIONS)
