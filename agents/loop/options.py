"""The options of a run: journalled at its beginning, and valid for all its sessions."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from simworlds.llm.apis.providers import DEFAULT_MODELS, ProviderName
from simworlds.llm.prices import Prices, read_price

Mode = Literal["make", "edit"]
Origin = Literal["live", "session", "replay"]

BEFORE_DRAFTS = {"early": False, "planner_looks": False}  # in records that are older than these options


class Options(BaseModel):
    """What does not change from session to session.

    ``origin``: where answers come from: a live model, a ``session`` (a transcript, its name) that was answered ``by``
    somebody, or the ``replay`` of another run (its folder). ``file``, ``reference``: what is edited, and a picture of
    what it should be. ``provider``: the API that live models are reached by. ``price``: IN/OUT in dollars per million
    tokens, of models without a list price. ``verifier``, ``stages``: False leaves that out (the paper's ablations).
    ``early``: the scene is delivered as each stage closes, and a draft before the film; ``planner_looks``: the planner
    decides on that draft. ``assets``: the user's asset library. Runs that were begun without these go on without them.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    mode: Mode = "make"
    prompt: str = Field(min_length=1, max_length=20_000)
    file: Path | None = None
    reference: Path | None = None
    origin: Origin = "live"
    source: str = ""
    by: str = "hand"
    provider: ProviderName = "anthropic"
    model: str = ""
    price: str | None = None
    models: dict[str, str] = Field(default_factory=dict[str, str])
    blender: str | None = None
    blender_exe: Path | None = None
    sandbox: Literal["bubblewrap", "landlock", "none"] | None = None
    read: tuple[Path, ...] = ()
    assets: Path | None = None
    render_minutes: float | None = Field(default=None, gt=0)
    samples: int | None = Field(default=None, ge=1)
    verifier: bool = True
    stages: bool = True
    early: bool = True
    planner_looks: bool = True

    @model_validator(mode="before")
    @classmethod
    def _default_model(cls, given: Any) -> Any:
        if isinstance(given, dict) and not given.get("model"):
            provider = given.get("provider", "anthropic")
            return {**given, "model": DEFAULT_MODELS.get(provider, "")}
        return given

    @field_validator("price")
    @classmethod
    def _readable_price(cls, price: str | None) -> str | None:
        if price is not None:
            read_price(price)
        return price

    @property
    def prices(self) -> Prices:
        """The prices in use: the list's, and ``price`` for models that are not in it."""
        if self.price is None:
            return Prices()
        given, listed = read_price(self.price), Prices()
        names = (self.model, *self.models.values())
        return Prices({name: given for name in names if listed.of(name) is None})

    def model_of(self, role: str) -> str:
        """The model that answers for a role."""
        return self.models.get(role, self.model)

    @property
    def source_text(self) -> str:
        """Where the answers come from, in words."""
        match self.origin:
            case "session":
                return f"transcript {self.source}, answered by {self.by}"
            case "replay":
                return f"recorded: {self.source}"
            case _:
                return "live"


class RunLimits(BaseModel):
    """What one session may use: minutes; from now on, how films are rendered, and the dollars of the whole run."""

    model_config = ConfigDict(frozen=True)

    max_cost: float | None = Field(default=None, ge=0)
    max_minutes: float | None = Field(default=None, gt=0)
    render_minutes: float | None = Field(default=None, gt=0)
    samples: int | None = Field(default=None, ge=1)
