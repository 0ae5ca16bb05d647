# SPDX-License-Identifier: GPL-3.0-or-later
"""Which settings of a view layer show the sockets of the node that reads its passes."""

from .instances.assigning import put

ENGINE = "engine"
TREE = "compositing_node_group"  # of a scene; 5.0 tells the passes of no other
# Not listed by RNA where they are add-ons; those that a Blender lacks refuse to be set.
ENGINES = ("BLENDER_EEVEE", "BLENDER_EEVEE_NEXT", "CYCLES", "BLENDER_WORKBENCH")
PARTS = ("eevee", "cycles")


def reads_passes(node):
    """Whether a node shows what a layer of a scene gives."""
    return getattr(node, "scene", None) is not None and hasattr(node, "layer")


def settings(layer):
    """(path from a view layer, what has it, name) of what decides its passes."""
    for prefix, struct in (("", layer), *((f"{part}.", getattr(layer, part, None)) for part in PARTS)):
        for prop in struct.bl_rna.properties if struct else ():
            if prop.type == "BOOLEAN" and "pass" in prop.identifier and not prop.is_readonly:
                yield f"{prefix}{prop.identifier}", struct, prop.identifier


def conditions(node, look):
    """Socket → what shows it, of those that a new layer does not show in every engine.

    ``look`` is given what is on, as a text, and returns the sockets that the node shows then.
    """
    scene, layer = node.scene, node.scene.view_layers[node.layer]
    before = scene.render.engine
    put(scene, TREE, node.id_data)
    usual, shown = {}, {}
    for engine in (name for name in ENGINES if put(scene.render, ENGINE, name)):
        usual[engine] = set(look(f"engine={engine}"))
        for path, struct, name in settings(layer):
            was = getattr(struct, name)
            if not was and put(struct, name, True):
                layer.update()
                for key in set(look(f"engine={engine},{path}")) - usual[engine]:
                    shown.setdefault(key, {}).setdefault(f"view_layer.{path}=True", []).append(engine)
            put(struct, name, was)
    put(scene.render, ENGINE, before)
    put(scene, TREE, None)
    for key in set().union(*usual.values()):
        engines = [engine for engine, keys in usual.items() if key in keys]
        if len(engines) < len(usual):
            shown[key] = {"": engines}
    return {
        key: ", or ".join(dict.fromkeys(said(setting, engines, usual) for setting, engines in found.items()))
        for key, found in shown.items()
    }


def said(setting, engines, all_):
    """A condition as a text: with the engines that need it to be of use, where that is not all of them."""
    engine = f"scene.render.engine={'|'.join(engines)}" if len(engines) < len(all_) else ""
    return " and ".join(filter(None, (setting, engine)))
