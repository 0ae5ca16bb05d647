"""What a signature lists."""

from __future__ import annotations

import pytest

from kb_serve.signatures import signature_arguments


def test_arguments_are_listed_by_how_they_are_given() -> None:
    listed = signature_arguments('bmesh.ops.bevel(bm, /, geom=[], *, offset=0.5, profile="a(b")')
    assert listed is not None
    kinds = (listed.posonlyargs, listed.args, listed.kwonlyargs)
    assert [[argument.arg for argument in held] for held in kinds] == [
        ["bm"],
        ["geom"],
        ["offset", "profile"],
    ]


@pytest.mark.parametrize(
    "signature", ["", "Vector", "(a)", "f(a", "f(...)", "f(a, [b])", "f(a\0)", "f" + "(" * 9999 + ")" * 9999]
)
def test_what_is_no_python_lists_none(signature: str) -> None:
    assert signature_arguments(signature) is None
