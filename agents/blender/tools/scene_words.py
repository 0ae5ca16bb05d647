"""The facts of a readout as compact lines for a model, in Blender's terms."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from agents.blender.tools.scene_fold import Range

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from agents.blender.tools.scene_fold import Entry

_PLAIN_ROOT = frozenset(
    {"name", "type", "in", "location", "rotation", "scale", "tags", "count", "pattern", "parent"}
)
ROOT = "is_object_root"
_NEW_VIEWPORT = [0.8, 0.8, 0.8, 1]  # colour of a new material
_FEW = 8  # items of a list in a readout that is not full


def value(fact: Any) -> str:
    """A fact as Python writes it; a range as ``from…to``."""
    if fact is None or isinstance(fact, (bool, int, float, str)):
        return str(fact)
    if isinstance(fact, list):
        return f"({', '.join(value(item) for item in cast('list[Any]', fact))})"
    table = cast("dict[str, Any]", fact)
    if isinstance(table, Range):
        return f"{value(table['from'])}…{value(table['to'])}"
    return f"{{{pairs(table)}}}"


def pairs(table: dict[str, Any]) -> str:
    """``key=value, …``."""
    return ", ".join(f"{key}={value(item)}" for key, item in table.items())


def row(numbers: Iterable[Any]) -> str:
    """Numbers side by side: ``0 0 1.5``."""
    return " ".join(value(number) for number in numbers)


def span(ends: Sequence[Any]) -> str:
    """First and last: ``1–250``."""
    first, last = ends
    return value(first) if first == last else f"{value(first)}–{value(last)}"


def titled(entry: Entry, word: str = "") -> str:
    """An entry's name, the number of objects it stands for, and ``word`` after them."""
    count = f" ({entry['count']})" if "count" in entry else ""
    return f"{entry['name']}{count} {word}".rstrip()


def _tags(entry: Entry) -> list[str]:
    return [f"{key}={value(item)}" for key, item in entry.get("tags", {}).items()]


def joined(head: str, parts: Iterable[str]) -> str:
    """A line of ``head`` and the parts that are not empty."""
    return "; ".join([head, *filter(None, parts)])


# The scene


def scene(facts: dict[str, Any]) -> str:
    """The first lines: file, frames, render engine, number of objects, likely mistakes."""
    info, frame, units = facts["scene"], facts["scene"]["frame"], facts["scene"]["units"]
    lines = [
        joined(f'# Scene "{info["name"]}"', [info["file"], f"Blender {info['blender']}", *_tags(info)]),
        joined(
            f"frame {frame['current']} of {frame['start']}–{frame['end']} at {frame['fps']} fps",
            [
                f"frame_step {frame['step']}" if frame["step"] != 1 else "",
                f"preview range {span(frame['preview'])}" if "preview" in frame else "",
                f"gravity {row(info['gravity'])}" if info["gravity"] is not None else "gravity off",
                _unit(units),
            ],
        ),
        joined(
            f"{info['engine']} {info['samples']} samples" if "samples" in info else info["engine"],
            [
                f"{info['resolution'][0]}×{info['resolution'][1]}"
                + (f" at {info['resolution'][2]}%" if info["resolution"][2] != 100 else ""),
                f"camera {info['camera']}" if info["camera"] else "no active camera",
            ],
        ),
        joined(
            f"{sum(info['counts'].values())} objects: {_counts(info['counts'])}"
            if info["counts"]
            else "no objects",
            [
                f"{info['outside']} more in the file, in no scene" if "outside" in info else "",
                f"other scenes: {', '.join(info['other_scenes'])}" if "other_scenes" in info else "",
                f"view layer {info['view_layer']}" if "view_layer" in info else "",
            ],
        ),
    ]
    if "markers" in info:
        lines.append("markers: " + ", ".join(info["markers"]))
    if "libraries" in info:
        lines.append("libraries: " + ", ".join(info["libraries"]))
    lines += [f"! {note}" for note in facts["notes"]]
    return "\n".join(lines)


def _unit(units: dict[str, Any]) -> str:
    if units["scale_length"] == 1:
        return "lengths in m"
    return f"1 unit = {value(units['scale_length'])} m, lengths here are in units"


def _counts(counts: dict[str, Any]) -> str:
    return ", ".join(f"{value(count)} {kind}" for kind, count in counts.items())


# Collections and objects


def collection(entry: Entry, *, names: bool) -> str:
    """A collection: a line of the tree."""
    indent = "  " * entry["depth"]
    if "again" in entry or "cut" in entry:
        return f"{indent}- {titled(entry)} ({'see above' if 'again' in entry else 'and what is below it'})"
    objects = entry.get("objects", {})
    inside = _counts(objects)
    if names and entry.get("names"):
        listed = entry["names"]
        inside += f": {', '.join(listed[:_FEW])}" + (
            f" and {len(listed) - _FEW} more" if len(listed) > _FEW else ""
        )
    return joined(
        f"{indent}- {titled(entry)}",
        [
            inside,
            ", ".join(_tags(entry)),
            f"hidden: {', '.join(entry['hidden'])}" if "hidden" in entry else "",
            f"linked from {entry['linked']}" if "linked" in entry else "",
        ],
    )


def scene_object(entry: Entry) -> str:
    """An object: a line, and one for each modifier and constraint; a root with nothing of its own in short."""
    if _PLAIN_ROOT.issuperset(entry) and entry["type"] == "EMPTY" and ROOT in entry.get("tags", {}):
        return "; ".join([f"- {titled(entry)} root of {', '.join(entry['in'])}", *_placement(entry)])
    head = f"- {titled(entry, entry['type'])} in {', '.join(entry['in'])}"
    lines = [joined(head, [*_placement(entry), *_properties(entry), *_tags(entry)])]
    if "parts" in entry:
        lines.append(f"  parts (size @ middle of underside, own axes): {_parts(entry)}")
    lines += [f"  modifier {_modifier(modifier)}" for modifier in entry.get("modifiers", ())]
    lines += [f"  constraint {_constraint(constraint)}" for constraint in entry.get("constraints", ())]
    return "\n".join(lines)


def _parts(entry: Entry) -> str:
    shown = [f"{'×'.join(map(value, size))} @ {row(place)}" for size, place in entry["parts"]]
    more = [f"{value(entry['more_parts'])} smaller ones"] if "more_parts" in entry else []
    return ", ".join([*shown, *more])


def _placement(entry: Entry) -> list[str]:
    info = [f"at {row(entry['location'])}"]
    if "parent" in entry:
        kind = f" ({entry['parent_type']})" if "parent_type" in entry else ""
        info.insert(0, f"parent {entry['parent']}{kind}")
    if (turn := entry.get("rotation", [0, 0, 0])) != [0, 0, 0]:
        info.append(f"rotation {row(turn)}°")
    if (scale := entry.get("scale", [1, 1, 1])) != [1, 1, 1]:
        info.append(f"scale {row(scale)}")
    if box := entry.get("extent"):
        about = "about " if box.get("rough") else ""
        size = "×".join(value(length) for length in box["size"])
        word = "each" if "count" in entry else "size"
        info.append(f"spans {about}({row(box['min'])}) to ({row(box['max'])}), {word} {size}")
    return info


def _properties(entry: Entry) -> list[str]:
    return [write(entry[key]) for key, write in _PROPERTIES.items() if key in entry]


_PROPERTIES: dict[str, Callable[[Any], str]] = {
    "vertices": lambda count: f"{value(count)} vertices",
    "evaluated_vertices": lambda count: f"{value(count)} evaluated",
    "faces": lambda count: f"{value(count)} faces",
    "bones": lambda count: f"{value(count)} bones",
    "splines": lambda count: f"{value(count)} splines",
    "instances": lambda count: f"{value(count)} instances",
    "instancing": lambda what: f"instances {what}",
    "shape_keys": lambda count: f"{value(count)} shape keys",
    "materials": lambda names: f"material {', '.join(str(name) for name in names)}",
    "shares": lambda data: f"shares data {data}",
    "data": lambda data: f"data {data}",
    "vertex_groups": lambda groups: (
        f"vertex groups {', '.join(groups) if isinstance(groups, list) else value(groups)}"
    ),
    "uv_layers": lambda names: f"UV {', '.join(names) or 'none'}",
    "text": lambda body: f'text "{body}"',
    "rotation_mode": lambda mode: f"rotation_mode {mode}",
    "display_type": lambda kind: f"display_type {kind}",
    "pass_index": lambda number: f"pass_index {value(number)}",
    "delta": lambda numbers: f"delta {row(numbers)}",
    "locked": lambda names: f"locked {', '.join(names)}",
    "hidden": lambda where: f"hidden: {', '.join(where)}",
    "linked": lambda path: f"linked from {path}",
    "overrides": lambda name: f"library override of {name}",
    "custom": lambda table: f"custom {pairs(table)}",
}


def _modifier(entry: Entry) -> str:
    off = f" off in {' and '.join(entry['off'])}" if "off" in entry else ""
    return f"{entry['name']} {entry['type']}{off}{settings(entry)}".rstrip()


def _constraint(entry: Entry) -> str:
    bone = f" on bone {entry['bone']}" if "bone" in entry else ""
    state = " off" if entry.get("off") else " INVALID" if entry.get("invalid") else ""
    return f"{entry['name']} {entry['type']}{bone}{state}{settings(entry)}".rstrip()


def settings(entry: Entry) -> str:
    """``: key=value, …`` if the entry has settings."""
    table = entry.get("settings")
    return f": {pairs(table)}" if table else ""


# Materials and the view


def material(entry: Entry) -> str:
    """A material: a line, and one for each node of a full readout."""
    return _with_nodes(
        f"- {titled(entry)}", entry, [f"{value(entry['users'])} users", *_shaders(entry), *_rest(entry)]
    )


def _rest(entry: Entry) -> Iterable[str]:
    if entry["viewport"] != _NEW_VIEWPORT:
        unseen = " (unused: previews show the nodes' colour)" if "nodes" in entry else ""
        yield f"viewport {row(entry['viewport'])}{unseen}"
    if "surface_render_method" in entry:
        yield entry["surface_render_method"]
    if "linked" in entry:
        yield f"linked from {entry['linked']}"
    if "settings" in entry:
        yield pairs(entry["settings"])


def _shaders(entry: Entry) -> Iterable[str]:
    for part in ("surface", "volume", "displacement"):
        if part not in entry:
            continue
        node = entry[part]
        if node is None:
            yield "nothing linked to its output"
        else:
            name = "" if part == "surface" else f"{part} "
            yield f"{name}{_shader(node)}"
            yield from (f"{mixed['name']} = {_shader(mixed)}" for mixed in node.get("mixed", ()))


def _shader(node: Entry) -> str:
    return node["shader"] + (f" {pairs(node['inputs'])}" if "inputs" in node else "")


def _with_nodes(head: str, entry: Entry, parts: Iterable[str]) -> str:
    lines = [joined(head, parts)]
    for node in entry.get("tree", ()):
        name = "" if node["name"] == node["shader"] else f" ({node['shader']})"
        inputs = f": {pairs(node['inputs'])}" if "inputs" in node else ""
        own = f" [{pairs(node['settings'])}]" if "settings" in node else ""
        lines.append(f"  node {node['name']}{name}{own}{inputs}" + (" MUTED" if node.get("muted") else ""))
    return "\n".join(lines)


def view(entry: Entry) -> str:
    """A camera, a light, the world, or the render settings."""
    kind = entry["kind"]
    if kind == "world":
        plain = f"color={value(entry['color'])}" if "color" in entry else ""
        return _with_nodes(f"- world {titled(entry)}", entry, [plain, *_shaders(entry)])
    skipped = {
        "kind",
        "name",
        "count",
        "pattern",
        "settings",
        "active",
        "location",
        "direction",
        "settings_left_out",
    }
    own = {key: item for key, item in entry.items() if key not in skipped}
    left = entry.get("settings_left_out")
    return joined(
        f"- {kind} {titled(entry)}" + (" (active)" if entry.get("active") else ""),
        [
            f"at {row(entry['location'])}" if "location" in entry else "",
            f"looking {row(entry['direction'])}" if "direction" in entry else "",
            pairs(own),
            pairs(entry["settings"]) if "settings" in entry else "",
            f"{left} more settings: detail='full'" if left else "",
        ],
    )
