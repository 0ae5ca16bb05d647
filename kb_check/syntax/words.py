"""The words of a script that may name a setting, and what it does with them: sets, asks for, reads from."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_check.script import once_per_script

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_check.script import Script

_WORD = re.compile(r"\w+")


@once_per_script
def named_words(script: Script) -> frozenset[str]:
    """Every word of the script that may name a setting."""
    return frozenset(attributes(script)) | keywords_and_texts(script)


@once_per_script
def keywords_and_texts(script: Script) -> frozenset[str]:
    """The words of the script that may name a setting without being an attribute."""
    return words_of(script.all(ast.keyword, ast.Constant))


@once_per_script
def attributes(script: Script) -> dict[str, list[ast.Attribute]]:
    """Name → the attributes of that name."""
    found: dict[str, list[ast.Attribute]] = {}
    for node in script.all(ast.Attribute):
        found.setdefault(node.attr, []).append(node)
    return found


def words_of(nodes: Iterable[ast.AST]) -> frozenset[str]:
    """The words of nodes, by themselves, that may name a setting: attributes, keywords, texts."""
    found: set[str] = set()
    for node in nodes:
        match node:
            case ast.Attribute(attr=name) | ast.keyword(arg=str(name)):
                found.add(name)
            case ast.Constant(value=str(text)):
                found.update(_WORD.findall(text))
            case _:
                pass
    return frozenset(found)


@once_per_script
def words_in_texts(script: Script) -> frozenset[str]:
    """The words of the script's texts: it may ask for an attribute by one."""
    return words_of(script.all(ast.Constant))


@once_per_script
def members_taken(script: Script) -> dict[ast.expr, str]:
    """Expression → the name of the attribute that is taken of it."""
    return {node.value: node.attr for node in script.all(ast.Attribute)}


@once_per_script
def stored_names(script: Script) -> frozenset[str]:
    """The attributes that the script sets or deletes."""
    return frozenset(node.attr for node in script.all(ast.Attribute) if not isinstance(node.ctx, ast.Load))


@once_per_script
def texts_but_keys(script: Script) -> frozenset[str]:
    """The texts of a script that are no keys of items."""
    keys = {node.slice for node in script.all(ast.Subscript)}
    return frozenset(
        node.value for node in script.all(ast.Constant) if isinstance(node.value, str) and node not in keys
    )


@once_per_script
def asked_names(script: Script) -> frozenset[str]:
    """The names and attributes that are used for more than to read from them, or to hold them."""
    read = {node.value for node in script.all(ast.Attribute)}
    held = {node.value for node in script.all(ast.Assign)}
    found: set[str] = set()
    for node in script.all(ast.Attribute, ast.Name):
        if isinstance(node.ctx, ast.Load):
            if node in read or (node in held and isinstance(node, ast.Attribute)):
                continue
            found.add(node.attr if isinstance(node, ast.Attribute) else node.id)
    return frozenset(found)
