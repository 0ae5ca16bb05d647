"""Members that other Blenders have and this one has nowhere, of values of which nothing says what they are.

Their name says it, with what holds the value or what it is called: ``light_settings.use_ambient_occlusion``, or
``file_node.file_slots`` in a script that speaks of ``CompositorNodeOutputFile``.
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.flow.values.types import UNKNOWN, Module
from kb_build.symbols.api_names import ID
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.object_data import OBJECT_DATA
from kb_check.running.raised import LACKS
from kb_check.running.tried import is_tried
from kb_check.script import once_per_script
from kb_check.syntax.words import attributes, keywords_and_texts

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_MODULE = "bpy"
_KNOWN = (None, Module(_MODULE))  # nothing else may stand there, or Blender does not come there
_DATA = "data"
_SEVERAL = re.compile(r"[a-z0-9]+_[a-z0-9]")  # a name of one word may be anything's
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")
# Words that names of any node may have, and the beginnings of classes' names.
_EMPTY_WORDS = frozenset({"node", "nodes", "shader", "compositor", "geometry", "function", "texture"})
_OPTION = re.compile(r"--?([a-z][a-z0-9-]*)")


def former_members(script: Script) -> Iterator[tuple[ast.Attribute, str]]:
    """Each attribute of this kind, with the class that had it.

    None in a script that may have something else for Blender's module: what it asks of it, as the version, is unknown.
    """
    if any(node.id == _MODULE and script.type_of(node) not in _KNOWN for node in script.all(ast.Name)):
        return
    for name, nodes in attributes(script).items():
        classes = _classes_that_had(script, name)
        if not classes or _may_be_own(script, name):
            continue
        for node in nodes:
            if (
                node in script.analysis.resolutions
                or script.type_of(node.value) != UNKNOWN
                or is_tried(script, node, LACKS)
            ):
                continue
            held = [
                cls
                for cls in classes
                if _holds(script, node.value, cls) or _is_called(script, node.value, cls)
            ]
            if len(held) == 1:
                yield node, held[0]


def _classes_that_had(script: Script, name: str) -> list[str]:
    """The classes that have a name in other Blenders, if it has several words and nothing in this one is called so."""
    if not _SEVERAL.match(name) or not script.names.is_nowhere(name):
        return []
    paths = script.names.reader.history.removed_named(name)
    owners = [
        path.removesuffix(f".{name}") for path in paths if path.startswith(T) and path.endswith(f".{name}")
    ]
    return [owner for owner in owners if script.api.is_class(owner)]


def _may_be_own(script: Script, name: str) -> bool:
    """Whether the script, or a file beside it, may give such a name to what is its own."""
    return name in script.own_names or name in _words(script) or script.package.gives(name)


def _holds(script: Script, node: ast.expr, cls: str) -> bool:
    """Whether a value is read from a member that holds such a thing in Blender: ``world.light_settings``."""
    if not isinstance(node, ast.Attribute):
        return False
    sql = "SELECT target FROM symbols WHERE name = ? AND kind = 'property' AND type = 'pointer' AND target != ''"
    targets = {f"{T}{target}" for (target,) in script.names.reader.rows(sql, node.attr)}
    if node.attr == _DATA and ID in targets:
        targets = {f"{T}{name}" for name in OBJECT_DATA.values()}
    return cls in targets or any(script.api.descends(cls, target) for target in targets - {ID})


def _is_called(script: Script, node: ast.expr, cls: str) -> bool:
    """Whether the script speaks of the class, and what the value is called has a word of the class's name."""
    name = cls.removeprefix(T)
    if name not in _words(script) and name not in attributes(script):
        return False
    called = node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""
    words = {word.lower() for word in _WORD.findall(name)} - _EMPTY_WORDS
    return not words.isdisjoint(called.lower().split("_"))


@once_per_script
def _words(script: Script) -> frozenset[str]:
    """The words of texts and keywords; those of options as what reads them calls them, ``base_path``."""
    texts = (node.value for node in script.all(ast.Constant) if isinstance(node.value, str))
    options = {option.replace("-", "_") for text in texts for option in _OPTION.findall(text)}
    return keywords_and_texts(script) | options
