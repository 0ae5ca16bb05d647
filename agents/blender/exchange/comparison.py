"""What a file has kept of the objects that were exported to it."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from simworlds.counting import counted, format_list

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.blender.exchange.formats import Format
    from agents.blender.exchange.replies import ExchangeFacts

_NEAR = 1e-4  # of the longest side, and metres
_LISTED = 5
_AS_MESH = {"CURVE", "SURFACE", "FONT", "META"}  # become meshes in most formats


def not_kept(sent: ExchangeFacts, known: Format) -> list[str]:
    """What of the objects a format cannot keep, in words; it is no fault of the file."""
    losses = [
        (known.materials or not sent.materials, "materials"),
        (known.textures or not _textures(sent), "textures"),
        (known.uv_maps or not sent.uv_mapped, "UV maps"),
        (known.hierarchy or not sent.parented, "parents"),
        (known.motion or not sent.animated, "animation"),
        (known.whole or sent.meshes < 2, "objects (all are one mesh)"),
    ]
    return [word for kept, word in losses if not kept]


def differences(sent: ExchangeFacts, back: ExchangeFacts, known: Format) -> list[str]:
    """How what came back from the file differs from what was exported, beyond what the format cannot keep."""
    return [*_counts(sent, back, known), *_places(sent, back), *_looks(sent, back, known)]


def _counts(sent: ExchangeFacts, back: ExchangeFacts, known: Format) -> Iterator[str]:
    if sent.triangles != back.triangles:
        yield f"{counted(back.triangles, 'triangle')} instead of {sent.triangles:,}"
    if known.whole and sent.meshes != back.meshes:
        yield f"{back.meshes:,} {'mesh' if back.meshes == 1 else 'meshes'} with faces instead of {sent.meshes:,}"
    if known.uv_maps and sent.uv_mapped != back.uv_mapped:
        yield f"{back.uv_mapped:,} with UV maps instead of {sent.uv_mapped:,}"
    if known.whole:
        before, after = _types(sent), _types(back)
        for kind in sorted({*before, *after} - {"EMPTY", "MESH"}):
            if before[kind] != after[kind]:
                yield f"{after[kind]:,} of type {kind.lower()} instead of {before[kind]:,}"
        # A format's own root is one more Empty, and one more parent of each root.
        if after["EMPTY"] < before["EMPTY"]:
            yield f"{after['EMPTY']:,} of type empty instead of {before['EMPTY']:,}"
    if known.hierarchy and back.parented < sent.parented:
        yield f"{back.parented:,} with a parent instead of {sent.parented:,}"
    if known.motion and sent.poses and bool(sent.animated) != bool(back.animated):
        yield f"{back.animated:,} animated objects instead of {sent.animated:,}"


def _types(facts: ExchangeFacts) -> Counter[str]:
    types = Counter(facts.objects)
    for kind in _AS_MESH:
        types["MESH"] += types.pop(kind, 0)
    return types


def _places(sent: ExchangeFacts, back: ExchangeFacts) -> Iterator[str]:
    if not _same(sent.low, sent.high, back.low, back.high):
        yield f"bounds {_bounds(back.low, back.high)} instead of {_bounds(sent.low, sent.high)}"
    after = {pose.frame: pose for pose in back.poses}
    for pose in sent.poses:
        other = after.get(pose.frame)
        low, high = (other.low, other.high) if other is not None else (None, None)
        if not _same(pose.low, pose.high, low, high):
            yield f"at frame {pose.frame}, bounds {_bounds(low, high)} instead of {_bounds(pose.low, pose.high)}"


def _same(
    low: list[float] | None, high: list[float] | None, low2: list[float] | None, high2: list[float] | None
) -> bool:
    if low is None or high is None or low2 is None or high2 is None:
        return low is low2
    far = max(1.0, *(b - a for a, b in zip(low, high, strict=True))) * _NEAR
    return all(abs(a - b) <= far for a, b in zip([*low, *high], [*low2, *high2], strict=True))


def _bounds(low: list[float] | None, high: list[float] | None) -> str:
    if low is None or high is None:
        return "none"
    return " × ".join(f"{a:.4g}…{b:.4g}" for a, b in zip(low, high, strict=True)) + " m"


def _looks(sent: ExchangeFacts, back: ExchangeFacts, known: Format) -> Iterator[str]:
    if not known.materials:
        return
    lost = sorted({entry.name for entry in sent.materials} - {entry.name for entry in back.materials})
    if lost and len(back.materials) < len(sent.materials):
        yield f"without the materials {format_list([repr(name) for name in lost], _LISTED)}"
    if known.textures:
        gone = sorted(_textures(sent) - _textures(back))
        if gone:
            yield "without the textures of " + format_list(
                [f"{name!r} ({into})" for name, into in gone], _LISTED
            )
        if back.missing:
            yield f"without the image files {format_list(back.missing, _LISTED)}"


def _textures(facts: ExchangeFacts) -> set[tuple[str, str]]:
    """(material, input) of every image that reaches a shader."""
    return {(entry.name, image.into) for entry in facts.materials for image in entry.images}


def describe_bounds(facts: ExchangeFacts) -> str:
    """The bounds in words."""
    return _bounds(facts.low, facts.high)
