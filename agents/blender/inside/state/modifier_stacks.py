# SPDX-License-Identifier: GPL-3.0-or-later
"""Modifier stacks and constraints, in order, with the settings that are not at their defaults."""

from .rna_values import changed_settings, text, to_json

# Their settings are listed with the physics.
_OF_PHYSICS = {"CLOTH", "SOFT_BODY", "COLLISION", "FLUID", "PARTICLE_SYSTEM", "DYNAMIC_PAINT"}
MOST_MODIFIERS = 40
MOST_CONSTRAINTS = 40


def modifiers_of(obj):
    """A stack from first to last: ``name``, ``type``, ``settings``, ``off`` (viewport, render)."""
    entries = []
    for modifier in obj.modifiers:
        if len(entries) == MOST_MODIFIERS:
            entries.append({"name": f"… {len(obj.modifiers) - MOST_MODIFIERS} more", "type": ""})
            break
        entry = {"name": text(modifier.name), "type": modifier.type}
        off = [word for word in ("viewport", "render") if not getattr(modifier, f"show_{word}")]
        if off:
            entry["off"] = off
        settings = {} if modifier.type in _OF_PHYSICS else changed_settings(modifier)
        if modifier.type == "NODES":
            settings = {**_nodes(modifier), **settings}
        if settings:
            entry["settings"] = settings
        entries.append(entry)
    return entries


def _nodes(modifier):
    """The node group, and the inputs that differ from the group's defaults."""
    tree = modifier.node_group
    if tree is None:
        return {"node_group": None}
    settings = {"node_group": text(tree.name)}
    keys = set(modifier.keys())
    for identifier, name, default in _inputs(tree):
        if f"{identifier}_use_attribute" in keys and modifier[f"{identifier}_use_attribute"]:
            settings[name] = f"attribute {text(str(modifier.get(f'{identifier}_attribute_name', '')))}"
        elif identifier in keys:
            value = to_json(modifier[identifier])
            if value != to_json(default):
                settings[name] = value
        if len(settings) > 24:
            settings["…"] = "further inputs"
            break
    return settings


def _inputs(tree):
    """(identifier, name, default) of a group's inputs that have a value."""
    interface = getattr(tree, "interface", None)
    items = tree.inputs if interface is None else interface.items_tree
    for item in items:
        if interface is not None and (item.item_type != "SOCKET" or item.in_out != "INPUT"):
            continue
        if hasattr(item, "default_value"):
            yield item.identifier, text(item.name), item.default_value


def constraints_of(obj):
    """Constraints of an object and of its bones: ``name``, ``type``, ``bone``, ``settings``, ``off``."""
    entries = [_constraint(constraint) for constraint in obj.constraints]
    if obj.pose is not None:
        for bone in obj.pose.bones:
            for constraint in bone.constraints:
                entries.append({"bone": text(bone.name), **_constraint(constraint)})
    if len(entries) > MOST_CONSTRAINTS:
        left = len(entries) - MOST_CONSTRAINTS
        entries[MOST_CONSTRAINTS:] = [{"name": f"… {left} more", "type": ""}]
    return entries


def _constraint(constraint):
    entry = {"name": text(constraint.name), "type": constraint.type}
    settings = changed_settings(constraint)
    targets = getattr(constraint, "targets", None)
    if targets:
        settings["targets"] = [text(target.target.name) if target.target else None for target in targets][:16]
    if constraint.mute or not getattr(constraint, "enabled", True):
        entry["off"] = True
    # Only set by evaluation, so it says nothing about a constraint that is off.
    elif not constraint.is_valid:
        entry["invalid"] = True
    if settings:
        entry["settings"] = settings
    return entry
