"""The figures that the paper publishes (Table "Scene-editing results on BlenderBench"), for comparison."""

from __future__ import annotations

from bench.blenderbench.task_set import LEVELS

OVERALL = "overall"
PUBLISHED: dict[str, dict[str, tuple[float, float, float]]] = {
    "VIGA (paper)": {
        "level1": (7.60, 6.06, 2.97),
        "level2": (2.44, 3.27, 2.97),
        "level3": (7.63, 6.27, 2.36),
        OVERALL: (6.02, 5.28, 2.76),
    },
    "SimWorlds (paper)": {
        "level1": (6.53, 5.91, 3.56),
        "level2": (0.97, 3.07, 3.84),
        "level3": (5.99, 5.23, 2.89),
        OVERALL: (4.63, 4.80, 3.41),
    },
}
"""System → row → PL, N-CLIP, VLM. PL and N-CLIP are × 100."""
TASKS = dict(zip(LEVELS, (9, 8, 9), strict=True))
"""Tasks a level over which the published overall figures are the mean; the set has nine in each."""
