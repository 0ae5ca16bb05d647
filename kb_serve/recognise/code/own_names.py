"""Names that a piece of code gives itself: variables that hold values of Python's own or of its classes, what it
imports of other modules than Blender's, properties and operators that it registers. Blender knows nothing of these.

Code stands in queries without its ends of lines, so that Python cannot parse it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OPERATORS
from kb_serve.recognise.chains.variables import usual_classes

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence, Set

    from kb_serve.recognise.chains.chains import Chain
    from kb_serve.recognise.recognition import MissingName

_ASSIGNED = re.compile(r"(?<![\w.])(?P<name>[^\W\d]\w*)\s*=(?!=)\s*(?P<value>\S{0,60})")
# What begins a value of Python's own; a number or None is often replaced by something of Blender's.
_OF_PYTHON = re.compile(
    r"[\[{]|[rbfu]{0,2}[\"']|(?:set|list|dict|tuple|str|frozenset|sorted|range|open|Path|defaultdict|deque|Counter|input|"
    r"int|float|bool|len|abs|round|zip|map|filter|enumerate|bytes|object)\("
)
_WORD = re.compile(r"\w+")
_CALLED = re.compile(r"(\w+)\(")
_BRACKET = re.compile(r"([()])")
_IMPORTED = re.compile(r"\bimport\s+(\w+)(?:\.\w+)*\s+as\s+(\w+)")
# A module beside the code's own is not named.
_IMPORTED_FROM = re.compile(
    r"\bfrom\s+(?:\.[\w.]*|(?P<module>\w+)(?:\.\w+)*)\s+import\s+\(?\s*"
    r"(?P<names>(?:\w+(?:\s+as\s+\w+)?\s*,\s*)*\w+(?:\s+as\s+\w+)?)"
)
# A class that has no class of Blender's above it, as far as its head tells.
_CLASS = re.compile(
    r"\bclass\s+(?P<name>\w+)\s*"
    r"(?:\(\s*(?:(?:object|Exception|(?:enum\.)?(?:Int|Str)?(?:Enum|Flag)|(?:typing\.)?(?:NamedTuple|TypedDict))\s*)?\)\s*)?:"
)
_REGISTERED = re.compile(
    r"\bbpy\.types\.\w+\.(?P<name>\w+)\s*(?::[^=\n]{1,60})?=\s*(?:bpy\.)?(?:props\.)?\w+Property\("
)
_OF_CLASS = re.compile(r"(?<![\w.])(?P<name>\w+)\s*:\s*(?:bpy\.)?(?:props\.)?\w+Property\(")
_FUNCTION = re.compile(r"\bdef\s+\w+\(([^()]*)")
_PARAMETER = re.compile(r"(?:^|,)\s*\**(?P<name>\w+)\s*(?::\s*(?P<type>[^,=]+))?")
_SIGNS = ("=", "import", "Property(", "def ", "class ")  # one of which code has that gives itself names
_OPERATOR = re.compile(r"\bbl_idname\s*=\s*[\"'](?P<module>[a-z_]\w*)\.(?P<name>\w+)[\"']")


@dataclass(frozen=True, slots=True)
class OwnNames:
    """``variables``, classes and modules of a piece of code that are none of Blender's, the ``parameters`` of its
    functions, the ``properties`` of its classes and those that it adds to Blender's, the paths of its ``operators``.
    """

    variables: frozenset[str] = frozenset()
    parameters: frozenset[str] = frozenset()
    properties: frozenset[str] = frozenset()
    operators: frozenset[str] = frozenset()

    def without(self, chains: Sequence[Chain]) -> list[Chain]:
        """The chains that lead on from none of its variables, nor from a property of its own class."""
        return [chain for chain in chains if not (chain.steps and self._is_own(chain))]

    def _is_own(self, chain: Chain) -> bool:
        first = chain.steps[0]
        is_of_class = chain.root == "self" and first.kind == "attr" and first.text in self.properties
        return chain.root in self.variables or is_of_class

    def have(self, missing: MissingName) -> bool:
        """Whether a name that Blender lacks is one of these, or of a parameter that no class is usually called by."""
        name = missing.variable
        is_of_parameter = name in self.parameters and missing.owner not in usual_classes(name)
        is_own = missing.name in self.properties or f"{missing.owner}.{missing.name}" in self.operators
        return is_own or is_of_parameter


def own_names(text: str, is_of_blender: Callable[[str], bool]) -> OwnNames:
    """The names that a text gives itself, if it is code. ``is_of_blender`` tells of the name of a module or class
    whether it is one of Blender's, or was.
    """
    if not any(sign in text for sign in _SIGNS):
        return _NONE
    properties = (match["name"] for form in (_REGISTERED, _OF_CLASS) for match in form.finditer(text))
    classes = frozenset(match["name"] for match in _CLASS.finditer(text))
    variables = _variables(_outside_brackets(text), classes)
    given = [one for match in _FUNCTION.finditer(text) for one in _PARAMETER.finditer(match[1])]
    others = (
        one["name"]
        for one in given
        if one["type"] and not any(map(is_of_blender, _WORD.findall(one["type"])))
    )
    return OwnNames(
        frozenset((*classes, *variables, *others, *_imported(text, is_of_blender))),
        frozenset(one["name"] for one in given),
        frozenset(properties),
        frozenset(f"{OPERATORS}{match['module']}.{match['name']}" for match in _OPERATOR.finditer(text)),
    )


def _variables(text: str, classes: Set[str]) -> Iterator[str]:
    """The variables that are set to values of Python's own, or to instances of ``classes``, and to nothing else."""
    values: dict[str, list[bool]] = {}
    for match in _ASSIGNED.finditer(text):
        called = _CALLED.match(match["value"])
        is_own = (called and called[1] in classes) or _OF_PYTHON.match(match["value"])
        values.setdefault(match["name"], []).append(bool(is_own))
    return (name for name, are_own in values.items() if all(are_own))


def _outside_brackets(text: str) -> str:
    """A text without what stands in round brackets, where ``name=value`` is an argument."""
    kept: list[str] = []
    depth = 0
    for part in _BRACKET.split(text):
        if part == ")":
            depth = max(0, depth - 1)
        if depth == 0:
            kept.append(part)
        if part == "(":
            depth += 1
    return "".join(kept)


def _imported(text: str, is_of_blender: Callable[[str], bool]) -> Iterator[str]:
    """The names under which modules that are none of Blender's are imported, or what is in these or beside the code."""
    for match in _IMPORTED.finditer(text):
        if not is_of_blender(match[1]):
            yield from match.groups()
    for match in _IMPORTED_FROM.finditer(text):
        if not match["module"] or not is_of_blender(match["module"]):
            yield from (name.split()[-1] for name in match["names"].split(","))


_NONE = OwnNames()
