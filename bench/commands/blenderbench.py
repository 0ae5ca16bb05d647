"""The commands ``simworlds bench blenderbench``: ``tasks``, ``run``, ``score``, ``report``."""

from __future__ import annotations

import json
import signal
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bench.commands.shared_options import MEMORY, judge_cache, price_of, with_blender_version
from simworlds.llm.apis.providers import PROVIDERS, TOLD_DEFAULTS
from simworlds.terminal.finite_range import FiniteRange

if TYPE_CHECKING:
    from collections.abc import Generator
    from types import FrameType

    from bench.blenderbench.results import Score
    from bench.blenderbench.score import ScoringRule
    from bench.judge.providers import JudgeProvider

_PATH = click.Path(path_type=Path)
_FOLDER = click.Path(file_okay=False, resolve_path=True, path_type=Path)
_GIB = 1024**3


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
def blenderbench() -> None:
    """BlenderBench: score edits of Blender scenes by how near their renders come to the goals.

    The set is not part of SimWorlds; its folder holds level1, level2 and level3. First 'run' has a system edit its
    tasks, then 'score' compares what was rendered with the goals, and 'report' prints the table.
    """


@blenderbench.command()
@click.argument("folder", metavar="SET", type=_FOLDER)
def tasks(folder: Path) -> None:
    """List the tasks in SET, and what is wrong with those that cannot be used.

    Exit code 0: all can be used. 1: some cannot. 2: none can.
    """
    from bench.blenderbench.task_set import read_set  # noqa: PLC0415 - not for --help

    with _errors_as_text():
        task_set = read_set(folder)
    for task in task_set.tasks:
        extra = ", with a visual prompt" if task.visprompt else ""
        click.echo(f"{task.id}  {task.size[0]} × {task.size[1]}{extra}  {' '.join(task.instruction.split())}")
    for fault in task_set.faults:
        click.echo(f"Cannot be used: {fault}", err=True)
    sys.exit(1 if task_set.faults else 0)


@blenderbench.command()
@click.argument("folder", metavar="SET", type=_FOLDER)
@click.option(
    "--system", required=True, metavar="NAME", help="start (nobody edits), simworlds, or folder=DIR."
)
@click.option("--out", required=True, type=_FOLDER, help="Folder of the results; goes on with what it holds.")
@click.option("--task", "names", multiple=True, metavar="NAME", help="A level, or a task as level1/attic.")
@click.option("--name", metavar="TEXT", help="What the system is called in tables.")
@click.option("--samples", type=click.IntRange(1, 65536), default=512, show_default=True, help="Of Cycles.")
@click.option(
    "--reference",
    type=click.Choice(["goal", "visprompt"]),
    default="goal",
    show_default=True,
    help="The picture that SimWorlds is given; a task without a visual prompt has its goal.",
)
@click.option("--model", metavar="NAME", help="Of SimWorlds.  [default: as of 'simworlds edit']")
@click.option("--max-cost", type=FiniteRange(0), metavar="USD", help="Of SimWorlds, for each task.")
@click.option("--max-minutes", type=FiniteRange(0, min_open=True), help="Of SimWorlds, for each task.")
@click.option(
    "--seconds",
    type=FiniteRange(1),
    default=1800.0,
    show_default=True,
    help="How long a step in Blender may take.",
)
@click.option("--memory", type=MEMORY, help="How much memory Blender may take (GiB).")
@with_blender_version
def run(folder: Path, **given: Any) -> None:
    """Have a system edit the tasks of SET, and render what came of it.

    Each task's start.py is run on its raw file before anything looks at the scene. Files and code of the set run in a
    confined Blender. DIR of folder=DIR holds renders that anybody made: DIR/level1/TASK/*.png, one a round, in the
    order of their names. What is done is not done again; a task that came to nothing is tried once more.

    Exit code 0: every task was rendered. 1: some came to nothing, and their records say why. 2: nothing could be run.
    """
    from bench.blenderbench.run import run as start  # noqa: PLC0415
    from bench.blenderbench.systems import system_of  # noqa: PLC0415
    from bench.blenderbench.task_scenes import EditRenderSettings  # noqa: PLC0415
    from bench.blenderbench.task_set import read_set, select_tasks  # noqa: PLC0415
    from simworlds.sandbox.errors import BlenderError  # noqa: PLC0415 - not for --help

    memory = int(given["memory"] * _GIB) if given["memory"] else None
    rendering = EditRenderSettings(
        given["samples"], given["blender"], given["blender_exe"], given["seconds"], memory
    )
    options = _words(given, "model", "blender", "blender_exe")
    limits = _words(given, "max_cost", "max_minutes")
    with _errors_as_text(BlenderError):
        system = system_of(given["system"], rendering, given["reference"], options, limits)
        found = read_set(folder)
        for fault in found.faults:
            click.echo(f"Cannot be used: {fault}", err=True)
        wanted = select_tasks(found, given["names"])
        records = start(found, wanted, system, given["out"], name=given["name"] or "", tell=_tell)
    for record in records:
        for note in record.notes:
            click.echo(f"{record.task}: {note}", err=True)
        if record.why is not None:
            click.echo(f"{record.task}: nothing to score: {record.why}", err=True)
    done = sum(record.why is None for record in records)
    click.echo(f"{done} of {len(records)} tasks rendered: {given['out']}")
    sys.exit(0 if done == len(records) else 1)


@blenderbench.command()
@click.argument("out", metavar="RESULTS", type=_FOLDER)
@click.option(
    "--clip",
    metavar="FOLDER|hub",
    help="CLIP's weights, for N-CLIP: a folder with model.safetensors; or 'hub', to fetch them (605 MB).",
)
@click.option("--best-round", is_flag=True, help="By the round that N-CLIP likes best, not by the last one.")
@click.option(
    "--peer", is_flag=True, help="The peer's convention: goals resized to the renders, nothing × 100."
)
@click.option("--judge", type=click.Choice(PROVIDERS), help="Have a model give the four marks.")
@click.option("--model", metavar="NAME", help=f"The judge's.  [default: {TOLD_DEFAULTS}]")
@click.option("--base-url", metavar="URL", help="Another server that speaks the judge's API.")
@click.option("--cache", type=_PATH, help="Folder that marks are kept in.  [default: of SimWorlds]")
@click.option("--max-cost", type=FiniteRange(0), metavar="USD", help="Ask no judge beyond it.")
@click.option("--price", metavar="IN/OUT", help="Dollars per million tokens, of a model that is in no list.")
def score(out: Path, **given: Any) -> None:
    """Score RESULTS: PL; N-CLIP with --clip; the judge's marks with --judge. No system is run again.

    Exit code 0: all that was asked for is scored. 1: some of it is not, and the reason is told. 2: nothing is.
    """
    from bench.blenderbench.score import score as start  # noqa: PLC0415 - not for --help

    with _errors_as_text():
        scores = start(out, _rule(given), _tell)
    for task_score in scores:
        click.echo(_line(task_score))
        for metric, why in task_score.missing.items():
            click.echo(f"{task_score.task}: {metric} is not scored: {why}", err=True)
    sys.exit(1 if any(task_score.missing for task_score in scores) else 0)


@blenderbench.command()
@click.argument("outs", metavar="RESULTS...", nargs=-1, required=True, type=_FOLDER)
@click.option("--paper", is_flag=True, help="The published figures beside it.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def report(outs: tuple[Path, ...], *, paper: bool, as_json: bool) -> None:
    """Print the table of one or several systems' RESULTS: means a level, and over all tasks."""
    from bench.blenderbench.report import as_data, as_markdown, read_results  # noqa: PLC0415 - not for --help

    with _errors_as_text():
        found = [read_results(out) for out in outs]
        text = as_markdown(found, published=paper)
    click.echo(json.dumps(as_data(found), indent=1, ensure_ascii=False) if as_json else text)


def _words(given: dict[str, Any], *names: str) -> tuple[str, ...]:
    """The options that were given, as words of another command."""
    pairs = [(f"--{name.replace('_', '-')}", str(given[name])) for name in names if given[name] is not None]
    return tuple(word for pair in pairs for word in pair)


def _rule(given: dict[str, Any]) -> ScoringRule:
    from bench.blenderbench.errors import BadResults  # noqa: PLC0415 - not for --help
    from bench.blenderbench.score import ScoringRule  # noqa: PLC0415
    from bench.blenderbench.weights import load_clip  # noqa: PLC0415

    if given["best_round"] and not given["clip"]:
        raise BadResults("--best-round chooses by N-CLIP, which needs weights: name them by --clip.")
    clip = load_clip(given["clip"], _tell) if given["clip"] else None
    convention = "peer" if given["peer"] else "paper"
    return ScoringRule(convention, clip, given["best_round"], _provider(given), judge_cache(given["cache"]))


def _provider(given: dict[str, Any]) -> JudgeProvider | None:
    from bench.judge.providers import provider_of  # noqa: PLC0415 - not for --help

    if given["judge"] is None:
        return None
    settings = {name: given[name] for name in ("model", "base_url", "max_cost")}
    provider = provider_of(given["judge"], price=price_of(given["price"]), tell=_tell, **settings)
    provider.ready()
    return provider


def _line(task_score: Score) -> str:
    values = {"PL": task_score.pl, "N-CLIP": task_score.n_clip, "VLM": task_score.vlm}
    text = "  ".join(f"{name} {value:.4f}" for name, value in values.items() if value is not None)
    round_text = f"  ({task_score.chosen} of {len(task_score.rounds)})" if len(task_score.rounds) > 1 else ""
    return f"{task_score.task}  {text or 'not scored'}{round_text}"


def _tell(doing: object) -> None:
    """Says what is being done: a task takes minutes."""
    click.echo(f"{doing} …", err=True)


@contextmanager
def _errors_as_text(*kinds: type[Exception]) -> Generator[None]:
    """Errors as words and an exit code; being ended by somebody is being interrupted."""
    from bench.blenderbench.errors import BlenderBenchError  # noqa: PLC0415 - not for --help
    from bench.judge.errors import NotJudged  # noqa: PLC0415

    def end(_number: int, _frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, end)
    try:
        yield
    except (BlenderBenchError, NotJudged, OSError, *kinds) as error:
        click.echo(f"Error: {error}", err=True)
        sys.exit(2)
    except KeyboardInterrupt:
        click.echo("Interrupted. What is done is kept; the same command goes on.", err=True)
        sys.exit(130)
    finally:
        signal.signal(signal.SIGTERM, before)
