"""How names are written in a stub: short within their own module, and never hidden by a member of the same name."""

from __future__ import annotations

import builtins
import keyword
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

_PARTS = re.compile(r"""(?P<text>"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*')|(?<![\w.])(?P<name>[A-Za-z_][\w.]*)""")
_BUILTINS = frozenset(name for name in dir(builtins) if name[0].islower())
# Python's own, as annotations name them.
_STANDARD = re.compile(r"(collections\.abc|typing_extensions|typing|builtins|types(?=\.ModuleType))\.")


def is_writable(name: str) -> bool:
    """Whether a name can be defined in Python."""
    return name.isidentifier() and not keyword.iskeyword(name)


def hidden_names(names: Iterable[str]) -> frozenset[str]:
    """The names of Python's own that members called ``names`` hide from the annotations beside them."""
    return _BUILTINS.intersection(names)


def shorten(text: str, module: str, hidden: Collection[str] = ()) -> str:
    """An annotation with full names as it is written inside ``module``, where ``hidden`` names mean something else."""
    prefix = f"{module}."

    def replaced(match: re.Match[str]) -> str:
        if match["text"]:
            return match["text"]
        name = match["name"]
        if name in hidden:
            return name if _is_definition(text, match) else f"builtins.{name}"
        own = name.removeprefix(prefix)
        return name if own.partition(".")[0] in hidden else own

    return _PARTS.sub(replaced, text)


def _is_definition(text: str, match: re.Match[str]) -> bool:
    """Whether a name is that of a function, a variable or a parameter, not part of a type."""
    before = text[: match.start()]
    if before.endswith(("def ", "class ")):
        return True
    return text[match.end() : match.end() + 1] == ":" and not before.endswith(("-> ", "| "))


def imports_of(text: str, module: str, modules: Collection[str]) -> list[str]:
    """The import statements that the text of a stub needs; ``module`` is its own name, ``modules`` are all stubs'."""
    found: set[str] = set()
    for match in _PARTS.finditer(text):
        name = match["name"]
        if not name or "." not in name:
            continue
        if standard := _STANDARD.match(name):
            found.add(standard[1])
        else:
            parts = name.split(".")
            paths = (".".join(parts[:count]) for count in range(len(parts) - 1, 0, -1))
            found.add(next((path for path in paths if path in modules), module))
    return [f"import {name}" for name in sorted(found - {module})]


def first_sentence(text: str) -> str:
    """The first sentence of a description, on one line."""
    line = " ".join(text.split())
    return re.split(r"(?<=[.!?]) ", line, maxsplit=1)[0]


def docstring(*texts: str) -> str:
    """A docstring of label and description, empty for none."""
    said = ". ".join(dict.fromkeys(part for text in texts if (part := first_sentence(text).rstrip("."))))
    return repr(said + ".") if said else ""
