"""Migrates the files of an add-on: what is certain is changed, round by round, and the rest is listed."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_build.symbols.paths import as_code, is_socket, last_name
from kb_check.findings import Finding, Span
from kb_check.migrate.change import Change, Decision, Done
from kb_check.migrate.guards import can_be_guarded, guarded_edits, innermost, plain_edits
from kb_check.migrate.place import Place, version_of
from kb_check.migrate.rewrite import all_rewrites
from kb_check.migrate.rewrites.matrix_products import BEFORE_PRODUCTS
from kb_check.migrate.version_tests import reaches
from kb_check.registered.package import paths_in_package
from kb_check.text.edits import Text, apart, largest
from kb_check.text.salvage import is_valid

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kb_check.checker import Checker, Read
    from kb_check.findings import Edit
    from kb_check.migrate.change import Version
    from kb_check.migrate.kept_version import KeptVersion
    from kb_check.registered.package import Package

_ROUNDS = 40
_TOLD = 160
_NEWER = "newer-name"  # what reports call a name that a Blender to be kept does not have yet


@dataclass
class FileMigration:
    """What happened to one file. ``new`` is ``old`` where nothing could be changed; ``kept`` are the errors that the
    new text has in Blenders that are to be kept, without those that are among the decisions.
    """

    name: str
    old: str
    new: str = ""
    changes: list[Done] = field(default_factory=list[Done])
    decisions: list[Decision] = field(default_factory=list[Decision])
    kept: list[tuple[str, Finding]] = field(default_factory=list[tuple[str, Finding]])


class Migrator:
    """Migrates to the Blender of ``target``; ``keep`` are older ones in which the scripts must still run.

    ``written_for`` is the Blender that they were written for; without it, it is told from what they use.
    """

    def __init__(
        self, target: Checker, keep: Sequence[KeptVersion] = (), written_for: Version | None = None
    ) -> None:
        self._target = target
        self._keep = keep
        self._written_for = written_for

    def migrate(
        self, files: Mapping[str, str], beside: Mapping[str, str] | None = None
    ) -> list[FileMigration]:
        """Migrates the files of one add-on: path → text. ``beside`` are its other files, which stay as they are."""
        states = {name: _State(FileMigration(name, code)) for name, code in files.items()}
        written_for = self._written_for
        package = self._target.package()
        for _ in range(_ROUNDS):
            package = self._read(states.values(), beside or {}, self._target)
            for state in states.values():
                state.findings = self._target.check(state.reading, package)
            if written_for is None:
                written_for = self._oldest(states.values())
            changed = [self._round(state, package, written_for) for state in states.values()]
            if not any(changed):
                break
        for state in states.values():
            self._finish(state)
            self._check_history(state, package)
        self._check_kept(states.values(), beside or {})
        return [state.file for state in states.values()]

    @staticmethod
    def _read(states: Iterable[_State], beside: Mapping[str, str], checker: Checker) -> Package:
        """Reads all files anew, for a Blender: what one says about types holds in the others, too."""
        states = list(states)
        texts = {**beside, **{state.file.name: state.text.code for state in states}}
        paths = paths_in_package(texts)
        if len(texts) == 1:
            reads = {path: checker.read(texts[name]) for name, path in paths.items()}
        else:
            reads = checker.read_files({path: texts[name] for name, path in paths.items()})
        for state in states:
            state.read = reads[paths[state.file.name]]
        return checker.package(reads.values())

    def _oldest(self, states: Iterable[_State]) -> Version:
        """The oldest Blender that had something which the files use and the target lacks."""
        reader = self._target.names.reader
        findings = [one for state in states for one in state.findings]
        spans = (reader.history.removed(one.symbol) for one in findings if one.symbol)
        oldest = min((version_of(span[1]) for span in spans if span), default=_version(self._target))
        has_products = any(one.rule == "refused-product" for one in findings)
        return min(oldest, BEFORE_PRODUCTS) if has_products else oldest

    # One round.

    def _round(self, state: _State, package: Package, written_for: Version) -> bool:
        """Makes all the changes that are known now; whether there were any."""
        if state.reading.error is not None or not state.reading.analysis.complete:
            return False
        place = Place(
            self._target.script(state.reading, package), state.findings, written_for, self._written_for
        )
        proposals = apart(state.text, self._proposals(place), lambda change: change.edits)
        chosen = [change for change in proposals if change.since <= place.target and self._is_wanted(change)]
        guarded: list[Change] = []
        plain: list[Change] = []
        for change in chosen:
            (guarded if self._needs_guard(place, change) else plain).append(change)
        # What needs no guard goes first, within the statements that get one too: a round for each.
        return self._make(state, place, plain, with_guard=False) or self._make(
            state, place, [change for change in guarded if can_be_guarded(place, change)], with_guard=True
        )

    def _make(self, state: _State, place: Place, changes: Sequence[Change], *, with_guard: bool) -> bool:
        """Makes as many of some changes as leave a text that Python can read; whether there were any."""

        def made(chosen: Sequence[Change]) -> Text:
            if with_guard:
                edits = guarded_edits(place, state.text, chosen)
            else:
                edits = [edit for change in chosen for edit in plain_edits(place, change)]
            return state.text.edited(
                [*edits, *{edit: None for change in chosen for edit in change.additions}]
            )

        chosen = largest(changes, lambda some: is_valid(made(some).code))
        new = made(chosen)
        if new.code == state.text.code:
            return False
        for change in chosen:
            self._note_kept(state, place, change, with_guard=with_guard)
        told = (_told(state.text, change, guarded=with_guard) for change in chosen)
        state.file.changes += sorted(told, key=lambda done: done.line)
        state.text = new
        return True

    def _proposals(self, place: Place) -> Iterator[Change]:
        for rewrite in all_rewrites():
            for change in rewrite.propose(place):
                if not any(place.script.is_doubted(edit.span) for edit in change.edits):
                    yield change
        for finding in place.findings:
            if finding.fix is None or finding.severity == "note":
                continue
            if finding.fix.sure or self._held_before(finding):
                yield place.change(
                    finding.rule, finding.symbol, finding.fix.edits, reason=finding.message,
                    targets=finding.instead[:1], is_deprecated=finding.rule == "deprecated",
                )  # fmt: skip

    def _held_before(self, finding: Finding) -> bool:
        """Whether a comparison that never holds now could hold where the script ran: only its value's name changed."""
        successors = (
            self._target.names.reader.history.successors(finding.symbol)
            if finding.rule == "never-true"
            else []
        )
        return len(successors) == 1 and bool(successors[0].target) and not successors[0].how

    def _is_wanted(self, change: Change) -> bool:
        """Whether a change is made: what the target still takes stays where an older Blender lacks the new form."""
        reader = self._target.names.reader
        return change.is_needed or all(kept.takes(change, reader) for kept in self._keep)

    def _needs_guard(self, place: Place, change: Change) -> bool:
        """Whether an older Blender needs the old form, and has it."""
        reader = self._target.names.reader
        return any(not kept.came_later(change.symbol, reader) for kept in self._lacking(place, change))

    def _lacking(self, place: Place, change: Change) -> Iterator[KeptVersion]:
        """The Blenders to be kept that come to where a change is made, and are not known to take its new form."""
        reader = self._target.names.reader
        return (kept for kept in self._coming(place, change) if not kept.takes(change, reader))

    def _coming(self, place: Place, change: Change) -> Iterator[KeptVersion]:
        """The Blenders to be kept that come to where a change is made."""
        nodes = [innermost(place, edit.span) for edit in change.edits]
        for kept in self._keep:
            if any(node is None or reaches(node, place.parents, kept.version) for node in nodes):
                yield kept

    def _note_kept(self, state: _State, place: Place, change: Change, *, with_guard: bool) -> None:
        """Notes the Blenders without a base that get an old form which came later, or a new one that they may lack."""
        line = state.text.origin(min(edit.span.line for edit in change.edits))
        coming = self._coming(place, change) if with_guard else self._lacking(place, change)
        for kept in coming:
            first = kept.came_later(change.symbol, self._target.names.reader)
            if first and kept.checker is None and kept.version < change.since:
                message = f"{_came(change.symbol, first)} Decide what {kept.name} gets here."
                state.unmet.append((kept.name, line, change.rule, message))

    # What is left.

    def _finish(self, state: _State) -> None:
        file = state.file
        file.new = state.result()
        file.changes.sort(key=lambda change: change.line)
        reader = self._target.names.reader
        for finding in state.findings:
            if finding.severity == "note":
                continue
            successors = reader.history.successors(finding.symbol) if finding.symbol else []
            how = "; ".join(dict.fromkeys(row.how for row in successors if row.how))
            if not how and finding.fix is not None:
                how = finding.fix.title
            source = successors[0].source if successors else ""
            file.decisions.append(
                Decision(
                    state.text.origin(finding.span.line), finding.span.line, finding.rule, finding.severity,
                    finding.message, how, source,
                )
            )  # fmt: skip
        file.decisions.sort(key=lambda decision: decision.line)

    def _check_history(self, state: _State, package: Package) -> None:
        """What of the new text is newer than the Blenders to be kept of which there is no base."""
        for name, line, rule, message in state.unmet:
            now = state.text.now(line)
            state.file.kept.append((name, Finding(rule, "error", Span(now, 0, now, 0), message)))
        without = [kept for kept in self._keep if kept.checker is None]
        if not without or state.reading.error is not None:
            return
        place = Place(self._target.script(state.reading, package), state.findings, _version(self._target))
        reader, asked = self._target.names.reader, _asked_members(place)
        known: set[tuple[str, int]] = set()
        for row in place.script.resolutions():
            if row.guarded or not row.sure or not row.symbols or asked & _members(row.node):
                continue
            if any(is_socket(symbol) or last_name(symbol) != row.value for symbol in row.symbols):
                continue  # found by a former name
            span = place.script.name_span(row.node)
            if place.script.is_doubted(span):
                continue
            for kept in without:
                firsts = [kept.came_later(symbol, reader) for symbol in row.symbols]
                key = kept.name, span.line
                if all(firsts) and key not in known and reaches(row.node, place.parents, kept.version):
                    known.add(key)
                    message = _came(row.symbols[0], firsts[0])
                    state.file.kept.append((kept.name, Finding(_NEWER, "error", span, message)))

    def _check_kept(self, states: Iterable[_State], beside: Mapping[str, str]) -> None:
        """Looks at the new text as the older Blenders see it: what is wrong there, and is not a decision already."""
        states = list(states)
        for kept in self._keep:
            if kept.checker is None:
                continue
            package = self._read(states, beside, kept.checker)
            for state in states:
                decided = {(one.now, one.rule) for one in state.file.decisions}
                state.file.kept += [
                    (kept.name, one)
                    for one in kept.checker.check(state.reading, package)
                    if one.severity == "error" and (one.span.line, one.rule) not in decided
                ]


@dataclass
class _State:
    """A file while it is migrated. ``unmet`` is what changes do not give to a Blender: (version, line of the original,
    rule, message).
    """

    file: FileMigration
    text: Text = field(init=False)
    read: Read | None = None
    findings: list[Finding] = field(default_factory=list[Finding])
    unmet: list[tuple[str, int, str, str]] = field(default_factory=list[tuple[str, int, str, str]])

    def __post_init__(self) -> None:
        self.text = Text.original(self.file.old.replace("\r\n", "\n") if self._windows else self.file.old)

    @property
    def _windows(self) -> bool:
        """Whether all lines end as they do on Windows. Otherwise the ends are kept as they are."""
        ends = self.file.old.count("\r\n")
        return 0 < ends == self.file.old.count("\n")

    def result(self) -> str:
        """The text as it is to be written."""
        return self.text.code.replace("\n", "\r\n") if self._windows else self.text.code

    @property
    def reading(self) -> Read:
        """The file as it was read last."""
        assert self.read is not None
        return self.read


def _version(checker: Checker) -> Version:
    return checker.version[0], checker.version[1]


def _asked_members(place: Place) -> frozenset[str]:
    """The members that a script asks for by ``hasattr`` or ``getattr``: it is ready for Blenders that lack them."""
    return frozenset(
        call.args[1].value
        for call in place.script.all(ast.Call)
        if isinstance(call.func, ast.Name) and call.func.id in {"hasattr", "getattr"} and len(call.args) > 1
        and isinstance(call.args[1], ast.Constant) and isinstance(call.args[1].value, str)
    )  # fmt: skip


def _members(node: ast.AST) -> frozenset[str]:
    """The members that an expression reads."""
    return frozenset(part.attr for part in walk(node) if isinstance(part, ast.Attribute))


def _came(path: str, first: str) -> str:
    return f"`{as_code(path)}` is there from Blender {first} on."


def _told(text: Text, change: Change, *, guarded: bool) -> Done:
    first = min(edit.span.line for edit in change.edits)
    last = max(edit.span.end_line for edit in change.edits)
    before = text.lines(first, last)
    whole = Text.original(before).edited(_moved(change.edits, first))
    return Done(
        text.origin(first), change.rule, _short(before), _short(whole.code), change.reason, change.source, guarded
    )  # fmt: skip


def _moved(edits: Sequence[Edit], first: int) -> list[Edit]:
    return [
        replace(
            edit,
            span=Span(edit.span.line - first + 1, edit.span.column, edit.span.end_line - first + 1,
                      edit.span.end_column),
        )
        for edit in edits
    ]  # fmt: skip


def _short(text: str) -> str:
    lines = [line.strip() for line in text.split("\n")]
    line = " ⏎ ".join(line for line in lines if line)
    return line if len(line) <= _TOLD else f"{line[:_TOLD]} …"
