"""Docstrings of Blender's Python and C functions: reST in, description, parameters and results out."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING

from docutils import nodes

from kb_build.blender.docstrings.calls import (
    BMESH_OPERATOR,
    annotation,
    call_parameters,
    definition_of,
    form,
    split_calls,
    with_values,
)
from kb_build.blender.docstrings.fields import Fields, parameters_of
from kb_build.blender.docstrings.markup import Declared, blocks, parsed_markup, unquoted
from kb_build.symbols.records import Parameter

if TYPE_CHECKING:
    from collections.abc import Sequence

_BMESH_ELEMENTS = {"vert": "BMVert", "verts": "BMVert", "edges": "BMEdge", "faces": "BMFace"}
_INIT = "__init__"


@dataclass(frozen=True, slots=True)
class Docstring:
    """The content of a docstring: Markdown ``description``, call ``signature``, and types as text."""

    description: str = ""
    signature: str = ""
    type: str = ""
    parameters: tuple[Parameter, ...] = ()
    returns: tuple[Parameter, ...] = ()
    members: tuple[Member, ...] = ()


@dataclass(frozen=True, slots=True)
class Member:
    """A method or attribute that the docstring of its class describes. ``kind`` as in ``.. method::``."""

    kind: str
    name: str
    docstring: Docstring


@cache
def parse_docstring(text: str, signature: str = "", *, is_python: bool = False) -> Docstring:
    """Reads a docstring as reST.

    ``signature`` is what Python's own introspection found; a directive line in the docstring wins over it, which
    knows the names that C functions give to their arguments. Of a function that is written in Python (``is_python``)
    the signature is what it takes, whatever the docstring says. Malformed markup loses its meaning, never its text.
    """
    calls, body = split_calls(text)
    taken = form(signature) if is_python else None
    if taken is not None and taken not in map(form, calls):
        calls = []
    body, slots = _bmesh_results(body) if text.startswith(BMESH_OPERATOR) else (body, ())
    parsed = _overloaded(parsed_markup(body), calls or [signature], slots, is_certain=taken is not None)
    return _called_as_constructed(parsed)


def constructed_by(parsed: Docstring, cls: str) -> Docstring:
    """The docstring of a class in which a method called like the class itself is what it is: the constructor."""
    if not any(member.name == cls for member in parsed.members):
        return parsed
    members = (_constructor(member) if member.name == cls else member for member in parsed.members)
    return _called_as_constructed(replace(parsed, members=tuple(members)))


def _constructor(member: Member) -> Member:
    signature = f"{_INIT}({member.docstring.signature.partition('(')[2]}"
    return Member(member.kind, _INIT, replace(member.docstring, signature=signature))


def _called_as_constructed(parsed: Docstring) -> Docstring:
    """The docstring of a class with the call of its constructor, if it has none of its own."""
    constructor = next((member.docstring for member in parsed.members if member.name == _INIT), None)
    if constructor and "(" not in parsed.signature:  # which may be the class's name alone
        return replace(parsed, signature=constructor.signature, parameters=constructor.parameters)
    return parsed


def _overloaded(
    children: Sequence[nodes.Node],
    calls: Sequence[str],
    slots: tuple[Parameter, ...] = (),
    *,
    is_certain: bool = False,
) -> Docstring:
    """Reads what has the longest of these signatures; the description mentions the others."""
    call, *others = sorted(calls, key=len, reverse=True)
    parsed = _interpreted(children, call, slots, is_certain=is_certain)
    if others:
        also = "Also " + ", ".join(f"`{other}`" for other in others) + "."
        parsed = replace(parsed, description=f"{parsed.description}\n\n{also}".strip())
    return parsed


def _member(node: Declared) -> Member:
    parsed = _overloaded(node.children, node["calls"])
    return Member(node["kind"], parsed.signature.partition("(")[0].strip(), parsed)


def _interpreted(
    children: Sequence[nodes.Node],
    written: str,
    slots: tuple[Parameter, ...] = (),
    *,
    is_certain: bool = False,
) -> Docstring:
    """Reads the body of a docstring, or of a method within it; ``slots`` are results known beforehand."""
    definition = definition_of(written)
    named = {parameter.name for parameter in call_parameters(written)}
    open_ended = definition is None or definition.args.kwarg is not None
    fields = Fields(arguments=frozenset() if open_ended else frozenset(named))
    described: list[nodes.Node] = []
    members: list[Member] = []
    for node in unquoted(children):
        if isinstance(node, nodes.field_list):
            for row in node.children:
                fields.read(row.children[0].astext(), blocks(row.children[1].children))
        elif isinstance(node, Declared):
            members.append(_member(node))
        else:
            described.append(node)
    return_type = fields.return_type
    if not return_type and definition is not None and not slots:
        annotated = annotation(definition.returns)
        return_type = annotated if annotated != "None" else ""
    returns = slots
    if fields.returns or return_type:
        returns = (with_values(Parameter(name="", type=return_type, description=fields.returns)),)
    return Docstring(
        description="\n\n".join(part for part in (blocks(described), *fields.other) if part),
        signature=written,
        type=fields.own_type or (fields.return_type if not written.endswith(")") else ""),
        parameters=parameters_of(written, fields, is_certain=is_certain),
        returns=returns,
        members=tuple(members),
    )


def _bmesh_result(slot: Parameter) -> Parameter:
    """A slot as the result it is: its empty value tells the kind of container, its name what a list holds."""
    if isinstance(slot.default, list):
        elements = _BMESH_ELEMENTS.get(slot.name, "BMVert | BMEdge | BMFace")
        return Parameter(name=slot.name, type=f"list[{elements}]")
    return Parameter(name=slot.name, type="" if slot.default is None else type(slot.default).__name__)


def _bmesh_results(body: str) -> tuple[str, tuple[Parameter, ...]]:
    """bmesh operators end in ``-> dict(verts=[])``: the slots of the returned dictionary."""
    head, arrow, tail = body.rpartition("-> dict(")
    if not arrow:
        return body, ()
    return head, tuple(map(_bmesh_result, call_parameters(f"({tail.strip()}")))
