"""Whether a class of a script may be registered where its name is not seen."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.running.computing import NAMESPACES, RUNNING, computing
from kb_check.syntax.words import named_words

if TYPE_CHECKING:
    from collections.abc import Collection

    from kb_check.registered.classes import OwnClass
    from kb_check.script import Script

# Words of what finds the classes of a module.
_FINDING = frozenset({"__subclasses__", "auto_load", "getmembers", "modules"})


def is_named_only_in(script: Script, one: OwnClass, places: Collection[ast.expr | None]) -> bool:
    """Whether nothing in a script names a class but some places, nor finds classes by themselves."""
    finds_classes = not _FINDING.isdisjoint(named_words(script)) or not computing(script).isdisjoint(
        NAMESPACES | RUNNING
    )
    name = one.node.name
    if one.node.decorator_list or finds_classes:
        return False
    if any(node.id == name and node not in places for node in script.all(ast.Name)):
        return False
    return not script.package.is_named_beside(name, script.tree)
