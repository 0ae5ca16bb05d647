"""Which classes are the data of objects, by the object's type."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

# ``Object.type`` → the class of ``Object.data``, of all versions.
OBJECT_DATA = {
    "MESH": "Mesh", "CURVE": "Curve", "SURFACE": "SurfaceCurve", "FONT": "TextCurve", "META": "MetaBall",
    "ARMATURE": "Armature", "LATTICE": "Lattice", "LIGHT": "Light", "LIGHT_PROBE": "LightProbe", "CAMERA": "Camera",
    "SPEAKER": "Speaker", "GPENCIL": "GreasePencil", "GREASEPENCIL": "GreasePencilv3", "CURVES": "Curves",
    "POINTCLOUD": "PointCloud", "VOLUME": "Volume",
}  # fmt: skip

OF_EMPTIES = "Image"  # the class of what an empty shows
# A class that some versions call otherwise: name → (other name, a class that tells that it means another thing yet).
# Grease Pencil's data is GreasePencilv3 from 4.3 to 4.5; before, GreasePencil is the older kind, with GPencilLayers.
_RENAMED = {"GreasePencilv3": ("GreasePencil", "GPencilLayer")}


def data_class(kind: str, is_class: Callable[[str], bool]) -> str:
    """The name of the class of the data of an object's type: Mesh of ``MESH``; empty for a type without data.

    ``is_class`` tells which names are classes in a version.
    """
    name = OBJECT_DATA.get(kind, "")
    other, unless = _RENAMED.get(name, ("", ""))
    return other if other and not is_class(name) and not is_class(unless) else name
