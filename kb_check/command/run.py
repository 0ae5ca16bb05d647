"""One run of the check: files are read and checked, fixes applied, and what is left is reported."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from kb_build.flow.syntax.parse import too_long
from kb_check.command.project import LoadedFile
from kb_check.command.report import FileReport, Report
from kb_check.text.fixes import apply_fixes, print_diff, write_fixed
from kb_check.text.reading import read_source
from kb_check.text.source import MOST_BYTES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from kb_check.command.configuration import Configuration
    from kb_check.command.files import FileGroup
    from kb_check.command.project import Group, Project
    from kb_check.findings import Finding

MOST_ROUNDS = 5  # of fixes: one may make way for the next


@dataclass(slots=True)
class Run:
    """Groups of files as they were read and as fixes left them, and what could not be checked."""

    project: Project
    configuration: Configuration
    before: list[Group]
    faults: list[str] = field(default_factory=list)
    groups: list[Group] = field(init=False)
    fixed: int = 0

    def __post_init__(self) -> None:
        self.groups = list(self.before)

    def check(self, blender: str, progress: Callable[[int, int], None]) -> Report:
        """Checks all groups, for the Blender whose name is shown."""
        report = Report(blender, [], list(self.faults), self.fixed)
        for group, result in zip(self.groups, self.project.check(self.groups, progress), strict=True):
            wanted = [file.name for file in group if file.wanted]
            if result.failure:
                names = ", ".join(wanted[:3]) + (f" and {len(wanted) - 3} more" if len(wanted) > 3 else "")
                report.faults.append(f"{names} could not be checked: {result.failure}.")
                continue
            for file, findings in zip(group, result.findings, strict=True):
                if not file.wanted:
                    continue
                source = read_source(file.data, file.name)
                if why_not := too_long(source.text):
                    report.faults.append(f"{file.name} was not checked: {why_not}.")
                    continue
                kept = self.configuration.kept(Path(file.name), findings)
                report.files.append(FileReport(file.name, source, kept))
        report.files.sort(key=lambda file: file.name)
        return report

    def fix(self, *, unsafe: bool) -> None:
        """Applies fixes, in memory, until none is left or the rounds are over."""
        for _ in range(MOST_ROUNDS):
            results = self.project.check(self.groups)
            changed = False
            for number, (group, result) in enumerate(zip(self.groups, results, strict=True)):
                files = [
                    self._fixed(file, findings, unsafe=unsafe)
                    for file, findings in zip(group, result.findings or [[] for _ in group], strict=True)
                ]
                changed = changed or files != list(group)
                self.groups[number] = tuple(files)
            if not changed:
                return

    def changes(self) -> Iterator[tuple[LoadedFile, LoadedFile]]:
        """The files that fixes changed: as they were, and as they are to be."""
        for group, fixed in zip(self.before, self.groups, strict=True):
            yield from ((old, new) for old, new in zip(group, fixed, strict=True) if old.data != new.data)

    def print_diff(self) -> None:
        """Prints what fixes changed, as one unified diff."""
        for old, new in self.changes():
            print_diff(old.name, old.data, new.data)

    def write(self) -> None:
        """Writes the files that fixes changed; one that cannot be written is a fault."""
        for old, new in self.changes():
            try:
                write_fixed(Path(old.name), old.data, new.data)
            except OSError as error:
                self.faults.append(f"{old.name} cannot be written: {error.strerror or error}.")

    def _fixed(self, file: LoadedFile, findings: list[Finding], *, unsafe: bool) -> LoadedFile:
        if not file.wanted or not findings:
            return file
        source = read_source(file.data, file.name)
        kept = self.configuration.kept(Path(file.name), findings)
        fixed = apply_fixes(source, kept, unsafe=unsafe)
        if not fixed.count:
            return file
        try:
            data = fixed.text.encode(source.encoding)
        except UnicodeEncodeError:  # the fix has letters that the file's encoding lacks
            return file
        self.fixed += fixed.count
        return replace(file, data=data)


def load(
    groups: Iterable[FileGroup], faults: list[str], given: Mapping[Path, bytes] = MappingProxyType({})
) -> list[Group]:
    """Reads the files; one that is gone, may not be read or is far too large is a fault if it is wanted. ``given``
    has the content of files that are not to be read.
    """
    loaded: list[Group] = []
    for group in groups:
        files: list[LoadedFile] = []
        for file in group.files:
            try:
                data = given.get(file.path)
                if data is None:
                    with file.path.open("rb") as stream:
                        data = stream.read(MOST_BYTES + 1)
                if len(data) > MOST_BYTES:
                    raise OSError(f"it is larger than {MOST_BYTES >> 20} MiB")
            except OSError as error:
                if file.wanted:
                    faults.append(f"{file.path} cannot be read: {error.strerror or error}.")
                continue
            files.append(LoadedFile(str(file.path), data, file.wanted))
        if any(file.wanted for file in files):
            loaded.append(tuple(files))
    return loaded
