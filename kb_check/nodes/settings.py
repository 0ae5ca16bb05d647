"""What a setting of a new node surely is where the script comes to a place."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.flags import usual_default
from kb_build.symbols.taken import NEVER
from kb_check.scene.made_here import is_new
from kb_check.script import once_for_each, once_per_script
from kb_check.syntax.bindings import assignments, bindings
from kb_check.syntax.bodies import places, statement_of
from kb_check.syntax.words import attributes, keywords_and_texts

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol
    from kb_check.script import Script


def setting_of(script: Script, node: ast.Name, path: str, before: ast.expr) -> str | None:
    """What a setting of the node that a name stands for surely is before a place; None where that is not known."""
    symbol = script.api.symbols.symbol(path)
    given = _given(script, path.rpartition(".")[2])
    made = bindings(script).get(node.id, [])
    if symbol is None or given is None or not _is_made_by_calls(script, node.id) or len(made) != 1:
        return None
    making = assignments(script).get(made[0]) if made[0] else None
    statements = given.get(node.id, [])
    earlier = [statement for statement in statements if _end(statement) <= (before.lineno, before.col_offset)]
    # What comes later in the script may come earlier in time: in a loop, or where a function is called again.
    is_last = len(earlier) == len(statements)
    if earlier:
        last = max(earlier, key=_end)
        value = last.value.value if isinstance(last.value, ast.Constant) else None
        is_given_where_made = making is not None and places(script)[making][0] is places(script)[last][0]
        is_sure = _runs_before(script, last, before, at_once=not is_last) or (
            len(statements) == 1 and is_given_where_made
        )
    else:
        value = usual_default(symbol)
        is_sure = is_last or (making is not None and _runs_before(script, making, before, at_once=True))
    if not is_sure or not isinstance(value, str) or not _stays(script, node, symbol, value, before):
        return None
    return value


def _end(statement: ast.stmt) -> tuple[int, int]:
    return statement.end_lineno or 0, statement.end_col_offset or 0


def _stays(script: Script, node: ast.Name, symbol: Symbol, value: str, before: ast.expr) -> bool:
    """Whether a value of a setting is one that no other setting of the node takes away again."""
    where = next((item.where for item in symbol.enum_items if item.identifier == value), NEVER)
    if where is None or not where.settings:
        return where != NEVER
    if where.how not in {"only", "not"} or len(where.settings) != 1:
        return False
    other = script.api.symbols.symbol(f"{symbol.owner}.{where.settings[0].name}")
    if other is None or any(item.where and item.where.settings for item in other.enum_items):
        return False
    given = setting_of(script, node, other.path, before)
    return given is not None and (given in where.settings[0].values) == (where.how == "only")


def _runs_before(script: Script, statement: ast.stmt, place: ast.expr, *, at_once: bool) -> bool:
    """Whether a statement runs whenever a place of its body is come to: each time ``at_once``, or some time before."""
    body, first = places(script)[statement]
    behind = statement_of(body, place)
    return behind > first and not (at_once and hasattr(body[behind], "body"))


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
