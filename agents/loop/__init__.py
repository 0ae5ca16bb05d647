"""The loop: from a sentence to a scene, stage by stage, and what is kept of a run."""
