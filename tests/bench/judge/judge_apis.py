"""Servers of both APIs on this machine that answer by a script, judges that reach them, and frames to judge."""

from __future__ import annotations

import json
import threading
from collections import deque
from typing import TYPE_CHECKING, Any

from fake_chat_api import FakeChatAPI, Said
from fake_messages_api import FakeMessagesAPI, Reply
from PIL import Image, PngImagePlugin

from bench.judge.providers import JudgeIdentity, JudgeProvider
from simworlds.llm.apis.attempts import Settings
from simworlds.llm.apis.claude import Claude
from simworlds.llm.apis.openai_chat import OpenAIChat
from simworlds.llm.apis.retries import RetryPolicy
from simworlds.llm.spending import Spending

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

PROMPT = (
    "At noon two parrots sit on a bamboo perch at a market stall; the left one flaps up and knocks a papaya off the "
    "crate beneath it."
)
LISTS = {
    "objects": [
        {"words": "two parrots", "text": "two parrots"},
        {"words": "a bamboo perch", "text": "a bamboo perch"},
        {"words": "a papaya", "text": "a papaya"},
        {"words": "the crate", "text": "a crate"},
    ],
    "relations": [
        {"words": "sit on a bamboo perch", "text": "both parrots sit on the perch at the beginning"},
        {"words": "crate beneath it", "text": "the crate stands beneath the left parrot"},
    ],
    "actions": [
        {"words": "the left one flaps up", "text": "the left parrot flaps up"},
        {"words": "knocks a papaya off", "text": "the papaya is knocked off the crate"},
    ],
}
STILL = "A walnut harp leans against a plaster wall."
STILL_LISTS = {
    "objects": [
        {"words": "walnut harp", "text": "a walnut harp"},
        {"words": "wall", "text": "a plaster wall"},
    ],
    "relations": [{"words": "leans against a plaster wall", "text": "the harp leans against the wall"}],
    "actions": [],
}


def verdicts(ids: list[str], *, fails: tuple[str, ...] = (), **changes: Any) -> list[dict[str, Any]]:
    """A verdict for each item: all hold but ``fails``."""
    return [
        {"id": one, "evidence": f"Seen: {one}.", "frames": [1, 2], "holds": one not in fails, **changes}
        for one in ids
    ]


class Script:
    """What a model says: lists and verdicts as asked for, or what was put in the way."""

    def __init__(self) -> None:
        self.lists: dict[str, Any] = LISTS
        self.fails: tuple[str, ...] = ("objects_present.2", "aesthetics.4")
        self.evidence = "Seen in the middle."
        self.instead: dict[str, deque[Any]] = {"items": deque(), "verdicts": deque()}
        self.before: Callable[[str], object] = lambda stage: None
        self.as_text = False

    def says(self, stage: str, words: str) -> Any:
        """An answer as data; a text; or a Reply or Said."""
        self.before(stage)
        if self.instead[stage]:
            given = self.instead[stage].popleft()
            return given(ids_in(words)) if callable(given) else given
        if stage == "items":
            return self.lists
        frames = [1] if "The still:" in words else [1, 5]
        given = verdicts(ids_in(words), fails=self.fails, evidence=self.evidence, frames=frames)
        return {"verdicts": given}


def ids_in(words: str) -> list[str]:
    """The ids of the items that a question lists."""
    start = words.index(" items, as JSON:") + len(" items, as JSON:")
    listed, _ = json.JSONDecoder().raw_decode(words[start:].lstrip())
    return [item["id"] for item in listed]


class Anthropic:
    """The Messages API."""

    name, model = "anthropic", "claude-opus-5-5"

    def __init__(self) -> None:
        self.server = FakeMessagesAPI(self._answer)
        self.script = Script()
        self.pauses: list[float] = []
        self.providers: list[JudgeProvider] = []

    def provider(
        self,
        *,
        model: str = "",
        max_cost: float | None = None,
        tries: int = 4,
        said_address: str | None = None,
    ) -> JudgeProvider:
        settings = Settings(api_key="key", base_url=self.server.base_url, patience=RetryPolicy(tries=tries))
        connect = lambda: Claude(settings, pause=self.pauses.append)  # noqa: E731
        identity = JudgeIdentity(self.name, model or self.model, said_address)
        self.providers.append(JudgeProvider(identity, connect, spending=Spending(max_cost)))
        return self.providers[-1]

    def fail(self, *faults: Any) -> None:
        self.server.fail("POST /v1/messages", *faults)

    def stages(self) -> list[str]:
        """What was asked, in order."""
        return [request.body["tools"][0]["name"] for request in self.server.requests]

    def question(self, place: int) -> tuple[str, list[bytes]]:
        """The words and the pictures of a request."""
        import base64

        body = self.server.requests[place].body
        blocks = [*body["system"], *(block for message in body["messages"] for block in message["content"])]
        pictures = [base64.b64decode(one["source"]["data"]) for one in blocks if one["type"] == "image"]
        return "\n".join(one["text"] for one in blocks if one["type"] == "text"), pictures

    def refusal(self) -> Any:
        return Reply("", stop_reason="refusal", stop_details={"type": "refusal", "explanation": "not this"})

    def cut(self) -> Any:
        return Reply('{"verdicts": [{"id": "objects', stop_reason="max_tokens", output_tokens=16_000)

    def _answer(self, params: dict[str, Any]) -> Reply:
        stage = params["tools"][0]["name"]
        said = self.script.says(stage, _words(params["messages"][0]["content"]))
        if isinstance(said, Reply):
            return said
        if isinstance(said, str) or self.script.as_text:
            return Reply(said if isinstance(said, str) else f"I looked.\n```json\n{json.dumps(said)}\n```")
        call = {"type": "tool_use", "id": "toolu_1", "name": stage, "input": said}
        content = ({"type": "text", "text": "I have looked."}, call)
        return Reply(content=content, stop_reason="tool_use", input_tokens=1000, output_tokens=200)


class OpenAI:
    """Chat completions."""

    name, model = "openai", "gpt-5.5"

    def __init__(self) -> None:
        self.server = FakeChatAPI(self._answer)
        self.script = Script()
        self.pauses: list[float] = []
        self.providers: list[JudgeProvider] = []

    def provider(
        self,
        *,
        model: str = "",
        max_cost: float | None = None,
        tries: int = 4,
        said_address: str | None = None,
    ) -> JudgeProvider:
        settings = Settings(api_key="key", base_url=self.server.base_url, patience=RetryPolicy(tries=tries))
        connect = lambda: OpenAIChat(settings, pause=self.pauses.append)  # noqa: E731
        identity = JudgeIdentity(self.name, model or self.model, said_address)
        self.providers.append(JudgeProvider(identity, connect, spending=Spending(max_cost)))
        return self.providers[-1]

    def fail(self, *faults: Any) -> None:
        self.server.fail(*faults)

    def stages(self) -> list[str]:
        return [request["response_format"]["json_schema"]["name"] for request in self.server.requests]

    def question(self, place: int) -> tuple[str, list[bytes]]:
        from fake_chat_api import picture_of

        words, pictures = [], []
        for message in self.server.requests[place]["messages"]:
            content = message["content"]
            for part in [{"type": "text", "text": content}] if isinstance(content, str) else content:
                if part["type"] == "text":
                    words.append(part["text"])
                else:
                    pictures.append(picture_of(part))
        return "\n".join(words), pictures

    def refusal(self) -> Any:
        return Said(None, refusal="not this")

    def cut(self) -> Any:
        return Said('{"verdicts": [{"id": "objects', "length", completion_tokens=16_000)

    def _answer(self, params: dict[str, Any]) -> Said:
        stage = params["response_format"]["json_schema"]["name"]
        said = self.script.says(stage, _words(params["messages"][1]["content"]))
        if isinstance(said, Said):
            return said
        return Said(
            said if isinstance(said, str) else json.dumps(said), prompt_tokens=1000, completion_tokens=200
        )


def _words(content: list[dict[str, Any]]) -> str:
    return "\n".join(part["text"] for part in content if part["type"] == "text")


def film(folder: Path, *, shade: int = 0, count: int = 5, note: str = "") -> list[Path]:
    """Frames of a square that moves to the right; ``note`` is written beside the pixels, as renderers do."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for number in range(count):
        image = Image.new("RGB", (64, 36), (40 + shade, 90, 60))
        image.paste((220, 200, 40), (8 * number, 10, 8 * number + 12, 22))
        beside = PngImagePlugin.PngInfo()
        if note:
            beside.add_text("File", note)
        paths.append(folder / f"frame_{number}.png")
        image.save(paths[-1], pnginfo=beside, compress_level=1 if note else 6)
    return paths


class Gate:
    """Holds a server's answer until it is let go."""

    def __init__(self) -> None:
        self.reached = threading.Event()
        self.go = threading.Event()

    def __call__(self, stage: str) -> None:
        if stage == "verdicts":
            self.reached.set()
            self.go.wait(20)
