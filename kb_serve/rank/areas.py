"""Areas of Blender that stand apart: who asks about one of them says so.

They have a pencil, a brush, a marker or a driver of their own, and much of what they say is said elsewhere, too.
"""

from __future__ import annotations

# The beginning of the slugs of an area's pages → the words by which people say that they mean it.
AREAS: dict[str, frozenset[str]] = {
    "grease_pencil/": frozenset(
        "2d draw drawing drawings gpencil grease ink onion pencil stroke strokes".split()  # noqa: SIM905
    ),
    "sculpt_paint/": frozenset(
        "brush brushes mask paint painting sculpt sculpting stroke weight weights".split()  # noqa: SIM905
    ),
    "video_editing/": frozenset(
        "audio clip cut edit film footage movie sequence sequencer sound strip strips video vse".split()  # noqa: SIM905
    ),
    "movie_clip/": frozenset(
        "clip footage marker markers mask masking matchmove movie shot tracker tracking video".split()  # noqa: SIM905
    ),
    "editors/texture_node/": frozenset(("brush", "brushes", "editor", "legacy")),
    "render/materials/legacy_textures/": frozenset(("brush", "brushes", "legacy")),
    "troubleshooting/gpu/": frozenset(
        "amd apple card directx gpu graphics intel mac mesa metal nvidia opengl vulkan windows".split()  # noqa: SIM905
    ),
}
NO_AREA = len(AREAS)
_SLUGS = tuple(AREAS)


def area_of(slug: str) -> int:
    """The place of a page's area in AREAS, or NO_AREA."""
    if not slug.startswith(_SLUGS):
        return NO_AREA
    return next((place for place, beginning in enumerate(_SLUGS) if slug.startswith(beginning)))


def unasked(words: frozenset[str]) -> list[int]:
    """The places of the areas of which a query's words say nothing."""
    return [place for place, said in enumerate(AREAS.values()) if words.isdisjoint(said)]
