"""Compares stubs with Blenders of the same versions, and keeps what holds."""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OPERATORS, TYPES, interface_part
from kb_build.symbols.paths import split_path
from kb_build.versions.history import SHARED

if TYPE_CHECKING:
    from collections.abc import Mapping, Set

LEAST = 0.99  # of what stubs have of a kind, this share must be true
_MODULE = "bpy.types"
_MENUS_MADE_AT_RUN_TIME = "bpy.types.NODE_MT_"


@dataclass(slots=True)
class Agreement:
    """How often stubs and Blender agree about one kind of path, over the versions of which both are known.

    ``extra`` are paths that only the stubs have; ``lacking`` those that only Blender has, although stubs of some
    version have them.
    """

    both: int = 0
    extra: int = 0
    lacking: int = 0


def kept_stubs(
    stubs: Mapping[str, Set[str]], asked: Mapping[str, Set[str]]
) -> tuple[dict[str, set[str]], dict[str, Agreement]]:
    """(minor version → paths that can be relied on, kind → agreement), for the versions that only stubs know.

    ``asked`` are the paths of Blenders, by minor version. A path that stubs have where the Blender of that version
    lacks it is dropped everywhere; so are kinds for which that is more than one in a hundred, modules that no
    Blender has, and what belongs to classes of the interface.
    """
    roots = {
        path for paths in asked.values() for path in paths if "." not in path and not path.startswith(SHARED)
    }
    wrong: set[str] = set()
    agreement: defaultdict[str, Agreement] = defaultdict(Agreement)
    only_stubs = [version for version in stubs if version not in asked]
    seen = set[str]().union(*(stubs[version] for version in only_stubs))
    for version in stubs.keys() & asked.keys():
        told, real = stubs[version], asked[version]
        listed, asked_lists = _lists(told), _lists(real)
        for path in told | real:
            above, mark, _ = split_path(path)
            if not _is_compared(path, roots) or (
                mark == ":" and not (above in listed and above in asked_lists)
            ):
                continue
            count = agreement[_kind(path)]
            if path not in real:
                wrong.add(path)
                # Stubs give members of the context twice, because they do not tell whose they are.
                count.extra += not path.startswith(("bpy.context.", "bpy.types.Context."))
            elif path in told:
                count.both += 1
            elif path in seen:
                count.lacking += 1
    vague = {kind for kind, count in agreement.items() if count.both < LEAST * (count.both + count.extra)}
    kept = {
        version: {
            path
            for path in stubs[version]
            if path not in wrong and _is_compared(path, roots) and _kind(path) not in vague
        }
        for version in only_stubs
    }
    return kept, dict(agreement)


def _lists(paths: Set[str]) -> set[str]:
    """The properties and parameters whose items are known."""
    return {above for above, mark, _ in map(split_path, paths) if mark == ":"}


def _is_compared(path: str, roots: Set[str]) -> bool:
    if re.split(r"[.(:]", path, maxsplit=1)[0] not in roots or path.startswith(_MENUS_MADE_AT_RUN_TIME):
        return False
    return not interface_part(path) or split_path(path)[0] == _MODULE


def _kind(path: str) -> str:
    above, mark, _ = split_path(path)
    if mark == ":":
        return "enum item"
    if path.startswith(OPERATORS):
        return "keyword of an operator" if mark == "(" else "operator"
    if not path.startswith(TYPES):
        module = ".".join(path.split(".")[: 2 if path.startswith("bpy.") else 1]).partition("(")[0]
        return f"parameter in {module}" if mark == "(" else f"name in {module}"
    if above == _MODULE:
        return "class of the interface" if interface_part(path) else "class"
    return "parameter" if mark == "(" else "member"
