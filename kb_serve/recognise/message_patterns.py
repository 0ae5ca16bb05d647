"""Patterns of error messages: which text is Blender's wording, which is the caller's, and which names symbols."""

from __future__ import annotations

import re
from functools import lru_cache
from itertools import islice
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

_MOST_MATCHES = 8
_EXCEPTION = re.compile(r"\b[A-Z]\w*(?:Error|Exception|Warning)\b:?|\b(?:Error|Warning):")
_REPORT = re.compile(r"Error:\s*Error:|^\s*(?:Error|Warning):\s")  # reported by an operator or C code
_TRACEBACK = re.compile(
    r"Traceback \(most recent call last\):|File \"[^\"]*\", line \d+(?:, in \S+)?|\^{2,}"
    r"|\bLocation: (?=[/<]|\w:)[^\n]{1,300}?:\d+(?!\S)"  # of the operator's call, mostly in Blender's own ``ops.py``
)
# What Blender's log puts before a line: the time, and which part of Blender writes it.
_OF_LOG = r"(?<![\w.])\w++(?:\.\w++)*+\s++\|\s++(?:DEBUG|INFO|WARNING|ERROR)\b|\bWARN\ \(\w++(?:\.\w++)*+\):"
_QUOTED = re.compile(r"(?<!\w)(['\"])[^'\"\n]{0,60}\1")

# Who types a message from memory leaves its quotes out.
HAS_NO = re.compile(
    r"(?<![\w.])(?P<owner>NoneType|[\w.]++(?=['\"]? object\b))['\"]?(?: object)? has no attribute ['\"]?(?P<name>\w+)"
)
TYPE_HAS_NO = re.compile(r"\btype object ['\"](?P<owner>[\w.]++)['\"] has no attribute ['\"](?P<name>\w+)")
MODULE_HAS_NO = re.compile(r"module ['\"]?(?P<owner>[\w.]++)['\"]? has no attribute ['\"]?(?P<name>\w+)")
MEANT = re.compile(r"\. Did you mean: '(?P<name>\w+)'\?")
NOT_IN_COLLECTION = re.compile(r"\bbpy_prop_collection: attribute \"(?P<name>\w+)\" not found")
NO_KEY = re.compile(
    r"(?:\b(?P<on>bpy_\w+)\[key\]: |^\W*(?:KeyError\b\W*)?)key \"(?P<name>[^\"]+)\" not found"
)
NO_INDEX = re.compile(r"\w+\[index\](?: = value)?: index (?P<index>-?\d+) out of range, size (?P<size>\d+)")
NO_ELEMENT = re.compile(
    r"\bindex out of range \"(?P<name>\w+)\", given (?P<index>-?\d+), array length is (?P<size>\d+)"
)
OUTDATED = re.compile(r"\boutdated internal index table")  # of a BMesh
SUBSCRIPTED = re.compile(r"\b([a-z]\w*)\[-?\d+\]")
BAD_ENUM = re.compile(r"(?P<quote>['\"])(?P<name>[^'\"]*)(?P=quote) not found in \((?P<items>[^)]*)\)?")
# Without the list of what is taken, as somebody who shortens a message leaves it.
UNLISTED_ENUM = re.compile(r"\benum (?P<quote>['\"])(?P<name>[^'\"\n]+)(?P=quote) not found(?! in)")
ENUM_VALUE = re.compile(r"\benum (?P<quote>['\"])[^'\"\n]*(?P=quote)(?= not found)")
# Of modules written in C, which take texts rather than items of enumerations: ``gpu``.
BAD_TEXT = re.compile(r"expected a string in \((?P<items>[^)]*)\), got '(?P<name>[^']*)'")
BAD_KEYWORD = re.compile(
    r"(?:(?<![\w.])(?P<of_bmesh>\w++): )?keyword \"(?P<name>\w+)\" (?:is invalid|unrecognized)"
    r"|(?:(?<![\w.])(?P<function>[\w.]++)\(\) got an )?unexpected keyword argument ['\"](?P<unexpected>\w+)['\"]"
    r"(?:\. Did you mean '(?P<meant>\w+)'\?)?"
    r"|['\"](?P<invalid>\w+)['\"] is an invalid keyword argument for (?:this function|(?P<of>[\w.]++)\(\))"
    r"|(?<![\w.])(?P<method>\w++(?:\.\w++)++)\(\): was called with invalid keyword argument\(s\) \((?P<several>[^)]*)\)"
)
OF_OPERATORS = "to operator properties"  # what arguments of operators are converted to
IN_FUNCTION = re.compile(r"(?<![\w.])(?P<method>\w++(?:\.\w++)*+)\(\): error with (?:keyword )?argument")
_ARGUMENT = r"error with (?:keyword )?argument (?:\d+, )?\"(?P<name>\w+)\" -"
IN_ARGUMENT = re.compile(_ARGUMENT)
# Of 5.0 and newer with no word behind it.
NO_SEQUENCE = re.compile(
    rf"(?<![\w.])(?P<function>\w++(?:\.\w++)++)\(\): {_ARGUMENT}"
    r"(?:\s*sequence expected at dimension 1|\s*(?=$|[\w.]+\())"
)
TOO_MANY = re.compile(
    r"(?<![\w.])(?P<function>\w++(?:\.\w++)*+)(?:\(\):? takes (?:at most|exactly)| expected at most) "
    r"(?P<most>\d+)(?: positional)? arguments?[,\s(]+(?:got )?(?P<given>\d+)"
)
BY_NAME_ONLY = re.compile(
    r"(?<![\w.])(?P<function>\w++(?:\.\w++)++)\(\): required parameter \"(?P<name>\w+)\" "
    r"(?:to be a keyword argument|not specified)"
)
NO_MODULE = re.compile(r"No module named ['\"](?P<module>[\w.-]+)['\"]")
NOT_DEFINED = re.compile(r"\bname ['\"](?P<name>\w+)['\"] is not defined")
NO_IMPORT = re.compile(r"cannot import name ['\"](?P<name>\w+)['\"] from ['\"](?P<module>[\w.]+)['\"]")
POLL = re.compile(r"Operator (?P<path>bpy\.ops\.\w+\.\w+)\.poll\(\)")
WRONG_TYPE = re.compile(
    # Only from the start of a dotted name, and the whole of it: trying each part of a long one takes seconds.
    r"(?<![\w.])(?:(?P<operator>[A-Z][A-Z_0-9]*_OT_\w+)\.\w+|(?P<path>\w++(?:\.\w++)++)) expected "
    r"(?P<wanted>an? \w+|[^,]{1,80})(?: type)?, not \w+"
)
GIVEN = re.compile(
    r"expected an? (?P<wanted>\w+) type, not (?P<given>\w+)"
    r"|does not support a '(?P<none>None)' assignment (?P<of>\w+) type"
)
READ_ONLY = re.compile(
    r"attribute \"(?P<name>\w+)\" from \"(?P<owner>\w+)\" is read-only"
    r"|bpy_prop \"(?P<array_owner>\w+)\.(?P<array>\w+)\" is read-only"
    r"|Context property \"(?P<context>\w+)\" is read-only"
    r"|property '(?P<of_python>\w+)' of '(?P<python_owner>\w+)' object has no setter"
)
FREED = re.compile(r"\b(?:StructRNA|(?P<module>BMesh) data) of type (?P<type>\w+) has been removed")
PRODUCT = re.compile(
    r"(?:(?:Inplace )?[Ee]lement-wise|Color) multiplication: not supported between "
    r"'(?P<left>\w+)' and '(?P<right>\w+)'"
)
MATRIX_PRODUCT = re.compile(
    r"Matrix multiplication: not supported between '(?P<left>\w+)' and '(?P<right>\w+)'"
)
NO_WRITING = re.compile(
    r"Writing to ID classes in this context is not allowed(?:.*?error setting (?P<owner>\w+)\.(?P<name>\w+))?"
)
# Of an operator that is called there; older Blenders say "can't".
NO_CALLING = re.compile(
    r"operator \"(?P<path>bpy\.ops\.\w+\.\w+)\" error, can(?:not|'t) modify blend data in this state"
)
OF_CLASSES = "validating class"  # what Blender says of classes that it is given to register
POSITIONAL = re.compile(r"\bargs execution context is supported")
NOT_AN_OPERATOR = re.compile(r"BMeshOpsModule: operator \"(?P<name>\w+)\" doesn't exist")
NO_OPERATOR = re.compile(
    r"Calling operator \"bpy\.ops\.(?P<called>\w+\.\w+)\" error, could not be found"
    r"|\bunknown operator '(?P<drawn>\w+\.\w+)'"
)
# Not of code, which may call its base's own: ``StrokeShader.__init__(self)``.
OF_MAKING = re.compile(r"(?<![\w.])(?P<class>[A-Z]\w++)\.__(?:new|init)__(?:\((?:\.\.\.)?\)|:)")
OF_BMESH = re.compile(
    r"(?<![\w.])(?P<function>\w++): keyword \"(?P<name>\w+)\" expected (?P<wanted>[^\n]{1,80}?), not (?P<given>\w+)"
)
NOT_MADE = re.compile(r"cannot create '(?P<type>[\w.]+)' instances")
NO_DRAWING = re.compile(r"GPU functions for drawing are not available")
# Of Mantaflow's own classes: its solver ends with these.
NO_FLUIDS = re.compile(
    r"\bManta::Error\b"
    r"|'(?:Levelset|MAC|Flag|Real|Vec|Int)Grid\w*' object has no attribute"
    r"|'(?:BasicParticle|Turbulence)System' object has no attribute"
)
INCOMPATIBLE = re.compile(r"class (?P<class>\w+), function (?P<function>\w+): incompatible return value")
NO_PROPERTY = re.compile(r"'\w+' (?P<kind>\w+Property) could not register")
NO_PARENT = re.compile(r"Registering panel class: parent '(?P<parent>\w*)' for '\w*' not found")
NO_NODE_TYPE = re.compile(r"Node type (?P<type>\w[\w ]{0,60}) undefined")
NO_NODE_OF_TREE = re.compile(r"Cannot add node of type (?P<type>\w+) to node tree '[^']*'")
NOT_ANIMATED = re.compile(r"\bkeyframe_(?:insert|delete)\(\):? property \"(?P<name>\w+)\" not animatable")
OF_ELEMENTS = re.compile(
    r"\bforeach_[gs]et\(\.\.\) '(?P<owner>\w+)\.(?P<collection>\w+)\[\.\.\.\]' elements have no attribute "
    r"'(?P<name>\w+)'"
)
EXPECTED_MEMBER = re.compile(
    r"expected (?P<base>\w+), \w+ class to have an? \"(?P<name>\w+)\" (?:attribute|function)"
)
_FAILED_OTHERWISE = re.compile(r"\b(?:Index|Key|Reference|Runtime|Type|Value|ZeroDivision)Error:")
NO_PATH = re.compile(
    r"\b(?:keyframe_(?:insert|delete)|driver_(?:add|remove))\(\):? property \"(?P<name>\w+)\" not found"
)

# A message that one of these patterns fits has one of these words.
_SIGNS = (
    "GPU functions",
    "Manta::Error",
    "Node type",
    "Writing to ID",
    "__init__",
    "__new__",
    "arg",  # argument, keyword arguments
    "attribute",
    "cannot create",
    "cannot import name",
    "could not",
    "doesn't exist",
    "does not support",
    "error with",
    "expected",
    "has been removed",
    "incompatible return value",
    "is not defined",
    "is read-only",
    "keyword",
    "module named",
    "node of type",
    "not animatable",
    "modify blend data",
    "multiplication",
    "no setter",
    "not found",
    "out of range",
    "outdated internal",
    "poll()",
    "required parameter",
    "sequences of dimension",
    "unknown operator",
)

# Of a function that is written in Python.
OTHER_ARGUMENTS = re.compile(
    r"(?<![\w.])(?:\w++\.)*+(?P<name>\w++)\(\) (?:missing \d+ required positional arguments?: '(?P<missing>\w++)'"
    r"|takes (?:\d+|from \d+ to \d+) positional arguments? but \d+ (?:was|were) given)"
)

_OF_CLASS = re.compile(r"'(\w+)' object\b")

# The wording of messages that looks like code, or like names of classes and members.
_WORDING = re.compile(
    r"""bpy_struct:\ item\.attr\s*=\s*val:|bpy_\w+\[(?:key|index|slice)\](?:\ =\ value)?:|BMElemSeq\[index\]:
    |bpy_prop_collection:\ attribute\ "\w+"\ not\ found|cannot\ create\ '[\w.]+'\ instances
    |'?_Restrict(?:Context|Data)'?\ object
    |(?:object\ )?has\ no\ attribute\ '\w+'|\bobject\ has\ no\ attribute\ \w+
    |and\ no\ __dict__\ for\ setting\ new\ attributes
    |Converting\ py\ args\ to\ operator\ properties::?|keyword\ "\w+"\ (?:is\ invalid|unrecognized)
    |(?:got\ an\ )?unexpected\ keyword\ argument|is\ an\ invalid\ keyword\ argument\ for(?:\ this\ function)?
    |was\ called\ with\ invalid\ keyword\ argument\(s\)\ \([^)]*\),\ expected\ \([^)]*\)?
    |No\ module\ named|cannot\ import\ name|function\ takes\ exactly\ \d+\ arguments?\ \(\d+\ given\)
    |not\ found\ in\ \([^)]*\)?|expected\ an?\ \w+\ type,\ not\ \w+|error\ with\ argument\ \d+,\ "\w+"\ -
    |\bFunction\.(?=\w+(?:\ expected|:\ |\ does\ not|\ enum))|[A-Z][A-Z_0-9]*_OT_\w+\.(?=\w+\ expected)
    |bpy_struct:\ (?=attribute|Context)|attribute\ "\w+"\ from\ "\w+"\ is\ read-only|Context\ property\ (?="\w+"\ is)
    |(?:StructRNA|BMesh\ data)\ of\ type\ \w+\ has\ been\ removed|BMeshOpsModule:\ operator
    |\bNode\ type\ (?=\w[\w\ ]{0,60}\ undefined)|\bnode\ of\ type\ (?=\w+)|'NoneType'\ object
    |\.\ Did\ you\ mean:\ '[^']*'\?
    |\berror\ setting\ \w+\.\w+
    |required\ parameter\ "\w+"\ (?:not\ specified|to\ be\ a\ keyword\ argument!?)|Calling\ operator\ (?=")
    |\brna_uiItem\w+:
    |"""
    + _OF_LOG,
    re.VERBOSE,
)


@lru_cache(maxsize=8)  # asked of one query several times
def may_be_message(query: str) -> bool:
    """Whether a query has words of a message that one of these patterns fits."""
    return any(sign in query for sign in _SIGNS)


def first_matches(pattern: re.Pattern[str], query: str) -> Iterator[re.Match[str]]:
    """The first matches: a log with more of them repeats itself."""
    return islice(pattern.finditer(query), _MOST_MATCHES)


@lru_cache(maxsize=8)  # the same
def is_message(query: str) -> bool:
    """Whether a query holds an error message."""
    return bool(_EXCEPTION.search(query) or _REPORT.search(query) or _WORDING.search(query))


def members_named(query: str) -> Iterator[tuple[str, str]]:
    """(class, member) of each that a message names whole: ``Scene.frame_end expected an int type``."""
    for match in first_matches(WRONG_TYPE, query):
        if match["path"]:
            owner, _, name = match["path"].rpartition(".")
            yield owner, name
    for match in first_matches(READ_ONLY, query):
        if match["owner"]:
            yield match["owner"], match["name"]
    for pattern in (IN_FUNCTION, BAD_KEYWORD):
        for match in first_matches(pattern, query):
            if match["method"] and "." in match["method"]:
                owner, _, name = match["method"].rpartition(".")
                yield owner, name


def items_listed(query: str) -> frozenset[str]:
    """The items that a message lists as those of the enumeration that was set; none where it says of no property."""
    if "item.attr = val" not in query:
        return frozenset()
    return frozenset(
        item for match in first_matches(BAD_ENUM, query) for item in re.findall(r"'([^']+)'", match["items"])
    )


def says_what_failed(query: str) -> bool:
    """Whether a message tells what was lacking, or is of something else than a name that is missing."""
    lacking = (HAS_NO, TYPE_HAS_NO, MODULE_HAS_NO, READ_ONLY)
    return bool(_FAILED_OTHERWISE.search(query)) or any(pattern.search(query) for pattern in lacking)


def classes_of_things(query: str) -> frozenset[str]:
    """The classes that messages say things are of: ``'Matrix' object is not callable``."""
    return frozenset(_OF_CLASS.findall(query))


@lru_cache(maxsize=8)  # the same
def without_wording(query: str) -> str:
    """A query without the wording of messages that looks like code or names."""
    text = _TRACEBACK.sub(" ", query)
    return _WORDING.sub(" ", text) if is_message(query) else text


def without_callers_names(query: str) -> str:
    """A query without the quoted names of the caller's data in a report (``Object 'Cube' already in …``)."""
    return _QUOTED.sub(" ", query) if _REPORT.search(query) else query


def without_values(query: str) -> str:
    """A query without the values that a message says are no items of an enumeration: they are no names."""
    return ENUM_VALUE.sub("enum", query)


def prose_of(query: str) -> str:
    """A message without the exception's name, the wording that looks like code, and the caller's names."""
    if not is_message(query):
        return query
    names = " ".join(match["name"] for match in HAS_NO.finditer(query))
    words = _EXCEPTION.sub(" ", without_callers_names(without_wording(query)))
    return f"{words} {names}".strip(" :") or query
