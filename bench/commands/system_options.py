"""The options of ``simworlds bench run`` that say which system makes the scenes, and the system that they mean."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from simworlds.llm.apis.providers import PROVIDERS
from simworlds.terminal.finite_range import FiniteRange
from simworlds.terminal.options import combine

if TYPE_CHECKING:
    from bench.sweep.records import Ablation, SystemInfo
    from bench.sweep.systems.system import SceneSystem

_ROLES = "planner, coder, reviewer, final_reviewer"
_BOTH = "simworlds, replay:"
# Options that the commands of a system take too: what results depend on, and what ends a session at a run.
_SETTINGS = ("provider", "model", "samples", "render_minutes", "blender", "blender_exe")
_LIMITS = ("max_cost", "max_minutes")


with_system_options = combine(
    click.option(
        "--system",
        required=True,
        metavar="simworlds|replay|folder=DIR",
        help="Who makes the scenes: SimWorlds, the transcripts that ship with it, or the author of the files in DIR.",
    ),
    click.option("--name", help="What the results call it.  [default: simworlds, replay, DIR's name]"),
    click.option(
        "--provider",
        type=click.Choice(PROVIDERS),
        help=f"simworlds: whose API the model is asked by.  [default: {PROVIDERS[0]}]",
    ),
    click.option("--model", metavar="NAME", help="simworlds: the model for all roles."),
    click.option(
        "--price",
        metavar="IN/OUT",
        help="simworlds: dollars per million tokens, of models that are in no list.",
    ),
    click.option(
        "--role-model", multiple=True, metavar="ROLE=NAME", help=f"simworlds: another one for {_ROLES}."
    ),
    click.option("--max-cost", type=FiniteRange(0), metavar="USD", help="simworlds: for each scene."),
    click.option("--max-minutes", type=FiniteRange(0, min_open=True), help=f"{_BOTH} for each scene."),
    click.option("--samples", type=click.IntRange(1), help=f"{_BOTH} samples of the rendering."),
    click.option("--render-minutes", type=FiniteRange(0, min_open=True), help=f"{_BOTH} for the rendering."),
    click.option("--no-verifier", is_flag=True, help="simworlds: leave the verifier out (ablation)."),
    click.option("--no-stages", is_flag=True, help="simworlds: build everything in one pass (ablation)."),
)


def system_of(given: dict[str, Any]) -> SceneSystem:
    """The system that the options mean. Raises UsageError."""
    from bench.sweep.systems.folder import FolderSystem  # noqa: PLC0415 - not for --help
    from bench.sweep.systems.simworlds_runs import ReplaySystem, SimWorldsSystem  # noqa: PLC0415

    kind, _, folder = str(given["system"]).partition("=")
    if kind == "folder" and folder:
        _refuse(
            given,
            "folder",
            "provider",
            "model",
            "price",
            "role_model",
            "max_cost",
            "max_minutes",
            "samples",
            "render_minutes",
            "no_verifier",
            "no_stages",
        )
        source = Path(folder).expanduser().resolve()
        return FolderSystem(
            _info("folder", given["name"] or _as_name(source.name), (), {"folder": str(source)}), source
        )
    if folder or kind not in ("simworlds", "replay"):
        raise click.UsageError("--system is simworlds, replay, or folder=DIR.")
    ablations: tuple[Ablation, ...] = (
        *(("no-verifier",) if given["no_verifier"] else ()),
        *(("no-stages",) if given["no_stages"] else ()),
    )
    if kind == "replay":
        _refuse(
            given,
            "replay",
            "provider",
            "model",
            "price",
            "role_model",
            "max_cost",
            "no_verifier",
            "no_stages",
        )
        return ReplaySystem(
            _info("replay", given["name"] or "replay", (), _settings(given)), _options(given), _limits(given)
        )
    name = given["name"] or "+".join(("simworlds", *ablations))
    return SimWorldsSystem(
        _info("simworlds", name, ablations, _settings(given)), _options(given), _limits(given)
    )


def _refuse(given: dict[str, Any], kind: str, *names: str) -> None:
    for name in names:
        if given[name]:
            raise click.UsageError(f"--{name.replace('_', '-')} means nothing with --system {kind}.")


def _info(kind: Any, name: str, ablations: tuple[Ablation, ...], settings: dict[str, Any]) -> SystemInfo:
    from pydantic import ValidationError  # noqa: PLC0415 - not for --help

    from bench.sweep.records import SystemInfo  # noqa: PLC0415

    try:
        return SystemInfo(name=name, kind=kind, ablations=ablations, settings=settings)
    except ValidationError:
        raise click.UsageError(
            f"{name!r} is not a valid name: give letters, digits, '.', '_', '+' and '-'."
        ) from None


def _as_name(name: str) -> str:
    kept = "".join(char if char.isascii() and (char.isalnum() or char in "._+-") else "-" for char in name)
    return kept.lstrip("._+-")[:80] or "folder"


def _settings(given: dict[str, Any]) -> dict[str, Any]:
    """What the system's results depend on."""
    settings = {name: given[name] for name in _SETTINGS if given[name] is not None}
    if given["role_model"]:
        settings["role_model"] = sorted(given["role_model"])
    return {name: str(value) if isinstance(value, Path) else value for name, value in settings.items()}


def _options(given: dict[str, Any]) -> tuple[str, ...]:
    """The same as words of a command, with what Blender may read."""
    options = [(name, given[name]) for name in _SETTINGS if given[name] is not None]
    options += [("price", given["price"])] if given["price"] else []
    options += [("role_model", role_model) for role_model in given["role_model"]]
    options += [("read", folder.expanduser().resolve()) for folder in given["read"]]
    flags = [f"--{name.replace('_', '-')}" for name in ("no_verifier", "no_stages") if given[name]]
    return (*_words(options), *flags)


def _limits(given: dict[str, Any]) -> tuple[str, ...]:
    return _words([(name, given[name]) for name in _LIMITS if given[name] is not None])


def _words(options: list[tuple[str, Any]]) -> tuple[str, ...]:
    return tuple(word for name, value in options for word in (f"--{name.replace('_', '-')}", str(value)))
