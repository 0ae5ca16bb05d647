"""The judge: a provider's model, connected at its first question, and the limit of its cost."""

from __future__ import annotations

import json
import threading
from dataclasses import replace
from importlib.util import find_spec
from typing import TYPE_CHECKING

from bench.judge.errors import NO_OPENAI_PACKAGE, NotJudged
from simworlds.llm.errors import Rejected
from simworlds.llm.messages import Text
from simworlds.llm.prices import Prices
from simworlds.llm.spending import Metered, Spending

if TYPE_CHECKING:
    from collections.abc import Callable

    from simworlds.llm.messages import Ask, Model, Turn
    from simworlds.llm.prices import Price
    from simworlds.llm.retries import Retry

# One strong vision model of each: the newest of the line that builds the scenes, and the paper's own judge.
DEFAULTS = {"anthropic": "claude-opus-5-5", "openai": "gpt-5.5"}


class JudgeProvider:
    """A Model for structured answers: the input of its call to the Ask's one tool becomes the text of its turn."""

    def __init__(
        self,
        name: str,
        model: str,
        connect: Callable[[], Model],
        *,
        spending: Spending | None = None,
        prices: Prices | None = None,
    ) -> None:
        """``connect`` may raise Rejected if a key is missing. ``spending`` counts the cost and holds the limit."""
        self.name = name
        self.model = model
        self.prices = prices or Prices()
        self.spending = spending or Spending(prices=self.prices)
        self._connect = connect
        self._connected: Model | None = None
        self._lock = threading.Lock()

    def ready(self) -> None:
        """Checks, without asking anything, that the key and all packages are there. Raises NotJudged."""
        with self._lock:
            if self._connected is None:
                try:
                    self._connected = Metered(self._connect(), self.spending)
                except Rejected as error:
                    raise NotJudged("not set up", str(error)) from error

    def answer(self, ask: Ask, on_text: Callable[[str], object] | None = None) -> Turn:
        """The turn, see Model. Raises ModelError, NotJudged."""
        self.ready()
        assert self._connected is not None
        return _as_text(self._connected.answer(replace(ask, model=self.model), on_text))


def provider_of(  # noqa: PLR0913
    name: str,
    *,
    model: str | None = None,
    base_url: str | None = None,
    max_cost: float | None = None,
    price: Price | None = None,
    tell: Callable[[Retry], object] | None = None,
) -> JudgeProvider:
    """A judge of that provider, not yet connected; ``openai`` needs the extra of that name.

    ``base_url``: another server with the provider's API. ``max_cost``: US dollars, over all questions. ``price``: of a
    model without a list price. ``tell`` is called on retries. Raises NotJudged, ValueError.
    """
    if name not in DEFAULTS:
        raise ValueError(f"There is no provider {name!r}. Choose {' or '.join(DEFAULTS)}.")
    chosen = model or DEFAULTS[name]
    prices = Prices({chosen: price} if price else None)
    spending = Spending(max_cost, prices)

    def anthropic() -> Model:
        from simworlds.llm.claude import Claude, Settings  # noqa: PLC0415 - loads the package

        return Claude(Settings(base_url=base_url, prices=prices), tell)

    def openai() -> Model:
        from bench.judge.openai_chat import OpenAIChat  # noqa: PLC0415

        return OpenAIChat(base_url, prices)

    if name == "openai" and find_spec("openai") is None:
        raise NotJudged("not set up", NO_OPENAI_PACKAGE)
    connect = {"anthropic": anthropic, "openai": openai}[name]
    return JudgeProvider(name, chosen, connect, spending=spending, prices=prices)


def _as_text(turn: Turn) -> Turn:
    """A turn whose text is the answer: the input of the tool call, or else what the model wrote."""
    if not turn.calls:
        return turn
    text = "\n".join(json.dumps(call.input, ensure_ascii=False) for call in turn.calls)
    return replace(turn, content=(Text(text),))
