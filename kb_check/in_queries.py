"""What is wrong in code that ``blender_docs`` is asked about, beyond its names, of which the answer itself tells."""

from __future__ import annotations

import ast
import builtins
import logging
import re
import sqlite3
import textwrap
from typing import TYPE_CHECKING

from kb_build.flow.syntax.parse import parsed
from kb_build.symbols.api_names import TYPES
from kb_build.symbols.paths import last_name
from kb_check.beside import checker_beside
from kb_check.summary import mended
from kb_check.text.source import split_lines
from kb_check.whole_fixes import with_whole_fixes
from kb_serve.lookups.base_file import UNLIMITED
from kb_serve.recognise.chains.chains import MOST_CODE, find_chains
from kb_serve.recognise.chains.variables import is_guess, usual_classes
from kb_serve.recognise.code.wrong_values import NO_VALUE
from kb_serve.recognise.likely.corrections import is_misspelling
from kb_serve.recognise.message_patterns import members_named
from kb_serve.recognise.removed.lost_names import is_telling

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from kb_check.checker import Checker
    from kb_check.findings import Finding
    from kb_serve.reader import BaseReader

_MOST = 4
_LONGEST = 100  # characters of a line that is shown
_SPAN = re.compile(r"`([^`\n]+)`")
_FAILED = re.compile(r"^\s*File .+, line \d+.*\n\s+(.+)$", re.MULTILINE)
_FENCED = re.compile(r"^```\w*\n(.*?)^```", re.DOTALL | re.MULTILINE)
# The modules of which scripts import classes and functions by name, that hardly anything else is called by.
_IMPORTED = ("mathutils", "mathutils.bvhtree", "mathutils.kdtree", "bpy.props")
_OF_DATA = (TYPES, "mathutils.")
_INSTANCES = frozenset({"self", "cls"})  # of the script's own classes
# What is wrong in a piece of a script too, whatever stands around it. Names, keywords, sockets and the values of
# properties are left out: of these an answer tells by itself, as it does of what other Blenders have.
_RULES = (
    "callback-signature", "crash", "given-callback", "left-out", "list-attribute", "lost-property", "missing-argument",
    "no-custom-properties", "not-a-number", "not-iterable", "not-subscriptable", "operator-idname",
    "positional-argument", "read-only", "refused-call", "refused-path", "refused-product", "refused-property",
    "refused-value", "unknown-node", "unknown-value", "wrong-count", "wrong-mode", "wrong-size", "wrong-type",
)  # fmt: skip
# Warnings, as Blender refuses nothing of it.
_NOT_REFUSED = ("invalid-link", "moved-socket", "never-true")
_NO_VALUE = "unknown-value"
_IS_NONE = re.compile(NO_VALUE)  # what is said of a value that no Blender has
_ARGUMENT = "("  # in the path of an argument: of the values of properties an answer tells by itself
# Of these an answer tells but where they are texts: ``layout.prop(ob, "locaton")``. What is wrong behind a name that is
# gone, its successor may take otherwise.
_NAMES = ("unknown-attribute", "unknown-operator")
_KEYWORD = "unknown-keyword"
_PRODUCT = "refused-product"  # an answer tells of those that another sign mends
_GONE_NAMES = ("unknown-context-member", _KEYWORD, "unknown-name", "unknown-socket")
_ANIMATED = re.compile(r"\.(?:keyframe|driver)_\w+\(")  # of their paths an answer tells, too
_OF_CLASS = re.compile(r"\s*bl_\w+\s*=")
_QUOTES = ("'", '"')
_SIGNS = "=([*"  # one of which such code has
_LOG = logging.getLogger(__name__)
# What code does that is more than a name.
_DOES = (
    ast.Assign, ast.AugAssign, ast.AnnAssign, ast.Call, ast.BinOp, ast.Compare, ast.Subscript, ast.FunctionDef,
    ast.ClassDef,
)  # fmt: skip


def notes_on_code(reader: BaseReader, query: str) -> tuple[str, ...]:
    """What Blender refuses of the code in a query, a line each; nothing where there is none.

    What a variable holds that the code does not bind is taken from its name, where scripts use that for some classes;
    what is told then holds for all of them. Raises BaseUnreadable.
    """
    asked = _code_in(query)
    if asked is None:
        return ()
    code, tree = asked
    checker = checker_beside(reader)
    code = f"{_bindings(tree, checker, dict(_owners_named(query, reader)))}\n{code}"
    lines = split_lines(code)
    is_long = sum(chain.is_code for chain in find_chains(query)) >= MOST_CODE
    try:
        with reader.bounded(UNLIMITED):  # each line of the code may take as much as a query
            rules = (*_RULES, *_NOT_REFUSED, *_NAMES, *(_GONE_NAMES if is_long else ()))
            read = checker.read(code)
            found = with_whole_fixes(checker, read, checker.check(read, rules=rules))
            findings = [*_news(found, lines, reader, is_long=is_long)]
    except sqlite3.DatabaseError as error:
        raise checker.names.reader.damaged(error) from error
    except Exception as error:  # what goes wrong with a rule takes no answer with it
        _LOG.warning("the code in %.300r could not be checked: %s: %s", query, type(error).__name__, error)
        return ()
    notes = list(dict.fromkeys(_note(finding, lines) for finding in findings))
    if left := len(notes[_MOST:]):
        notes[_MOST:] = [f"{left} more: `blender_check` lists them."]
    return tuple(notes)


def _code_in(query: str) -> tuple[str, ast.Module] | None:
    """The code in a query: the line of a traceback that failed, what is in a fence or between backticks, else all of
    it, or what a line of words introduces.
    """
    if failed := _FAILED.findall(query):
        texts = [failed[-1]]
    elif fenced := _FENCED.findall(f"{query}\n"):
        texts = ["".join(fenced)]
    elif spans := _SPAN.findall(query):
        texts = ["\n".join(spans)]
    else:
        texts = [query, query.partition("\n")[2], query.rpartition("\n")[0]]
    for text in texts:
        code = _with_body(textwrap.dedent(text).strip())
        tree = parsed(code) if any(sign in code for sign in _SIGNS) else None
        if isinstance(tree, ast.Module) and any(isinstance(node, _DOES) for node in ast.walk(tree)):
            return code, tree
    return None


def _with_body(code: str) -> str:
    """Code that ends with the head of a block, as ``if obj.type == "LAMP":``, with a block."""
    return f"{code} ..." if code.endswith(":") else code


def _owners_named(query: str, reader: BaseReader) -> Iterator[tuple[str, str]]:
    """(member, the class that has it) of each that a message in a query names."""
    for cls, name in members_named(query):
        entry = reader.entry(TYPES + cls)
        if entry is not None and entry.kind == "class" and entry.group == "data":
            yield name, entry.path


def _bindings(tree: ast.Module, checker: Checker, owners: Mapping[str, str]) -> str:
    """A line that imports what a piece of code uses of modules, and says what its variables hold. ``owners`` has the
    classes of what has members of some names, as a message tells them.
    """
    bound: set[str] = set()
    read: dict[str, None] = {}
    attributes: dict[str, set[str]] = {}
    for node in ast.walk(tree):
        match node:
            case ast.Name(id=name, ctx=ast.Load()):
                read[name] = None
            case ast.Attribute(value=ast.Name(id=name), attr=attribute):
                attributes.setdefault(name, set()).add(attribute)
            case ast.Name(id=name) | ast.arg(arg=name) | ast.alias(asname=str(name)):
                bound.add(name)
            case ast.alias(name=name):
                bound.add(name.partition(".")[0])
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name):
                bound.add(name)
            case _:
                pass
    free = [name for name in read if name not in bound and not hasattr(builtins, name)]
    return "; ".join(
        (
            "import bpy",
            *filter(None, (_binding(name, attributes.get(name, ()), checker, owners) for name in free)),
        )
    )


def _binding(name: str, attributes: Collection[str], checker: Checker, owners: Mapping[str, str]) -> str:
    """A line that says what a name stands for of which some attributes are used; empty where that is not known."""
    known = checker.names.reader.entry
    if told := {owners[attribute] for attribute in attributes if attribute in owners}:
        return f"{name}: {' | '.join(sorted(told))}"
    if (entry := known(name)) is not None and entry.kind == "module":
        return f"import {name}"
    for module in _IMPORTED:
        if known(f"{module}.{name}") is not None:
            return f"from {module} import {name}"
    # What only stands as a value is not told by its name: ``mat`` may be a matrix.
    is_told = bool(attributes) and not is_guess(name)
    classes = [path for path in usual_classes(name) if known(path)] if is_told else []
    classes = classes or _having(name, attributes, checker.names.reader)
    modules = {path.rpartition(".")[0] for path in classes}
    return "; ".join(
        (*(f"import {module}" for module in modules), f"{name}: {' | '.join(classes)}") if classes else ()
    )


def _having(name: str, attributes: Collection[str], reader: BaseReader) -> list[str]:
    """The class of a variable that one of its attributes tells, as it alone has one of that name."""
    is_own = name in _INSTANCES or name[:1].isupper()  # a class of the script's, or one that it imports
    for attribute in () if is_own else filter(is_telling, attributes):
        owners = {entry.owner for entry in reader.names.by_name(attribute)}
        if any(path.endswith(f".{attribute}") for path in reader.history.removed_named(attribute)):
            continue  # another class had it, and may be meant
        cls = reader.entry(owners.pop()) if len(owners) == 1 else None
        if cls is not None and cls.kind == "class" and cls.group == "data" and cls.path.startswith(_OF_DATA):
            return [cls.path]
    return []


def _news(
    findings: Sequence[Finding], lines: Sequence[str], reader: BaseReader, *, is_long: bool
) -> Iterator[Finding]:
    """Errors in the code itself, but for names that are gone, and what is wrong behind one of those in its line.

    Of names that are gone an answer tells by itself, unless the code ``is_long``: it reads the first expressions alone.
    Of names that are texts, and of the values of a class's own attributes, it does not tell. A text that is no
    misspelling may be the name of what an add-on registers.
    """
    gone = {finding.span.line: finding.span.column for finding in findings if finding.absent}
    for finding in findings:
        span = finding.span
        is_behind = span.line in gone and gone[span.line] < span.column
        line = lines[span.line - 1]
        is_text = line[span.column : span.column + 1] in _QUOTES and not _ANIMATED.search(line)
        is_text = is_text and finding.rule in _NAMES and _is_misspelt(finding)
        is_value = finding.rule == _NO_VALUE and (_ARGUMENT in finding.symbol or bool(_OF_CLASS.match(line)))
        is_value = is_value and _IS_NONE.search(finding.message) is not None
        is_name = finding.rule in _NAMES or bool(finding.absent)
        is_left = is_long and (finding.rule == _KEYWORD or reader.history.removed(finding.symbol) is not None)
        is_product = finding.rule == _PRODUCT and finding.fix is not None
        is_told = (is_name and not (is_value or is_text or is_left)) or is_behind or is_product
        is_wrong = finding.severity == "error" or is_value or finding.rule in _NOT_REFUSED
        if is_wrong and span.line > 1 and not is_told:
            yield finding


def _is_misspelt(finding: Finding) -> bool:
    """Whether a name that Blender lacks is one of its names, misspelt."""
    lacked, *closest = map(last_name, _SPAN.findall(finding.message)[1:])
    return any(is_misspelling(lacked, name) for name in closest)


def _note(finding: Finding, lines: list[str]) -> str:
    """What is wrong, behind the line that it is wrong in."""
    line = lines[finding.span.line - 1].strip()
    shown = f"`{line}`: " if len(line) <= _LONGEST and "`" not in line else ""
    fix = mended(lines, finding.fix) if finding.fix is not None and finding.fix.sure else ""
    instead = f" Write `{fix.strip()}`." if fix and "\n" not in fix.strip() and "`" not in fix else ""
    return f"{shown}{finding.message}{instead}"
