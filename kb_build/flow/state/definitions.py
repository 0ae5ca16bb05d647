"""The functions and classes of a script."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kb_build.flow.state.doubts import NO_DOUBTS, Doubts
from kb_build.flow.state.scopes import kept
from kb_build.flow.values.types import UNKNOWN, Carried, Given, Readings, Type, Uses, join

if TYPE_CHECKING:
    import ast

    from kb_build.flow.state.scopes import Scope
    from kb_build.flow.state.source_files import SourceFile


@dataclass(slots=True)
class FunctionDefinition:
    """A function of the script.

    ``received`` joins what calls pass as far as it is known; ``unknown`` names the parameters for which some pass
    something else; ``returned`` is what it returns. ``seen`` is the state of the script's definitions at the last run;
    ``used`` are the attributes that it reads from each name, ``takes_out`` the names that it takes something out of,
    ``asks_version`` whether it looks at Blender's version, once they were asked for. ``file`` is where it stands,
    ``doubted`` what is doubted there, ``readings`` what the last run took from other definitions, ``uses`` the calls
    that it made, ``carried`` what texts were found to be in it that come from elsewhere.

    ``passed`` is what single calls pass; ``calls`` has a reading for each, where it was read so: a definition of its
    own, ``exact``, whose ``received`` is that alone. ``in_vain`` are those of the last of them that brought nothing.
    """

    node: ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda
    scope: Scope
    cls: int | None = None
    is_static: bool = False
    is_class_method: bool = False
    is_property: bool = False
    received: dict[str, Type] = field(default_factory=dict[str, Type])
    unknown: set[str] = field(default_factory=set[str])
    returned: Type | None = None
    running: bool = False
    runs: int = 0
    stale: bool = True
    seen: tuple[int, int] = (-1, -1)
    used: dict[str, set[str]] | None = None
    asks_version: bool | None = None
    takes_out: frozenset[str] | None = None
    file: SourceFile | None = None
    doubted: Doubts = NO_DOUBTS
    readings: Readings = field(default_factory=Readings)
    uses: Uses = field(default_factory=Uses)
    carried: Carried = field(default_factory=Carried)
    calls: dict[Given, FunctionDefinition] = field(default_factory=dict[Given, "FunctionDefinition"])
    passed: set[Given] = field(default_factory=set[Given])
    in_vain: int = 0
    exact: bool = False


@dataclass(slots=True)
class ClassDefinition:
    """A class of the script; ``attributes`` joins what its body, its annotations and its methods bind.

    Those that are ``declared`` by bpy.props keep their types, whatever is assigned to them. ``fields`` are those of a
    data class, which its instances are made with, in their order.
    """

    node: ast.ClassDef
    bases: tuple[Type, ...]
    attributes: dict[str, Type] = field(default_factory=dict[str, Type])
    declared: frozenset[str] = frozenset()
    fields: tuple[str, ...] = ()
    changes: int = 0

    def bind(self, name: str, kind: Type) -> None:
        """Adds to what an attribute holds."""
        kind = kept(kind)
        before = self.attributes.get(name)
        after = kind if before is None or before is UNKNOWN else join(before, kind)
        if after != before:
            self.attributes[name] = after
            self.changes += 1
