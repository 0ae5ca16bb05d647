"""The APIs that a model can be reached by, and the model that is asked where none is named."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Literal, Protocol, get_args

if TYPE_CHECKING:
    from collections.abc import Callable

    from simworlds.llm.apis.attempts import Settings
    from simworlds.llm.apis.retries import Retry
    from simworlds.llm.messages import Ask, Turn

ProviderName = Literal["anthropic", "openai"]
PROVIDERS: tuple[ProviderName, ...] = get_args(ProviderName)
"""``anthropic``: the Messages API; ``openai``: chat completions, which most other servers speak."""

# One strong model that sees pictures of each: the newest of the paper's line, and the paper's own judge.
DEFAULT_MODELS: dict[ProviderName, str] = {"anthropic": "claude-opus-5-5", "openai": "gpt-5.5"}
TOLD_DEFAULTS = ", or ".join(
    model if name == PROVIDERS[0] else f"{model} of {name}" for name, model in DEFAULT_MODELS.items()
)
"""The same in words, as options tell it."""


class Connection(Protocol):
    """A Model with connections that can be closed."""

    def answer(self, ask: Ask, on_text: Callable[[str], object] | None = None) -> Turn:
        """The model's turn, see Model."""
        ...

    def close(self) -> None:
        """Closes the connections."""
        ...


def connect(
    provider: ProviderName,
    settings: Settings | None = None,
    tell: Callable[[Retry], object] | None = None,
    *,
    pause: Callable[[float], object] = time.sleep,
) -> Connection:
    """A model of that provider; nothing is asked yet. Each package is loaded when it is needed.

    ``tell`` is called before every Retry, ``pause`` waits. Raises Rejected without a key, NoPackage without the
    package.
    """
    if provider == "openai":
        from simworlds.llm.apis.openai_chat import OpenAIChat  # noqa: PLC0415

        return OpenAIChat(settings, tell, pause=pause)
    from simworlds.llm.apis.claude import Claude  # noqa: PLC0415

    return Claude(settings, tell, pause=pause)
