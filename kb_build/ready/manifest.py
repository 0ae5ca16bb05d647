"""What a ready base says of itself: which Blender, which file, whose text, under which licences."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from kb_build.errors import ReadyBaseError
from kb_build.schema import SCHEMA_VERSION
from simworlds.own_command import own_command
from simworlds.schemas.faults import first_fault

if TYPE_CHECKING:
    from pathlib import Path

SUFFIX = ".tar.xz"
MANIFEST, NOTICE, BASE = "manifest.json", "NOTICE.txt", "base.sqlite"
MEMBERS = frozenset({MANIFEST, NOTICE, BASE})
LONGEST_MANIFEST = 64 * 1024
LARGEST_BASE = 512 << 20


class Licensed(BaseModel):
    """A part of a base, with its licence (SPDX) and whom to name."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    part: str = Field(max_length=300)
    licence: str = Field(max_length=80)
    attribution: str = Field(max_length=300)


LICENCES = (
    Licensed(
        part="the manual and the guides of the Python API, by section",
        licence="CC-BY-SA-4.0",
        attribution="Blender Documentation Team, docs.blender.org; cut into sections and written as Markdown",
    ),
    Licensed(
        part="names, types, values and descriptions of the Python API; lines of Blender's own scripts",
        licence="GPL-3.0-or-later",
        attribution="Blender Foundation and the contributors to Blender, blender.org",
    ),
    Licensed(
        part="summaries, query expansions, the table of successors and the index",
        licence="GPL-3.0-or-later",
        attribution="The SimWorlds authors",
    ),
)


class Manifest(BaseModel):
    """The first member of a ready base."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Literal["simworlds-base/1"] = "simworlds-base/1"
    blender: str = Field(pattern=r"^\d{1,2}\.\d{1,2}\.\d{1,3}$")
    schema_version: int = Field(ge=1)
    size: int = Field(gt=0, le=LARGEST_BASE, description="Of the base, in bytes.")
    sha256: str = Field(pattern=r"^[0-9a-f]{64}$", description="Of the base.")
    built_at: str = Field(max_length=40)
    simworlds: str = Field(max_length=40)
    licences: tuple[Licensed, ...] = Field(min_length=1, max_length=20)

    @property
    def minor(self) -> str:
        """``"5.1"``."""
        return self.blender.rpartition(".")[0]


def read_manifest(path: Path, origin: str) -> Manifest:
    """The manifest in a file. Raises ReadyBaseError, which names ``origin``."""
    try:
        if path.stat().st_size > LONGEST_MANIFEST:
            raise ReadyBaseError(f"{origin}: its manifest is too long for a ready base; do not use this file")
        manifest = Manifest.model_validate_json(path.read_bytes())
    except ValidationError as error:
        fault = first_fault(error, whole="JSON")
        raise ReadyBaseError(
            f"{origin}: its manifest is not one of a ready base ({fault}); get another file"
        ) from error
    if manifest.schema_version != SCHEMA_VERSION:
        newer = manifest.schema_version > SCHEMA_VERSION
        build = f"{own_command()} kb build {manifest.minor}"
        then = "update SimWorlds" if newer else f"ask for a newer file, or build it: {build}"
        raise ReadyBaseError(
            f"{origin} has layout {manifest.schema_version}, and this SimWorlds reads {SCHEMA_VERSION}; {then}"
        )
    return manifest


def notice(manifest: Manifest) -> str:
    """What must go along with the base, for people."""
    parts = "\n".join(
        f"- {row.part}\n  {row.attribution}\n  licence: {row.licence}\n" for row in manifest.licences
    )
    return (
        f"Knowledge base of Blender {manifest.blender}, made by SimWorlds {manifest.simworlds}.\n\n{parts}\n"
        "CC-BY-SA-4.0: https://creativecommons.org/licenses/by-sa/4.0/legalcode\n"
        "GPL-3.0-or-later: https://www.gnu.org/licenses/gpl-3.0.html\n"
        "Blender is a trademark of the Blender Foundation, which has no part in this file.\n"
    )
