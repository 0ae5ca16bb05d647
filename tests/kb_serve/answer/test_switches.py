"""An answer names what a setting does nothing without, where only the names tell it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.answer.facts.switches import switch_lines
from kb_serve.answer.known.practice import Practice

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("ArrayModifier.use_constant_offset", ["goes with `constant_offset_displace`"]),
        (
            "ArrayModifier.constant_offset_displace",
            ["goes with `use_constant_offset` (a new one has it off)"],
        ),
        ("ArrayModifier.relative_offset_displace", ["goes with `use_relative_offset`"]),
        ("LimitLocationConstraint.max_x", ["goes with `use_max_x` (a new one has it off)"]),
        (
            "BooleanModifier.collection",
            ["goes with `operand_type = 'COLLECTION'` (a new one has `'OBJECT'`)"],
        ),
        ("BooleanModifier.solver", []),
        ("Mesh.vertices", []),
    ],
)
def test_what_goes_with_a_setting(reader: BaseReader, path: str, expected: list[str]) -> None:
    symbol = reader.symbol(f"bpy.types.{path}")
    assert symbol is not None
    assert list(switch_lines(symbol, reader)) == expected


def test_a_handler_is_said_to_go_when_a_file_is_loaded(reader: BaseReader) -> None:
    practice = Practice(reader)
    assert any("persistent" in text for text in practice.of("bpy.app.handlers.load_post", "load_post"))
    assert not list(practice.of("bpy.app.handlers.persistent", "persistent"))
