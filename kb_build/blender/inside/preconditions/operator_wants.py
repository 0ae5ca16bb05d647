# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds what operators want that neither an active object nor an area is enough for: both, or something set besides.

All is tried in a new, empty scene, so that what is told is enough: areas of every type without an active object; what
they show; objects of every type in every mode there; then, with and without an area, what scenes and objects have. What
is set is listed in operator_settings. Of several that an operator takes the first is told.
"""

import operator
import os
import re
import tempfile
import traceback
import wave
from collections import defaultdict
from contextlib import contextmanager, nullcontext, suppress

import bpy

from ..instances.making import activate, choices, no_sequencer_scene, remove
from .active_objects import Objects, can_run, empty_scene, modes, typed_object, wanted
from .operator_settings import SPACE, TRIED, made, shown

SET_IN_SPACE = re.compile(rf"{re.escape(SPACE)}\.((?:\w+\.)*)(\w+) = ")
AREA_UI = "area.ui_type = "


class Places:
    """The area in which everything is tried, as any editor, and what statements are given."""

    def __init__(self, folder):
        self.window = bpy.context.window
        # One of which no editor has shown anything yet: the largest is for other steps.
        self.area = min(self.window.screen.areas, key=lambda area: area.width * area.height)
        # Area type → the editor that an area of it is when nothing else is said.
        self.usual = {}
        for kind in choices("Area", "type"):
            with suppress(*TRIED):
                self.area.type = kind
                self.usual.setdefault(self.area.type, self.area.ui_type)
        self.names = {"bpy": bpy, "area": self.area, **files(folder)}

    @contextmanager
    def within(self, editor):
        """The area as an editor, in the context."""
        self.area.ui_type = editor
        region = next(region for region in self.area.regions if region.type == "WINDOW")
        with bpy.context.temp_override(
            window=self.window, screen=self.window.screen, area=self.area, region=region
        ):
            yield

    def scene(self):
        """A new scene without objects."""
        self.names["scene"] = empty_scene()
        no_sequencer_scene()

    def object(self, kind):
        """A new scene with an active and selected object; None where this Blender has no such type."""
        self.scene()
        try:
            obj = typed_object(kind)
        except TRIED:
            return None
        if obj is not None:
            activate(obj).select_set(True)
            self.names["obj"] = obj
        return obj

    def run(self, statements):
        """Whether statements can be run, one after the other."""
        try:
            for text in statements:
                exec(text, self.names)  # noqa: S102 - of the text that is told
        except TRIED:
            return False
        return True

    @contextmanager
    def set_in_space(self, statements):
        """Whether statements on the area could be run, which is taken back."""
        before = []
        for match in filter(None, map(SET_IN_SPACE.match, statements)):
            with suppress(*TRIED):
                owner = operator.attrgetter(f"active.{match[1]}".rstrip("."))(self.area.spaces)
                before.append((owner, match[2], getattr(owner, match[2])))
        try:
            yield self.run(statements)
        finally:
            for owner, name, value in reversed(before):
                with suppress(*TRIED):
                    setattr(owner, name, value)

    def type_of(self, editor):
        """The area type of an editor; None where this Blender has no such."""
        try:
            self.area.ui_type = editor
        except TypeError:
            return None
        return self.area.type


def files(folder):
    """The paths of an image and a sound, by the names that statements give them."""
    image_path, sound_path = (os.path.join(folder, name) for name in ("image.png", "sound.wav"))
    image = bpy.data.images.new("image", 8, 8)
    with suppress(*TRIED):
        image.filepath_raw, image.file_format = image_path, "PNG"
        image.save()
    bpy.data.images.remove(image)
    with wave.open(sound_path, "wb") as sound:
        sound.setnchannels(1)
        sound.setsampwidth(2)
        sound.setframerate(8000)
        sound.writeframes(bytes(16000))
    return {"image_path": image_path, "sound_path": sound_path}


class Wants:
    """What operators want, found one after the other: an operator that is found is no longer asked."""

    def __init__(self, known, in_areas, editors, folder, defaults):
        """``in_areas``: path → the types of areas in which an operator could run when everything was there."""
        self.left = dict(known)
        self.in_areas = in_areas
        self.places = Places(folder)
        self.types = {editor: kind for editor in editors if (kind := self.places.type_of(editor))}
        self.defaults = defaults
        # path → (what of an active object, areas, statements).
        self.found = {}

    def keep(self, path, needs, editors, statements=()):
        """Keeps what an operator wants: of editors that an area is not by itself, the first is a statement more."""
        usual = [editor for editor in editors if self.places.usual.get(self.types[editor]) == editor]
        ui_type = [] if usual or not editors else [f"{AREA_UI}{editors[0]!r}"]
        kinds = sorted({self.types[editor] for editor in usual or editors[:1]})
        areas = ["any"] if kinds and {*kinds} == {*self.types.values()} else kinds
        at = next((at for at, text in enumerate(statements) if "area." in text), len(statements))
        self.found[path] = needs, areas, [*statements[:at], *ui_type, *statements[at:]]
        del self.left[path]

    def asked(self, paths):
        """Those of these operators that can run here and now."""
        running = can_run({path: self.left[path] for path in paths if path in self.left})
        self.defaults.ask(running)
        return running

    def of_type(self, editor):
        """The operators that could run in such an area."""
        return [path for path in self.left if self.types[editor] in self.in_areas.get(path, ())]

    def alone(self):
        """Areas without an active object."""
        self.places.scene()
        passed = defaultdict(list)
        for editor in self.types:
            with self.places.within(editor):
                for path in self.asked(self.of_type(editor)):
                    passed[path].append(editor)
        for path, editors in passed.items():
            self.keep(path, {}, editors)

    def with_objects(self):
        """Areas and an active object. Those that run without an area now, and did not before, are no longer asked."""
        objects = Objects(self.defaults)
        passed = defaultdict(lambda: defaultdict(dict))
        unselected = defaultdict(set)
        for kind in choices("Object", "type"):
            obj = self.places.object(kind)
            if obj is None:
                continue
            layer, objects.tried[kind] = bpy.context.view_layer, []
            for mode in modes(obj):
                objects.tried[kind].append(mode)
                for path in can_run(self.left):
                    # It wants something that is nobody's, and that other steps have left.
                    del self.left[path]
                    passed.pop(path, None)
                for editor in self.types:
                    if not (paths := self.of_type(editor)):
                        continue
                    with self.places.within(editor):
                        for path in self.asked(paths):
                            passed[path][editor].setdefault(kind, []).append(mode)
                        if (kind, mode) == ("MESH", "OBJECT"):
                            obj.select_set(False, view_layer=layer)
                            unselected[editor].update(self.asked(paths))
                            obj.select_set(True, view_layer=layer)
            remove(obj)
        for path, by_editor in passed.items():
            # The editors that take the same of all that was tried, and the most of it.
            most = max(by_editor.values(), key=lambda found: sum(map(len, found.values())))
            editors = [editor for editor, found in by_editor.items() if found == most]
            is_selected = "OBJECT" in most.get("MESH", ()) and not all(
                path in unselected[editor] for editor in editors
            )
            active = "selected" if is_selected else "active"
            self.keep(path, {"active": active, **objects.cases(most)}, editors)

    def with_settings(self, settings):
        """Each setting by itself, without and with an area."""
        for setting in settings:
            if not self.left:
                return
            tried = TriedSetting(setting)
            for kind in setting.kinds:
                obj = self.places.object(kind)
                if obj is not None and self.places.run(setting.of_scene):
                    tried.modes[kind] = []
                    self.with_object(tried, obj, kind)
            for path in tried.passed:
                self.keep(path, *tried.told(path))

    def with_object(self, tried, obj, kind):
        """A setting with one object in its modes."""
        setting = tried.setting
        for mode in modes(obj, setting.modes):
            tried.modes[kind].append(mode)
            places = [("", nullcontext())] if not setting.of_area else []
            places += [
                (editor, self.places.within(editor)) for editor in setting.editors if editor in self.types
            ]
            for editor, within in places:
                with within:
                    # These want nothing of what is set in the area.
                    before = {*self.asked(list(self.left))} if setting.of_area else ()
                    with self.places.set_in_space(setting.of_area) as is_set:
                        running = (
                            self.asked([path for path in self.left if path not in before]) if is_set else []
                        )
                        for path in running:
                            tried.passed[path][editor].setdefault(kind, []).append(mode)
                        if running and mode == "OBJECT":
                            self.without_object(tried, obj, running)

    def without_object(self, tried, obj, running):
        """The same with the object unselected, and then not active."""
        layer = self.places.names["scene"].view_layers[0]
        obj.select_set(False, view_layer=layer)
        tried.selected.update({*running}.difference(self.asked(running)))
        layer.objects.active = None
        tried.active.update({*running}.difference(self.asked(running)))
        layer.objects.active = obj
        obj.select_set(True, view_layer=layer)


class TriedSetting:
    """What came of one setting."""

    def __init__(self, setting):
        self.setting = setting
        # kind → modes in which it was tried.
        self.modes = {}
        # path → editor, or "" for no area → {kind: modes in which it can run}.
        self.passed = defaultdict(lambda: defaultdict(dict))
        # Those that want the object of the setting selected, or active.
        self.selected = set()
        self.active = set()

    def told(self, path):
        """What an operator wants: of an active object, editors, and statements."""
        by_editor = self.passed[path]
        most = by_editor.get("") or max(by_editor.values(), key=lambda found: sum(map(len, found.values())))
        is_of_scene = not any("obj." in text for text in self.setting.statements)
        is_free = is_of_scene and path not in self.active and "OBJECT" in most.get("MESH", ())
        needs = {} if is_free else active_of(most, self.modes, is_selected=path in self.selected)
        if "" in by_editor:
            return {**needs, **what(self.setting)}, [], ()
        editors = [editor for editor in by_editor if by_editor[editor] == most]
        return needs, editors, self.setting.statements


def active_of(found, tried, *, is_selected):
    """Which active object a setting is of: of mesh objects the type is not told, as most are."""
    needs = {"active": "selected" if is_selected else "active"}
    if "MESH" not in found:
        needs["types"] = {"names": list(found), "is_others": False}
    passed = {mode: None for modes_passed in found.values() for mode in modes_passed}
    refused = {mode: None for kind in found for mode in tried[kind] if mode not in found[kind]}
    if passed.keys() & refused.keys():
        return {**needs, "in_some_modes": True}
    return {**needs, "modes": wanted(list(passed), list(refused))}


def what(setting):
    """What a setting is: the statements, and whether they set something rather than add it."""
    return {"calls": list(setting.statements), "sets": " = " in setting.statements[-1]}


def find(write, known, in_areas, editors, defaults):
    """Path → (what of an active object, types of areas, statements), of those of which that was found."""
    with tempfile.TemporaryDirectory(prefix="simworlds-") as folder:
        wants = Wants(known, in_areas, editors, folder, defaults)
        steps = (
            wants.alone,
            lambda: wants.with_settings(shown()),
            wants.with_objects,
            lambda: wants.with_settings(made()),
        )
        for step in steps:
            try:
                step()
            except Exception:
                write("fault", step="settings of operators", traceback=traceback.format_exc())
        return wants.found
