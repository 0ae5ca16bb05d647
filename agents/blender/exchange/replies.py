"""Blender's replies about files of other formats."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from simworlds.sandbox.replies import Claim, Count, Frame, Name, Place, Text

_MOST = 2000
Corner = Annotated[list[Annotated[float, Field(ge=-1e12, le=1e12)]], Field(min_length=3, max_length=3)]


class ImageUse(Claim):
    """An image that reaches the input ``into`` of a shader; ``file``: the name of its file."""

    name: Name
    into: Name
    file: Place
    packed: bool
    missing: bool


class MaterialUse(Claim):
    """A material in use, and the images in it."""

    name: Name
    images: list[ImageUse] = Field(max_length=40)


class Pose(Claim):
    """The bounds at a frame, in metres."""

    frame: Frame
    low: Corner
    high: Corner


class ExchangeFacts(Claim):
    """What a set of objects is made of.

    ``objects`` by type; ``meshes``: how many have faces, ``uv_mapped``: how many have UV maps; ``parented``: how many
    have a parent among them; ``range``: the frames of their actions. Bounds are in metres; None if there are none.
    """

    objects: dict[Name, Count] = Field(max_length=100)
    vertices: Count
    triangles: Count
    meshes: Count
    uv_mapped: Count
    low: Corner | None
    high: Corner | None
    parented: Count
    animated: Count
    range: tuple[Frame, Frame] | None
    poses: list[Pose] = Field(max_length=10)
    materials: list[MaterialUse] = Field(max_length=200)
    missing: list[Place] = Field(max_length=_MOST)


class ImportedFile(ExchangeFacts):
    """What came in with a file. ``outside``: images that lie where it may not refer to; ``reads_on``: files that are
    read again at every frame; ``notes``: what is odd.
    """

    collection: Name
    roots: list[Name] = Field(max_length=50)
    outside: list[Place] = Field(max_length=_MOST)
    reads_on: list[Place] = Field(max_length=_MOST)
    notes: list[Text] = Field(max_length=100)


class ExportedFile(ExchangeFacts):
    """What was exported; ``files`` are relative to the folder that was given; ``notes``: what was left out, and why;
    ``timing``: the frames a second, their base, and the frame of the scene."""

    files: list[Place] = Field(max_length=_MOST)
    timing: tuple[Annotated[int, Field(ge=1, le=100_000)], Annotated[float, Field(gt=0, le=1e7)], Frame]
    notes: list[Text] = Field(max_length=100)


class FormatSupport(Claim):
    """What this Blender ``reads`` and ``writes``."""

    reads: bool
    writes: bool


class AvailableFormats(Claim):
    """The formats of a Blender, by kind."""

    version: Name
    formats: dict[Name, FormatSupport] = Field(max_length=50)
