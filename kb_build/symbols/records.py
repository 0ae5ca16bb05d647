"""The records that a knowledge base is made of.

Everything the extractor and the page readers produce, and everything the server answers from, is one of
these. It imports nothing of the project but leaves.
"""

from __future__ import annotations

import hashlib
from dataclasses import fields, is_dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, cast, get_args

from kb_build.symbols.needs import OperatorNeeds
from kb_build.symbols.paths import last_name, socket_name, socket_side
from kb_build.symbols.taken import NEVER, Taken
from simworlds.schemas.value_class import value_class

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

Scalar = str | int | float | bool | None
Default = Scalar | list[Any]

SymbolKind = Literal[
    "module", "class", "property", "function", "operator", "socket", "data", "context", "enum"
]
PageSource = Literal["manual", "guide", "template"]
PAGE_SOURCES: tuple[PageSource, ...] = get_args(PageSource)
LinkKind = Literal["manual", "base", "pointer", "collection", "socket-of"]


# The types of properties in Blender's own data: those of values, and all. What Python computes has others.
SCALAR_TYPES = frozenset({"boolean", "int", "float", "string", "enum"})
RNA_TYPES = SCALAR_TYPES | {"pointer", "collection"}
# How the types of parameters end that are texts for which None can be given, too.
OR_NONE = " or None"
# The flags of properties that scripts cannot assign, that can have keyframes, that are a set of items, and that are a
# pointer which is never None.
READ_ONLY, ANIMATABLE, ENUM_FLAG, NEVER_NONE = "readonly", "animatable", "enum-flag", "never-none"
# The flags of functions that are called on a class, and that need neither a class nor an instance.
OF_CLASS, STATIC = "classmethod", "static"
# The flag of what was compared with newly made things, so that its default is what these have.
COMPARED = "compared"
# The flag of a property that an add-on has registered.
RUNTIME = "runtime"
# The flags of sockets that a new node hides, and that their name gives while they are shown.
HIDDEN, NAME_WHEN_SHOWN = "hidden-by-default", "name-when-shown"
# How flags of sockets begin: with the identifier, another name in some mode, and a setting that chooses the type.
IDENTIFIER, ALSO_NAMED, TYPE_BY = "identifier:", "also-named:", "type-by:"
# How a flag begins that names what the symbol repeats, or is another name of; and one that names a kind of editor which
# provides a member of the context.
SAME_AS, PROVIDED_BY = "same-as:", "from:"
# How flags begin that say what fills a pointer that is None on a new thing, and on which new things it is not None.
FILLED_BY = "filled-by:"
FILLED_ON = "filled-on:"
# The flags of a member of the context that is None: where no object is active, and outside the areas of windows.
WITHOUT_ACTIVE = "none-without-active-object"
WITHOUT_AREA = "none-without-area"
# … and while the interface shows no such thing: no popup, no asset.
WITHOUT_SHOWN = "none-unless-shown"
# The flag of a socket that its identifier gives in no mode of its node.
NEVER_BY_IDENTIFIER = "identifier-never"
# How flags begin that name the other operators which an operator's own script calls.
CALLS = "calls:"
# How flags begin that name the types of areas in which alone an operator runs (``any``), and the member of the context
# that it takes instead.
AREAS = "areas:"
GIVEN = "given:"
# How flags begin that name what must be set besides, where an operator runs only in areas: statements, in their order,
# or what is said of an area that is not enough where that was not found.
ALSO = "also:"
NOT_ENOUGH = "..."
# The flags of an operator whose poll said no to all that was tried, and of one that was not asked or did not answer
# alike.
REFUSED_ALL = "refused-all"
NOT_KNOWN = "poll-not-known"
# How a flag begins that says what must not be None: Blender ends when the function is called.
ENDS_WITHOUT = "ends-without:"
# How flags begin that name an argument for which None ends Blender, or the pointer itself to which None is assigned;
# and the argument without which a call does, although it may be left out.
ENDS_ON_NONE, ENDS_LEFT_OUT = "ends-on-none:", "ends-left-out:"
# The flag of a function that ends a Blender without a window.
ENDS_WINDOWLESS = "ends-windowless"
# The flags of a function that ends Blender whatever it is given, and of one that does so where Blender is a module of
# Python.
ENDS_EVERY_TIME, ENDS_IN_MODULE = "ends-every-time", "ends-in-module"
# How a flag begins that names the index of -1 by which a pointer comes to be None.
UNSET_BY = "unset-by:"
# How a flag begins that says what must be called before an operator's mode is entered: else Blender ends where there is
# no undo step yet, as in one without a window.
ENDS_BEFORE = "ends-before:"
# How the flag of an operator begins that adds an object whose data RNA has no class for, before what to call instead.
BARE_DATA = "bare-data:"
# The flag of a switch that some panel shows the other way round.
INVERTED = "inverted"
# How a flag begins that names an end of a number's range that is not kept: ``min`` or ``max``.
UNBOUNDED = "unbounded:"
# How a flag begins that says where a number of a new thing stops before the end of its range: ``min=0``, ``max=1``, or
# by which other number of it, ``min=frame_start``.
STOPS = "stops:"
# The flag of a socket that a node of a zone has once it is paired with the other one, and the method that does it.
WHEN_PAIRED = "when-paired"
PAIRS = "pair_with_output"
# How the flag of a class of nodes begins that says what ``type`` is of all such nodes.
NODE_TYPE = "node-type:"
# How a flag begins that says in which of a node's modes a socket is shown, where its modes cannot say it.
SHOWN_WHEN = "shown-when:"
# The flag of a property, not called ``name``, by whose value collections find such an item.
NAMES_ITEMS = "names-items"
# The flag of a collection that has no elements on what is newly made.
EMPTY = "empty-when-new"
# The flag of a collection whose elements only a loop gives.
ITERATED = "only-iterated"
# The flag of what a module has as a name alone, as this Blender is built: it is None.
STUB = "stub"
# The flag of a pointer that is None on some new things of a kind and not on others.
NONE_ON_SOME = "none-on-some"
# The flags of a collection of ``bpy.data`` or the window manager that is empty when Blender starts, and of a pointer
# that leads to something on what it starts with.
EMPTY_AT_START, FILLED_AT_START = "empty-at-start", "filled-at-start"
# The flag of a function that gave None for every index, and of a method that changes its value and returns None.
GIVES_NONE, RETURNS_NONE = "gives-none", "returns-none"
# How a flag begins with what Blender said of a call where it had no window.
WINDOWLESS = "windowless:"
# How a flag begins that names the property of the same class which always has the same value.
SAME_VALUE = "same-value:"
# How flags begin that name another property of its class which assigning a set of items changes, and the flag of such a
# set that keeps its items where it is given none.
SETS_ALSO, KEEPS_ITEMS = "sets-also:", "keeps-items"
# How flags begin of a property that RNA calls writable, and Blender does not always let be assigned: on which things it
# is locked, or is not (``any``: on all that were tried), in which modes, and which setting frees it.
LOCKED_ON = "locked-on:"
FREE_ON = "free-on:"
LOCKED_WITH = "locked-with:"
FREED_BY = "freed-by:"
ANY = "any"
# How a flag begins that says which part of its object alone a text may name, and is left out else: ``UV map``.
NAMES_PART = "names-part:"
# How a flag begins that says what becomes of a kind of thing that a pointer is given: ``takes:MESH`` (see accepted.py).
ACCEPTS = "accepts:"
# How a flag begins that names what a class of a script's own must have, or Blender does not register it.
MUST_HAVE = "must-have:"
# The flags of functions that such classes define and Blender calls: if they want, and in any case.
DEFINED, DEFINED_ALWAYS = "defined", "defined-always"
# The flag of what Blender computes for evaluated objects, and leaves empty on the originals.
EVALUATED = "evaluated-only"
THEN = " then "  # between calls that fill it one after the other
# How the names begin of what is there when Blender starts, among those of new things.
STARTUP = "start-up "
FACTORY = "factory "


@value_class
class EnumItem:
    """One value of an enumeration.

    ``where`` it is taken; None for everywhere.
    """

    identifier: str
    name: str = ""
    description: str = ""
    where: Taken | None = None

    @property
    def is_taken(self) -> bool:
        """Whether anything takes it: RNA lists some that everything refused which was tried."""
        return self.where != NEVER


@value_class
class NewValue:
    """What newly made instances have: all of them, or those that ``made`` names, or those in the mode ``when``.

    Of several without a mode the first is the usual one; ``made`` is then empty: all the others. ``by`` is the call
    that made all that have it, if one call did. The last ones may be of what is there when Blender starts
    (``is_startup``), which is the usual one only where nothing of the kind can be made.
    """

    value: Default
    made: tuple[str, ...] = ()
    when: str = ""
    by: str = ""

    @property
    def is_startup(self) -> bool:
        """Whether it is not of a new thing, but of one that Blender starts with."""
        return (
            bool(self.made)
            and not self.when
            and all(name.startswith((STARTUP, FACTORY)) for name in self.made)
        )


@value_class
class Parameter:
    """One argument (or returned value) of a function or an operator.

    ``type`` is text for people (``"float[3]"``, ``"enum"``, ``"Object"``, ``"string or None"``); ``default`` is absent
    (None with ``required``) when the caller must give the argument. ``values_asked`` are those that Blender named in a
    new file, of an enumeration that it lists none of, or a stand-in: other files may have more.
    """

    name: str
    type: str = ""
    description: str = ""
    default: Default = None
    required: bool = False
    enum_items: tuple[EnumItem, ...] = ()
    label: str = ""
    hard_min: float | None = None
    hard_max: float | None = None
    unit: str = ""
    values_asked: tuple[str, ...] = ()

    @property
    def plain_type(self) -> str:
        """The type without whether None can be given, too."""
        return self.type.removesuffix(OR_NONE)

    @property
    def takes_none(self) -> bool:
        """Whether None can be given for a text."""
        return self.type.endswith(OR_NONE)

    @property
    def is_open(self) -> bool:
        """Whether the values depend on the instance: one that was not asked may take others."""
        return any(item.where for item in self.enum_items)

    @property
    def has_stand_in(self) -> bool:
        """Whether RNA lists nothing but what is refused, since the values are put together while Blender runs."""
        return bool(self.enum_items) and not any(item.is_taken for item in self.enum_items)


@value_class
class Deprecation:
    """What Blender itself, or its release notes, say of a property that is on its way out. Versions as ``"5.0"``."""

    note: str
    since: str = ""
    removal: str = ""


@value_class
class Refusal:
    """What Blender said to calls of a function whose arguments are those that the signature asks for.

    ``message`` has … for what things are called and what was given; it is empty where the call returned None. Refused
    were these ``values`` of the ``argument``, () for all; made of what ``by`` names, () for everything that was tried,
    while ``taken_by`` names what takes them. ``given`` are the further arguments with which they were taken, ``mode``
    the mode of the object. ``again``: only a call after another one was refused, ``any`` with its choice,
    the ``same`` one, or one with an ``other`` choice, too.
    """

    message: str
    argument: str = ""
    values: tuple[str, ...] = ()
    by: tuple[str, ...] = ()
    taken_by: tuple[str, ...] = ()
    given: tuple[str, ...] = ()
    mode: str = ""
    again: str = ""

    @property
    def is_explained(self) -> bool:
        """Whether it is known when the call is refused."""
        return bool(self.values or self.by or self.given or self.mode or self.again)


def told_by(flags: Iterable[str], prefix: str) -> tuple[str, ...]:
    """What the flags that begin with ``prefix`` say."""
    return tuple([flag.removeprefix(prefix) for flag in flags if flag.startswith(prefix)])


@value_class
class Symbol:
    """One public identifier of Blender's Python API.

    ``path`` is the identifier as the API reference writes it; what the reference lacks (node sockets) follows
    Python's own spelling: ``bpy.types.ShaderNodeBsdfPrincipled.inputs["Specular IOR Level"]``.
    Ranges are in the unit that ``unit`` names (Blender's scene units: metres, radians, frames).

    ``target`` is the class that a pointer, a collection or a socket leads to (an operator: its ``_OT_`` class),
    ``collection`` the class of the collection itself, which carries ``new`` and ``remove``; ``group`` of a class
    is ``data``, ``ui`` or ``operator``; ``modes`` name the enum values under which a node shows a socket;
    ``trees`` the node trees that take a node; ``reached`` is an expression that leads to an instance,
    ``lacks`` the property on that way which is None, or empty, on new things.

    ``default`` is RNA's, which a new instance need not have: ``new_values`` are what new ones had where some differed.
    The flag ``compared`` says that new ones were read. ``subscripts`` give a socket in every mode in which its node
    has it, best first; with the flag ``name-when-shown`` its name does only while the node shows it. So it is with
    ``identifier-when-shown`` of its identifier, which with ``identifier-never`` gives it in none of its node's modes.

    A pointer that is None on new things has None as its new value; a flag ``filled-by:CALL`` then names what was seen
    to fill it, flags ``filled-on:THING`` the new things on which it leads to something. ``needs`` are what an operator
    runs with, of all that was tried, beside an area if it wants one; None where it has no more to want, or that is not
    known. ``refusals`` are what a function refused, of all that was tried.
    """

    path: str
    kind: SymbolKind
    owner: str = ""
    label: str = ""
    description: str = ""
    type: str = ""
    subtype: str = ""
    unit: str = ""
    target: str = ""
    array: tuple[int, ...] = ()
    default: Default = None
    hard_min: float | None = None
    hard_max: float | None = None
    soft_min: float | None = None
    soft_max: float | None = None
    flags: tuple[str, ...] = ()
    enum_items: tuple[EnumItem, ...] = ()
    enum_computed: bool = False
    base: str = ""
    group: str = ""
    signature: str = ""
    parameters: tuple[Parameter, ...] = ()
    returns: tuple[Parameter, ...] = ()
    deprecation: Deprecation | None = None
    modes: tuple[str, ...] = ()
    collection: str = ""
    trees: tuple[str, ...] = ()
    reached: str = ""
    lacks: str = ""
    new_values: tuple[NewValue, ...] = ()
    subscripts: tuple[str, ...] = ()
    refusals: tuple[Refusal, ...] = ()
    needs: OperatorNeeds | None = None

    @property
    def name(self) -> str:
        """The last part of the path: what a programmer writes after the dot (or between the brackets)."""
        return socket_name(self.path) if self.kind == "socket" else last_name(self.path)

    @property
    def side(self) -> str:
        """``inputs`` or ``outputs``, of a socket; "" for others."""
        return socket_side(self.path)

    @property
    def positional(self) -> list[Parameter]:
        """What calls give by place: all parameters but what a method is read from."""
        return [parameter for parameter in self.parameters if parameter.name not in {"self", "cls"}]

    def parameter(self, name: str) -> Parameter | None:
        """The parameter of a name."""
        return next((parameter for parameter in self.parameters if parameter.name == name), None)

    @property
    def has_empty_signature(self) -> bool:
        """Whether it is known to take no arguments, and is not one whose arguments are unknown."""
        return self.signature == f"{self.name}()"

    @property
    def socket_names(self) -> tuple[str, ...]:
        """The names that a socket has in the modes of its node, the usual one first."""
        return (self.label, *self.flagged(ALSO_NAMED))

    @property
    def identifier(self) -> str:
        """A socket's identifier, which its name need not be; empty for what is no socket."""
        return "".join(self.flagged(IDENTIFIER)[:1])

    @property
    def socket_keys(self) -> tuple[str, ...]:
        """The texts in brackets that give a socket, at least in some modes of its node: its names, and its identifier
        where that does, too.
        """
        by_identifier = self.identifier and NEVER_BY_IDENTIFIER not in self.flags
        names = (*self.socket_names, self.identifier) if by_identifier else self.socket_names
        return tuple(dict.fromkeys(name for name in names if name))

    @property
    def type_settings(self) -> tuple[str, ...]:
        """The settings of its node that choose a socket's type; none where it is always the same."""
        return self.flagged(TYPE_BY)

    @property
    def is_called_back(self) -> bool:
        """Whether classes of scripts define the function, and Blender calls it."""
        return not {DEFINED, DEFINED_ALWAYS}.isdisjoint(self.flags)

    @property
    def same_as(self) -> str:
        """The path of what it repeats, or is another name of; empty for none."""
        return next(iter(self.flagged(SAME_AS)), "")

    @property
    def editors(self) -> tuple[str, ...]:
        """The kinds of editors that provide a member of the context; ``screen`` stands for all."""
        return self.flagged(PROVIDED_BY)

    def flagged(self, prefix: str) -> tuple[str, ...]:
        """What the flags that begin with ``prefix`` say."""
        return told_by(self.flags, prefix) if self.flags else ()


@value_class
class Section:
    """A titled part of a page: the unit of retrieval.

    ``text`` is Markdown without the heading itself; definition lists, field lists, notes, tables and code are
    kept, pictures become their captions. ``level`` is 1 for the page's title section. ``marks`` are the places in it
    that addresses of symbols lead to (``bpy-types-clothsettings-quality``), each with its line of ``text`` counted
    from 0; -1 is the heading.
    """

    anchor: str
    title: str
    level: int
    text: str
    marks: tuple[tuple[str, int], ...] = ()


@value_class
class Page:
    """One page of the manual, one guide, or one script template.

    ``slug`` is the page's address without suffix (``physics/cloth/settings/collisions``,
    ``info_gotchas_meshes``); ``version`` is the documentation's own, which may differ from Blender's.
    ``breadcrumbs`` are the titles of the pages above it, outermost first; ``children`` the slugs below it, in
    order; ``links`` the slugs that its text refers to.
    """

    slug: str
    source: PageSource
    version: str
    title: str
    sections: tuple[Section, ...]
    breadcrumbs: tuple[str, ...] = ()
    children: tuple[str, ...] = ()
    links: tuple[str, ...] = ()
    url: str = ""
    warnings: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The whole page as Markdown, headings included."""
        parts: list[str] = []
        for section in self.sections:
            parts.append(f"{'#' * max(1, section.level)} {section.title}")
            if section.text:
                parts.append(section.text)
        return "\n\n".join(parts)

    @property
    def content_hash(self) -> str:
        """SHA-256 of the text with its white space folded: equal for equal content, whatever the layout."""
        return hashlib.sha256(" ".join(self.text.split()).encode(errors="replace")).hexdigest()


# What a setting is where what it depends on is otherwise: Blender's panels grey it out, or do not show it; or it has no
# effect, as it was tried.
Otherwise = Literal["greyed", "hidden", "idle"]


class SettingCondition(NamedTuple):
    """What a setting (``gate``) must be, as text: ``on``, ``'SUN'``, before Blender's panels let ``path`` be set, or an
    operator be run; or before it has an effect.

    Of those with one ``clause`` any is enough; all clauses must hold.
    """

    path: str
    clause: int
    gate: str
    test: str
    otherwise: Otherwise


@value_class
class Link:
    """A relation between two ids (symbol paths or page slugs)."""

    source: str
    target: str
    kind: LinkKind


_LEAVES = frozenset({str, int, float, bool, type(None)})


def to_json(record: Symbol | Page) -> dict[str, Any]:
    """A record as a JSON-ready dictionary, without the fields that hold their default value."""
    return {
        name: _plain(value)
        for name, default in _fields(type(record))
        if (value := getattr(record, name)) != default
    }


def _plain(value: Any) -> Any:
    """A field's value, the records in it taken apart."""
    if type(value) in _LEAVES:  # hundreds of thousands
        return value
    if isinstance(value, tuple):
        return [_plain(part) for part in cast("tuple[Any, ...]", value)]
    if isinstance(value, Section):  # thousands, and most have no marks
        plain = {"anchor": value.anchor, "title": value.title, "level": value.level, "text": value.text}
        return {**plain, "marks": value.marks} if value.marks else plain
    known = _fields(type(value))
    return {name: _plain(getattr(value, name)) for name, _ in known} if known else value


@cache
def _fields(of: type) -> tuple[tuple[str, Any], ...]:
    """(name, default) of the fields of a record; none for other values."""
    return tuple((field.name, field.default) for field in fields(of)) if is_dataclass(of) else ()


def _enum_item(row: dict[str, Any]) -> EnumItem:
    if row.get("where") is None:
        return EnumItem(**row)
    values: dict[str, Any] = {**row, "where": Taken.of(row["where"])}
    return EnumItem(**values)


def _enum_items(rows: list[dict[str, Any]]) -> tuple[EnumItem, ...]:
    return tuple(map(_enum_item, rows))


def _parameters(rows: list[dict[str, Any]]) -> tuple[Parameter, ...]:
    parameters: list[Parameter] = []
    for row in rows:
        values: dict[str, Any] = {
            **row,
            "enum_items": _enum_items(row.get("enum_items", [])),
            "values_asked": tuple(row.get("values_asked", ())),
        }
        parameters.append(Parameter(**values))
    return tuple(parameters)


def _new_values(rows: list[dict[str, Any]]) -> tuple[NewValue, ...]:
    return tuple(
        NewValue(row["value"], tuple(row.get("made", ())), row.get("when", ""), row.get("by", ""))
        for row in rows
    )


def _refusals(rows: list[dict[str, Any]]) -> tuple[Refusal, ...]:
    refusals: list[Refusal] = []
    for row in rows:
        values: dict[str, Any] = {
            name: tuple(row.get(name, ())) for name in ("values", "by", "taken_by", "given")
        }
        refusals.append(Refusal(**{**row, **values}))
    return tuple(refusals)


# How the fields that JSON has as lists or objects are read.
_SYMBOL_FIELDS: dict[str, Callable[[Any], Any]] = {
    **dict.fromkeys(("array", "flags", "modes", "trees", "subscripts"), tuple),
    "enum_items": _enum_items,
    "parameters": _parameters,
    "returns": _parameters,
    "deprecation": lambda row: Deprecation(**row),
    "new_values": _new_values,
    "refusals": _refusals,
    "needs": OperatorNeeds.of,
}


def symbol_fields(data: Mapping[str, Any]) -> dict[str, Any]:
    """A symbol's fields as JSON has them, as those of a Symbol; unknown ones as they are."""
    return {
        name: _SYMBOL_FIELDS[name](value) if name in _SYMBOL_FIELDS else value for name, value in data.items()
    }


def symbol_from_json(data: Mapping[str, Any]) -> Symbol:
    """The inverse of :func:`to_json` for symbols. Raises TypeError on unknown fields."""
    return Symbol(**symbol_fields(data))


def _section(row: dict[str, Any]) -> Section:
    marks = tuple((str(name), int(line)) for name, line in row.get("marks", ()))
    values: dict[str, Any] = {**row, "marks": marks}
    return Section(**values)


def page_from_json(data: dict[str, Any]) -> Page:
    """The inverse of :func:`to_json` for pages. Raises TypeError on unknown fields."""
    values: dict[str, Any] = {
        **data,
        "sections": tuple(map(_section, data.get("sections", []))),
        "breadcrumbs": tuple(data.get("breadcrumbs", ())),
        "children": tuple(data.get("children", ())),
        "links": tuple(data.get("links", ())),
        "warnings": tuple(data.get("warnings", ())),
    }
    return Page(**values)
