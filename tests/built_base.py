"""A base that was built for tests, with everything that it was built from."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kb_build.pipeline import BuildOptions, BuildReport, build
from simworlds.releases import minor_of

if TYPE_CHECKING:
    from collections.abc import Mapping

MINIATURE = Path(__file__).resolve().parent / "corpora_mini"
_FEW = re.compile(
    r"bpy\.types\.(?:Cloth\w*|Mesh(?:Vert\w+)?|ID|Modifier|bpy_struct)\b|bpy\.types\.(?:BlendData|Context)$"
    r"|bpy\.ops\.mesh\b|bpy(?:\.\w+)?$"
)


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

    def rebuilt_small(self) -> Built:
        """Its base built again, of the few symbols that are left of Blender's own description."""
        (extract,) = (self.home / "extracts").glob("*.jsonl")
        _keep_few(extract)
        self.path.unlink()
        return Built(self.home, self.corpora, build(None, options=self.options, home=self.home))

    @property
    def path(self) -> Path:
        return self.home / "kb" / f"blender-{self.minor}.sqlite"

    @property
    def minor(self) -> str:
        return ".".join(self.report.version.split(".")[:2])


def build_miniature(folder: Path) -> Built:
    """Builds a base in ``folder``: all of this environment's Blender, and the miniature manual and guides."""
    minor = minor_of(metadata.version("bpy"))
    home, corpora = folder / "home", folder / "corpora"
    shutil.copytree(MINIATURE / "manual", corpora / f"manual-{minor}-rst")
    shutil.copytree(MINIATURE / "guides", corpora / f"api-guides-{minor}-rst")
    return Built(home, corpora, build(None, options=BuildOptions(corpora=corpora, offline=True), home=home))


def _keep_few(extract: Path) -> None:
    """Leaves the symbols of a few classes and operators in an extract: building with all of them takes seconds."""
    rows = [json.loads(line) for line in extract.read_text(encoding="utf-8").splitlines()]
    few = {row["path"] for row in rows if _FEW.match(row.get("path", ""))}
    kept = [
        row
        for row in rows
        if row["record"] not in {"end", "manual"}
        and row.get("path", "bpy") in few
        and (row.get("kind") != "property" or _targets(row) <= few)
    ]
    kept.append({"record": "end", "lines": len(kept)})
    lines = (json.dumps(row, ensure_ascii=False, separators=(",", ":")) + "\n" for row in kept)
    extract.write_text("".join(lines), encoding="utf-8")


def _targets(row: Mapping[str, Any]) -> set[str]:
    """The classes that a property leads to."""
    return {f"bpy.types.{row[name]}" for name in ("target", "collection") if row.get(name)}
