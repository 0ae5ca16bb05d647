"""What the planner hears of the user's asset library, where a run was given one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.loop.running.run_tools import RUNNER

if TYPE_CHECKING:
    from agents.loop.running.run import Run

ASSETS = "blender_assets"
_TOLD = """\
{prompt}

The user has an asset library. Where one of its assets is what the scene needs, say so in the plan by its id (in the \
description of an object, the texture of a material, or the light); the coder then brings it in with {tool} and does \
not build it. Else plan as without it.

{found}"""


def prompt_with_assets(run: Run) -> str:
    """The run's prompt, followed by what the library has; without a library, the prompt alone. Raises RunError."""
    prompt = run.options.prompt
    if run.options.assets is None:
        return prompt
    found = run.tools.use(RUNNER, "modeling", ASSETS, {"previews": False})
    return prompt if found.failed else _TOLD.format(prompt=prompt, tool=ASSETS, found=found.text)
