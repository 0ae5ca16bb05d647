"""``simworlds bench judge``."""

from __future__ import annotations

import json
import sys
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bench.commands.scenes import chosen_spec
from bench.commands.shared_options import judge_cache, price_of, tell_on_terminal
from simworlds.llm.apis.providers import PROVIDERS, TOLD_DEFAULTS
from simworlds.terminal.finite_range import FiniteRange

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bench.judge.agreement import Agreement
    from bench.judge.errors import NotJudged
    from bench.judge.estimate import JudgeRequest
    from bench.judge.providers import JudgeProvider
    from bench.judge.verdicts import Judgement

_PATH = click.Path(path_type=Path)
_PASSING = ("refused", "cut short", "malformed")  # another attempt may succeed


@click.command()
@click.argument("frames", nargs=-1, type=_PATH)
@click.option("--scene", metavar="ID", help="Judge by this scene's prompt (see list), or a YAML file's.")
@click.option("--prompt", metavar="TEXT", help="Judge by a prompt of your own.")
@click.option("--static", is_flag=True, help="The prompt asks for a still. Not needed with --scene.")
@click.option("--provider", type=click.Choice(PROVIDERS), default=PROVIDERS[0], show_default=True)
@click.option("--model", metavar="NAME", help=f"The model.  [default: {TOLD_DEFAULTS}]")
@click.option("--base-url", metavar="URL", help="Another server with the provider's API.")
@click.option("--repeat", type=click.IntRange(1, 100), default=1, show_default=True, help="Judge so often.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@click.option("--cache", type=_PATH, help="Folder of cached answers.  [default: in SimWorlds' cache]")
@click.option("--max-cost", type=FiniteRange(0), metavar="USD", help="Stop before it could cost more.")
@click.option(
    "--price", metavar="IN/OUT", help="Dollars per million tokens, for a model without a list price."
)
@click.option("--dry-run", is_flag=True, help="Show the questions and what they can cost; call no model.")
def judge(frames: tuple[Path, ...], **given: Any) -> None:
    """Judge FRAMES by a prompt: evenly spaced frames of a film, from first to last; for a still, one.

    A model lists what the prompt asks for, then says for each item whether the frames show it. This needs a key
    (ANTHROPIC_API_KEY or OPENAI_API_KEY), except with --dry-run. A dry run without frames assumes five; without a
    prompt, it shows what all scenes of the benchmark would cost for one system. Answers are cached.

    Exit code 0: judged, whatever the score. 2: not judged; the reason is printed.
    """
    from bench.judge.errors import NotJudged  # noqa: PLC0415 - not for --help
    from simworlds.llm.apis.providers import DEFAULT_MODELS  # noqa: PLC0415

    given["price"] = price_of(given["price"])
    given["model"] = given["model"] or DEFAULT_MODELS[given["provider"]]
    given["cache"] = judge_cache(given["cache"])
    wanted = _request(frames, given)
    if (frames and wanted is None) or not (frames or given["dry_run"]):
        raise click.UsageError("Give the frames, and --scene or --prompt.")
    try:
        if given["dry_run"]:
            _dry_run(wanted, given)
        elif wanted is not None:
            _judge(wanted, given)
    except NotJudged as error:
        click.echo(f"Not judged ({error.reason}): {error}", err=True)
        sys.exit(2)
    except KeyboardInterrupt:
        click.echo("Interrupted. Complete answers are cached.", err=True)
        sys.exit(130)


def _request(frames: Sequence[Path], given: dict[str, Any]) -> JudgeRequest | None:
    """The judgement that is requested; None without a scene or prompt."""
    from bench.judge.estimate import JudgeRequest  # noqa: PLC0415 - not for --help

    if given["scene"] is not None and given["prompt"] is not None:
        raise click.UsageError("Give --scene or --prompt, not both.")
    if given["prompt"] is not None:
        return JudgeRequest(given["prompt"], given["static"], frames)
    if given["scene"] is None:
        return None
    spec = chosen_spec(given["scene"])
    static = spec.category == "static"
    if given["static"] and not static:
        raise click.UsageError(f"{spec.id} is not a static scene; leave out --static.")
    return JudgeRequest(spec.prompt, static, frames, spec.id)


# Judging


def _judge(request: JudgeRequest, given: dict[str, Any]) -> None:
    from bench.judge.agreement import agreement  # noqa: PLC0415 - not for --help
    from bench.judge.errors import NotJudged  # noqa: PLC0415
    from bench.judge.judge import judge as run  # noqa: PLC0415
    from bench.judge.judgement_text import judgement_lines  # noqa: PLC0415
    from bench.judge.providers import provider_of  # noqa: PLC0415

    names = ("model", "base_url", "max_cost", "price")
    provider = provider_of(given["provider"], tell=tell_on_terminal, **{name: given[name] for name in names})
    judgements: list[Judgement] = []
    failed: list[tuple[int, NotJudged]] = []
    with closing(provider):
        for number in range(given["repeat"]):
            try:
                judgements.append(
                    run(
                        request.prompt,
                        request.frames,
                        static=request.static,
                        provider=provider,
                        cache=given["cache"],
                        scene=request.scene,
                        repetition=number,
                        tell=tell_on_terminal,
                    )
                )
            except NotJudged as error:
                failed.append((number, error))
                if error.reason not in _PASSING:
                    break
    agreements = agreement(judgements) if len(judgements) > 1 else None
    if given["as_json"]:
        click.echo(
            json.dumps(_as_json(judgements, failed, agreements, provider), indent=1, ensure_ascii=False)
        )
    elif judgements:
        click.echo("\n".join(judgement_lines(judgements, agreements, provider.spending.total())))
    for number, error in failed:
        which = f" (repetition {number})" if given["repeat"] > 1 else ""
        click.echo(f"Not judged{which}: {error.reason}: {error}", err=True)
    sys.exit(2 if failed else 0)


def _as_json(
    judgements: Sequence[Judgement],
    failed: Sequence[tuple[int, NotJudged]],
    agreements: Agreement | None,
    provider: JudgeProvider,
) -> dict[str, Any]:
    spent = provider.spending.total()
    return {
        "judgements": [judgement.model_dump(mode="json") for judgement in judgements],
        "not_judged": [
            {"repetition": number, "reason": error.reason, "message": str(error)} for number, error in failed
        ],
        "agreement": agreements.model_dump(mode="json") if agreements else None,
        "asked_now": {"requests": spent.calls, "cost": None if spent.unpriced else spent.cost},
    }


# Dry run


def _dry_run(request: JudgeRequest | None, given: dict[str, Any]) -> None:
    from bench.judge.estimate import JudgeRequest, estimate  # noqa: PLC0415
    from bench.judge.judgement_text import question_lines, sum_lines  # noqa: PLC0415
    from bench.judge.providers import identity_of  # noqa: PLC0415
    from bench.scenes.spec import specs  # noqa: PLC0415
    from simworlds.llm.prices import Prices  # noqa: PLC0415 - not for --help

    identity = identity_of(given["provider"], given["model"], given["base_url"])
    prices = Prices({given["model"]: given["price"]} if given["price"] else None)
    requests = (
        [request] if request else [JudgeRequest(spec.prompt, spec.category == "static") for spec in specs()]
    )
    questions = [
        question
        for question in requests
        for question in estimate(
            question,
            identity,
            prices=prices,
            cache=given["cache"],
            repeat=given["repeat"],
        )
    ]
    if given["as_json"]:
        click.echo(
            json.dumps(
                [question.model_dump(mode="json") for question in questions], indent=1, ensure_ascii=False
            )
        )
        return
    if request:
        click.echo("\n".join(line for question in questions for line in question_lines(question)))
    click.echo("\n".join(sum_lines(questions, f"{given['provider']}/{given['model']}")))
