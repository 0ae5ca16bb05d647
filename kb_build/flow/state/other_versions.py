"""Functions and classes of scripts that only other Blenders come to.

What stands behind a guard is left out, or doubted. So is a function whose every use stands there: ``old_copy`` of
``if bpy.app.version < (4, 0): old_copy(tree)``, and what only ``old_copy`` calls. It is doubted, as code that nobody
shows here may call it too.
"""

from __future__ import annotations

import ast
from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import children, walk

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence

    from kb_build.flow.state.source_files import SourceFile

_DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
_Definition = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef
_HARMLESS = frozenset(
    {"staticmethod", "classmethod", "property", "cached_property", "persistent"}
)  # decorators


@dataclass(frozen=True, slots=True, eq=False)
class _Use:
    """A place that names a definition, or may: what it stands in, and whether that is left out or doubted."""

    inside: tuple[ast.AST, ...]
    guarded: bool


def doubt_what_others_use(
    files: Sequence[SourceFile], definitions: Iterable[ast.AST], is_called: Callable[[_Definition], bool]
) -> None:
    """Adds to what is doubted in files the definitions that are used by nothing but what is left out or doubted.

    ``definitions`` are those of the files that were read; ``is_called`` tells of one whether Blender uses it, which no
    file says.
    """
    guarded = [part for file in files for part in (*file.left_out, *file.doubted)]
    if not guarded or not all(file.is_read for file in files if file.tree):
        return
    named = {name for part in guarded for node in walk(part) for name in _named(node)}
    if not any(isinstance(node, _DEFINITIONS) and node.name in named for node in definitions):
        return
    defined = [
        (file, node)
        for file in files
        for node in walk(file.tree or ast.Module([], []))
        if isinstance(node, _DEFINITIONS)
    ]
    uses = _all_uses(files, {node.name for _, node in defined})
    found = [
        (file, node)
        for file, node in defined
        if any(node not in use.inside for use in uses.get(node.name, ()))
    ]
    _spread([(file, node) for file, node in found if not _is_special(node) and not is_called(node)], uses)


def _spread(found: Sequence[tuple[SourceFile, _Definition]], uses: Mapping[str, Sequence[_Use]]) -> None:
    """Doubts definitions, and with each what only it uses."""
    # What is used where a run of this Blender may come by, by name, and by what it stands in.
    left = {name: {use for use in places if not use.guarded} for name, places in uses.items()}
    within: defaultdict[ast.AST, list[tuple[str, _Use]]] = defaultdict(list)
    for name, places in left.items():
        for use in places:
            for node in use.inside:
                within[node].append((name, use))
    of_name: defaultdict[str, list[tuple[SourceFile, _Definition]]] = defaultdict(list)
    for file, node in found:
        of_name[node.name].append((file, node))
    own = {node: [use for name, use in within[node] if name == node.name] for _, node in found}
    waiting = [*found]
    for file, node in waiting:  # it grows
        its_own = sum(use in left[node.name] for use in own[node])
        if node in file.doubted or len(left[node.name]) > its_own:
            continue
        file.doubted.add(node)
        for name, use in within[node]:
            left[name].discard(use)
            waiting += of_name[name]


def _is_special(node: _Definition) -> bool:
    """Whether Python, Blender or a decorator may use it by itself."""
    decorators = {
        each.attr if isinstance(each, ast.Attribute) else getattr(each, "id", "")
        for each in node.decorator_list
    }
    return (
        not decorators <= _HARMLESS or node.name.startswith("__") or node.name in {"register", "unregister"}
    )


def _all_uses(files: Sequence[SourceFile], names: Container[str]) -> Mapping[str, Sequence[_Use]]:
    """Name → the places that name it, for those of some names."""
    found: defaultdict[str, list[_Use]] = defaultdict(list)
    for file in files:
        for name, use in _uses(file, names):
            found[name].append(use)
    return found


def _uses(file: SourceFile, names: Container[str]) -> Iterator[tuple[str, _Use]]:
    waiting: list[tuple[ast.AST, tuple[ast.AST, ...], bool, bool]] = [
        (file.tree or ast.Module([], []), (), False, False)
    ]
    while waiting:
        node, inside, left_out, doubted = waiting.pop()
        left_out = left_out or node in file.left_out
        doubted = doubted or node in file.doubted
        for name in _named(node):
            if name in names:
                # What is left out at one reading may be read at another.
                yield name, _Use(inside, doubted or (left_out and node not in file.types))
        within = (*inside, node) if isinstance(node, _DEFINITIONS) else inside
        waiting += ((part, within, left_out, doubted) for part in children(node))


def _named(node: ast.AST) -> tuple[str, ...]:
    """The names by which a node may use a definition."""
    match node:
        case ast.Name(id=name, ctx=ast.Load()) | ast.Attribute(attr=name, ctx=ast.Load()):
            return (name,)
        case ast.Constant(value=str() as name) | ast.alias(name=name, asname=str()):
            return (name,)
        case _:
            return ()
