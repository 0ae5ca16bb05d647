"""What new things have otherwise than in older Blenders, as new ones of each tell: code that leaves it as it is does
another thing without an error.
"""

from __future__ import annotations

from typing import NamedTuple

from kb_build.symbols.api_names import OPERATORS, TYPES
from kb_serve.answer.known.told_of import Advice


class ChangedDefault(NamedTuple):
    """A property, socket or parameter, with the value that it had in new things up to ``last``, and has no more since
    ``since``; in no Blender between these was it asked. ``makers`` make such things.
    """

    path: str
    former: str
    last: tuple[int, int]
    since: tuple[int, int]
    makers: tuple[str, ...] = ()
    advice: str = ""


def _socket(
    node: str, name: str, former: str, last: tuple[int, int], since: tuple[int, int]
) -> ChangedDefault:
    return ChangedDefault(f'{TYPES}{node}.inputs["{name}"]', former, last, since)


CHANGED_DEFAULTS = (
    ChangedDefault(
        f"{TYPES}GeometryNodeSwitch.input_type", "'GEOMETRY'", (5, 0), (5, 1), (f"{TYPES}GeometryNodeSwitch",),
        "Set `node.input_type = 'GEOMETRY'` before its sockets are linked.",
    ),
    ChangedDefault(
        f"{TYPES}GeometryNodeIndexSwitch.data_type", "'GEOMETRY'", (5, 0), (5, 1),
        (f"{TYPES}GeometryNodeIndexSwitch",), "Set `node.data_type = 'GEOMETRY'` before its sockets are linked.",
    ),
    ChangedDefault(
        f"{TYPES}ShapeKey.value", "0.0", (4, 5), (5, 0), (f"{TYPES}Object.shape_key_add",),
        "Set `key.value = 0.0` for one that is not to show yet.",
    ),
    ChangedDefault(f"{TYPES}ShaderNodeTexSky.sky_type", "'NISHITA'", (4, 5), (5, 0)),
    ChangedDefault(f"{TYPES}ShaderNodeBsdfGlass.distribution", "'BECKMANN'", (3, 4), (4, 2)),
    ChangedDefault(f"{TYPES}ToolSettings.use_uv_select_sync", "False", (4, 5), (5, 0)),
    ChangedDefault(f"{OPERATORS}uv.unwrap(method)", "'ANGLE_BASED'", (4, 2), (4, 5)),
    _socket("ShaderNodeBlackbody", "Temperature", "1500", (4, 5), (5, 0)),
    _socket("ShaderNodeBsdfGlass", "IOR", "1.45", (3, 4), (4, 2)),
    _socket("ShaderNodeBsdfPrincipled", "Emission Strength", "1", (3, 4), (4, 2)),
    _socket("ShaderNodeBsdfPrincipled", "Subsurface Scale", "0.05", (5, 1), (5, 2)),
    _socket("ShaderNodeBump", "Distance", "1", (4, 2), (4, 5)),
    _socket("ShaderNodeDisplacement", "Scale", "1", (4, 2), (4, 5)),
    _socket("ShaderNodeFresnel", "IOR", "1.45", (3, 4), (4, 2)),
    _socket("ShaderNodeMix", "Factor", "0.5", (5, 1), (5, 2)),
    _socket("ShaderNodeSubsurfaceScattering", "Scale", "1", (3, 4), (4, 2)),
    _socket("ShaderNodeSubsurfaceScattering", "Scale", "0.05", (5, 1), (5, 2)),
    _socket("ShaderNodeVectorDisplacement", "Scale", "1", (4, 2), (4, 5)),
)  # fmt: skip


def _advice(changed: ChangedDefault) -> Advice:
    last, since = (".".join(map(str, version)) for version in (changed.last, changed.since))
    is_next = changed.since in {(changed.last[0], changed.last[1] + 1), (changed.last[0] + 1, 0)}
    above, _, parameter = changed.path.partition("(")
    what = (
        f"A call without `{parameter[:-1]}` does another thing"
        if parameter
        else f"New ones have another `{above.rpartition('.')[2]}`"
    )
    text = (
        f"{what} since Blender {since}{'' if is_next else ' at the latest'}: it was {changed.former} in {last}."
        f"{' ' if changed.advice else ''}{changed.advice}"
    )
    return Advice(text, frozenset({above, *changed.makers}), since=changed.since)


ADVICE_ON_DEFAULTS = tuple(map(_advice, CHANGED_DEFAULTS))
