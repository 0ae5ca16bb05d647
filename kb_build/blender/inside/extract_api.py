# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the whole API of this Blender as JSON Lines.

The first line names the Blender, the last one counts the lines before it: a file without it is incomplete.
A step that fails is a ``fault`` line with its traceback; the other steps still run.
"""

import gc
import json
import os
import re
import sys
import tempfile
import traceback

import bpy

from . import nodes
from .apart import Beside, can_work_apart
from .bpy_ops import addon_names, left_out, operators
from .classes import context, given_nothing, own_classes, rna, source_items
from .instances import context_modes, new_things, own_names, pointer_fillers, startup
from .instances.neighbours import Neighbours
from .instances.observer import Observer
from .outside_rna import crashing_calls, handed_on, modules, returning_none, texts_taken, windowless
from .preconditions import operator_needs, reached_modes, undo_steps
from .tried import accepted, crashes, evaluated, idle, limits, refusals
from .wire import Writer

INVERTED = re.compile(r"\.prop\(\w+, ['\"](\w+)['\"][^()\n]*invert_checkbox=True")


def text(value):
    """Blender gives its build facts as bytes."""
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def write_enum_sets(write, _found):
    """The enumerations that several properties share, under the names the reference gives them."""
    import _bpy

    for name, items in getattr(_bpy, "rna_enum_items_static", dict)().items():
        write("symbol", path=name, kind="enum", owner="bpy.types", enum_items=rna.read_items(items))


def write_manual_links(write, _found):
    """Blender's own table: a pattern over RNA ids and the manual page that explains them."""
    try:
        import _rna_manual_reference as table
    except ImportError:
        import rna_manual_reference as table
    for pattern, page in table.url_manual_mapping:
        write("manual", pattern=pattern, page=page)


def write_inverted(write, found):
    """The switches that some panel shows the other way round: what the manual says of them may be meant of that."""
    names = set()
    for folder in bpy.utils.script_paths(subdir=os.path.join("startup", "bl_ui")):
        for file in sorted(os.listdir(folder)):
            if file.endswith(".py"):
                with open(os.path.join(folder, file), encoding="utf-8") as script:
                    names.update(INVERTED.findall(script.read()))
    for _, struct in sorted(found["structs"].items()):
        for prop in rna.own(struct, "properties"):
            if prop.type == "BOOLEAN" and prop.identifier in names:
                write("inverted", path=rna.path_of(struct, prop.identifier))


def write_templates(write, _found):
    """The example scripts that Blender ships."""
    for folder in bpy.utils.script_paths(subdir="templates_py"):
        for name in sorted(os.listdir(folder)):
            if name.endswith(".py"):
                with open(os.path.join(folder, name), encoding="utf-8") as file:
                    write("template", name=name[:-3], text=file.read())


def write_rna(write, found):
    """RNA classes; later steps look at the same ones."""
    found["structs"] = rna.write_all(write, modules.write_member)


def start_beside(_write, found):
    """Begins with what takes longest, and needs nothing of the other steps."""
    if can_work_apart():
        observer, skipped = found["observer"], found["skipped"]

        def tried(write):
            refusals.find_all(write, observer)
            limits.find_all(write, observer)
            left_out.find_all(write)
            undo_steps.find_all(write)
            reached_modes.find_all(write)
            windowless.find_all(write)
            crashing_calls.find_all(write)
            accepted.find_all(write, observer)

        found["refusals"] = Beside("refusals", tried)
        found["crashes"] = Beside("crashes", lambda write: crashes.find_all(write, observer))
        found["addons"] = Beside("addons", addon_names.write_all)
        found["idle"] = Beside("idle", idle.find_all)
        found["needs"] = Beside("needs", lambda write: operator_needs.find_alone(write, skipped))


def write_begun(write, found):
    """What was begun there."""
    for step in ("refusals", "crashes", "addons", "idle"):
        if step in found:
            found[step].into(write)


STEPS = (
    ("start beside", start_beside),
    ("classes", write_rna),
    ("given nothing", lambda write, found: given_nothing.find_all(write, found["structs"])),
    ("operators", lambda write, _found: operators.write_all(write)),
    ("names", lambda _write, found: own_names.look_at_start(found["observer"])),
    ("present", lambda write, found: startup.write_present(write, found["observer"])),
    ("start", lambda _write, found: startup.look_at_start(found["observer"])),
    (
        "nodes",
        lambda write, found: nodes.write_all(write, found["structs"], found["observer"], found["former"]),
    ),
    ("places of nodes", lambda write, _found: own_names.write_places(write)),
    ("modules", lambda write, _found: modules.write_all(write)),
    ("returning none", lambda write, _found: returning_none.find_all(write)),
    ("texts taken", lambda write, found: texts_taken.find_all(write, found["structs"])),
    ("handed on", lambda write, found: handed_on.find_all(write, found["structs"])),
    ("own classes", lambda write, found: own_classes.find_all(write, found["structs"])),
    ("enums", write_enum_sets),
    ("links", write_manual_links),
    ("inverted", write_inverted),
    ("templates", write_templates),
    # Last, because they change the scene.
    ("context", lambda write, _found: context.write_all(write)),
    (
        "new things",
        lambda write, found: new_things.write_all(
            write, found["observer"], found["neighbours"], found["skipped"]
        ),
    ),
    ("pointers", lambda write, found: pointer_fillers.find_all(write, found["observer"], found["skipped"])),
    ("evaluated", lambda write, found: evaluated.find_all(write, found["skipped"])),
    ("own names", lambda write, found: own_names.find_all(write, found["observer"], found["skipped"])),
    (
        "needs",
        lambda write, found: operator_needs.find_all(
            write, found["observer"], found["skipped"], found.get("needs")
        ),
    ),
    ("modes of the context", lambda _write, found: context_modes.find_all(found["observer"])),
    ("neighbours", lambda write, found: found["neighbours"].write(write)),
    ("instances", lambda write, found: found["observer"].write(write)),
    # Of enumerations of which the instances have told their items.
    ("items in sources", lambda write, _found: source_items.find_all(write)),
    ("refusals", write_begun),
)


def main(arguments):
    """Writes everything to the file that is the last argument; a failing step is reported in place.

    The first is a JSON file: ``former``, see nodes.write_all, and ``skipped``, the makers of new things that
    crashed this Blender before.
    """
    given, output = arguments
    gc.disable()  # what is read stays until the end, which is near
    write = Writer(open(output, "w", encoding="utf-8", errors="replace"))
    with open(given, encoding="utf-8") as file:
        observer = Observer()
        found = {"observer": observer, "neighbours": Neighbours(observer), **json.load(file)}
    os.chdir(tempfile.gettempdir())  # some operators that are tried write files where they are
    write(
        "blender",
        version=bpy.app.version_string.split()[0],
        build=text(bpy.app.build_hash),
        addons=sorted(bpy.context.preferences.addons.keys()),
        scripts=bpy.utils.system_resource("SCRIPTS"),
    )
    for name, step in STEPS:
        try:
            step(write, found)
        except Exception:
            write("fault", step=name, traceback=traceback.format_exc())
    write("end", lines=write.count)
    write.close()
    # Blender's own shutdown can abort after scratch data was made; everything is on disk by now.
    sys.stdout.flush()
    os._exit(0)
