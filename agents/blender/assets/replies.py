"""Blender's replies about assets."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from simworlds.sandbox.replies import Claim, Count, Name, Text

MOST_ASSETS = 2000  # of one file
Kind = Literal["object", "collection", "material", "world", "node_group"]
Picture = Annotated[str, Field(pattern=r"^(\d{1,6}\.png)?$")]


class MarkedAsset(Claim):
    """A data-block that its .blend marks as an asset; ``picture``: the file of its preview, "" if it has none."""

    kind: Kind
    name: Name
    description: Text
    tags: list[Name] = Field(max_length=100)
    author: Name
    license: Name
    picture: Picture


class ReadAssets(Claim):
    """What a file has: marked assets, or the size of an image in pixels; ``fault``: why it cannot be read."""

    assets: list[MarkedAsset] = Field(max_length=MOST_ASSETS)
    size: tuple[Count, Count] | None
    picture: Picture
    fault: Text


class PlacedAsset(Claim):
    """What an asset has become: names of data-blocks by kind; ``assigned``: objects that got a material."""

    made: dict[Name, list[Name]] = Field(max_length=20)
    assigned: list[Name] = Field(max_length=1000)
    connected: dict[Name, Name] = Field(max_length=20)
    notes: list[Text] = Field(max_length=50)
