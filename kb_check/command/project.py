"""Checks groups of files: what was checked before comes from the cache, the rest is shared among processes."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass, field
from multiprocessing.connection import wait
from typing import TYPE_CHECKING, cast

from kb_check.command.cache import result_key
from kb_check.findings import Finding, Span
from kb_check.registered.package import paths_in_package
from kb_check.text.reading import read_source
from simworlds.forked import can_fork, forked

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
    from multiprocessing.connection import Connection
    from pathlib import Path

    from kb_check.checker import Checker
    from kb_check.command.cache import ResultCache
    from kb_check.text.source import Source
    from simworlds.forked import Work

_BYTES_PER_PROCESS = 150_000  # less is checked sooner than a process has started

Done = tuple[int, list[list[Finding]], str]


@dataclass(frozen=True, slots=True)
class LoadedFile:
    """A file's name and content. Of one that is not ``wanted`` only what it registers counts."""

    name: str
    data: bytes
    wanted: bool = True


@dataclass(frozen=True, slots=True)
class GroupResult:
    """The findings of each file of a group, in their order; ``failure`` says why there are none."""

    findings: list[list[Finding]] = field(default_factory=list)
    failure: str = ""


Group = tuple[LoadedFile, ...]


class Project:
    """Checks groups of files against one base, and remembers the results."""

    def __init__(self, base: Path, fingerprint: str, cache: ResultCache | None, jobs: int = 1) -> None:
        self._base = base
        self._fingerprint = fingerprint
        self._cache = cache
        self._jobs = jobs
        self._known: dict[bytes, GroupResult] = {}

    def check(
        self, groups: Sequence[Group], progress: Callable[[int, int], None] = lambda _done, _total: None
    ) -> list[GroupResult]:
        """The results of the groups, in their order. ``progress`` is told how many bytes of how many are done."""
        keys = [self._key(group) for group in groups]
        missing = [number for number, key in enumerate(keys) if not self._recall(key)]
        sizes = {number: sum(len(file.data) for file in groups[number]) for number in missing}
        total, done = sum(sizes.values()), 0
        for number, findings, failure in self._run(groups, missing, sizes):
            self._known[keys[number]] = GroupResult(findings, failure)
            if self._cache is not None and not failure:
                self._cache.put(keys[number], findings)
            done += sizes[number]
            progress(done, total)
        return [self._known[key] for key in keys]

    def _key(self, group: Group) -> bytes:
        return result_key(self._fingerprint, ((file.name, file.data, file.wanted) for file in group))

    def _recall(self, key: bytes) -> bool:
        if key not in self._known and self._cache is not None:
            findings = self._cache.get(key)
            if findings is not None:
                self._known[key] = GroupResult(findings)
        return key in self._known

    def _run(self, groups: Sequence[Group], numbers: list[int], sizes: dict[int, int]) -> Iterator[Done]:
        jobs = min(self._jobs, 1 + sum(sizes.values()) // _BYTES_PER_PROCESS, len(numbers))
        if jobs < 2 or not can_fork():
            yield from _check_all(self._base, groups, numbers)
            return
        left = numbers
        while left:
            shares = _shares(left, sizes, jobs)
            left = yield from self._run_beside(groups, shares)

    def _run_beside(
        self, groups: Sequence[Group], shares: list[list[int]]
    ) -> Generator[Done, None, list[int]]:
        """Has each share checked by a process of its own. Returns what is left where one of them was ended."""
        left: list[int] = []
        with ExitStack() as stack:
            running = {
                stack.enter_context(forked(_sending(self._base, groups, share))): list(share)
                for share in shares
            }
            while running:
                for connection in cast("list[Connection]", wait(list(running))):
                    share = running[connection]
                    try:
                        done: Done = connection.recv()
                    except EOFError:
                        del running[connection]
                        if share:
                            yield share[0], [], "the process that checked it was ended"
                            left += share[1:]
                        continue
                    share.remove(done[0])
                    yield done
        return left


def _shares(numbers: list[int], sizes: dict[int, int], jobs: int) -> list[list[int]]:
    """Shares of about the same size, the largest groups first."""
    shares: list[list[int]] = [[] for _ in range(jobs)]
    loads = [0] * jobs
    for number in sorted(numbers, key=lambda number: -sizes[number]):
        least = loads.index(min(loads))
        shares[least].append(number)
        loads[least] += sizes[number] + 1
    return [share for share in shares if share]


def _sending(base: Path, groups: Sequence[Group], numbers: list[int]) -> Work:
    def work(messages: Connection) -> None:
        for done in _check_all(base, groups, numbers):
            messages.send(done)

    return work


def _check_all(base: Path, groups: Sequence[Group], numbers: Iterable[int]) -> Iterator[Done]:
    from kb_check.checker import Checker  # noqa: PLC0415 - where everything was checked before, it is not needed

    with Checker(base) as checker:
        for number in numbers:
            try:
                yield number, check_group(checker, groups[number]), ""
            except Exception as error:  # noqa: BLE001, RUF100 - whatever a file does to a rule, the others are checked
                yield number, [], f"{type(error).__name__}: {error}"


def check_group(checker: Checker, group: Group) -> list[list[Finding]]:
    """The findings of each file; none for those that are not wanted."""
    sources = [read_source(file.data, file.name) for file in group]
    paths = paths_in_package(file.name for file in group)
    found = checker.read_files(
        {paths[file.name]: source.text for file, source in zip(group, sources, strict=True)}
    )
    reads = [found[paths[file.name]] for file in group]
    package = checker.package(reads)
    return [
        _with_fault(source, checker.check(read, package)) if file.wanted else []
        for file, source, read in zip(group, sources, reads, strict=True)
    ]


def _with_fault(source: Source, findings: list[Finding]) -> list[Finding]:
    """The findings, with the source's fault in the place of what its text is no Python for."""
    if not source.fault:
        return findings
    span = Span(source.fault_line, 0, source.fault_line, 0)
    fault = Finding("syntax-error", "error", span, f"Python cannot read this: {source.fault}.")
    return [fault, *(finding for finding in findings if finding.rule != fault.rule)]
