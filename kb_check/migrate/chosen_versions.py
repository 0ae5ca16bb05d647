"""The Blenders of a migration: to which, from which, and which must still run the code."""

from __future__ import annotations

from contextlib import closing, suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_check.checker import Checker
from kb_check.command.versions import base_files
from kb_check.migrate.kept_version import KeptVersion
from kb_check.migrate.place import version_of
from kb_serve.bases import Bases
from kb_serve.reader import BaseReader
from simworlds.errors import UserError
from simworlds.releases import minor_of, version_key
from simworlds.settings import built_bases

if TYPE_CHECKING:
    from contextlib import ExitStack
    from pathlib import Path


@dataclass(frozen=True, slots=True)
class Versions:
    """Minor versions: ``source`` is None where the code tells it, ``keep`` are older than the target, oldest first.

    ``base`` is the target's, of the full version ``blender``; ``bases`` are all that there are.
    """

    base: Path
    blender: str
    target: str
    source: str | None
    keep: tuple[str, ...]
    bases: dict[str, Path]

    @property
    def without_base(self) -> tuple[str, ...]:
        """Those to keep of which there is no base."""
        return tuple(version for version in self.keep if version not in self.bases)

    def kept(self, stack: ExitStack) -> list[KeptVersion]:
        """Those to keep, with their bases open as long as ``stack`` is."""
        histories: list[BaseReader] = []
        for base in self.bases.values() if self.without_base else ():
            with suppress(UserError):  # one that cannot be read tells nothing
                histories.append(stack.enter_context(closing(BaseReader(base))))
        return [
            KeptVersion(
                version_of(version),
                stack.enter_context(Checker(self.bases[version])) if version in self.bases else None,
                tuple(histories),
            )
            for version in self.keep
        ]


def read_versions(target: str | None, source: str | None, keep: str, home: Path) -> Versions:
    """The versions that a command names; the target is by default the Blender in use.

    Raises UserError where they contradict each other, and where there is no base to migrate to.
    """
    if target:
        (base,) = base_files([target], home).values()
    else:
        with closing(Bases(home)) as bases:
            base = bases.file()
    with closing(BaseReader(base)) as reader:
        blender, to = reader.meta["blender"], minor_of(reader.meta["minor"])
    if source:
        source = minor_of(source)
        if version_key(source) > version_key(to):
            raise UserError(
                f"--from {source} is newer than {to}, the Blender to migrate to. Give a newer --to, or no --from."
            )
    kept = sorted({minor_of(version) for version in keep.split(",") if version.strip()}, key=version_key)
    if newer := [version for version in kept if version_key(version) > version_key(to)]:
        raise UserError(
            f"--keep {','.join(newer)} is newer than {to}, the Blender to migrate to. Give a newer --to, or "
            "leave it out."
        )
    return Versions(
        base, blender, to, source, tuple(version for version in kept if version != to), built_bases(home)
    )
