"""The judged dimensions (paper, "Itemized VLM judge"): three with items from the prompt, two with fixed items."""

from __future__ import annotations

from typing import Literal

Dimension = Literal["objects_present", "spatial_relations", "actions_visible", "visual_quality", "aesthetics"]
DIMENSIONS: tuple[Dimension, ...] = (
    "objects_present",
    "spatial_relations",
    "actions_visible",
    "visual_quality",
    "aesthetics",
)
CHECKLISTS: dict[Dimension, tuple[str, ...]] = {
    "visual_quality": (
        "Materials: all that is seen has a material; nothing is left in the grey of a fresh mesh, or shows the "
        "magenta of a missing texture.",
        "Exposure: the light lets the forms be read; what matters is neither lost in black nor burnt out to white.",
        "Rendering: no heavy noise, stray bright pixels, flickering or torn surfaces, holes or missing faces.",
    ),
    "aesthetics": (
        "Material fidelity: surfaces have the colours, and look like the stuff, that the request names.",
        "Palette: the colours go together, and the subject stands out from what is around it.",
        "Lighting mood: the light suits the place and the time of day that the request names, or, if it names none, "
        "the scene.",
        "Composition: the subject and what it does are in the frame as a whole, large enough, and lead the eye.",
    ),
}


def fixed_items() -> dict[str, str]:
    """Id → the statement to judge, of all fixed items."""
    return {
        f"{name}.{number}": text
        for name, listed in CHECKLISTS.items()
        for number, text in enumerate(listed, 1)
    }


def dimensions(*, static: bool) -> tuple[Dimension, ...]:
    """The dimensions of a scene; a still has no actions."""
    return tuple(dimension for dimension in DIMENSIONS if not (static and dimension == "actions_visible"))
