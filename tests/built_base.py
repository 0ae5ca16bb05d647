"""A base that was built for tests, with everything that it was built from."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path

from kb_build.pipeline import BuildOptions, BuildReport

MINIATURE = Path(__file__).resolve().parent / "corpora_mini"


@dataclass(frozen=True)
class Built:
    """A home folder with one base in it, and the corpora folder that it was built from."""

    home: Path
    corpora: Path
    report: BuildReport

    @property
    def options(self) -> BuildOptions:
        return BuildOptions(corpora=self.corpora, offline=True)

    def copy(self, folder: Path) -> Built:
        """The same in a folder where it can be damaged."""
        home, corpora = folder / "home", folder / "corpora"
        shutil.copytree(self.home, home)
        shutil.copytree(self.corpora, corpora)
        return Built(home, corpora, self.report)

    @property
    def path(self) -> Path:
        return self.home / "kb" / f"blender-{self.minor}.sqlite"

    @property
    def minor(self) -> str:
        return ".".join(self.report.version.split(".")[:2])
