"""Sentences on what came of calls that were tried in a Blender without a window, or with every index."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import BEGIN_DRAWING, SIDES
from kb_build.symbols.flag_names import GIVES_NONE, WINDOWLESS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol

_WITHOUT_WINDOW = "a Blender without a window (`--background`, or `import bpy` in another Python)"


def outcomes(symbol: Symbol) -> Iterator[str]:
    """What is known of a function, or of making an instance of a class, from calling it."""
    if GIVES_NONE in symbol.flags:
        side = f"{symbol.name.removesuffix('_template')}s"
        read = f": what a node has is in its `{side}`" if side in SIDES else ""
        yield f"Gave `None` for every index that was tried{read}."
    for said in symbol.flagged(WINDOWLESS):
        raised = f"it raises `SystemError`, “{said}”."
        if BEGIN_DRAWING in said:
            yield f"In {_WITHOUT_WINDOW} call `{BEGIN_DRAWING}()` first: until then {raised}"
        else:
            yield f"Not in {_WITHOUT_WINDOW}: there {raised}"
