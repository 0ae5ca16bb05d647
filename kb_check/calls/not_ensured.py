"""Calls that give None on a new thing, since they are not told to make what they find: ``strip.channelbag(slot)``."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_check.calls.sites import calls_by_node, giving
from kb_check.findings import Fix
from kb_check.running.out_of_sight import knows_all
from kb_check.scene.made_here import has_plain_operators_only, is_new
from kb_check.script import once_for_each
from kb_check.syntax.bindings import bindings
from kb_check.syntax.words import asked_names, keywords_and_texts, named_words

if TYPE_CHECKING:
    from kb_check.calls.sites import CallSite
    from kb_check.script import Script

_ENSURE = "ensure"
# What may make it as well: other functions that ensure or insert something.
_MAKING = re.compile(r"ensure|insert|bake|copy|duplicate|convert|assign")


def not_ensured(script: Script, node: ast.expr) -> CallSite | None:
    """The call that surely has given None for an expression of which something is read; None for any other."""
    if isinstance(node, ast.Name):
        values = bindings(script).get(node.id, []) if node.id not in asked_names(script) else []
        node = values[0] if len(values) == 1 and values[0] else node
    call = calls_by_node(script).get(node) if isinstance(node, ast.Call) else None
    if call is None or call.has_unpacking or not isinstance(call.node.func, ast.Attribute):
        return None
    symbol = call.callee.symbol
    ensures = any(parameter.name == _ENSURE for parameter in symbol.parameters)
    if not ensures or not symbol.returns or _ENSURE in call.given or not is_new(script, call.node.func.value):
        return None
    return None if _may_be_made(script, symbol.name) else call


@once_for_each
def _may_be_made(script: Script, name: str) -> bool:
    """Whether anything else in the script may make what a function of a name finds."""
    if not knows_all(script) or not has_plain_operators_only(script) or name in keywords_and_texts(script):
        return True
    return any(_MAKING.search(word) or (name in word and word != name) for word in named_words(script))


def ensuring(script: Script, call: CallSite) -> Fix | None:
    """``strip.channelbag(slot)`` → ``strip.channelbag(slot, ensure=True)``."""
    edit = giving(script, call.node, f"{_ENSURE}=True")
    return Fix(f"Write {_ENSURE}=True", (edit,), sure=True) if edit else None
