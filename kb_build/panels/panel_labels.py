"""Reads in which panels of Blender's interface a property stands, and what it is called there.

The manual goes by panels: it has "Particle System ‣ Emission" above what one of that name shows.
"""

from __future__ import annotations

import ast
from collections import defaultdict
from typing import TYPE_CHECKING, NamedTuple

from kb_build.flow.syntax.trees import walk
from kb_build.panels.layout_calls import SHOWS, shown_property

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kb_build.flow.analysis import Analysis

_DEEPEST = 6  # classes above one another
_OWN_FACTS = ("bl_label", "bl_parent_id", "bl_context", "bl_category")


class PanelClass(NamedTuple):
    """A class of a script that may be a panel, or a base of panels: what it says of itself, empty for nothing."""

    name: str
    bases: list[str]
    functions: list[str]
    label: str = ""
    parent: str = ""
    tab: str = ""
    category: str = ""


class ShownProperty(NamedTuple):
    """A property that a function of a class shows, and the text that stands there instead of its label, if any."""

    path: str
    cls: str
    function: str
    text: str = ""


class ScriptPanels(NamedTuple):
    """The classes of a script that say something of panels, and the properties that they show."""

    classes: Sequence[PanelClass] = ()
    shown: Sequence[ShownProperty] = ()


class PanelLabel(NamedTuple):
    """Where a property stands in the interface: the labels of the panels around it, the outermost first, and the tab
    that they are in; with the texts that stand beside it there instead of its own label.
    """

    headings: tuple[str, ...]
    tab: str
    texts: tuple[str, ...]


def panels_in(analysis: Analysis) -> ScriptPanels:
    """What a script's panels show, as far as it is certain whose properties these are."""
    classes = [node for node in analysis.tree.body if isinstance(node, ast.ClassDef)] if analysis.tree else []
    facts = [_facts(cls) for cls in classes]
    shown = [one for cls in classes for one in _shown(cls, analysis)]
    return ScriptPanels([one for one in facts if any(one[1:])], list(dict.fromkeys(shown)))


def _facts(cls: ast.ClassDef) -> PanelClass:
    own = dict.fromkeys(_OWN_FACTS, "")
    functions: list[str] = []
    for node in cls.body:
        match node:
            case ast.FunctionDef():
                functions.append(node.name)
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Constant(value=str(text))) if name in own:
                own[name] = text
            case _:
                pass
    bases = [base.id for base in cls.bases if isinstance(base, ast.Name)]
    return PanelClass(cls.name, bases, functions, *own.values())


def _shown(cls: ast.ClassDef, analysis: Analysis) -> Iterator[ShownProperty]:
    for function in cls.body:
        if not isinstance(function, ast.FunctionDef):
            continue
        for node in walk(function):
            if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute):
                continue
            _, named = shown_property(node)
            row = analysis.resolutions.get(named) if node.func.attr in SHOWS and named is not None else None
            if row is None or row.kind != "button":
                continue
            found = row.symbols or row.possible
            if len(found) == 1:
                text = next((keyword.value for keyword in node.keywords if keyword.arg == "text"), None)
                yield ShownProperty(found[0], cls.name, function.name, _text(text))


def _text(node: ast.expr | None) -> str:
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""


def merged(parts: Iterable[ScriptPanels]) -> ScriptPanels:
    """What the panels of several scripts show, together."""
    every = list(parts)
    return ScriptPanels(
        [cls for part in every for cls in part.classes], [one for part in every for one in part.shown]
    )


def labels_of(panels: ScriptPanels) -> dict[str, list[PanelLabel]]:
    """Property → where it stands, in panels that have a label."""
    found = _Panels({cls.name: cls for cls in panels.classes})
    texts: dict[str, dict[tuple[tuple[str, ...], str], set[str]]] = defaultdict(lambda: defaultdict(set))
    for shown in panels.shown:
        for name in found.drawn_by(shown.cls, shown.function):
            if headings := found.headings(name):
                texts[shown.path][headings, found.tab(name)].add(shown.text)
    return {
        path: [PanelLabel(*place, tuple(sorted(found - {""}))) for place, found in places.items()]
        for path, places in texts.items()
    }


class _Panels:
    """The classes of all scripts."""

    def __init__(self, classes: Mapping[str, PanelClass]) -> None:
        self._classes = classes
        self._derived: dict[str, list[str]] = defaultdict(list)
        for cls in classes.values():
            for base in cls.bases:
                self._derived[base].append(cls.name)

    def drawn_by(self, cls: str, function: str, depth: int = _DEEPEST) -> Iterator[str]:
        """A class, and those that take a function of it over."""
        yield cls
        for derived in self._derived[cls] if depth else ():
            if function not in self._classes[derived].functions:
                yield from self.drawn_by(derived, function, depth - 1)

    def headings(self, name: str) -> tuple[str, ...]:
        """The labels of a panel and of those that it lies in, the outermost first; nothing for what is no panel."""
        labels = (self._fact(one, "label") for one in reversed(self._around(name)))
        return tuple(filter(None, labels))

    def tab(self, name: str) -> str:
        """The tab or the category that a panel is in, or the first one around it that says so."""
        tabs = (
            self._fact(one, "category") or self._fact(one, "tab").lstrip(".") for one in self._around(name)
        )
        return next(filter(None, tabs), "")

    def _around(self, name: str) -> list[str]:
        """A panel, and those that it lies in, the innermost first."""
        found: list[str] = []
        while name and name not in found:
            found.append(name)
            name = self._fact(name, "parent")
        return found

    def _fact(self, name: str, fact: str, depth: int = _DEEPEST) -> str:
        """What a class, or the first of its bases that does, says of itself."""
        cls = self._classes.get(name)
        if cls is None or not depth:
            return ""
        own: str = getattr(cls, fact)
        return own or next(filter(None, (self._fact(base, fact, depth - 1) for base in cls.bases)), "")
