"""Physics and animation of a readout as lines for a model."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from agents.blender.tools.scene_fold import series
from agents.blender.tools.scene_words import joined, pairs, row, settings, span, titled, value

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from agents.blender.tools.scene_fold import Entry

_FEW_NAMES = 16
_UNITS = ((1 << 30, "GiB"), (1 << 20, "MiB"), (1 << 10, "KiB"))


def _size(count: Any) -> str:
    if not isinstance(count, int):
        return f"{value(count)} bytes"
    for unit, name in _UNITS:
        if count >= unit:
            return f"{count / unit:.1f} {name}"
    return f"{count} bytes"


# Physics

_SHOWN_APART = (
    *("kind", "name", "count", "pattern", "settings", "cache", "caches", "off", "modifier", "surfaces"),
    "names",
)


def physics(entry: Entry) -> str:
    """An object's part in a simulation: a line, and one for each cache."""
    own = {key: item for key, item in entry.items() if key not in _SHOWN_APART}
    head = f"- {entry['kind']} {titled(entry)}"
    if "names" in entry:
        head = f"- {entry['kind']} ({entry['count']}): {', '.join(entry['names'])}"
    off = f"modifier off in {' and '.join(entry['off'])}" if "off" in entry else ""
    lines = [
        joined(head, [pairs(own), off]) + (f"; {pairs(entry['settings'])}" if "settings" in entry else "")
    ]
    for cache in (*([entry["cache"]] if "cache" in entry else ()), *entry.get("caches", ())):
        lines.append(f"  cache {_cache(cache)}")
    for surface in entry.get("surfaces", ()):
        lines.append(f"  surface {surface['name']} {surface['type']}{settings(surface)}")
        lines.append(f"    cache {_cache(surface['cache'])}")
    return "\n".join(lines)


def _cache(cache: dict[str, Any]) -> str:
    parts = [cache["state"].upper()]
    if cache.get("outdated"):
        parts.append("OUTDATED" if cache["state"] == "baked" else "simulates again")
    if "range" in cache:
        parts.append(f"frames {span(cache['range'])}")
    if "step" in cache:
        parts.append(f"step {value(cache['step'])}")
    if "type" in cache:
        parts.append(f"cache_type {cache['type']}")
    if cache.get("baked"):
        parts.append(f"baked: {', '.join(cache['baked'])}")
    held = cache.get("on_disk")
    if isinstance(held, dict):
        parts.append(f"on disk: {_held(cast('dict[str, Any]', held))}")
    elif "frames" in cache:
        where = "in external files" if "external" in cache else "on disk" if held else "in memory"
        parts.append(f"holds {value(cache['frames'])} {where}")
    if cache.get("bytes"):
        parts.append(_size(cache["bytes"]))
    parts += [
        f"{key} {cache[key]}" for key in ("name", "external", "directory", "node", "target") if key in cache
    ]
    return ", ".join(parts)


def _held(held: dict[str, Any]) -> str:
    if "first" in held:
        return f"{span((held['first'], held['last']))} ({value(held['frames'])})"
    return ", ".join(f"{part} {_held(frames)}" for part, frames in held.items())


def by_kind(entries: Sequence[Entry]) -> list[Entry]:
    """The simulations in few entries: those of the same kind and state together, without settings."""
    groups: dict[str, list[Entry]] = {}
    for entry in entries:
        cache = entry.get("cache", {})
        state = (cache.get("state"), cache.get("outdated"), cache.get("range"), entry.get("type"))
        groups.setdefault(f"{entry['kind']} {state}", []).append(entry)
    merged: list[Entry] = []
    for group in groups.values():
        first = group[0]
        kept = {key: first[key] for key in ("kind", "name", "type") if key in first}
        if "cache" in first:
            kept["cache"] = {key: first["cache"][key] for key in _KEPT_OF_CACHE if key in first["cache"]}
        names = series([entry["name"] for entry in group])
        if len(names) > _FEW_NAMES:
            names[_FEW_NAMES:] = [f"… {len(names) - _FEW_NAMES} more"]
        merged.append({**kept, "count": len(group), "names": names})
    return merged


_KEPT_OF_CACHE = ("state", "outdated", "range")


# Animation


def animation(entry: Entry) -> str:
    """What animates a data-block: action with channels, NLA, drivers, shape keys."""
    if "actions" in entry:
        return f"- unused actions ({entry['count']}): {', '.join(entry['actions'])}"
    head = f"- {titled(entry)}" + (f" ({entry['of']})" if "of" in entry else "")
    head += "".join(f", {value(count)} {key}" for key, count in entry.get("counts", {}).items())
    lines: list[str] = []
    points = entry.get("points", {}) if "count" not in entry else {}
    for key, write in _WRITERS.items():
        items = entry.get(key, ())
        if key == "channels":
            items = [{**item, "points": points.get(item.get("path"))} for item in items]
        lines += [f"  {write(item)}" for item in items]
        if left := entry.get(f"{key}_left_out"):
            lines.append(f'  … {value(left)} more {key}: detail="full"')
    if "unlisted" in entry:
        lines.append(f"  … {value(entry['unlisted'])} that are not listed")
    if "part" in entry:
        head += f", {entry['part']}"
    if "action" in entry:
        slot = f" slot {value(entry['slot'])}" if "slot" in entry else ""
        frames = f", frames {span(entry['range'])}" if "range" in entry else ""
        curves = f"{value(entry['curves'])} f-curves, {value(entry['keys'])} keys"
        head += f": action {entry['action']}{slot}, {curves}{frames}"
    if "absolute" in entry:
        head += f": absolute, eval_time {value(entry['absolute'])}"
    return "\n".join([head, *lines])


def _channel(entry: Entry) -> str:
    axes = f"[{','.join(value(axis) for axis in entry['axes'])}]" if "axes" in entry else ""
    parts = [f"{_path(entry)}{axes}: {value(entry['keys'])} keys"]
    if (points := entry["points"]) and "count" not in entry:
        parts.append(f"at frame {'; '.join(f'{value(frame)}: {row(values)}' for frame, *values in points)}")
    elif "frames" in entry:
        parts.append(f"frames {span(entry['frames'])}")
    if not points and (values := entry.get("values")):
        spans = [values] if not isinstance(values[0], list) else values
        parts.append(f"values {', '.join(_from_to(ends) for ends in spans)}")
    if entry.get("every_frame"):
        parts.append("a key on every frame")
    for key in ("interpolation", "modifiers", "extrapolation", "samples"):
        if key in entry:
            parts.append(f"{key} {value(entry[key])}")
    parts += [word.upper() for word in ("muted", "broken") if entry.get(word)]
    return ", ".join(parts)


def _path(entry: Entry) -> str:
    """The property; of folded ones, the first and the last."""
    return titled(entry) if "count" in entry else entry["path"]


def _from_to(ends: Sequence[Any]) -> str:
    return value(ends[0]) if ends[0] == ends[1] else f"{value(ends[0])} to {value(ends[1])}"


def _driver(entry: Entry) -> str:
    axis = f"[{value(entry['axis'])}]" if "axis" in entry else ""
    expression = f" = {entry['expression']}" if "expression" in entry else ""
    variables = "; ".join(
        f"{variable['name']} = {', '.join(variable['targets'])}" for variable in entry.get("variables", ())
    )
    state = "".join(f" {word.upper()}" for word in ("muted", "broken") if entry.get(word))
    inside = f" ({variables})" if variables else ""
    return f"driver {_path(entry)}{axis} {entry['type']}{expression}{inside}{state}"


def _track(entry: Entry) -> str:
    strips = ", ".join(
        f"{strip['name']} frames {span(strip['frames'])} action {strip['action']}"
        + (" MUTED" if strip.get("muted") else "")
        for strip in entry["strips"]
    )
    return f"NLA {entry['name']}{' MUTED' if entry.get('muted') else ''}: {strips}"


def _block(entry: Entry) -> str:
    rest = {key: item for key, item in entry.items() if key not in {"name", "value", "count", "pattern"}}
    return f"key {titled(entry)} {value(entry['value'])}" + (f" {pairs(rest)}" if rest else "")


_WRITERS: dict[str, Callable[[Entry], str]] = {
    "channels": _channel,
    "drivers": _driver,
    "nla": _track,
    "blocks": _block,
}
LISTS = tuple(_WRITERS)  # keys of lists of an animated data-block, which may be long


def counted(entry: Entry) -> Entry:
    """An animated data-block with only the numbers of its channels, drivers, tracks and shape keys."""
    short = {key: item for key, item in entry.items() if key not in LISTS}
    if counts := {_WORDS[key]: len(entry[key]) for key in LISTS if key in entry and key != "channels"}:
        short["counts"] = counts
    return short


_WORDS = {"drivers": "drivers", "nla": "NLA tracks", "blocks": "shape keys"}
