"""What one has to know of a few symbols that neither Blender's API nor its manual says."""

from __future__ import annotations

from typing import TYPE_CHECKING

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
    '`owner["name"] = 3.0` call `owner.update_tag()`, also after each later change. One that is invalid already needs '
    "`driver.expression = driver.expression`, too."
)
_TOGGLES_ATTRIBUTE = "bpy.ops.object.geometry_nodes_input_attribute_toggle"
_POINT = "_bpy_internal.grease_pencil.stroke.GreasePencilStrokePoint"
_STROKE_POINTS = frozenset((_POINT, f"{_POINT}.opacity", f"{_POINT}.radius"))
_EVERY_POINT = (
    "Set `radius` and `opacity` of every point: the first `opacity` that is set in a drawing makes it 0 for all its "
    "other points, and strokes that are added after either was set begin with 0 of it."
)
_BAKES_FLUID = "bpy.ops.fluid.bake_"
_TIMER = "bpy.app.timers.register"
_NO_TIMERS = (
    "Timers run between the events of a Blender with a window. Without one (`--background`, or `import bpy` in another "
    "Python) none ever runs: call the function yourself there."
)
_SIZES = {f"{_TYPES}GreasePencilDrawing.add_strokes": "strokes", f"{_TYPES}Curves.add_curves": "curves"}
_NO_SIZES = "An empty list crashes Blender 5.1: `if sizes: data.add_{}(sizes)`. Each size is at least 1."
_INDICES = {
    f"{_TYPES}{path}": done
    for path, done in (
        ("GreasePencilDrawing.remove_strokes", "removes all strokes"),
        ("GreasePencilDrawing.set_types", "sets the type of all strokes"),
        ("Curves.remove_curves", "removes all curves"),
        ("Curves.set_types", "sets the type of all curves"),
    )
}
_ALL = "`indices=[]` {}, as if it were left out: call it only `if indices:`."


class Practice:
    """Sentences for the answers from one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._custom = CustomProperties(reader)

    def of(self, identifier: str) -> Iterator[str]:
        """Sentences on a symbol, or on what the page with that slug explains."""
        if identifier.startswith(_HANDLERS) and identifier != _PERSISTENT and self._reader.entry(_PERSISTENT):
            yield _STAYING
        if identifier == _TIMER:
            yield _NO_TIMERS
        if identifier.startswith(_BAKES_FLUID):
            yield NO_FLUIDS
        if identifier in CLASSES:
            yield WITH_AT
        if identifier in _DRIVERS:
            yield _TAGGED
        if identifier in _STROKE_POINTS:
            yield _EVERY_POINT
        if thing := _SIZES.get(identifier):
            yield _NO_SIZES.format(thing)
        if done := _INDICES.get(identifier):
            yield _ALL.format(done)
        if identifier == _TOGGLES_ATTRIBUTE and (text := self._custom.on_attributes()):
            yield text
        if identifier == NODES_MODIFIER or identifier in self._explaining(NODES_MODIFIER):
            yield self._custom.on_inputs()

    def _explaining(self, path: str) -> set[str]:
        return {target.partition("#")[0] for target in self._reader.manual_links(path)}
