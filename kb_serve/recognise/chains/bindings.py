"""What the variables of a piece of code were bound to in it: the expressions that they stand for.

Code stands in queries between prose, in tracebacks, or without its ends of lines, so that Python cannot parse it.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from kb_build.symbols.flags import NODE_FAMILIES
from kb_serve.recognise.chains.chains import MAX_STEPS, Chain, ChainStep, sockets_in

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_OF_NODE = re.compile(rf"""\s*["'](?:{"|".join(NODE_FAMILIES)})\w+["']""")
_ELEMENT = ChainStep("index", "0")  # any element of what is iterated over
_MOST_TARGETS = 5  # words of ``for a, b in``
_SEQUENCE = re.compile(r"(?:(?:enumerate|list|reversed|sorted|tuple)\()*")  # in which the same elements are
# Behind an expression that is only a part of what is assigned; ``if`` and ``for`` may begin the next line as well.
_GOES_ON = re.compile(r"\s*(?:[-+*/%@|&^<>!,.\[(]|(?:and|or|in|is|not)\b|if\b[^:]*\belse\b)")


class _Binding(NamedTuple):
    """The expression that a variable stands for, and its place among all of a text."""

    value: Chain
    place: int


def with_bindings(text: str, chains: Sequence[Chain]) -> list[Chain]:
    """The chains of a text, and behind them the sockets in their calls; those that begin with a variable which was
    bound before begin with what it was bound to, and this leads on.
    """
    if not any(chain.steps for chain in chains):  # plain words
        return [*chains]
    bound: dict[str, _Binding] = {}
    elements: dict[str, _Binding] = {}
    found: list[Chain] = []
    sockets: list[Chain] = []
    leading: set[int] = set()
    end = 0
    gap = ""
    for place, chain in enumerate(chains):
        start = text.find(chain.source, end)
        before, gap = gap, "".join(text[end:start].split())
        end = start + len(chain.source)
        is_assigned = gap == "=" and _is_single(found, before)
        rest = _without(found, bound)
        own = _from(chain, bound if is_assigned else rest, leading)
        is_whole = own.steps and not _GOES_ON.match(text, end)
        bound = rest
        if is_whole and is_assigned:
            bound[found[-1].root] = _Binding(_as_made(own), place)
        elif is_whole and (name := _iterated(found)) and _SEQUENCE.fullmatch(gap):
            element = own._replace(steps=(*own.steps, _ELEMENT))
            elements[name] = bound[name] = _Binding(element, place)
        elif not own.steps and _is_named_otherwise(found):
            bound[own.root] = _Binding(found[-2], place - 2)
        found.append(own)
        sockets += (_from(socket, bound, leading) for socket in sockets_in(chain))
    if elements:  # ``[v.co for v in …]``: used before it is bound
        found = [_from(chain, elements, leading) for chain in found]
    for place in leading:
        found[place] = found[place]._replace(leads_on=True)
    return [*found, *sockets]


def _as_made(chain: Chain) -> Chain:
    """What is assigned; a call of the script's own with the type of a node, ``add("ShaderNodeMath")``, as the node."""
    first = chain.steps[0] if chain.steps else None
    if first is None or first.kind != "call" or not _OF_NODE.match(first.text):
        return chain
    return chain._replace(root="nodes", steps=(ChainStep("attr", "new"), *chain.steps))


def _without(found: Sequence[Chain], bound: dict[str, _Binding]) -> dict[str, _Binding]:
    """What is bound, without the variable that is assigned to at the end."""
    if not found or not found[-1].assigned or found[-1].steps:
        return bound
    return {name: value for name, value in bound.items() if name != found[-1].root}


def _is_named_otherwise(found: Sequence[Chain]) -> bool:
    """Whether ``as`` ends what was found, behind an expression or a module that is imported."""
    if len(found) < 2 or found[-1].root != "as":
        return False
    return bool(found[-2].steps) or (len(found) > 2 and found[-3].root == "import" and not found[-3].steps)


def _is_single(found: Sequence[Chain], before: str) -> bool:
    """Whether the last chain is one variable by itself: of ``a, b = …`` none is what stands behind. ``before`` stands
    before it.
    """
    return bool(found) and not found[-1].steps and not before.endswith(",")


def _iterated(found: Sequence[Chain]) -> str:
    """The variable of ``for … in`` at the end, of several the last; empty for none."""
    names = ["" if chain.steps else chain.root for chain in found[-_MOST_TARGETS:]]
    return names[-2] if len(names) > 2 and names[-1] == "in" and "for" in names[:-2] else ""


def _from(chain: Chain, bound: Mapping[str, _Binding], leading: set[int]) -> Chain:
    """A chain from what its variable was bound to, if it goes on from there; that place is added to the leading."""
    binding = bound.get(chain.root) if chain.steps else None
    if binding is None or len(binding.value.steps) + len(chain.steps) > MAX_STEPS:
        return chain
    leading.add(binding.place)
    return chain._replace(root=binding.value.root, steps=(*binding.value.steps, *chain.steps))
