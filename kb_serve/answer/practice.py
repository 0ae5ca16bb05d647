"""What one has to know of a few symbols that neither Blender's API nor its manual says."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.index.analysis import stem, words
from kb_serve.recognise.messages.ways_to_run import NO_FLUIDS
from kb_serve.recognise.products import CLASSES, WITH_AT
from kb_serve.recognise.subscripts import NODES_MODIFIER, CustomProperties

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.reader import BaseReader

_HANDLERS = "bpy.app.handlers."
_PERSISTENT = f"{_HANDLERS}persistent"
_STAYING = f"Loading a file removes a handler, before `load_post` runs it too, unless it has `@{_PERSISTENT}` above it."

_TYPES = "bpy.types."
_DRIVERS = frozenset(
    f"{_TYPES}{path}"
    for path in (
        "ChannelDriverVariables.new",
        "Driver",
        "Driver.is_valid",
        "DriverTarget",
        "DriverTarget.data_path",
        "DriverVariable",
        "bpy_struct.driver_add",
    )
)
_TAGGED = (
    "A driver does not see a custom property that a script has just set, and stays invalid: after "
    '`owner["name"] = 3.0` call `owner.id_data.update_tag()`, also after each later change. One that is invalid '
    "already needs `driver.expression = driver.expression`, too."
)
_TOGGLES_ATTRIBUTE = "bpy.ops.object.geometry_nodes_input_attribute_toggle"
_STROKE = "_bpy_internal.grease_pencil.stroke.GreasePencilStroke"
_POINT = f"{_STROKE}Point"
_STROKE_POINTS = frozenset((_POINT, f"{_POINT}.opacity", f"{_POINT}.radius"))
_EVERY_POINT = (
    "Set `radius` and `opacity` of every point: the first `opacity` that is set in a drawing makes it 0 for all its "
    "other points, and strokes that are added after either was set begin with 0 of it."
)
_REACHED = (
    "`drawing.strokes[0]` is one, with `drawing = layer.frames[0].drawing`; `drawing.add_strokes([4])` makes a new "
    "one, of four points."
)
_STYLE = f"{_TYPES}MaterialGPencilStyle"
_FILLS = frozenset(
    (
        *(f"{_STROKE}.{name}" for name in ("fill_color", "fill_id", "fill_opacity")),
        *(f"{_STYLE}{name}" for name in ("", ".fill_color", ".fill_style", ".is_fill_visible", ".show_fill")),
    )
)
_FILLED = (
    "A fill is drawn where the stroke has a `fill_id` other than 0 (`drawing.strokes[0].fill_id = 1`), whatever the "
    "material's `show_fill` is: in the material's `grease_pencil.fill_color`, with the stroke's `fill_color` over it. "
    "It is black where no light falls, unless `layer.use_lights = False`."
)
_RIGID_BODY = f"{_TYPES}RigidBodyObject"
_PLACES = frozenset((f"{_TYPES}Object.location", f"{_TYPES}Object.rotation_euler"))
# By one of these a question says that something else than a script or its keys moves the object.
_SIMULATED = frozenset(
    map(
        stem,
        [
            "bake",
            "body",
            "bounce",
            "drop",
            "fall",
            "physics",
            "rigid",
            "roll",
            "settle",
            "simulate",
            "simulation",
        ],
    )
)
_MOVED = (
    "A rigid body's simulation moves `ob.matrix_world`, not `ob.location` or `ob.rotation_euler`: call "
    "`scene.frame_set(frame)` for every frame from the first, then read `ob.matrix_world.translation`."
)
_RANGES = f"{_TYPES}bpy_struct.id_properties_ui"
_RANGED = (
    '`ob["x"] = 1.0` makes the property, `ob.id_properties_ui("x").update(min=0.0, max=2.0, description="…")` gives it '
    "limits, which the panel keeps and scripts need not. Choices are named numbers: after "
    '`ob["mode"] = 0` call `….update(items=[("A", "First", ""), ("B", "Second", "")])`.'
)
_BAKES_FLUID = "bpy.ops.fluid.bake_"
_BAKES_FLUIDS = f"{_BAKES_FLUID}all"
_SIMULATES_FLUID = frozenset(
    (
        "bpy.ops.object.quick_liquid",
        "bpy.ops.object.quick_smoke",
        f"{_TYPES}FluidDomainSettings",
        f"{_TYPES}FluidModifier",
    )
)
# How a question says that a fluid is simulated without a window, or ends Blender.
_FLUIDS = frozenset(map(stem, ("fluid", "smoke", "fire", "liquid")))
_NO_WINDOW = frozenset(map(stem, ("abort", "background", "crash", "headless", "terminate", "window")))
_TIMERS = "bpy.app.timers"
_TIMER = f"{_TIMERS}.register"
_NO_TIMERS = (
    "Timers run between the events of a Blender with a window. Without one (`--background`, or `import bpy` in another "
    "Python) none ever runs: call the function yourself there."
)
_SIZES = {f"{_TYPES}GreasePencilDrawing.add_strokes": "strokes", f"{_TYPES}Curves.add_curves": "curves"}
_NO_SIZES = "An empty list crashes Blender 5.1: `if sizes: data.add_{}(sizes)`. Each size is at least 1."
_RETIMED = frozenset(
    f"{_TYPES}{path}" for path in ("RetimingKey", "RetimingKey.timeline_frame", "RetimingKeys")
)
_RETIMES = f"{_TYPES}RetimingKeys.add"
_NO_RETIMING = (
    "Assigning a key's `timeline_frame` may crash Blender: 5.1 where the scene has an earlier strip without such keys, "
    "4.5 always. Make keys where they shall be, `strip.retiming_keys.add(timeline_frame=20)`; "
    "`strip.retiming_keys.reset()` removes all."
)
_NO_KEY = (
    "It makes no key, and returns None, at a frame outside the strip, as the default is for most, and on a strip that "
    "takes none."
)
_CLOTH_GRAVITY = f"{_TYPES}ClothSettings.gravity"
_FALLS = (
    "Cloth does not use its own `gravity`, whatever it is: while `scene.use_gravity` is on it falls by "
    "`scene.gravity` times the cloth's `settings.effector_weights.gravity`."
)
_BAKES = "bpy.ops.object.bake"
_BAKED = (
    "What is left out is not the default that is listed here, but what `scene.render.bake` has, where it has a setting "
    "of that name: `target`, `margin`, `use_clear`, `normal_space` …"
)
_INDICES = {
    f"{_TYPES}{path}": done
    for path, done in (
        ("GreasePencilDrawing.remove_strokes", "removes all strokes"),
        ("GreasePencilDrawing.set_types", "sets the type of all strokes"),
        ("Curves.remove_curves", "removes all curves"),
        ("Curves.set_types", "sets the type of all curves"),
    )
}
# What a question in plain words says that comes to these sentences; a name needs none.
_OF_DRIVERS = frozenset(map(stem, ("driver", "driven", "drive")))
_OF_HANDLERS = frozenset(map(stem, ("handler", "persistent", "callback")))
_OF_RANGES = frozenset(map(stem, ("property", "custom", "limit", "range", "min", "max", "slider", "ui")))
_OF_TIMERS = frozenset(map(stem, ("timer", "delay", "interval", "later", "second", "repeat", "periodic")))
_ALL = "`indices=[]` {}, as if it were left out: call it only `if indices:`."

_SAID = {
    **dict.fromkeys(_RETIMED, (_NO_RETIMING,)),
    _RETIMES: (_NO_KEY, _NO_RETIMING),
    _CLOTH_GRAVITY: (_FALLS,),
    _BAKES: (_BAKED,),
}


def _is_of_fluids(identifier: str, said: frozenset[str]) -> bool:
    """Whether a symbol simulates fluids, or a question with these words is on doing so without a window."""
    if identifier.startswith(_BAKES_FLUID) or identifier in _SIMULATES_FLUID:
        return True
    return not (_FLUIDS.isdisjoint(said) or _NO_WINDOW.isdisjoint(said))


class Practice:
    """Sentences for the answers from one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._custom = CustomProperties(reader)

    def of(self, identifier: str, question: str, *, is_named: bool = True) -> Iterator[str]:
        """Sentences on a symbol, or on what the page with that slug explains, that a question comes to.

        ``is_named``: the question has its name, and was not only found to be like it.
        """
        said = frozenset(map(stem, words(question)))

        def is_about(subject: frozenset[str]) -> bool:
            return is_named or not subject.isdisjoint(said)

        is_handler = identifier.startswith(_HANDLERS) and identifier != _PERSISTENT
        if is_handler and is_about(_OF_HANDLERS) and self._reader.entry(_PERSISTENT):
            yield _STAYING
        if identifier in {_TIMER, _TIMERS} and is_about(_OF_TIMERS):
            yield _NO_TIMERS
        if _is_of_fluids(identifier, said) or self._explains(identifier, _BAKES_FLUIDS):
            yield NO_FLUIDS
        yield from _SAID.get(identifier, ())
        is_of_place = identifier in _PLACES and not _SIMULATED.isdisjoint(said)
        chapter = identifier.rpartition("/")[0]
        if is_of_place or identifier == _RIGID_BODY or chapter in self._chapters_of_rigid_bodies:
            yield _MOVED
        if (identifier == _RANGES or self._explains(identifier, _RANGES)) and is_about(_OF_RANGES):
            yield _RANGED
        if identifier in CLASSES:
            yield WITH_AT
        if identifier in _DRIVERS and is_about(_OF_DRIVERS):
            yield _TAGGED
        yield from self._on_strokes(identifier)
        if thing := _SIZES.get(identifier):
            yield _NO_SIZES.format(thing)
        if done := _INDICES.get(identifier):
            yield _ALL.format(done)
        if identifier == _TOGGLES_ATTRIBUTE and (text := self._custom.on_attributes()):
            yield text
        if identifier == NODES_MODIFIER or self._explains(identifier, NODES_MODIFIER):
            yield self._custom.on_inputs()

    def _on_strokes(self, identifier: str) -> Iterator[str]:
        if identifier == _STROKE or identifier.startswith(f"{_STROKE}."):
            yield _REACHED
        if identifier in _FILLS or self._explains(identifier, _STYLE):
            yield _FILLED
        if identifier in _STROKE_POINTS:
            yield _EVERY_POINT

    def _explains(self, slug: str, path: str) -> bool:
        """Whether a page is one that explains a symbol."""
        return slug in self._pages[path]

    @cached_property
    def _pages(self) -> dict[str, frozenset[str]]:
        """Symbol → the pages that explain it, of those that something is known of."""
        return {
            path: frozenset(target.partition("#")[0] for target in self._reader.manual_links(path))
            for path in (_BAKES_FLUIDS, _RANGES, _RIGID_BODY, _STYLE, NODES_MODIFIER)
        }

    @cached_property
    def _chapters_of_rigid_bodies(self) -> frozenset[str]:
        """The folders of the pages that explain rigid bodies."""
        return frozenset(slug.rpartition("/")[0] for slug in self._pages[_RIGID_BODY]) - {""}
