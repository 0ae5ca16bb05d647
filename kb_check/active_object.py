"""What Blender's API calls the active object."""

from __future__ import annotations

from kb_build.flow.facts import READ_ACTIVE, SET_ACTIVE

# What it is read by, and what it is set by.
READ = READ_ACTIVE
SET = SET_ACTIVE
