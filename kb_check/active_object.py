"""What Blender's API calls the active object."""

from __future__ import annotations

from kb_build.flow.facts import T

# What it is read by, and what it is set by.
READ = frozenset({f"{T}Context.object", f"{T}Context.active_object"})
SET = f"{T}LayerObjects.active"
