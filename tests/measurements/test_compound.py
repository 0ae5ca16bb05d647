"""What counts as told of a question that wants several names at once."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING

import pytest

from kb_serve.reader import BaseReader
from measurements.compound import OPTION, SETS, is_given, read_compound
from measurements.setting import QUERIES

if TYPE_CHECKING:
    from pathlib import Path

ANSWER = """## `bpy.types.SpotLight.spot_size`

**In Python**
- `SpotLight.spot_blend` float = 0.15
- `bpy.ops.wm.usd_export` Export a USD file — asked for: `selected_objects_only`
"""


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("bpy.types.SpotLight.spot_size", True),
        ("bpy.types.SpotLight.spot_blend", True),
        ("bpy.types.SpotLight.show_cone", False),
        ("bpy.ops.wm.usd_export", True),
        ("bpy.ops.wm.usd_export.selected_objects_only", True),
        ("bpy.ops.wm.usd_export.export_hair", False),
        ("bpy.ops.wm.alembic_export.selected_objects_only", False),
    ],
)
def test_a_name_is_given_with_its_class_and_an_argument_with_its_operator(name: str, told: bool) -> None:
    assert is_given(name, ANSWER) is told


@pytest.mark.parametrize("name", SETS)
def test_every_question_wants_at_least_two_things(name: str) -> None:
    queries = read_compound(QUERIES / f"{name}.jsonl")
    assert len({query.query for query in queries}) == len(queries) > 100
    assert all(len(query.expect_all) > 1 and all(query.expect_all) for query in queries)


@pytest.mark.parametrize("name", SETS)
def test_each_of_them_has_a_name_in_the_base_that_was_built(name: str, base: Path) -> None:
    with closing(BaseReader(base)) as reader:
        known = {path for (path,) in reader.rows("SELECT path FROM symbols")}
    queries = read_compound(QUERIES / f"{name}.jsonl")
    wanted = [[OPTION.sub(r"\1", name) for name in names] for query in queries for names in query.expect_all]
    assert [names for names in wanted if known.isdisjoint(names)] == []
