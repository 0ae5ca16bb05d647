"""Physics and animation of a readout in words."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from agents.blender.tools.scene_fold import series
from agents.blender.tools.scene_words import joined, pairs, settings, span, titled, value

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

_TOLD = (
    *("kind", "name", "count", "pattern", "settings", "cache", "caches", "off", "modifier", "surfaces"),
    "names",
)


def physics(entry: Entry) -> str:
    """A part in a simulation: a line, and one for its cache."""
    own = {key: item for key, item in entry.items() if key not in _TOLD}
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
    told = [cache["state"].upper()]
    if cache.get("outdated"):
        told.append("OUTDATED")
    if "range" in cache:
        told.append(f"frames {span(cache['range'])}")
    if "step" in cache:
        told.append(f"step {value(cache['step'])}")
    if "type" in cache:
        told.append(f"cache_type {cache['type']}")
    if cache.get("baked"):
        told.append(f"baked: {', '.join(cache['baked'])}")
    held = cache.get("on_disk")
    if isinstance(held, dict):
        told.append(f"on disk: {_held(cast('dict[str, Any]', held))}")
    elif "frames" in cache:
        where = "in external files" if "external" in cache else "on disk" if held else "in memory"
        told.append(f"holds {value(cache['frames'])} {where}")
    if cache.get("bytes"):
        told.append(_size(cache["bytes"]))
    told += [
        f"{key} {cache[key]}" for key in ("name", "external", "directory", "node", "target") if key in cache
    ]
    return ", ".join(told)


def _held(held: dict[str, Any]) -> str:
    if "first" in held:
        return f"{span((held['first'], held['last']))} ({value(held['frames'])})"
    return ", ".join(f"{part} {_held(one)}" for part, one in held.items())


def by_kind(entries: Sequence[Entry]) -> list[Entry]:
    """What simulates, in few entries: those of one kind and state together, without their settings."""
    groups: dict[str, list[Entry]] = {}
    for entry in entries:
        cache = entry.get("cache", {})
        state = (cache.get("state"), cache.get("outdated"), cache.get("range"), entry.get("type"))
        groups.setdefault(f"{entry['kind']} {state}", []).append(entry)
    told: list[Entry] = []
    for group in groups.values():
        first = group[0]
        kept = {key: first[key] for key in ("kind", "name", "type") if key in first}
        if "cache" in first:
            kept["cache"] = {key: first["cache"][key] for key in _KEPT_OF_CACHE if key in first["cache"]}
        names = series([entry["name"] for entry in group])
        if len(names) > _FEW_NAMES:
            names[_FEW_NAMES:] = [f"… {len(names) - _FEW_NAMES} more"]
        told.append({**kept, "count": len(group), "names": names})
    return told


_KEPT_OF_CACHE = ("state", "outdated", "range")


# Animation


def animation(entry: Entry) -> str:
    """What moves a data-block: its action with channels, its NLA, its drivers, its shape keys."""
    if "actions" in entry:
        return f"- unused actions ({entry['count']}): {', '.join(entry['actions'])}"
    head = f"- {titled(entry)}" + (f" ({entry['of']})" if "of" in entry else "")
    head += "".join(f", {value(count)} {key}" for key, count in entry.get("counts", {}).items())
    lines: list[str] = []
    for key, write in _WRITERS.items():
        lines += [f"  {write(item)}" for item in entry.get(key, ())]
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
    told = [f"{_path(entry)}{axes}: {value(entry['keys'])} keys"]
    if "frames" in entry:
        told.append(f"frames {span(entry['frames'])}")
    if values := entry.get("values"):
        spans = [values] if not isinstance(values[0], list) else values
        told.append(f"values {', '.join(_from_to(ends) for ends in spans)}")
    if entry.get("every_frame"):
        told.append("a key on every frame")
    for key in ("interpolation", "modifiers", "extrapolation", "samples"):
        if key in entry:
            told.append(f"{key} {value(entry[key])}")
    told += [word.upper() for word in ("muted", "broken") if entry.get(word)]
    return ", ".join(told)


def _path(entry: Entry) -> str:
    """The property; of folded ones the first and last."""
    return titled(entry) if "count" in entry else entry["path"]


def _from_to(ends: Sequence[Any]) -> str:
    return value(ends[0]) if ends[0] == ends[1] else f"{value(ends[0])} to {value(ends[1])}"


def _driver(entry: Entry) -> str:
    axis = f"[{value(entry['axis'])}]" if "axis" in entry else ""
    expression = f" = {entry['expression']}" if "expression" in entry else ""
    variables = "; ".join(
        f"{one['name']} = {', '.join(one['targets'])}" for one in entry.get("variables", ())
    )
    state = "".join(f" {word.upper()}" for word in ("muted", "broken") if entry.get(word))
    inside = f" ({variables})" if variables else ""
    return f"driver {_path(entry)}{axis} {entry['type']}{expression}{inside}{state}"


def _track(entry: Entry) -> str:
    strips = ", ".join(
        f"{one['name']} frames {span(one['frames'])} action {one['action']}"
        + (" MUTED" if one.get("muted") else "")
        for one in entry["strips"]
    )
    return f"NLA {entry['name']}{' MUTED' if entry.get('muted') else ''}: {strips}"


def _block(entry: Entry) -> str:
    told = {key: item for key, item in entry.items() if key not in {"name", "value", "count", "pattern"}}
    return f"key {titled(entry)} {value(entry['value'])}" + (f" {pairs(told)}" if told else "")


_WRITERS: dict[str, Callable[[Entry], str]] = {
    "channels": _channel,
    "drivers": _driver,
    "nla": _track,
    "blocks": _block,
}
LISTS = tuple(_WRITERS)  # of an animated data-block, that may be long


def counted(entry: Entry) -> Entry:
    """An animated data-block with the numbers of its channels, drivers, tracks and shape keys alone."""
    told = {key: item for key, item in entry.items() if key not in LISTS}
    if counts := {_WORDS[key]: len(entry[key]) for key in LISTS if key in entry and key != "channels"}:
        told["counts"] = counts
    return told


_WORDS = {"drivers": "drivers", "nla": "NLA tracks", "blocks": "shape keys"}
