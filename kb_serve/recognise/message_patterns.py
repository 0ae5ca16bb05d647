"""What error messages look like: which text is Blender's own, which is the caller's, and which names something."""

from __future__ import annotations

import re

_EXCEPTION = re.compile(r"\b[A-Z]\w*(?:Error|Exception|Warning)\b:?|\b(?:Error|Warning):")
_REPORT = re.compile(r"Error:\s*Error:|^\s*(?:Error|Warning):\s")  # what an operator or C code reports itself
_TRACEBACK = re.compile(r"Traceback \(most recent call last\):|File \"[^\"]*\", line \d+(?:, in \S+)?|\^{2,}")
_QUOTED = re.compile(r"(?<!\w)(['\"])[^'\"\n]{0,60}\1")

HAS_NO = re.compile(r"['\"](?P<owner>[\w.]+)['\"] object has no attribute ['\"](?P<name>\w+)['\"]")
MODULE_HAS_NO = re.compile(r"module ['\"](?P<owner>[\w.]+)['\"] has no attribute ['\"](?P<name>\w+)['\"]")
NO_KEY = re.compile(r"\b(?P<on>bpy_\w+)\[key\]: key \"(?P<name>[^\"]+)\" not found")
NO_INDEX = re.compile(r"\w+\[index\]: index (?P<index>-?\d+) out of range, size (?P<size>\d+)")
BAD_ENUM = re.compile(r"enum \"(?P<name>[^\"]*)\" not found in \((?P<items>[^)]*)\)?")
BAD_KEYWORD = re.compile(r"keyword \"(?P<name>\w+)\" (?:is invalid|unrecognized)")
POLL = re.compile(r"Operator (?P<path>bpy\.ops\.\w+\.\w+)\.poll\(\)")
WRONG_TYPE = re.compile(
    r"\b(?:(?P<operator>[A-Z][A-Z_0-9]*_OT_\w+)\.\w+|(?P<path>\w+(?:\.\w+)+)) expected [^,]{1,80}, not \w+"
)
READ_ONLY = re.compile(
    r"attribute \"(?P<name>\w+)\" from \"(?P<owner>\w+)\" is read-only"
    r"|Context property \"(?P<context>\w+)\" is read-only"
)
FREED = re.compile(r"\b(?:StructRNA|(?P<module>BMesh) data) of type (?P<type>\w+) has been removed")
POSITIONAL = re.compile(r"\bargs execution context is supported")
NOT_AN_OPERATOR = re.compile(r"BMeshOpsModule: operator \"(?P<name>\w+)\" doesn't exist")
NO_NODE_TYPE = re.compile(r"Node type (?P<type>\w+) undefined")

# What reads like code, or like the names of classes and their members, and is the message's own wording.
_WORDING = re.compile(
    r"""bpy_struct:\ item\.attr\s*=\s*val:|bpy_\w+\[(?:key|index|slice)\](?:\ =\ value)?:|BMElemSeq\[index\]:
    |(?:object\ )?has\ no\ attribute\ '\w+'|and\ no\ __dict__\ for\ setting\ new\ attributes
    |Converting\ py\ args\ to\ operator\ properties::?|keyword\ "\w+"\ (?:is\ invalid|unrecognized)
    |not\ found\ in\ \([^)]*\)?|expected\ an?\ \w+\ type,\ not\ \w+|error\ with\ argument\ \d+,\ "\w+"\ -
    |\bFunction\.(?=\w+\ expected)|[A-Z][A-Z_0-9]*_OT_\w+\.(?=\w+\ expected)
    |bpy_struct:\ (?=attribute|Context)|attribute\ "\w+"\ from\ "\w+"\ is\ read-only|Context\ property\ (?="\w+"\ is)
    |(?:StructRNA|BMesh\ data)\ of\ type\ \w+\ has\ been\ removed|BMeshOpsModule:\ operator
    |\bNode\ type\ (?=\w+\ undefined)|\bnode\ of\ type\ (?=\w+)|'NoneType'\ object
    |required\ parameter\ "\w+"\ not\ specified|Calling\ operator\ (?=")""",
    re.VERBOSE,
)


def is_message(query: str) -> bool:
    """Whether a query holds an error message."""
    return bool(_EXCEPTION.search(query) or _REPORT.search(query) or _WORDING.search(query))


def without_wording(query: str) -> str:
    """A query without the parts of messages that only look like code or like names."""
    return _WORDING.sub(" ", _TRACEBACK.sub(" ", query))


def without_callers_names(query: str) -> str:
    """A query without what a report quotes: names of the caller's own data (``Object 'Cube' already in …``)."""
    return _QUOTED.sub(" ", query) if _REPORT.search(query) else query


def prose_of(query: str) -> str:
    """What a message says in words: without the exception's name, its wording, and the caller's names."""
    if not is_message(query):
        return query
    names = " ".join(match["name"] for match in HAS_NO.finditer(query))
    said = _EXCEPTION.sub(" ", without_callers_names(without_wording(query)))
    return f"{said} {names}".strip(" :") or query
