"""Reads the paths that functions are given to animate what they lead to: ``rotation_euler`` of
``obj.keyframe_insert("rotation_euler")`` is ``obj.rotation_euler``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.recognise.chains.call_texts import arguments, texts_in
from kb_serve.recognise.chains.chains import ChainStep, find_chains

if TYPE_CHECKING:
    from kb_serve.recognise.chains.chains import Chain

# Function of every thing in Blender → the name of its argument that is a path from the thing.
PATHS = {
    "keyframe_insert": "data_path",
    "keyframe_delete": "data_path",
    "driver_add": "path",
    "driver_remove": "path",
}


def path_given(chain: Chain) -> Chain | None:
    """What such a call animates, as an expression; None for other expressions and for paths that are no literals."""
    match chain.steps:
        case (*before, ChainStep("attr", function), ChainStep("call", text)) if function in PATHS:
            name = PATHS[function]
        case _:
            return None
    given = next((value for called, value in arguments(text) if called in {"", name}), "")
    path = next(iter(texts_in(given)), "")
    found = find_chains(f"{chain.root}.{path}") if path else []
    if len(found) != 1 or found[0].source != f"{chain.root}.{path}":
        return None
    return found[0]._replace(steps=(*before, *found[0].steps), source=f"{chain.source} {path}")
