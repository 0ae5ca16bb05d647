"""The protocol of blender-mcp's add-on: a command comes as ``{"type", "params"}``, its reply has a ``status``."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any

from agents.blender.drop_in.messages import parse
from agents.blender.drop_in.tools import tools
from agents.blender.tools.base import Call, Knowledge
from agents.blender.tools.failures import describe_failure
from simworlds.installed import own_version
from simworlds.releases import version_key

if TYPE_CHECKING:
    from collections.abc import Callable

    from agents.blender.blender_sessions import BlenderSession
    from agents.blender.drop_in.screenshot_places import ScreenshotPlaces

_PROTOCOL = 15
"""The version of the protocol whose commands these are: clients ask for no command of a later one."""
_INTEGRATIONS = {
    "polyhaven": "Poly Haven",
    "set_texture": "Poly Haven",
    "sketchfab": "Sketchfab",
    "polypizza": "Poly Pizza",
    "hyper3d": "Hyper3D Rodin",
    "rodin": "Hyper3D Rodin",
    "hunyuan": "Hunyuan3D",
    "meshy": "Meshy",
    "tripo": "Tripo",
    "generated_asset": "The generation of models",
}
_STATUS = re.compile(r"get_(polyhaven|sketchfab|polypizza|hyper3d|hunyuan3d|meshy|tripo)_status")
_LONGEST_NAME = 80


class Commands:
    """Answers the commands of all clients in one Blender; its ``version`` is told to them.

    Code may run for ``seconds``; screenshots are written to ``places``.
    """

    def __init__(
        self, session: BlenderSession, version: str, seconds: float, places: ScreenshotPlaces
    ) -> None:
        self._session = session
        self._version = version
        self._in_blender = tools(seconds, places)
        self._at_once: dict[str, Callable[[dict[str, Any]], dict[str, Any]]] = {
            "ping": lambda _: {"pong": True},
            "get_addon_info": self._about,
            "get_telemetry_consent": lambda _: {"consent": False},
            "set_telemetry_consent": _set_consent,
        }

    async def answer(self, message: bytes) -> bytes:
        """The reply to a message, whatever it is."""
        try:
            command = parse(message)
        except ValueError as error:
            return failure(f"The message cannot be read: {error}. Nothing was done.")
        name, params = command.get("type"), command.get("params")
        if not isinstance(name, str) or not name:
            return failure(
                'The message has no command: give it as "type", such as {"type": "get_scene_info", "params": {}}.'
            )
        if params is not None and not isinstance(params, dict):
            return failure(f"The params of {name[:_LONGEST_NAME]} are not a JSON object.")
        return await self._perform(name, params or {})

    async def _perform(self, name: str, params: dict[str, Any]) -> bytes:
        if tool := self._in_blender.get(name):
            try:
                result = await self._session.use(tool, params, Call(), _unknown)
            except Exception as error:
                return failure(describe_failure(name, error))
            return _success(result.data)
        if at_once := self._at_once.get(name):
            return _success(at_once(params))
        title = next((title for word, title in _INTEGRATIONS.items() if word in name), None)
        if title is None:
            known = ", ".join(sorted(self._known))
            return failure(f"Unknown command type: {name[:_LONGEST_NAME]}. Known: {known}.")
        off = (
            f"{title} is off, as this Blender has no network. Build what you need with execute_code, or load it "
            "from a folder that the server may read (--read)."
        )
        return _success({"enabled": False, "message": off}) if _STATUS.fullmatch(name) else failure(off)

    @property
    def _known(self) -> set[str]:
        return {*self._in_blender, *self._at_once}

    def _about(self, _params: dict[str, Any]) -> dict[str, Any]:
        return {
            "name": "SimWorlds",
            "addon_version": list(version_key(own_version())) or [0, 0, 0],
            "protocol_version": _PROTOCOL,
            "capabilities": sorted(self._known),
            "blender_version": self._version,
            "premium_generators": [],
        }


def failure(message: str) -> bytes:
    """The reply to a command that failed."""
    return _encoded({"status": "error", "message": message})


def _success(result: dict[str, Any]) -> bytes:
    return _encoded({"status": "success", "result": result})


def _encoded(reply: dict[str, Any]) -> bytes:
    return json.dumps(reply).encode()


def _set_consent(params: dict[str, Any]) -> dict[str, Any]:
    if params.get("consent"):
        return {"error": "Consent stays off: nothing is recorded here."}
    return {"consent": False}


def _unknown(_version: str) -> Knowledge:
    """Stands for a knowledge base: code is run as it is, and its errors are Python's."""

    def docs(query: str, *, max_tokens: int = 0) -> str:
        del query, max_tokens
        return ""

    return Knowledge(docs)
