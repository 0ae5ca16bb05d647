"""Matrices and quaternions are multiplied by ``@``; ``*`` multiplies item by item."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import PRODUCTS
from kb_build.flow.syntax.trees import walk
from kb_check.findings import Edit
from kb_check.migrate.change import Change
from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.place import Place

_SINCE = (2, 80)
BEFORE_PRODUCTS = (2, 79)  # the last Blender in which * multiplied them as @ does now
_SOURCE = "release notes 2.80: Python API"
_REASON = "Matrices, quaternions and vectors are multiplied with @ since 2.80; * is item by item."
# Pairs for which Blender refuses ``*``. For the others both work, with another meaning: only old code means a product.
_REFUSED = PRODUCTS["@"] - PRODUCTS["*"]


def _propose(place: Place) -> Iterator[Change]:
    if place.target < _SINCE:
        return
    for node in walk(place.script.tree):
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult):
            left, right = node.left, node.right
        elif isinstance(node, ast.AugAssign) and isinstance(node.op, ast.Mult):
            left, right = node.target, node.value
        else:
            continue
        if not _is_product(place, left, right):
            continue
        span, text = place.between(left, right)
        if text.count("*") == 1 and "#" not in text:
            yield Change(REWRITE.id, (Edit(span, text.replace("*", "@")),), _REASON, _SOURCE, _SINCE)


def _is_product(place: Place, left: ast.expr, right: ast.expr) -> bool:
    for one, other in PRODUCTS["@"]:
        if place.is_a(left, one) and place.is_a(right, other):
            return (one, other) in _REFUSED or place.written_for < _SINCE
    return False


REWRITE = Rewrite("matrix-product", _propose)
