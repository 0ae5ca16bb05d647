"""Docstrings of Blender's Python and C functions: reST in, description, parameters and results out."""

from __future__ import annotations

import ast
import re
import textwrap
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any, ClassVar, cast

from docutils import nodes
from docutils.frontend import get_default_settings
from docutils.parsers.rst import Directive, Parser, directives, roles
from docutils.utils import new_document

from kb_build.docutils_states import states_when_entered
from kb_build.symbols.records import Default, EnumItem, Parameter

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

_DECLARATIONS = (
    *("function", "method", "classmethod", "staticmethod"),
    *("class", "data", "attribute", "property", "exception"),
)
_OF_ROWS = (nodes.table, nodes.tgroup, nodes.thead, nodes.tbody, nodes.row, nodes.line_block)
_REMARKS = {
    "seealso": "See also",
    "versionadded": "Added in",
    "versionchanged": "Changed in",
    "deprecated": "Deprecated since",
}
_DIRECTIVE = re.compile(rf"\.\. (?:{'|'.join(_DECLARATIONS)})::[ \t]*(.*)")
_OWN = "docstring-"  # Sphinx has these directives too, in a registry that all of docutils shares
_SPHINX = re.compile(rf"^(\s*\.\. )(?={'|'.join((*_DECLARATIONS, *_REMARKS))}::)", re.MULTILINE)
_CALL = re.compile(r"\w+\s*\(")
_INCLUDED = re.compile(r"\s*\.\. (?:literal)?include:: *(\S+)")
# “(optional when size is 2)”, of an argument that the call gives no default.
_OPTIONAL = re.compile(r"\(optional\b|^Optional\b")
_CONTINUED = re.compile(r"\s*\\\s*\n\s*")
_LITERAL = re.compile(r"\bLiteral(\[[^\[\]]*\])")
_LISTED = re.compile(r"\b(?:enum|string|str) in ([\[{(][^\[\]{}()]*[\]})])", re.IGNORECASE)
_ELEMENT = re.compile(r"(?:bmesh\.types\.)?BM(?:Vert|Edge|Face)")
_SEVERAL = re.compile(r"sequence of\b|the (?:verts|edges|faces)\b", re.IGNORECASE)
_BMESH_ELEMENTS = {"vert": "BMVert", "verts": "BMVert", "edges": "BMEdge", "faces": "BMFace"}
_REFERENCE_ROLES = ("class", "func", "meth", "attr", "data", "mod", "exc", "const", "obj", "doc")
_TWO_STOPS = re.compile(r"(?<!\.)\.\.$")  # of a sentence that was put before another full stop
_QUIET = 5
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


@dataclass(slots=True)
class _Fields:
    """The field list while it is read: ``:arg x:`` and ``:type x:`` come in any order."""

    texts: dict[str, str] = field(default_factory=dict)
    types: dict[str, str] = field(default_factory=dict)
    returns: str = ""
    return_type: str = ""
    own_type: str = ""
    other: list[str] = field(default_factory=list)
    arguments: frozenset[str] = frozenset()
    last: str = ""

    def set_type(self, name: str, kind: str) -> None:
        """Takes ``:type name:``.

        Some docstrings misspell the name there, or repeat another one. The type then belongs to the argument
        described just before it; where there is none, it belongs to nothing.
        """
        misplaced = name in self.types or (bool(self.arguments) and name not in self.arguments)
        if misplaced and self.last and self.last not in self.types:
            name = self.last
        elif misplaced and name not in self.texts and name not in self.types:
            return
        self.types[name] = kind


def _literal_role(
    _name: str, rawtext: str, text: str, *_position: object, **_options: object
) -> tuple[list[nodes.Node], list[nodes.system_message]]:
    """A cross-reference inside a docstring is the identifier it names."""
    name = text.partition(" <")[0] if text.endswith(">") else text
    return [nodes.literal(rawtext, name.lstrip("~!"))], []


def _label_role(
    _name: str, rawtext: str, text: str, *_position: object, **_options: object
) -> tuple[list[nodes.Node], list[nodes.system_message]]:
    """A reference to a place of the documentation is its title, or what its label says: ``page-custom_properties``.

    A label of one word is an identifier: of an enumeration that functions share.
    """
    title, _, label = text.rpartition(" <")
    if not title and "-" not in label:
        return [nodes.literal(rawtext, label)], []
    own = label.partition("-")[2] if "_" in label else label
    return [nodes.Text(title or own.replace("_", " ").replace("-", " "))], []


class _Declared(nodes.General, nodes.Element):
    """A method or attribute within the docstring of a class; ``calls`` are its signatures."""


class _Declaration(Directive):
    """``.. method:: f(a)`` and its content; several signatures stand on a line each."""

    has_content = True
    required_arguments = 1
    final_argument_whitespace = True
    option_spec: ClassVar[Any] = {"noindex": directives.flag}

    def run(self) -> list[nodes.Node]:
        lines = _CONTINUED.sub(" ", self.arguments[0]).split("\n")
        calls = [lines[0].strip(), *(line.strip() for line in lines[1:] if _CALL.match(line.strip()))]
        node = _Declared(kind=self.name.removeprefix(_OWN), calls=calls)
        if remarks := [line for line in lines[1:] if not _CALL.match(line.strip())]:
            node += nodes.paragraph("", "\n".join(remarks))
        self.state.nested_parse(self.content, self.content_offset, node)
        return [node]


class _Remark(Directive):
    """``.. seealso::`` and its like: an admonition that docutils alone does not know."""

    has_content = True
    optional_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        node = nodes.admonition(title=_REMARKS[self.name.removeprefix(_OWN)])
        if self.arguments:
            inline, messages = self.state.inline_text(self.arguments[0], self.lineno)
            node += nodes.paragraph("", "", *inline, *messages)
        self.state.nested_parse(self.content, self.content_offset, node)
        return [node]


@cache
def _parser() -> tuple[Parser, Any]:
    for name in _DECLARATIONS:
        directives.register_directive(_OWN + name, _Declaration)
    for name in _REMARKS:
        directives.register_directive(_OWN + name, _Remark)
    for role in _REFERENCE_ROLES:
        roles.register_local_role(role, cast("Any", _literal_role))
    roles.register_local_role("ref", cast("Any", _label_role))
    settings: Any = get_default_settings(Parser())
    settings.report_level = settings.halt_level = _QUIET
    settings.file_insertion_enabled = settings.raw_enabled = False
    return Parser(), settings


def _inline(node: nodes.Node) -> str:
    parts: list[str] = []
    for child in node.children:
        if isinstance(child, nodes.literal):
            parts.append(f"`{child.astext()}`")
        elif isinstance(child, nodes.Text):
            parts.append(child.astext().replace("\n", " "))
        elif not isinstance(child, nodes.system_message | nodes.problematic):
            parts.append(_inline(child))
        elif isinstance(child, nodes.problematic):
            parts.append(child.astext())
    return "".join(parts)


def _block(node: nodes.Node) -> str:  # noqa: PLR0911 - one return a kind of node
    """One body element as Markdown."""
    if isinstance(node, nodes.paragraph):
        return _inline(node)
    if isinstance(node, nodes.literal_block) and (included := _INCLUDED.match(node.astext())):
        file = PurePosixPath(included[1])  # not there, but templates are pages
        is_template = file.parent.name == "templates_py"
        if file.suffix == ".rst":
            return ""  # a part of the reference's own pages, which nobody can look up
        return f"Example: `templates_py/{file.stem}`" if is_template else f"This includes `{included[1]}`"
    if isinstance(node, nodes.literal_block | nodes.doctest_block):
        return f"```python\n{node.astext()}\n```"
    if isinstance(node, nodes.bullet_list | nodes.enumerated_list):
        return "\n".join(
            "- " + textwrap.indent(_blocks(item.children), "  ").lstrip() for item in node.children
        )
    if isinstance(node, nodes.definition_list):
        return "\n".join(
            f"**{_inline(item.children[0])}**: {_blocks(item.children[-1].children)}"
            for item in node.children
            if item.children
        )
    if isinstance(node, nodes.field_list):
        return "\n".join(
            f"- **{_inline(item.children[0])}**: "
            + textwrap.indent(_blocks(item.children[-1].children), "  ").lstrip()
            for item in node.children
            if item.children
        )
    if isinstance(node, nodes.Admonition):
        return f"**{_title(node)}:** {_blocks(node.children)}"
    if isinstance(node, nodes.section | nodes.block_quote):
        return _blocks(node.children)
    if isinstance(node, nodes.system_message):  # a directive nobody knows: its source
        return _blocks([child for child in node.children if isinstance(child, nodes.literal_block)])
    if isinstance(node, nodes.comment | nodes.substitution_definition | nodes.target):
        return ""
    return _rows(node) if isinstance(node, _OF_ROWS) else _inline(node) if node.children else node.astext()


def _rows(node: nodes.Node) -> str:
    """A table, or a part of one, with a line for each of its rows; lines that are to be kept as they are."""
    if isinstance(node, nodes.row):
        return " | ".join(_blocks(entry.children) for entry in node.children)
    return "\n".join(text for text in map(_block, node.children) if text)


def _title(node: nodes.Admonition) -> str:
    title = node["title"] if isinstance(node, nodes.admonition) else ""
    return title or type(node).__name__.title()


def _blocks(children: Sequence[nodes.Node]) -> str:
    return "\n\n".join(text for text in map(_block, children) if text)


def _read_field(name: str, body: str, fields: _Fields) -> None:
    body = _TWO_STOPS.sub(".", body)
    keyword, _, argument = name.partition(" ")
    if keyword in {"arg", "param", "parameter", "argument", "key", "keyword"}:
        kind, _, argument = argument.rpartition(" ")
        argument = argument.lstrip("*")
        fields.texts[argument] = body
        fields.last = argument
        if kind:
            fields.types[argument] = kind
    elif keyword == "type":
        if argument:
            fields.set_type(argument.strip().lstrip("*"), body.replace("`", ""))
        else:
            fields.own_type = body.replace("`", "")
    elif keyword in {"return", "returns"}:
        fields.returns = body
    elif keyword == "rtype":
        fields.return_type = body.replace("`", "")
    else:
        fields.other.append(f"**{name}**: {body}")


def _literal(expression: ast.expr | None) -> Default:
    """A default's value in JSON's terms, None where it is an expression."""
    try:
        value = ast.literal_eval(expression) if expression else None
    except ValueError:
        return None
    if isinstance(value, set):
        return sorted(value, key=repr)
    return list(value) if isinstance(value, tuple) else value


@cache
def _definition(signature: str) -> ast.FunctionDef | None:
    """A call's text as Python reads a definition with these arguments; None where it is not Python."""
    call = signature[signature.index("(") :] if "(" in signature else "("
    for text in (call, call.partition(" -> ")[0]):
        try:
            definition = ast.parse(f"def _{text}: ...").body[0]
        except (SyntaxError, ValueError):
            continue
        assert isinstance(definition, ast.FunctionDef)
        return definition
    return None


def _annotation(expression: ast.expr | None) -> str:
    """A type as an annotation gives it, the quotes around a whole one left out."""
    if expression is None:
        return ""
    if isinstance(expression, ast.Constant) and isinstance(expression.value, str):
        return expression.value
    return ast.unparse(expression)


def _values(text: str, pattern: re.Pattern[str]) -> list[str]:
    """The strings of the list that this pattern finds; [] for several lists, and for other values."""
    lists = pattern.findall(text)
    try:
        held = ast.parse(lists[0], mode="eval").body if len(lists) == 1 else None
    except SyntaxError:
        return []
    values = [ast.literal_eval(item) for item in getattr(held, "elts", ()) if isinstance(item, ast.Constant)]
    whole = len(values) == len(getattr(held, "elts", ())) and all(isinstance(value, str) for value in values)
    return values if whole else []


def _with_values(parameter: Parameter) -> Parameter:
    """The strings that a type or a description allows, as values: ``Literal['A', 'B']``, ``string in ['A']``."""
    kind = parameter.type
    if values := _values(kind, _LITERAL):
        kind = _LITERAL.sub("enum", kind)
    else:
        values = _values(kind, _LISTED) or _values(parameter.description, _LISTED)
    return replace(parameter, type=kind, enum_items=tuple(map(EnumItem, values))) if values else parameter


def call_parameters(signature: str) -> list[Parameter]:
    """The arguments in a call's text, ``(a, *, b=1)``; [] when it is not Python.

    A default that is a literal is given as its value; one that is an expression stands in the signature alone.
    """
    definition = _definition(signature)
    if definition is None:
        return []
    arguments = definition.args
    positional = [*arguments.posonlyargs, *arguments.args]
    defaults: list[ast.expr | None] = [None] * (len(positional) - len(arguments.defaults))
    pairs = [*zip(positional, [*defaults, *arguments.defaults], strict=True)]
    pairs += zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)
    parameters = [
        Parameter(
            name=argument.arg,
            type=_annotation(argument.annotation),
            default=_literal(default),
            required=default is None,
        )
        for argument, default in pairs
        if argument.arg != "self"
    ]
    parameters += [Parameter(name=extra.arg) for extra in (arguments.vararg, arguments.kwarg) if extra]
    return parameters


def _split(text: str) -> tuple[list[str], str]:
    """(calls, body) of a docstring: its own directive with one call a line, or a bare call on the first line."""
    first, _, rest = text.partition("\n")
    if first.startswith("BMeshOpFunc "):
        # The mesh is the only argument that goes by position.
        call = (
            first.removeprefix("BMeshOpFunc ")
            .strip()
            .replace("(bmesh,", "(bmesh, /, *,")
            .replace("(bmesh)", "(bmesh, /)")
        )
        return [call], rest
    if not _DIRECTIVE.match(first.strip()):
        return [], text
    while first.endswith("\\"):
        line, _, rest = rest.partition("\n")
        first = f"{first[:-1].rstrip()} {line.strip()}"
    match = _DIRECTIVE.match(first.strip())
    calls = [match.group(1).strip()] if match else []
    while calls and _CALL.match(calls[0]) and rest[:1].isspace() and _CALL.match(rest.lstrip(" \t")):
        line, _, rest = rest.partition("\n")
        calls.append(line.strip())
    return calls, textwrap.dedent(rest)


def _parameters(signature: str, fields: _Fields, *, is_certain: bool) -> tuple[Parameter, ...]:
    """The call's arguments in its order, completed from the field list; ``is_certain``: there are no others."""
    parameters = {parameter.name: parameter for parameter in call_parameters(signature)}
    described = fields.texts | fields.types
    misnamed = [name for name in described if name not in parameters]
    undescribed = [name for name in parameters if name not in described]
    if fields.arguments and len(misnamed) == len(undescribed) and (is_certain or len(misnamed) == 1):
        # The docstring calls the arguments that are left otherwise than the signature does.
        for wrong, right in zip(misnamed, undescribed, strict=True):
            for known in (fields.texts, fields.types):
                if wrong in known:
                    known[right] = known.pop(wrong)
    untyped = [name for name in fields.texts if name not in fields.types]
    undescribed = [name for name in fields.types if name not in fields.texts]
    if not parameters and len(untyped) == len(undescribed) == 1:
        # Of two names in the docstring alone, one is a slip: it describes the one, and has the type of the other.
        fields.types[untyped[0]] = fields.types.pop(undescribed[0])
    for name in fields.texts | fields.types if not is_certain else ():
        parameters.setdefault(name, Parameter(name=name))
    return tuple(
        _with_values(
            replace(
                parameter,
                description=(text := fields.texts.get(parameter.name, "")),
                type=_of_several(fields.types.get(parameter.name, ""), text) or parameter.type,
                required=parameter.required and not _OPTIONAL.search(text),
            )
        )
        for parameter in parameters.values()
    )


def _of_several(kind: str, description: str) -> str:
    """A type, which is a sequence's where the description says that it is one: some docstrings name only the class of
    its elements.
    """
    return f"Sequence[{kind}]" if _ELEMENT.fullmatch(kind) and _SEVERAL.match(description) else kind


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


def _form(call: str) -> tuple[object, ...] | None:
    """What two texts of one call have in common: the arguments, how each is given, and which may be left out; None
    where that is open.
    """
    definition = _definition(call)
    if definition is None or definition.args.vararg or definition.args.kwarg:
        return None
    arguments = definition.args
    listed = (arguments.posonlyargs, arguments.args, arguments.kwonlyargs)
    names = tuple(tuple(argument.arg for argument in each if argument.arg != "self") for each in listed)
    return *names, len(arguments.defaults), *(default is None for default in arguments.kw_defaults)


@cache
def parse_docstring(text: str, signature: str = "", *, is_python: bool = False) -> Docstring:
    """Reads a docstring as reST.

    ``signature`` is what Python's own introspection found; a directive line in the docstring wins over it, which
    knows the names that C functions give to their arguments. Of a function that is written in Python (``is_python``)
    the signature is what it takes, whatever the docstring says. Malformed markup loses its meaning, never its text.
    """
    calls, body = _split(text)
    taken = _form(signature) if is_python else None
    if taken is not None and taken not in map(_form, calls):
        calls = []
    body, slots = _bmesh_results(body) if text.startswith("BMeshOpFunc ") else (body, ())
    parser, settings = _parser()
    document = new_document("docstring", settings)
    with states_when_entered():
        parser.parse(_SPHINX.sub(rf"\1{_OWN}", body), document)
    parsed = _overloaded(document.children, calls or [signature], slots, is_certain=taken is not None)
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


def _member(node: _Declared) -> Member:
    parsed = _overloaded(node.children, node["calls"])
    return Member(node["kind"], parsed.signature.partition("(")[0].strip(), parsed)


def _unquoted(children: Sequence[nodes.Node]) -> Iterator[nodes.Node]:
    """The body elements, those included that stand too far to the right: a field there is a field."""
    for node in children:
        if isinstance(node, nodes.block_quote) and any(
            isinstance(n, nodes.field_list) for n in node.children
        ):
            yield from _unquoted(node.children)
        else:
            yield node


def _interpreted(
    children: Sequence[nodes.Node],
    written: str,
    slots: tuple[Parameter, ...] = (),
    *,
    is_certain: bool = False,
) -> Docstring:
    """Reads the body of a docstring, or of a method within it; ``slots`` are results known beforehand."""
    definition = _definition(written)
    named = {parameter.name for parameter in call_parameters(written)}
    open_ended = definition is None or definition.args.kwarg is not None
    fields = _Fields(arguments=frozenset() if open_ended else frozenset(named))
    described: list[nodes.Node] = []
    members: list[Member] = []
    for node in _unquoted(children):
        if isinstance(node, nodes.field_list):
            for row in node.children:
                _read_field(row.children[0].astext(), _blocks(row.children[1].children), fields)
        elif isinstance(node, _Declared):
            members.append(_member(node))
        else:
            described.append(node)
    return_type = fields.return_type
    if not return_type and definition is not None and not slots:
        annotation = _annotation(definition.returns)
        return_type = annotation if annotation != "None" else ""
    returns = slots
    if fields.returns or return_type:
        returns = (_with_values(Parameter(name="", type=return_type, description=fields.returns)),)
    return Docstring(
        description="\n\n".join(part for part in (_blocks(described), *fields.other) if part),
        signature=written,
        type=fields.own_type or (fields.return_type if not written.endswith(")") else ""),
        parameters=_parameters(written, fields, is_certain=is_certain),
        returns=returns,
        members=tuple(members),
    )
