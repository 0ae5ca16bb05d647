"""The paper's published figures (its Tables 1 and 3), for comparison; measured by others, on other hardware."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bench.results.scores import Metric

SOURCE = "published in the paper"
# System → metric → category → score.
TABLE_1: dict[str, dict[Metric, dict[str, float]]] = {
    "SimWorlds": {
        "mpr": {"cloth": 0.92, "fluid": 0.95, "rigid": 0.83, "particle": 0.79, "soft": 0.87, "overall": 0.87},
        "spr": {"cloth": 0.78, "fluid": 1.00, "rigid": 0.83, "particle": 0.89, "soft": 0.89, "static": 0.98,
                "overall": 0.89},
        "vlm": {"cloth": 0.82, "fluid": 0.75, "rigid": 0.80, "particle": 0.84, "soft": 0.89, "static": 0.79,
                "overall": 0.82},
    },
    "VIGA": {
        "mpr": {"cloth": 0.85, "fluid": 0.56, "rigid": 0.61, "particle": 0.62, "soft": 0.72, "overall": 0.67},
        "spr": {"cloth": 0.72, "fluid": 0.89, "rigid": 0.67, "particle": 0.67, "soft": 0.72, "static": 0.42,
                "overall": 0.70},
        "vlm": {"cloth": 0.81, "fluid": 0.75, "rigid": 0.82, "particle": 0.70, "soft": 0.87, "static": 0.67,
                "overall": 0.78},
    },
}  # fmt: skip
# Parts left out → metric → score, on 15 scenes.
ABLATIONS: dict[tuple[str, ...], dict[Metric, float]] = {
    (): {"mpr": 0.97, "spr": 0.97, "vlm": 0.87},
    ("no-verifier",): {"mpr": 0.93, "spr": 0.87, "vlm": 0.84},
    ("no-stages",): {"mpr": 0.94, "spr": 0.92, "vlm": 0.76},
}
