"""Errors below ``with``: a context manager that lets them out hides none of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from conftest import Check

_BODY = "ob = bpy.data.objects.new('a', None)\n    ob.keyframe_insert('location.x')"


@pytest.mark.parametrize(
    ("manager", "is_found"),
    [
        ("open('points.txt') as file", True),
        ("tempfile.TemporaryDirectory() as folder", True),
        ("bpy.context.temp_override(object=None)", True),
        ("open('a') as one, contextlib.redirect_stdout(one)", True),
        ("contextlib.suppress(TypeError)", False),
        ("pytest.raises(TypeError)", False),
        ("open('a') as one, contextlib.suppress(TypeError)", False),
        ("guard", False),
    ],
)
def test_what_lets_errors_out_hides_no_finding(check: Check, manager: str, *, is_found: bool) -> None:
    code = f"import bpy, contextlib, tempfile, pytest\nwith {manager}:\n    {_BODY}\n"
    assert bool(check("refused-path", code)) is is_found
