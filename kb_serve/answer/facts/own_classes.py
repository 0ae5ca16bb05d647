"""What classes of a script's own are asked for: what they must have, and the functions that Blender calls on them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flag_names import DEFINED, DEFINED_ALWAYS, MUST_HAVE, OF_CLASS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader


def definition(symbol: Symbol) -> str:
    """The source by which a class of a script's own defines a function that Blender calls."""
    is_of_class = OF_CLASS in symbol.flags
    given = [parameter.name for parameter in symbol.parameters]
    head = f"def {symbol.name}({', '.join(('cls' if is_of_class else 'self', *given))}):"
    lines = [f"class My{symbol.owner.removeprefix(TYPES)}({symbol.owner}):"]
    lines += ["    @classmethod"] if is_of_class else []
    return "\n".join((*lines, f"    {head}", "        ..."))


def asked_of_classes(symbol: Symbol, reader: BaseReader) -> Iterator[str]:
    """Sentences on what a class of a script's own must have, and on a function that it defines."""
    if DEFINED_ALWAYS in symbol.flags:
        yield "A class of your own has to define it: Blender calls it."
    elif DEFINED in symbol.flags:
        yield "A class of your own may define it: Blender calls it where it is."
    of_class = reader.symbol(symbol.owner) if symbol.is_called_back else symbol
    must = [name for name in of_class.flagged(MUST_HAVE) if name != symbol.name] if of_class else []
    if must:
        names = ", ".join(f"`{name}`" for name in must)
        which = "Such a class" if symbol.is_called_back else "A class of your own"
        yield f"{which} must have {names}: Blender does not register it without."
