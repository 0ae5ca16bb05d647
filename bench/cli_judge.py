"""``simworlds bench judge``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bench.cli_specs import chosen_spec

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from agents.models.prices import Price
    from bench.judge.agreement import Agreed, Agreement
    from bench.judge.errors import NotJudged
    from bench.judge.estimate import Asked, Question
    from bench.judge.providers import Provider
    from bench.judge.verdicts import Item, Judgement

_PATH = click.Path(path_type=Path)
_PROVIDERS = ("anthropic", "openai")
_WIDTH = 110
_PASSING = ("refused", "cut short", "malformed")  # another time, the model may answer otherwise


@click.command()
@click.argument("frames", nargs=-1, type=_PATH)
@click.option("--scene", metavar="ID", help="Judge by this scene's prompt (see list), or a YAML file's.")
@click.option("--prompt", metavar="TEXT", help="Judge by a prompt of your own.")
@click.option("--static", is_flag=True, help="The prompt asks for a still. Scenes know by themselves.")
@click.option("--provider", type=click.Choice(_PROVIDERS), default="anthropic", show_default=True)
@click.option("--model", metavar="NAME", help="The model.  [default: claude-opus-5-5, or gpt-5.5 of openai]")
@click.option("--base-url", metavar="URL", help="Another server that speaks the provider's API.")
@click.option("--repeat", type=click.IntRange(1, 100), default=1, show_default=True, help="Judge so often.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@click.option("--cache", type=_PATH, help="Folder that answers are kept in.  [default: in SimWorlds' own]")
@click.option("--max-cost", type=click.FloatRange(0), metavar="USD", help="Ask nothing that might cost more.")
@click.option("--price", metavar="IN/OUT", help="Dollars per million tokens, of a model that is in no list.")
@click.option("--dry-run", is_flag=True, help="Show what would be asked, and what it can cost; ask nobody.")
def judge(frames: tuple[Path, ...], **given: Any) -> None:
    """Judge FRAMES by a prompt: pictures from the first to the last of a film, evenly spread; of a still, one.

    A model lists what the prompt asks for, then says of each item whether the frames show it. Needs a key
    (ANTHROPIC_API_KEY or OPENAI_API_KEY); with --dry-run, none. Without frames, a dry run assumes five of them; without
    a prompt, it tells what all scenes of the benchmark would cost for one system. Nothing is asked twice.

    Exit code 0: judged, well or badly. 2: not judged, and the reason is told.
    """
    from bench.judge.errors import NotJudged  # noqa: PLC0415 - not for --help
    from bench.judge.providers import DEFAULTS  # noqa: PLC0415

    given["price"] = _price(given["price"])
    given["model"] = given["model"] or DEFAULTS[given["provider"]]
    given["cache"] = given["cache"] or _own_cache()
    try:
        if given["dry_run"]:
            _dry_run(_wanted(frames, given), given)
            return
        [wanted] = _wanted(frames, given)[:1] or [None]
        if wanted is None or not frames:
            raise click.UsageError("Give the frames, and --scene or --prompt.")
        _judge(wanted, given)
    except NotJudged as error:
        click.echo(f"Not judged ({error.reason}): {error}", err=True)
        sys.exit(2)
    except KeyboardInterrupt:
        click.echo("Interrupted. What was answered is kept.", err=True)
        sys.exit(130)


def _wanted(frames: Sequence[Path], given: dict[str, Any]) -> list[Asked]:
    """What is to be judged; empty where nothing is named."""
    from bench.judge.estimate import Asked  # noqa: PLC0415 - not for --help

    if given["scene"] is not None and given["prompt"] is not None:
        raise click.UsageError("Give --scene or --prompt, not both.")
    if given["prompt"] is not None:
        return [Asked(given["prompt"], given["static"], frames)]
    if given["scene"] is None:
        return []
    spec = chosen_spec(given["scene"])
    static = spec.category == "static"
    if given["static"] and not static:
        raise click.UsageError(f"{spec.id} is no still.")
    return [Asked(spec.prompt, static, frames)]


def _price(text: str | None) -> Price | None:
    from agents.models.prices import read_price  # noqa: PLC0415 - not for --help

    try:
        return None if text is None else read_price(text)
    except ValueError as error:
        raise click.UsageError(str(error)) from error


def _own_cache() -> Path:
    from kb_build.settings import cache_folder, home_folder  # noqa: PLC0415 - not for --help

    return cache_folder(home_folder()) / "judge"


def _tell(doing: object) -> None:
    """Says on a terminal what is being done; elsewhere, nothing: it takes seconds."""
    if sys.stderr.isatty():
        click.echo(f"{doing} …", err=True)


# Judging


def _judge(wanted: Asked, given: dict[str, Any]) -> None:
    from bench.judge.agreement import agreement  # noqa: PLC0415 - not for --help
    from bench.judge.errors import NotJudged  # noqa: PLC0415
    from bench.judge.judge import judge as run  # noqa: PLC0415
    from bench.judge.providers import provider_of  # noqa: PLC0415

    names = ("model", "base_url", "max_cost", "price")
    provider = provider_of(given["provider"], tell=_tell, **{name: given[name] for name in names})
    judged: list[Judgement] = []
    failed: list[tuple[int, NotJudged]] = []
    for number in range(given["repeat"]):
        try:
            judged.append(
                run(
                    wanted.prompt,
                    wanted.frames,
                    static=wanted.static,
                    provider=provider,
                    cache=given["cache"],
                    scene=given["scene"] or "",
                    repetition=number,
                    tell=_tell,
                )
            )
        except NotJudged as error:
            failed.append((number, error))
            if error.reason not in _PASSING:
                break
    agreed = agreement(judged) if len(judged) > 1 else None
    if given["as_json"]:
        click.echo(json.dumps(_as_json(judged, failed, agreed, provider), indent=1, ensure_ascii=False))
    else:
        click.echo("\n".join(_lines(judged, agreed, provider)))
    for number, error in failed:
        which = f" (repetition {number})" if given["repeat"] > 1 else ""
        click.echo(f"Not judged{which}: {error.reason}: {error}", err=True)
    sys.exit(2 if failed else 0)


def _as_json(
    judged: Sequence[Judgement],
    failed: Sequence[tuple[int, NotJudged]],
    agreed: Agreement | None,
    provider: Provider,
) -> dict[str, Any]:
    spent = provider.spending.total()
    return {
        "judgements": [one.model_dump(mode="json") for one in judged],
        "not_judged": [
            {"repetition": number, "reason": error.reason, "message": str(error)} for number, error in failed
        ],
        "agreement": agreed.model_dump(mode="json") if agreed else None,
        "asked_now": {"requests": spent.calls, "cost": None if spent.unpriced else spent.cost},
    }


def _lines(judged: Sequence[Judgement], agreed: Agreement | None, provider: Provider) -> Iterator[str]:
    for one in judged:
        yield from _judgement(one)
        yield ""
    if agreed:
        yield from _agreement(agreed)
        yield ""
    spent = provider.spending.total()
    if not spent.calls:
        yield "Nothing was asked now: all answers were kept."
    else:
        cost = None if spent.unpriced else spent.cost
        yield (
            f"Asked now: {spent.calls} request{'s' if spent.calls > 1 else ''}, {_usd(cost)}, "
            f"{spent.usage.prompt:,} tokens in, {spent.usage.output:,} out"
        )


def _judgement(one: Judgement) -> Iterator[str]:
    label = f"{one.scene}: " if one.scene else ""
    again = f", repetition {one.repetition}" if one.repetition else ""
    yield f"{label}{one.provider}/{one.answered_by}, prompts {one.prompt_version}, items by {one.items_by}{again}"
    for name, items in one.dimensions.items():
        yield ""
        yield f"{name} {_number(one.scores[name])}"
        for item in items:
            yield from _item(item)
    yield ""
    yield (
        f"score {_number(one.score)}   {_usd(one.cost)} and, once for the prompt, {_usd(one.items_cost)}; "
        f"{one.usage.input:,} tokens in, {one.usage.output:,} out"
    )


def _item(item: Item) -> Iterator[str]:
    frames = f" [{', '.join(map(str, item.frames))}]" if item.frames else ""
    yield f"  {'✓' if item.holds else '✗'} {item.text}"
    yield click.wrap_text(f"{item.evidence}{frames}", _WIDTH, "      ", "      ")


def _agreement(agreed: Agreement) -> Iterator[str]:
    yield f"agreement of {agreed.judgements} judgements     κ  pairwise   score ± sd"
    for name, one in (*agreed.dimensions.items(), ("all items", agreed.overall)):
        yield _agreed(name, one)
    split = {name: share for name, share in agreed.shares.items() if 0 < share < 1}
    if split:
        yield f"not of one mind on {', '.join(f'{name} ({share:.2f})' for name, share in split.items())}"


def _agreed(name: str, one: Agreed) -> str:
    sd = "" if one.sd is None else f" ± {one.sd:.3f}"
    return f"  {name:<22}{_number(one.kappa):>11}{_number(one.pairwise):>10}   {_number(one.mean)}{sd}"


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.3f}"


def _usd(value: float | None) -> str:
    return "price not known" if value is None else f"${value:.4f}"


# Asking nobody


def _dry_run(wanted: Sequence[Asked], given: dict[str, Any]) -> None:
    from agents.models.prices import Prices  # noqa: PLC0415 - not for --help
    from bench.judge.estimate import Asked, estimate  # noqa: PLC0415
    from bench.spec import specs  # noqa: PLC0415

    prices = Prices({given["model"]: given["price"]} if given["price"] else None)
    named = wanted or [Asked(spec.prompt, spec.category == "static") for spec in specs()]
    questions = [
        question
        for one in named
        for question in estimate(
            one,
            given["provider"],
            given["model"],
            prices=prices,
            cache=given["cache"],
            repeat=given["repeat"],
        )
    ]
    if given["as_json"]:
        click.echo(
            json.dumps([one.model_dump(mode="json") for one in questions], indent=1, ensure_ascii=False)
        )
        return
    if wanted:
        click.echo("\n".join(line for one in questions for line in _question(one)))
    click.echo("\n".join(_sums(questions, f"{given['provider']}/{given['model']}")))


def _question(one: Question) -> Iterator[str]:
    times = "kept, not asked" if not one.times else f"asked {one.times} time{'s' if one.times > 1 else ''}"
    yield f"═══ {one.stage}: {times}, {one.pictures} pictures, about {one.tokens:,} tokens ═══"
    yield one.system
    yield "─── the user ───"
    yield from one.said
    yield ""


def _sums(questions: Sequence[Question], who: str) -> Iterator[str]:
    yield f"{who} would be asked:"
    for stage in dict.fromkeys(one.stage for one in questions):
        rows = [one for one in questions if one.stage == stage]
        cost = _total((one.cost, one.times) for one in rows)
        most = _total((one.most, one.times) for one in rows)
        yield (
            f"  {stage:<9}{sum(one.times for one in rows):>5} times, {sum(one.tokens * one.times for one in rows):>9,} "
            f"tokens and {sum(one.pictures * one.times for one in rows):>4} pictures in: {_usd(cost)} without the "
            f"answers, {_usd(most)} with the longest there can be"
        )
    yield "An answer that is none is asked for again, at most twice. Tokens are estimates, rather too many."


def _total(costs: Iterable[tuple[float | None, int]]) -> float | None:
    total = 0.0
    for cost, times in costs:
        if cost is None:
            return None
        total += cost * times
    return total
