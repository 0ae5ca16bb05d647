"""The note beside fetched assets: where they are from, under which licence, and by whom."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

NOTE_FILE = "asset.json"
LONGEST = 1 << 18  # bytes of a note
Short = Annotated[str, Field(max_length=1000)]


class LicenceNote(BaseModel):
    """What is known of the files in its folder; ``md5`` are those that the source lists."""

    model_config = ConfigDict(extra="ignore", frozen=True)

    source: Short
    page: Short
    license: Short
    author: Short
    name: Short
    tags: list[Short] = Field(default_factory=list[str], max_length=100)
    md5: dict[Short, Short] = Field(default_factory=dict[str, str], max_length=1000)
