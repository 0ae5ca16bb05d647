"""Blender's replies about drawn views: previews and marked findings. Metres; pixels from the upper left."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from simworlds.sandbox.replies import Claim, Count, Frame, Name

_LARGEST = 2048  # pixels a side
_MOST_NOTES = 60
_FARTHEST = 1e38
_File = Annotated[str, Field(pattern=r"^\.(preview|close-up)-\d{1,3}\.png$")]
Key = Annotated[str, Field(pattern=r"^[0-9a-f]{32}$")]
Note = Annotated[str, Field(max_length=2000)]
Metres = Annotated[float, Field(ge=-_FARTHEST, le=_FARTHEST)]
Pixel = Annotated[float, Field(ge=-1e15, le=1e15)]
Side = Annotated[int, Field(ge=16, le=_LARGEST)]
Scale = Annotated[float, Field(gt=0, le=_FARTHEST)]
Place = tuple[Pixel, Pixel]
Corner = tuple[Metres, Metres, Metres]
Part = Annotated[float, Field(ge=0, le=1.001)]
Share = Annotated[float, Field(ge=-2, le=2)]
Axis = tuple[Literal["X", "Y", "Z"], Share, Share, Share]
"""A world axis: its letter, and where it points in the picture: right, up, towards the viewer."""


class DrawnView(Claim):
    """One picture. ``file``: its name in the workspace; ``ground``: the height of z = 0 in it, if that is seen."""

    name: Name
    file: _File
    size: tuple[Side, Side]
    metres_per_pixel: Scale | None
    axes: list[Axis] = Field(max_length=3)
    cut_away: list[Name] = Field(max_length=10_000)
    labels: list[tuple[Name, Pixel, Pixel]] = Field(max_length=100)
    ground: Pixel | None
    lens: Name = ""
    marks: list[Place | None] = Field(default_factory=list[Place | None], max_length=200)


class CloseUp(Claim):
    """A picture of one finding; ``mark``: the number of the finding, from 0."""

    mark: int = Field(ge=0, le=200)
    name: Name
    file: _File
    metres_per_pixel: Scale


class PreviewReply(Claim):
    """A preview: ``low`` and ``high`` are the corners of what is framed; ``turned``: by how many degrees about the
    vertical the views are, along the subject's own axes."""

    title: Name
    frame: Frame
    objects: Count
    low: Corner
    high: Corner
    views: list[DrawnView] = Field(min_length=1, max_length=6)
    notes: list[Note] = Field(max_length=_MOST_NOTES)
    engine: Name
    turned: float = Field(default=0.0, ge=-360, le=360)

    @property
    def size(self) -> Corner:
        """The framed extent along the axes."""
        (x, y, z), (right, back, top) = self.low, self.high
        return right - x, back - y, top - z


class LitView(DrawnView):
    """The scene in neutral light at a ``frame``. Without a ``file`` it is the picture that was kept by its ``key``."""

    file: _File | None  # pyright: ignore[reportIncompatibleVariableOverride]
    key: Key | None
    frame: Frame


class LitObject(Claim):
    """An object alone in neutral light: its ``materials``, which others are ``alike`` and so not shown, some named and
    how many, and which of its parts are ``bare``: without a material. ``file`` and ``key`` are as in ``LitView``."""

    name: Name
    file: _File | None
    key: Key | None
    metres_per_pixel: Scale
    materials: list[Name] = Field(max_length=20)
    alike: list[Name] = Field(max_length=20)
    alike_in_all: Count
    bare: list[Name] = Field(max_length=20)


class LitPatch(Claim):
    """A close picture of a part of an object. ``file`` and ``key`` are as in ``LitView``."""

    name: Name
    file: _File | None
    key: Key | None
    metres_per_pixel: Scale


class MaterialReply(Claim):
    """Stills in neutral light."""

    title: Name
    scene: list[LitView] = Field(max_length=4)
    objects: list[LitObject] = Field(max_length=12)
    patches: list[LitPatch] = Field(max_length=3)
    notes: list[Note] = Field(max_length=_MOST_NOTES)


class UvMesh(Claim):
    """A mesh's UV map: files of its pictures, bounds, shares of its surface (``overlap``: of the map; None if it was
    not measured), and from how many to how many tiles a metre has. ``missing``: it has no usable coordinates."""

    name: Name
    uv_map: Name
    maps: Count
    faces: Count
    missing: bool
    checker: _File
    map: _File | None
    alike: list[Name] = Field(max_length=8)
    alike_in_all: Count
    low: tuple[Metres, Metres] = (0.0, 0.0)
    high: tuple[Metres, Metres] = (0.0, 0.0)
    outside: Part = 0.0
    stretched: Part = 0.0
    collapsed: Part = 0.0
    mirrored: Part = 0.0
    overlap: Part | None = None
    scale: tuple[Metres, Metres] = (0.0, 0.0)


class UvReply(Claim):
    """The UV maps of a scene, and the names of meshes ``without`` one."""

    title: Name
    meshes: list[UvMesh] = Field(max_length=8)
    without: list[Name] = Field(max_length=64)
    notes: list[Note] = Field(max_length=_MOST_NOTES)


class FindingsReply(Claim):
    """The pictures of marked findings."""

    title: Name
    frame: Frame
    views: list[DrawnView] = Field(min_length=1, max_length=6)
    close: list[CloseUp] = Field(max_length=200)
    notes: list[Note] = Field(max_length=_MOST_NOTES)
