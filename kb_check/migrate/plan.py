"""Migrates the files of an add-on: what is certain is changed, round by round, and the rest is listed."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from kb_check.findings import Span
from kb_check.migrate.change import Change, Decision, Done
from kb_check.migrate.guards import can_be_guarded, guarded_edits, innermost, plain_edits
from kb_check.migrate.place import Place, version_of
from kb_check.migrate.rewrite import all_rewrites
from kb_check.migrate.rewrites.matrix_products import BEFORE_PRODUCTS
from kb_check.migrate.version_tests import reaches
from kb_check.package import paths_in_package
from kb_check.salvage import parses
from kb_check.text_edits import Text, apart

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from kb_check.checker import Checker, Read
    from kb_check.findings import Edit, Finding
    from kb_check.migrate.change import Version
    from kb_check.migrate.kept_version import KeptVersion
    from kb_check.package import Package

_ROUNDS = 40
_TOLD = 160
_MOST_TRIALS = 60  # to find the changes that leave a text which cannot be read


@dataclass
class FileMigration:
    """What happened to one file. ``new`` is ``old`` where nothing could be changed; ``kept`` are errors that the new
    text has in a Blender that is to be kept, and the old one did not.
    """

    name: str
    old: str
    new: str = ""
    changes: list[Done] = field(default_factory=list[Done])
    decisions: list[Decision] = field(default_factory=list[Decision])
    kept: list[tuple[str, Finding]] = field(default_factory=list[tuple[str, "Finding"]])


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
        for _ in range(_ROUNDS):
            package = self._read(states.values(), beside or {})
            for state in states.values():
                state.findings = self._target.check(state.reading, package)
            if written_for is None:
                written_for = self._oldest(states.values())
            changed = [self._round(state, package, written_for) for state in states.values()]
            if not any(changed):
                break
        for state in states.values():
            self._finish(state)
        self._check_kept(states.values())
        return [state.file for state in states.values()]

    def _read(self, states: Iterable[_State], beside: Mapping[str, str]) -> Package:
        """Reads all files anew: what one says about types holds in the others, too."""
        states = list(states)
        texts = {**beside, **{state.file.name: state.text.code for state in states}}
        paths = paths_in_package(texts)
        if len(texts) == 1:
            reads = {path: self._target.read(texts[name]) for name, path in paths.items()}
        else:
            reads = self._target.read_files({path: texts[name] for name, path in paths.items()})
        package = self._target.package(reads.values())
        for state in states:
            state.read = reads[paths[state.file.name]]
        return package

    def _oldest(self, states: Iterable[_State]) -> Version:
        """The oldest Blender that had something which the files use and the target lacks."""
        reader = self._target.names.reader
        findings = [one for state in states for one in state.findings]
        spans = (reader.removed(one.symbol) for one in findings if one.symbol)
        oldest = min((version_of(span[1]) for span in spans if span), default=_version(self._target))
        has_products = any(one.rule == "refused-product" for one in findings)
        return min(oldest, BEFORE_PRODUCTS) if has_products else oldest

    # One round.

    def _round(self, state: _State, package: Package, written_for: Version) -> bool:
        """Makes all the changes that are known now; whether there were any."""
        if state.reading.error is not None or not state.reading.analysis.complete:
            return False
        place = Place(self._target.script(state.reading, package), state.findings, written_for)
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

        chosen = _largest(changes, lambda some: parses(made(some).code))
        new = made(chosen)
        if new.code == state.text.code:
            return False
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
            self._target.names.reader.successors(finding.symbol) if finding.rule == "never-true" else []
        )
        return len(successors) == 1 and bool(successors[0].target) and not successors[0].how

    def _is_wanted(self, change: Change) -> bool:
        """Whether a change is made: what the target still takes stays where an older Blender lacks the new form."""
        reader = self._target.names.reader
        return change.is_needed or all(kept.takes(change, reader) for kept in self._keep)

    def _needs_guard(self, place: Place, change: Change) -> bool:
        reader = self._target.names.reader
        nodes = [innermost(place, edit.span) for edit in change.edits]
        return any(
            not kept.takes(change, reader)
            and any(node is None or reaches(node, place.parents, kept.version) for node in nodes)
            for kept in self._keep
        )

    # What is left.

    def _finish(self, state: _State) -> None:
        file = state.file
        file.new = state.result()
        file.changes.sort(key=lambda change: change.line)
        reader = self._target.names.reader
        for finding in state.findings:
            if finding.severity == "note":
                continue
            successors = reader.successors(finding.symbol) if finding.symbol else []
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

    def _check_kept(self, states: Iterable[_State]) -> None:
        """Looks at the new text as the older Blenders see it: what is wrong there now and was not before."""
        states = [state for state in states if state.file.changes]
        for kept in self._keep:
            if kept.checker is None:
                continue
            for state, before, after in zip(
                states, _errors(kept.checker, [state.file.old for state in states]),
                _errors(kept.checker, [state.file.new for state in states]), strict=True,
            ):  # fmt: skip
                known = {(one.rule, one.symbol) for one in before}
                name = ".".join(map(str, kept.version))
                state.file.kept += [(name, one) for one in after if (one.rule, one.symbol) not in known]


@dataclass
class _State:
    """A file while it is migrated."""

    file: FileMigration
    text: Text = field(init=False)
    read: Read | None = None
    findings: list[Finding] = field(default_factory=list["Finding"])

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


def _errors(checker: Checker, codes: Sequence[str]) -> list[list[Finding]]:
    reads = [checker.read(code) for code in codes]
    package = checker.package(reads)
    return [[one for one in checker.check(read, package) if one.severity == "error"] for read in reads]


def _largest(changes: Sequence[Change], holds: Callable[[Sequence[Change]], bool]) -> list[Change]:
    """Changes for which a condition holds together: all of them, or without those that break it."""
    trials = _MOST_TRIALS

    def among(some: Sequence[Change]) -> list[Change]:
        nonlocal trials
        trials -= 1
        if trials < 0 or not some:
            return []
        if holds(some):
            return list(some)
        if len(some) == 1:
            return []
        halves = [*among(some[: len(some) // 2]), *among(some[len(some) // 2 :])]
        return halves if holds(halves) else []

    return among(changes)


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
