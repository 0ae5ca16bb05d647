"""Which map of a texture set a file is, by the names that are common; and which set it belongs to."""

from __future__ import annotations

import re
from collections import defaultdict
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

IMAGES = frozenset({".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr", ".tga", ".webp", ".bmp"})
# Map → words that stand for it, as tokens of a file's name or at its end.
_WORDS = {
    "base_color": (
        "basecolor",
        "albedo",
        "diffuse",
        "diff",
        "color",
        "colour",
        "col",
        "basecol",
        "alb",
        "bc",
    ),
    "normal": ("normal", "normalgl", "nor", "nrm", "norgl", "norm", "normalopengl", "noropengl"),
    "normal_directx": ("normaldx", "nordx", "normaldirectx", "nordirectx"),
    "roughness": ("roughness", "rough", "rgh"),
    "glossiness": ("glossiness", "gloss"),
    "metallic": ("metallic", "metalness", "metal", "mtl", "met"),
    "displacement": ("displacement", "disp", "height", "dsp"),
    "ambient_occlusion": ("ambientocclusion", "ao", "occlusion", "occ"),
    "occlusion_roughness_metallic": ("arm", "orm"),
    "alpha": ("opacity", "alpha", "mask"),
    "emission": ("emission", "emissive", "emit"),
}
_BY_WORD = {word: name for name, words in _WORDS.items() for word in words}
_PAIRS = {
    *(("base", "color"), ("base", "colour"), ("ambient", "occlusion")),
    *((start, end) for start in ("normal", "nor") for end in ("gl", "dx", "opengl", "directx")),
}
_ASIDE = re.compile(r"\d{1,2}k|\d{3,5}|\d{3,5}x\d{3,5}|jpe?g|png|exr|tiff?")  # resolutions and file types
_PARTS = re.compile(r"[ _\-.]+|(?<=[a-z])(?=[A-Z])")


def map_of(stem: str) -> tuple[str, str]:
    """(map, set) of a file's name without its ending; ("", …) if nothing in it stands for a map."""
    words = [word for word in _PARTS.split(stem) if word]
    folded = [word.lower() for word in words]
    for at in range(len(words) - 1, 0, -1):
        pair = tuple(folded[at - 1 : at + 1])
        if pair in _PAIRS and at > 1:
            return _BY_WORD["".join(pair)], _set_name(words[: at - 1] + words[at + 1 :])
        if (name := _BY_WORD.get(folded[at])) is not None:
            return name, _set_name(words[:at] + words[at + 1 :])
    return "", stem


def _set_name(words: list[str]) -> str:
    kept = [word for word in words if not _ASIDE.fullmatch(word.lower())]
    return "_".join(kept or words)


def texture_sets(names: Iterable[str]) -> dict[str, dict[str, str]]:
    """{path of the set: {map: file}} of files, given by paths below one folder. Other images are left out.

    A set has a base colour, or two maps at least. Of two files for one map, the first by name counts.
    """
    sets: defaultdict[str, dict[str, str]] = defaultdict(dict)
    for name in sorted(names):
        path = PurePosixPath(name)
        kind, stem = map_of(path.stem)
        if kind and path.suffix.lower() in IMAGES:
            sets[path.with_name(stem).as_posix()].setdefault(kind, name)
    return {place: maps for place, maps in sets.items() if "base_color" in maps or len(maps) > 1}
