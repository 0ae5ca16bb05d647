"""Reads type stubs of Blender's API (the packages ``fake-bpy-module-X.Y``) as paths of the history.

Blenders before 4.2 have no bpy package; stubs say what their API references listed. Only names are taken: classes,
members, operators, parameters, and the items of enumerations that are written out.
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING
from warnings import catch_warnings, simplefilter

from kb_build.errors import KBBuildError
from kb_build.symbols.api_names import OPERATORS

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_SUFFIX = "-stubs"
_ALIASES = "bpy.stub_internal.rna_enums"
_CONTEXT = "bpy.types.Context."
_MEMBER = re.compile(r"(bpy\.types\.\w+)\.(\w+)")
_ALIAS = re.compile(rb"^type (\w+) =", re.MULTILINE)  # an assignment, to Pythons older than 3.12
_IGNORED = re.compile(r"_|bl_rna_get_subclass")


def read_stubs(folder: Path) -> set[str]:
    """The paths of the stubs in ``folder``, which holds ``bpy-stubs`` and its siblings.

    Raises KBBuildError where there are none, or where a file is no Python.
    """
    modules = {_module_name(folder, file): file for file in sorted(folder.glob(f"*{_SUFFIX}/**/*.pyi"))}
    if "bpy.types" not in modules:
        raise KBBuildError(f"{folder} holds no stubs of Blender: there is no bpy{_SUFFIX}/types in it")
    aliases = _enum_aliases(_parse(modules[_ALIASES])) if _ALIASES in modules else {}
    stubs = _Stubs(aliases)
    for name, file in modules.items():
        if not name.startswith(_ALIASES.rpartition(".")[0]):
            stubs.read(name, _parse(file))
    paths = stubs.own_paths()
    # Stubs do not tell members of the class from those that only an editor has, ``bpy.context.selected_objects``.
    return paths | {f"bpy.context.{path[len(_CONTEXT) :]}" for path in paths if path.startswith(_CONTEXT)}


def _module_name(folder: Path, file: Path) -> str:
    parts = file.relative_to(folder).with_suffix("").parts
    name = ".".join((parts[0].removesuffix(_SUFFIX), *parts[1:]))
    return name.removesuffix(".__init__")


def _parse(file: Path) -> ast.Module:
    try:
        with catch_warnings():
            simplefilter("ignore")  # of their docstrings: a SyntaxWarning, before Python 3.12 a deprecation
            return ast.parse(_ALIAS.sub(rb"\1 =", file.read_bytes()))
    except (SyntaxError, ValueError, OSError) as error:
        raise KBBuildError(f"{file} cannot be read as a stub: {error}") from error


def _enum_aliases(module: ast.Module) -> dict[str, frozenset[str]]:
    """Name → items of the enumerations that many annotations share."""
    return {
        node.targets[0].id: frozenset(_literals(node.value, {}))
        for node in module.body
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
    }


def _literals(annotation: ast.expr, aliases: dict[str, frozenset[str]]) -> Iterator[str]:
    """The texts that an annotation allows, in ``Literal``, ``set[Literal]`` or an alias of them."""
    match annotation:
        case ast.BinOp(left=left, op=ast.BitOr(), right=right):
            yield from _literals(left, aliases)
            yield from _literals(right, aliases)
        case ast.Subscript(value=(ast.Name(id=name) | ast.Attribute(attr=name)), slice=inner):
            if name == "Literal":
                entries = inner.elts if isinstance(inner, ast.Tuple) else [inner]
                yield from (
                    entry.value
                    for entry in entries
                    if isinstance(entry, ast.Constant) and isinstance(entry.value, str)
                )
            elif name == "set":
                yield from _literals(inner, aliases)
        case ast.Name(id=name) | ast.Attribute(attr=name):
            yield from aliases.get(name, ())
        case _:
            pass


class _Stubs:
    """Collects what the modules declare."""

    def __init__(self, aliases: dict[str, frozenset[str]]) -> None:
        self._aliases = aliases
        self._paths: set[str] = set()
        self._bases: dict[str, list[str]] = {}

    def read(self, name: str, module: ast.Module) -> None:
        """Adds a module."""
        self._paths.add(name)
        self._body(module.body, name)

    def own_paths(self) -> set[str]:
        """The paths without what classes only repeat from their bases."""
        kept: set[str] = set()
        for path in self._paths:
            match = _MEMBER.match(path)
            if match is None or not any(
                f"{base}.{match[2]}" in self._paths for base in self._ancestors(match[1])
            ):
                kept.add(path)
        return kept

    def _ancestors(self, path: str) -> Iterator[str]:
        for base in self._bases.get(path, ()):
            yield base
            yield from self._ancestors(base)

    def _body(self, body: list[ast.stmt], owner: str) -> None:
        for node in body:
            match node:
                case ast.ClassDef(name=name) if not name.startswith("_"):
                    self._class(node, f"{owner}.{name}")
                case ast.FunctionDef(name=name) if not _IGNORED.match(name):
                    self._function(node, f"{owner}.{name}")
                case ast.AnnAssign(target=ast.Name(id=name), annotation=annotation) if name[0] != "_":
                    self._add(f"{owner}.{name}", annotation)
                case _:
                    pass

    def _class(self, node: ast.ClassDef, path: str) -> None:
        self._paths.add(path)
        if path.startswith(OPERATORS):
            for entry in node.body:
                if isinstance(entry, ast.FunctionDef) and entry.name == "__new__":
                    self._parameters(entry.args.kwonlyargs, path)
            return
        module = path.rpartition(".")[0]
        names = [name for base in node.bases if (name := _last_name(base))]
        self._bases[path] = [f"{module}.{name}" for name in names if f"{module}.{name}" != path]
        self._body(node.body, path)

    def _function(self, node: ast.FunctionDef, path: str) -> None:
        decorators = [_last_name(decorator) for decorator in node.decorator_list]
        if "property" in decorators or "setter" in decorators:
            self._add(path, node.returns if "property" in decorators else None)
            return
        self._paths.add(path)
        arguments = [*node.args.posonlyargs, *node.args.args]
        if arguments and arguments[0].arg in {"self", "cls"}:
            arguments = arguments[1:]
        self._parameters([*arguments, *node.args.kwonlyargs], path)

    def _parameters(self, arguments: list[ast.arg], path: str) -> None:
        for argument in arguments:
            # Blender's own docstrings call the first argument of bmesh.ops so; stubs were corrected by hand.
            name = "bmesh" if argument.arg == "bm" and path.startswith("bmesh.ops.") else argument.arg
            self._add(f"{path}({name})", argument.annotation)

    def _add(self, path: str, annotation: ast.expr | None) -> None:
        self._paths.add(path)
        if annotation:
            self._paths.update(f"{path}:{item}" for item in _literals(annotation, self._aliases))


def _last_name(node: ast.expr) -> str:
    return node.attr if isinstance(node, ast.Attribute) else getattr(node, "id", "")
