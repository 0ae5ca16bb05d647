"""What nodes of shaders are linked to in a new tree, which has its usual nodes already."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_serve.answer.steps.making.trees import OF_WORLDS, WORLD_END

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

    from kb_serve.answer.steps.node_trees.sockets import NodeSockets
    from kb_serve.answer.steps.scene.new_scene import NewScene

_LIGHT_END = f"{TYPES}ShaderNodeOutputLight"
_END = "tree.get_output_node('ALL')"
_END_NODE = f"{TYPES}ShaderNodeOutputMaterial"  # what that gives
_DISPLACES = "displacement_method = 'DISPLACEMENT'"
_PRINCIPLED = 'tree.nodes["Principled BSDF"]'
_BACKGROUND = 'tree.nodes["Background"].inputs["Color"]'
# What goes into a node that takes shaders: what ended the tree before, of a material mostly; then a further shader.
_FIRST_SHADER = f'{_PRINCIPLED}.outputs["BSDF"]'
_FIRST_SHADER_OF = {WORLD_END: 'tree.nodes["Background"].outputs["Background"]', _LIGHT_END: ""}
_MORE_SHADERS = ('emission = tree.nodes.new("ShaderNodeEmission")', 'emission.outputs["Emission"]')


class ShaderLinks:
    """The links of nodes of shaders in one list of steps."""

    def __init__(self, scene: NewScene, sockets: NodeSockets) -> None:
        self._scene = scene
        self._reader = scene.reader
        self._sockets = sockets

    def of(self, node: str) -> Iterator[str]:
        """The links of a shader node: from the shaders that it takes, and to the tree's end, or to the usual shader's
        input of the kind of its output.
        """
        variable = self._scene.variables.of(node)
        takes = yield from self._shaders_into(node, variable)
        if shader := self._sockets.first(node, "outputs", ("shader",)):
            called = shader.replace("outputs", "inputs", 1)
            known = self._reader.members(_END_NODE)
            taken = called if called in known else 'inputs["Surface"]'
            yield f"`tree.links.new({variable}.{shader}, {_END}.{taken})`"
            return
        members = self._reader.members(node)
        if 'outputs["Displacement"]' in members:
            yield f'`tree.links.new({variable}.outputs["Displacement"], {_END}.inputs["Displacement"])`'
            if material := self._scene.variables.there(f"{TYPES}Material"):
                yield f"`{material}.{_DISPLACES}` — a new one has 'BUMP', by which nothing is moved"
        elif takes and (color := self._sockets.first(node, "outputs", ("rgba",))):
            yield f'`tree.links.new({variable}.{color}, {_END}.inputs["Surface"])`'
        elif color := self._sockets.first(node, "outputs", ("rgba",)):
            to = _BACKGROUND if node in OF_WORLDS else f'{_PRINCIPLED}.inputs["Base Color"]'
            yield f"`tree.links.new({variable}.{color}, {to})`"
        elif 'outputs["Normal"]' in members:
            yield f'`tree.links.new({variable}.outputs["Normal"], {_PRINCIPLED}.inputs["Normal"])`'
        elif value := self._sockets.first(node, "outputs", ("value",)):
            yield f'`tree.links.new({variable}.{value}, {_PRINCIPLED}.inputs["Roughness"])`'

    def _shaders_into(self, node: str, variable: str) -> Generator[str, None, bool]:
        """The steps that link shaders to a node which takes some: one to the first input, and another to each further
        one that is called alike, as those of a mix are. Returns whether it takes any.
        """
        first = self._sockets.first(node, "inputs", ("shader",))
        before = _FIRST_SHADER_OF.get(node, _FIRST_SHADER)
        if not (first and before):
            return False
        yield f"`tree.links.new({before}, {variable}.{first})`"
        alike = [name for name in self._reader.members(node) if name.startswith(f"{first[:-2]}_")]
        if alike:
            yield f"`{_MORE_SHADERS[0]}`"
            yield from (f"`tree.links.new({_MORE_SHADERS[1]}, {variable}.{name})`" for name in alike)
        return True
