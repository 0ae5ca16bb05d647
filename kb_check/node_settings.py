"""What a setting of a new node surely is where the script comes to a place."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.flags import usual_default
from kb_check.made_here import attributes, bindings, is_new, keywords_and_texts, places
from kb_check.script import once_for_each, once_per_script

if TYPE_CHECKING:
    from kb_check.script import Script


def setting_of(script: Script, node: ast.Name, path: str, before: ast.expr) -> str | None:
    """What a setting of the node that a name stands for surely is before a place; None where that is not known."""
    symbol = script.api.symbols.symbol(path)
    given = _given(script, path.rpartition(".")[2])
    made = bindings(script).get(node.id, [])
    if symbol is None or given is None or not _is_made_by_calls(script, node.id) or len(made) != 1:
        return None
    match given.get(node.id, []):
        case []:
            usual = usual_default(symbol)
            return usual if isinstance(usual, str) else None
        case [statement]:
            making = _assignments(script).get(made[0])
            is_sure = making is not None and places(script)[making][0] is places(script)[statement][0]
            value = statement.value.value if isinstance(statement.value, ast.Constant) else None
            is_before = statement.lineno < before.lineno
            return value if is_sure and is_before and isinstance(value, str) else None
        case _:
            return None


@once_for_each
def _given(script: Script, setting: str) -> dict[str, list[ast.Assign]] | None:
    """Name of a node → the statements that give it a setting.

    None where the script may give it in another way: by another name of the node, or by one that is written as a text.
    """
    if setting in keywords_and_texts(script):
        return None
    found: dict[str, list[ast.Assign]] = {}
    for target in attributes(script).get(setting, ()):
        statement, owner = _plain_stores(script).get(target), target.value
        if statement is None or not isinstance(owner, ast.Name) or not _is_made_by_calls(script, owner.id):
            return None
        found.setdefault(owner.id, []).append(statement)
    return found


@once_for_each
def _is_made_by_calls(script: Script, name: str) -> bool:
    """Whether a name stands for nothing but what calls have just made, which no other name does then."""
    values = bindings(script).get(name, [])
    return all(isinstance(value, ast.Call) and is_new(script, value) for value in values) and bool(values)


@once_per_script
def _plain_stores(script: Script) -> dict[ast.expr, ast.Assign]:
    """Attribute → the statement that gives it a value, and nothing else."""
    return {node.targets[0]: node for node in script.all(ast.Assign) if len(node.targets) == 1}


@once_per_script
def _assignments(script: Script) -> dict[ast.expr | None, ast.Assign]:
    """Value → the statement that assigns it."""
    return {node.value: node for node in script.all(ast.Assign)}
