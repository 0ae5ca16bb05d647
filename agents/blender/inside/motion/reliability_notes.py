# SPDX-License-Identifier: GPL-3.0-or-later
"""Notes on how far a motion sheet can be trusted: what it does not show, and why."""

from ..physics.caches import PARTICLES
from ..physics.stillness_causes import likely_causes

_STILL = 0.002  # share of its size; an actor that moves less counts as still
_LISTED = 4


def notes_on(track, caches, missing, scene):
    """Sentences about one actor. ``caches``: (cache, its state); ``missing``: {object: why no picture shows it}."""
    notes = []
    first, last = track.frames[0], track.frames[-1]
    for cache, state in caches:
        notes += _on_cache(cache, state, track)
    there = [frame for frame, centre in zip(track.frames, track.centres, strict=True) if centre is not None]
    if not there:
        notes.append(f"It does not exist at any frame from {first} to {last}.")
    elif _is_still(track):
        causes = [cause for cache, _ in caches for cause in likely_causes(cache, scene)]
        because = f" Likely cause: {'; or '.join(causes[:2])}." if causes else ""
        notes.append(f"It does not move from frame {first} to {last}.{because}")
    for name, why in _missing_of(track.actor, missing):
        notes.append(f"Not in the pictures: {name!r}: {why}.")
    if track.strays:
        frames = ", ".join(str(frame) for frame in list(track.strays)[:_LISTED])
        notes.append(
            f"Its motion is not repeatable: when frame {frames} was drawn, it was elsewhere than when it was measured."
        )
    if track.actor.measured == "origin":
        what = "bones are" if track.actor.objects[0].pose is not None else "origin is"
        notes.append(f"It has no geometry, so its {what} measured.")
    return notes


def _on_cache(cache, state, track):
    first, last = track.frames[0], track.frames[-1]
    if not state["on"]:
        yield f"Disabled in the viewport, so not simulated here: {cache.label}."
        return
    if "outdated" in state["state"]:
        yield f"The bake of {cache.label} is outdated: this shows its old result."
    if cache.domain is not None and state["state"] == "unbaked" and cache.domain.cache_type != "REPLAY":
        kind = cache.domain.cache_type
        yield (
            f"Not baked: {cache.label}. With cache_type {kind!r}, stepping does not simulate it; anything that is "
            "visible comes from old files in its folder."
        )
    elif state["end"] < last and cache.kind != PARTICLES:
        yield f"Simulated only up to frame {state['end']}: {cache.label}."
    elif state["start"] > first and cache.kind != PARTICLES:
        yield f"Simulated only from frame {state['start']} on: {cache.label}."


def _is_still(track):
    lows, highs = ([place for place in places if place is not None] for places in (track.lows, track.highs))
    size = max((high - low).length for low, high in zip(lows, highs, strict=True))
    displacements = [value for value in track.displacements() if value is not None]
    moved = max(displacements) > _STILL * max(size, 1e-6)
    turned = sum(turn for turn in track.turns if turn is not None) > 0.01
    return not (moved or turned or track.deforms)


def _missing_of(actor, missing):
    reasons = [(obj.name, missing[obj.name]) for obj in actor.objects if obj.name in missing]
    return reasons[:_LISTED]
