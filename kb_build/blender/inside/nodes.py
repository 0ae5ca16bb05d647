# SPDX-License-Identifier: GPL-3.0-or-later
"""Node sockets: RNA does not describe them, so every node is made once and asked.

Sockets that a node shows only in some of its modes (``ShaderNodeMix.data_type``) carry those modes; those that a mode
gives another type or another name (``GeometryNodeSwitch.input_type``) carry what decides it, and the names.
"""

import itertools
import math

import bpy

from . import passes
from .classes.rna import read_items
from .instances.assigning import put, refused_items
from .wire import limit, plain

MOST_STATES = 1_000
MOST_CONDITIONS = 3
TREES = ("ShaderNodeTree", "GeometryNodeTree", "CompositorNodeTree", "TextureNodeTree")


def choices_of(give):
    """The choices of what ``give`` gives a wrong one to: where RNA has none to list, Blender names them in refusing."""
    try:
        give("\x01")
    except TypeError as refusal:
        return refused_items(refusal)
    return []


def menu_items(socket):
    """A menu socket's choices."""
    names = choices_of(lambda name: setattr(socket, "default_value", name))
    return [{"identifier": name} for name in names]


def write_choices(write):
    """What takes a type of node trees: RNA lists a stand-in."""
    kinds = choices_of(lambda name: bpy.data.node_groups.new("scratch", name))
    items = [{"identifier": name} for name in kinds]
    write("choices", path="bpy.types.BlendDataNodeTrees.new", parameter="type", items=items)


def available(socket):
    """Whether a socket can be seen in the node's present mode."""
    return socket.enabled and not getattr(socket, "is_unavailable", False)


def describe(socket):
    """One socket in the terms of ``records.Symbol``."""
    row = {"label": socket.name, "type": socket.type.lower(), "target": socket.bl_idname}
    row["description"] = getattr(socket, "description", "")
    prop = socket.bl_rna.properties.get("default_value")
    if prop is None or not hasattr(socket, "default_value"):
        return row
    if prop.type not in {"POINTER", "COLLECTION"}:
        row["default"] = plain(socket.default_value)
    else:
        row["target"] = prop.fixed_type.identifier
    if prop.type in {"INT", "FLOAT"}:
        # The soft range follows the declaration of this very socket; RNA's class-wide one says nothing.
        row["subtype"] = prop.subtype if prop.subtype != "NONE" else ""
        row["hard_min"], row["hard_max"] = limit(prop.hard_min), limit(prop.hard_max)
        row["soft_min"], row["soft_max"] = limit(prop.soft_min), limit(prop.soft_max)
    if socket.type == "MENU":
        row["enum_items"] = menu_items(socket)
    return row


def sides(node):
    """A node's two socket collections."""
    return {"inputs": node.inputs, "outputs": node.outputs}


def mode_enums(node):
    """The enum properties that belong to the node's own class and have more than one value."""
    inherited = set(bpy.types.Node.bl_rna.properties.keys())
    for prop in node.bl_rna.properties:
        if (
            prop.type == "ENUM"
            and prop.identifier not in inherited
            and not prop.is_readonly
            and not prop.is_enum_flag
        ):
            values = [row["identifier"] for row in read_items(prop.enum_items_static)]
            if len(values) > 1 and getattr(node, prop.identifier) in values:
                yield prop.identifier, values


def taken(node, name, values):
    """The values that a node takes of one of its properties; RNA may list those of all nodes."""
    before = getattr(node, name)
    found = [value for value in values if put(node, name, value)]
    put(node, name, before)
    return found


def covering(shown, states):
    """The fewest groups of states, each all combinations of some values, that are those in which a socket is shown."""
    boxes, left = [], set(shown)
    while left:
        box = [{value} for value in min(left)]
        for place in range(len(box)):
            for value in sorted({state[place] for state in states} - box[place]):
                wider = [{value} if number == place else values for number, values in enumerate(box)]
                inside = [state for state in itertools.product(*wider) if state in states]
                if inside and shown.issuperset(inside):
                    box[place].add(value)
        boxes.append(box)
        left -= set(itertools.product(*box))
    within = [states & set(itertools.product(*box)) for box in boxes]
    for number in reversed(range(len(boxes))):
        if len(boxes) > 1 and within[number] <= set().union(*(within[:number] + within[number + 1 :])):
            del boxes[number], within[number]
    return boxes


def said(box, enums, states):
    """A group of states as modes, without the properties of which it has all values."""
    return [
        f"{name}={'|'.join(value for value in values if value in kept)}"
        for place, ((name, values), kept) in enumerate(zip(enums, box, strict=True))
        if kept != {state[place] for state in states}
    ]


def found(sockets, spelling):
    """The socket that a subscript gives, as its pointer; 0 for none."""
    try:
        return sockets[spelling].as_pointer()
    except (KeyError, IndexError):
        return 0


class Sockets:
    """A node's sockets in all its modes: what they are, when they are shown, and which subscripts give them.

    ``nodes`` are of one class, one in each type of tree: which modes there are depends on it.
    """

    def __init__(self, nodes):
        self.nodes = nodes
        self.rows = {}
        # key → (states in which it exists, …is shown, …its name gives it, …its identifier does) and its places
        self.seen = {}
        self.places = {}
        # key → the names it has, the usual one first
        self.names = {}
        for node in nodes:
            self.look(node, "")
        # key → the properties that decide its type
        self.deciding = {}
        # Those that a new node does not show, or does not have.
        new = {key for key, (_, shown, _, _) in self.seen.items() if shown}
        self.modes = self.vary()
        self.vary_pairs()
        # key → when it is shown, where that is more than one condition for each property, or none of the node's
        self.conditions = self.checked()
        # Those of passes stand where the others that are shown leave room.
        self.placeless = {}
        if passes.reads_passes(nodes[0]):
            self.placeless = passes.conditions(nodes[0], lambda state: self.look(nodes[0], state))
        self.conditions |= self.placeless
        self.hidden = self.rows.keys() - new

    def look(self, node, mode):
        """Reads the sockets in the node's present mode. Returns those that it shows: key → type."""
        shown = {}
        state = (node.id_data.bl_idname, mode)
        for side, sockets in sides(node).items():
            for place, socket in enumerate(sockets):
                key = (side, socket.identifier)
                if key not in self.rows:
                    self.rows[key] = describe(socket)
                    self.seen[key] = (set(), set(), set(), set())
                    self.places[key] = set()
                    self.names[key] = {}
                self.names[key][socket.name] = None
                states = self.seen[key]
                pointer = socket.as_pointer()
                states[0].add(state)
                self.places[key].add(place)
                if available(socket):
                    shown[key] = socket.bl_idname
                    states[1].add(state)
                if socket.name == self.rows[key]["label"] and found(sockets, socket.name) == pointer:
                    states[2].add(state)
                if found(sockets, socket.identifier) == pointer:
                    states[3].add(state)
        return shown

    def vary(self):
        """Sets every mode in turn; returns key → the modes that show the socket."""
        modes = {}
        for name, values in mode_enums(self.nodes[0]):
            shown, types = {}, {}
            for node in self.nodes:
                before = getattr(node, name)
                for value in values:
                    if put(node, name, value):
                        for key, kind in self.look(node, f"{name}={value}").items():
                            shown.setdefault(key, set()).add(value)
                            types.setdefault(key, set()).add(kind)
                put(node, name, before)
            for key in [key for key in types if len(types[key]) > 1]:
                self.deciding.setdefault(key, []).append(name)
            tried = set().union(*shown.values())
            for key in self.rows:
                if key in shown and shown[key] != tried:
                    kept = [value for value in values if value in shown[key]]
                    modes.setdefault(key, []).append(f"{name}={'|'.join(kept)}")
        return modes

    def vary_pairs(self):
        """Looks for sockets that no mode shows by itself in the modes of two properties at once."""
        node = self.nodes[0]
        enums = list(mode_enums(node))
        if len(enums) < 2 or not self.may_show_more():
            return
        for (first, values), (second, others) in itertools.combinations(enums, 2):
            before = getattr(node, first), getattr(node, second)
            for value, other in itertools.product(values, others):
                if put(node, first, value) and put(node, second, other):
                    known = {key for key, (_, shown, _, _) in self.seen.items() if shown}
                    for key in self.look(node, f"{first}={value},{second}={other}").keys() - known:
                        self.modes[key] = [f"{first}={value}", f"{second}={other}"]
            put(node, first, before[0])
            put(node, second, before[1])

    def may_show_more(self):
        """Whether there are sockets that no mode shows, or that a mode makes."""
        states = set().union(*(present for present, *_ in self.seen.values()))
        return any(not shown or present != states for present, shown, *_ in self.seen.values())

    def checked(self):
        """Sets all modes together, and corrects what does not hold; returns the conditions that modes cannot say."""
        node = self.nodes[0]
        enums = [(name, taken(node, name, values)) for name, values in mode_enums(node) if self.decides(name)]
        if len(enums) < 2 or math.prod(len(values) for _, values in enums) > MOST_STATES:
            return {}
        before = [(name, getattr(node, name)) for name, _ in enums]
        seen, told = {}, {}
        for state in itertools.product(*(values for _, values in enums)):
            if all(put(node, name, value) for (name, _), value in zip(enums, state, strict=True)):
                seen[state] = {
                    (side, socket.identifier)
                    for side, sockets in sides(node).items()
                    for socket in sockets
                    if available(socket)
                }
        for name, value in before:
            put(node, name, value)
        for key in self.rows:
            shown = {state for state, keys in seen.items() if key in keys}
            boxes = covering(shown, seen.keys())
            if len(boxes) == 1:
                self.modes[key] = said(boxes[0], enums, seen.keys())
            elif boxes:
                self.modes.pop(key, None)
                texts = [" and ".join(said(box, enums, seen.keys())) for box in boxes]
                told[key] = (
                    ", or ".join(texts) if len(texts) <= MOST_CONDITIONS else "some of its modes say so"
                )
        return told

    def decides(self, name):
        """Whether a property of the node decides which sockets are shown."""
        return any(mode.partition("=")[0] == name for modes in self.modes.values() for mode in modes)

    def subscripts(self, key):
        """(subscripts that always give a socket, the best first; whether its name does whenever it is shown)."""
        side, identifier = key
        present, shown, by_name, by_identifier = self.seen[key]
        name = self.rows[key]["label"]
        texts = [f'{side}["{name}"]'] if name and by_name == present else []
        if by_identifier == present and identifier != name:
            texts.append(f'{side}["{identifier}"]')
        if len(self.places[key]) == 1 and key not in self.placeless:
            texts.append(f"{side}[{next(iter(self.places[key]))}]")
        return texts, by_name != present and bool(shown) and shown <= by_name

    def of_identifier(self, key):
        """What a socket's identifier does as a subscript where it does not always give the socket, as flags."""
        present, shown, _, by_identifier = self.seen[key]
        if not shown or by_identifier == present:
            return []
        if not by_identifier:
            return ["identifier-never"]
        return ["identifier-when-shown"] if by_identifier == shown else []


def make(trees, identifier):
    """Tree type → the new node, for each that takes it."""
    nodes = {}
    for name, tree in trees.items():
        try:
            node = tree.nodes.new(identifier)
        except RuntimeError:
            continue
        nodes[name] = node
    return nodes


def remove(nodes):
    """Removes nodes from their trees."""
    for node in nodes:
        if node is not None:
            node.id_data.nodes.remove(node)


def write_node(write, owner, nodes, former, alone=None):
    """The sockets of a node (see Sockets). ``former``: side → names that its sockets had in other Blenders.

    ``alone`` are (side, identifier) of those that it had before it was paired; None if it is not.
    """
    sockets = Sockets(nodes)
    node = nodes[0]
    named, paths = set(), {}
    for key, row in sockets.rows.items():
        side, identifier = key
        spelling = row["label"] if row["label"] and (side, row["label"]) not in named else identifier
        if (side, spelling) in named:
            continue
        named.add((side, spelling))
        paths[key] = f'{owner}.{side}["{spelling}"]'
        subscripts, while_shown = sockets.subscripts(key)
        flags = [f"identifier:{identifier}"]
        flags += ["hidden-by-default"] if key in sockets.hidden else []
        flags += ["name-when-shown"] if while_shown else []
        flags += sockets.of_identifier(key)
        flags += [f"also-named:{name}" for name in sockets.names[key] if name not in {"", row["label"]}]
        flags += ["when-paired"] if alone is not None and key not in alone else []
        flags += [f"shown-when:{sockets.conditions[key]}"] if key in sockets.conditions else []
        flags += [f"type-by:{name}" for name in sockets.deciding.get(key, ())]
        write(
            "symbol",
            path=paths[key],
            kind="socket",
            owner=owner,
            flags=flags,
            modes=sockets.modes.get(key, []),
            subscripts=subscripts,
            **row,
        )
    for side, names in former.items():
        pointers = {socket.as_pointer(): socket.identifier for socket in sides(node)[side]}
        for name in names:
            identifier = pointers.get(found(sides(node)[side], name))
            if (side, name) not in named and (side, identifier) in paths:
                write("still_works", path=f'{owner}.{side}["{name}"]', taken_as=paths[side, identifier])


def paired(node, tree):
    """Gives the first node of a zone its last one, which decides its sockets; returns that, or None."""
    unfinished = "Closure" in node.bl_idname and bpy.app.version < (5, 0)  # they crash Blender 4.5
    if unfinished or not hasattr(node, "pair_with_output"):
        return None
    try:
        end = tree.nodes.new(node.bl_idname.replace("Input", "Output"))
    except RuntimeError:
        return None
    node.pair_with_output(end)
    return end


def is_called_after(identifier, tree):
    """Whether a class of nodes has the name of a type of trees: ``GeometryNodeRepeatInput``."""
    return identifier.startswith(tree.bl_idname.removesuffix("Tree"))


def compositing_scene():
    """A scratch scene with a compositor tree of its own: before Blender 5.0 some nodes go nowhere else."""
    if "node_tree" not in bpy.types.Scene.bl_rna.properties:
        return None
    scene = bpy.data.scenes.new("scratch")
    scene.use_nodes = True
    return scene


def write_former_classes(write, trees, names):
    """The node classes of other Blenders that this one still makes, under their new names."""
    for identifier in names:
        nodes = make(trees, identifier).values()
        for made in {node.bl_idname for node in nodes} - {identifier}:
            write("still_works", path=f"bpy.types.{identifier}", taken_as=f"bpy.types.{made}")
        remove(nodes)


def write_all(write, structs, observer, former):
    """The sockets of every node class that one of the built-in tree types takes; ``observer`` reads the nodes.

    ``former``: node class → side → names of sockets that other Blenders had.
    """
    trees = {}
    for name in TREES:
        try:
            trees[name] = bpy.data.node_groups.new("scratch", name)
        except TypeError:
            continue
    write_choices(write)
    scene = compositing_scene()
    for identifier in sorted(structs):
        cls = getattr(bpy.types, identifier, None)
        if cls is None or not issubclass(cls, bpy.types.Node) or cls is bpy.types.Node:
            continue
        nodes = make(trees, identifier)
        if not nodes and scene is not None:
            nodes = make({"CompositorNodeTree": scene.node_tree}, identifier)  # pyright: ignore[reportAttributeAccessIssue]
            for node in filter(passes.reads_passes, nodes.values()):
                node.scene = scene  # not the file's, whose passes change nothing in this tree
        if not nodes:
            continue
        owner = f"bpy.types.{identifier}"
        # What a new one has may depend on the tree: it is what it has in the tree that it is called after.
        node, *others = sorted(nodes.values(), key=lambda one: not is_called_after(identifier, one.id_data))
        alone = {(side, socket.identifier) for side, sockets in sides(node).items() for socket in sockets}
        end = paired(node, node.id_data)
        observer.look(identifier, node, place=f" in a {node.id_data.bl_idname}" if others else "")
        for other in others:
            observer.ask(other, f"{identifier} in a {other.id_data.bl_idname}", "")
        write("node", path=owner, trees=list(nodes), type=node.type)
        write_node(write, owner, [node, *others], former.get(identifier, {}), alone if end else None)
        remove((*nodes.values(), end))
    write_former_classes(write, trees, [name for name in former if name not in structs])
    for tree in trees.values():
        bpy.data.node_groups.remove(tree)
    if scene is not None:
        bpy.data.scenes.remove(scene)
