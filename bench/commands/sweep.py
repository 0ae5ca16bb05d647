"""``simworlds bench run`` and ``simworlds bench rescore``."""

from __future__ import annotations

import os
import sys
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bench.commands.shared_options import blender_options, judge_cache, price_of, with_audit_options
from bench.commands.system_options import system_of, with_system_options
from simworlds.counting import counted
from simworlds.llm.apis.providers import PROVIDERS
from simworlds.terminal.finite_range import FiniteRange
from simworlds.terminal.options import combine

if TYPE_CHECKING:
    from collections.abc import Generator, Sequence

    from bench.sweep.executor import Executor
    from bench.sweep.judging import SweepJudge
    from bench.sweep.sweep import ScoringOptions, SweepSummary
    from bench.sweep.systems.system import SceneSystem

_PATH = click.Path(path_type=Path)

_scoring = combine(
    click.option(
        "--jobs",
        type=click.IntRange(1, 256),
        default=os.cpu_count() or 1,
        show_default="one a core",
        help="Scenes at a time.",
    ),
    click.option(
        "--frames",
        type=click.Choice(["video", "blend", "none"]),
        default="video",
        show_default=True,
        help="Of the system's video where there is one, of the .blend, or none.",
    ),
    click.option(
        "--frame-size",
        default="480x270",
        show_default=True,
        metavar="WxH",
        help="Of frames of a .blend: as many pixels, in the scene's proportions.",
    ),
    click.option(
        "--frame-samples",
        type=click.IntRange(1, 4096),
        default=16,
        show_default=True,
        help="Of frames of a .blend.",
    ),
    click.option(
        "--judge",
        type=click.Choice([*PROVIDERS, "none"]),
        default=PROVIDERS[0],
        show_default=True,
        help="Who judges the frames; needs a key.",
    ),
    click.option("--judge-model", metavar="NAME", help="The judge's model.  [default: as of 'bench judge']"),
    click.option("--judge-url", metavar="URL", help="Another server that speaks the provider's API."),
    click.option("--judge-max-cost", type=FiniteRange(0), metavar="USD", help="For all scenes together."),
    click.option(
        "--judge-price",
        metavar="IN/OUT",
        help="Dollars per million tokens, for a judge's model without a list price.",
    ),
    click.option("--judge-cache", type=_PATH, help="Folder of answers.  [default: in SimWorlds' own]"),
    with_audit_options,
)


@click.command()
@with_system_options
@click.option(
    "--scenes",
    multiple=True,
    metavar="NAMES",
    help="Ids, categories, levels, patterns, or all, dynamic, ablation; with commas.  [default: all; of replay, those "
    "with a transcript]",
)
@click.option(
    "--out",
    type=_PATH,
    default=Path("bench-results"),
    show_default=True,
    help="Folder of the results.",
)
@click.option(
    "--ray", metavar="auto|ADDRESS", help="Do it on a Ray cluster instead of here; needs the extra 'ray'."
)
@_scoring
def run(**given: Any) -> None:
    """Have a system make the benchmark's scenes, or take its .blend files; audit them, take frames, judge these.

    Results are kept below --out. The same command again goes on where it was, however it ended, and does again only
    what depends on something that changed. Exit code 0: each scene is scored, or it is told why not. 1: some could not
    be done here. 2: nothing could be begun. 130: it was interrupted.
    """
    from bench.sweep.sweep import make_tasks, sweep  # noqa: PLC0415 - not for --help
    from bench.sweep.sweep_view import make_view  # noqa: PLC0415

    with _errors():
        system = system_of(given)
        specs = _specs(given["scenes"], system)
        tasks = make_tasks(system, specs, given["out"].expanduser().resolve(), _scoring_options(given))
        system.ready()
        with closing(_judge(given)) as judge:
            summary = sweep(tasks, judge, _executor(given), make_view(sys.stderr, len(tasks)))
    _conclude([summary], given["out"])


@click.command()
@click.argument("results", type=_PATH)
@_scoring
def rescore(results: Path, **given: Any) -> None:
    """Score all that is in a folder of results anew, as far as specs, code, Blender or judge have changed since.

    No system is run again. What was scored stays where its file is gone. Exit codes as of 'run'.
    """
    from bench.sweep.sweep import make_rescore_tasks, sweep  # noqa: PLC0415 - not for --help
    from bench.sweep.sweep_view import make_view  # noqa: PLC0415

    summaries: list[SweepSummary] = []
    with _errors():
        systems = make_rescore_tasks(results.expanduser().resolve(), _scoring_options(given))
        if not systems:
            raise click.UsageError(f"There are no results in {results}.")
        with closing(_judge(given)) as judge:
            for tasks in systems:
                click.echo(f"{tasks[0].system.info.name}:", err=True)
                view = make_view(sys.stderr, len(tasks))
                summaries.append(sweep(tasks, judge, _executor(given), view))
    _conclude(summaries, results)


@contextmanager
def _errors() -> Generator[None]:
    """Ends the command with what is wrong in one sentence."""
    from bench.scenes.spec import BadSpec  # noqa: PLC0415
    from bench.sweep.records import BadSceneRecord  # noqa: PLC0415
    from bench.sweep.systems.system import SystemNotReady  # noqa: PLC0415
    from simworlds.sandbox.errors import BlenderError, Refusal  # noqa: PLC0415 - not for --help

    try:
        yield
    except (BadSpec, BadSceneRecord, SystemNotReady, Refusal, BlenderError, OSError) as error:
        click.echo(f"Error: {error}", err=True)
        sys.exit(2)
    except KeyboardInterrupt:
        click.echo("Interrupted. The same command goes on from here.", err=True)
        sys.exit(130)


# What was asked for


def _specs(names: Sequence[str], system: SceneSystem) -> Any:
    from bench.scenes.spec import specs  # noqa: PLC0415 - not for --help
    from bench.sweep.scene_selection import select_scenes  # noqa: PLC0415

    chosen = select_scenes(names) if names else tuple(spec for spec in specs() if system.is_for(spec))
    if not chosen:
        raise click.UsageError("--scenes names no scene.")
    return chosen


def _scoring_options(given: dict[str, Any]) -> ScoringOptions:
    from bench.frames.clip_frames import RenderQuality  # noqa: PLC0415 - not for --help
    from bench.sweep.sweep import ScoringOptions  # noqa: PLC0415

    look = RenderQuality(_pixels(given["frame_size"]), given["frame_samples"])
    return ScoringOptions(blender_options(given), look, given["frames"] != "none", given["frames"] == "video")


def _pixels(size: str) -> int:
    width, _, height = size.partition("x")
    if not (width.isdecimal() and height.isdecimal() and 256 <= int(width) * int(height) <= 4096 * 4096):
        raise click.UsageError(f"--frame-size takes WIDTHxHEIGHT, as 480x270; not {size[:40]!r}.")
    return int(width) * int(height)


def _judge(given: dict[str, Any]) -> SweepJudge:
    from bench.sweep.judging import JudgeOptions, judge_of  # noqa: PLC0415 - not for --help

    cache = judge_cache(given["judge_cache"])
    who = (given["judge"], given["judge_model"], given["judge_url"], given["judge_max_cost"], cache)
    return judge_of(JudgeOptions(*who, price_of(given["judge_price"])))


def _executor(given: dict[str, Any]) -> Executor:
    if given.get("ray"):
        from bench.sweep.ray_executor import RayExecutor  # noqa: PLC0415 - an optional extra

        return RayExecutor(given["ray"])
    from bench.sweep.executor import LocalExecutor  # noqa: PLC0415 - not for --help

    return LocalExecutor(given["jobs"])


# How it ended


def _conclude(summaries: Sequence[SweepSummary], out: Path) -> None:
    from bench.sweep.sweep_view import reason  # noqa: PLC0415 - not for --help

    for one in summaries:
        click.echo(f"{counted(one.asked, 'scene')}: {one.scored} scored, {one.judged} judged")
        for why, count in sorted(one.why_not_scored.items(), key=lambda item: -item[1]):
            click.echo(f"  {count} not scored: {reason(why)}")
        for why, count in sorted(one.why_not_judged.items(), key=lambda item: -item[1]):
            click.echo(f"  {count} not judged: {reason(why)}")
        for why, count in sorted(one.why_stands.items(), key=lambda item: -item[1]):
            click.echo(f"  {count} with an earlier judgement, which stays: {reason(why)}")
    faults = [fault for one in summaries for fault in one.faults]
    for scene, why in faults:
        click.echo(f"  {scene} could not be done: {reason(why)}", err=True)
    click.echo(f"Tables and page: simworlds bench report {out}")
    sys.exit(1 if faults else 0)
