"""How much a confined process may take."""

from __future__ import annotations

from dataclasses import dataclass

GIB = 1024**3


@dataclass(frozen=True, slots=True)
class ResourceLimits:
    """Bytes of memory, of one file, of all files; numbers of files and threads. 0: no limit."""

    memory: int = 0
    file_size: int = 4 * GIB
    disk: int = 20 * GIB
    files: int = 200_000
    threads: int = 4096

    @property
    def in_words(self) -> tuple[str, ...]:
        """The limits as phrases."""
        each = (
            (self.memory, f"{self.memory / GIB:.1f} GiB of memory"),
            (self.file_size, f"{self.file_size / GIB:.1f} GiB a file"),
            (self.disk, f"{self.disk / GIB:.1f} GiB on disk"),
            (self.files, f"{self.files:,} files"),
            (self.threads, f"{self.threads:,} threads"),
        )
        return tuple(words for amount, words in each if amount)
