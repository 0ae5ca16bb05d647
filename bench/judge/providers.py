"""The judge: a provider's model, connected at its first question, and the limit of its cost."""

from __future__ import annotations

import json
import os
import threading
from dataclasses import replace
from importlib.util import find_spec
from typing import TYPE_CHECKING, NamedTuple

from bench.judge.errors import NotJudged
from simworlds.llm.apis.attempts import Settings
from simworlds.llm.apis.openai_chat import NO_PACKAGE
from simworlds.llm.apis.providers import DEFAULT_MODELS, PROVIDERS, connect
from simworlds.llm.errors import Rejected
from simworlds.llm.messages import Text
from simworlds.llm.prices import Prices
from simworlds.llm.spending import Metered, Spending

if TYPE_CHECKING:
    from collections.abc import Callable

    from simworlds.llm.apis.providers import Connection, ProviderName
    from simworlds.llm.apis.retries import Retry
    from simworlds.llm.messages import Ask, Turn
    from simworlds.llm.prices import Price


_STRUCTURED = ("openai",)  # providers with structured outputs


class JudgeIdentity(NamedTuple):
    """Who judges: one name of a model may stand for several on servers with the same API."""

    provider: str
    model: str
    base_url: str | None = None


def identity_of(name: ProviderName, model: str | None = None, base_url: str | None = None) -> JudgeIdentity:
    """The judge that these options name, with what the environment says of the server."""
    server = base_url or os.environ.get(f"{name.upper()}_BASE_URL", "").strip() or None
    return JudgeIdentity(name, model or DEFAULT_MODELS[name], server)


class JudgeProvider:
    """A Model for structured answers: what an Ask's one tool takes is the form of the answer.

    Where the API has structured outputs, they hold the model to it; else the input of its call becomes the text of the
    turn.
    """

    def __init__(
        self,
        identity: JudgeIdentity,
        connect: Callable[[], Connection],
        *,
        spending: Spending | None = None,
        prices: Prices | None = None,
    ) -> None:
        """``connect`` may raise Rejected if a key is missing. ``spending`` counts the cost and holds the limit."""
        self.identity = identity
        self.name, self.model = identity.provider, identity.model
        self.prices = prices or Prices()
        self.spending = spending or Spending(prices=self.prices)
        self._connect = connect
        self._connection: Connection | None = None
        self._lock = threading.Lock()

    def ready(self) -> None:
        """Checks, without asking anything, that the key and all packages are there. Raises NotJudged."""
        with self._lock:
            if self._connection is None:
                try:
                    self._connection = self._connect()
                except Rejected as error:
                    raise NotJudged("not set up", str(error)) from error

    def answer(self, ask: Ask, on_text: Callable[[str], object] | None = None) -> Turn:
        """The turn, see Model. Raises ModelError, NotJudged."""
        self.ready()
        assert self._connection is not None
        ask = replace(ask, model=self.model)
        if self.name in _STRUCTURED:
            (form,) = ask.tools
            ask = replace(ask, tools=(), form=form)
        return _as_text(Metered(self._connection, self.spending).answer(ask, on_text))

    def close(self) -> None:
        """Closes the connections; what is asked afterwards opens new ones."""
        with self._lock:
            if self._connection is not None:
                self._connection.close()
                self._connection = None


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
    if name not in PROVIDERS:
        raise ValueError(f"There is no provider {name!r}. Choose {' or '.join(PROVIDERS)}.")
    identity = identity_of(name, model, base_url)
    prices = Prices({identity.model: price} if price else None)
    settings = Settings(base_url=base_url, prices=prices)
    if name == "openai" and find_spec("openai") is None:
        raise NotJudged("not set up", NO_PACKAGE)
    return JudgeProvider(
        identity,
        lambda: connect(name, settings, tell),
        spending=Spending(max_cost, prices),
        prices=prices,
    )


def _as_text(turn: Turn) -> Turn:
    """A turn whose text is the answer: the input of the tool call, or else what the model wrote."""
    if not turn.calls:
        return turn
    text = "\n".join(json.dumps(call.input, ensure_ascii=False) for call in turn.calls)
    return replace(turn, content=(Text(text),))
