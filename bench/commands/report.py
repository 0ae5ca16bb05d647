"""``simworlds bench report`` and ``simworlds bench estimate``."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from simworlds.terminal.finite_range import FiniteRange
from simworlds.terminal.output_file import OutputFile

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from bench.results.estimate import SweepEstimate
    from bench.results.scores import ResultSet

_PATH = click.Path(path_type=Path)


@click.command()
@click.argument("results", type=_PATH, nargs=-1, required=True)
@click.option(
    "--baseline", metavar="SYSTEM", help="Compare all other systems with this one.  [default: the first]"
)
@click.option(
    "--html",
    type=OutputFile(),
    help="Where to write the page with every scene.  [default: report.html in the first RESULTS]",
)
@click.option("--markdown", type=OutputFile(), help="Write the tables to this file.")
@click.option(
    "--json",
    "as_json",
    type=OutputFile(),
    help="Write the figures as JSON; '-' prints them instead of the tables.",
)
@click.option("--paper", is_flag=True, help="Add the paper's published figures.")
def report(results: tuple[Path, ...], **given: Any) -> None:
    """Print the tables of RESULTS, folders that 'bench run' wrote, and write a page with every scene.

    The tables: the paper's Table 1 with 95 % intervals, coverage, paired comparisons of systems, ablations, cost. The
    page also has frames, scores, failed checks with the values seen, and the judge's verdicts.
    """
    from bench.markdown_tables import format_table  # noqa: PLC0415 - not for --help
    from bench.results.notes import notes  # noqa: PLC0415
    from bench.results.tables import tables  # noqa: PLC0415

    result_set = _read(results)
    if given["baseline"] is not None and result_set.system(given["baseline"]) is None:
        names = ", ".join(system.name for system in result_set.systems)
        raise click.UsageError(
            f"There is no system {given['baseline'][:80]!r} in these results. Choose one of: {names}."
        )
    result_tables = tables(result_set, baseline=given["baseline"], with_paper=given["paper"])
    warnings = notes(result_set, with_paper=given["paper"])
    text = _plain(
        "\n\n".join(
            (
                *(f"> {note}" for note in warnings),
                *(format_table(result_table) for result_table in result_tables),
            )
        )
        + "\n"
    )
    place = given["html"] or results[0] / "report.html"
    numbers = (
        json.dumps(_numbers(result_set, given["baseline"], warnings), indent=1, ensure_ascii=False) + "\n"
    )
    try:
        _write_page(place, result_set, result_tables, warnings)
        if given["markdown"] is not None:
            _write(given["markdown"], text)
        if given["as_json"] is not None and str(given["as_json"]) != "-":
            _write(given["as_json"], numbers)
    except OSError as error:
        click.echo(f"Error: {error.filename or place} cannot be written: {error.strerror or error}", err=True)
        sys.exit(2)
    click.echo(numbers if str(given["as_json"]) == "-" else text, nl=False)
    click.echo(f"Page: {place}", err=True)


@click.command()
@click.argument("results", type=_PATH, nargs=-1, required=True)
@click.option(
    "--systems", type=click.IntRange(1, 10_000), default=10, show_default=True, help="Number of systems."
)
@click.option(
    "--machines",
    type=click.IntRange(1, 100_000),
    default=20,
    show_default=True,
    help="Number of machines.",
)
@click.option(
    "--jobs",
    type=click.IntRange(1, 256),
    default=2,
    show_default=True,
    help="Scenes in parallel on each machine.",
)
@click.option(
    "--making",
    type=FiniteRange(0),
    metavar="MINUTES",
    help="Time that a system takes per scene, instead of the measured one.",
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def estimate(results: tuple[Path, ...], **given: Any) -> None:
    """Estimate how long all scenes take for many systems on many machines, from the times measured in RESULTS."""
    from bench.results.estimate import estimate as run  # noqa: PLC0415 - not for --help

    making = given["making"] * 60 if given["making"] is not None else None
    sizes = {"systems": given["systems"], "machines": given["machines"], "at_a_time": given["jobs"]}
    sweep_estimate = run(_read(results), **sizes, making=making)
    if sweep_estimate is None:
        click.echo("Error: no scene in these results was scored, so there are no measured times.", err=True)
        sys.exit(2)
    click.echo(
        json.dumps(asdict(sweep_estimate), indent=1)
        if given["as_json"]
        else "\n".join(_estimate_lines(sweep_estimate))
    )


def _read(folders: Sequence[Path]) -> ResultSet:
    """The results; ends the command with exit code 2 if there are none."""
    from bench.results.scores import read_results  # noqa: PLC0415 - not for --help
    from bench.scenes.spec import BadSpec  # noqa: PLC0415

    try:
        result_set = read_results([folder.expanduser().resolve() for folder in folders])
    except (BadSpec, OSError) as error:
        click.echo(f"Error: {error}", err=True)
        sys.exit(2)
    if not result_set.systems:
        for fault in result_set.faults:
            click.echo(fault, err=True)
        where = ", ".join(map(str, folders))
        click.echo(f"Error: there are no results in {where}. Make some with 'simworlds bench run'.", err=True)
        sys.exit(2)
    return result_set


def _plain(text: str) -> str:
    """A text without control characters, which results from anybody may contain."""
    return "".join(char if char.isprintable() or char == "\n" else " " for char in text)


def _write_page(place: Path, result_set: ResultSet, result_tables: Any, warnings: Sequence[str]) -> None:
    from bench.results.page import page  # noqa: PLC0415 - not for --help
    from bench.sweep.provenance import code_of, provenance  # noqa: PLC0415

    seal = provenance(code_of("bench.results.page"))
    _write(place, page(result_set, result_tables, warnings, seal))


def _write(path: Path, text: str) -> None:
    from simworlds.files import write_whole  # noqa: PLC0415 - not for --help

    write_whole(path.expanduser(), text.encode("utf-8", "replace"))


def _numbers(results: ResultSet, baseline: str | None, warnings: Sequence[str]) -> dict[str, Any]:
    """All figures as data, with the settings of their statistics."""
    from bench.results import statistics  # noqa: PLC0415 - not for --help
    from bench.results.figures import ablations, comparisons, figures_of  # noqa: PLC0415
    from bench.results.scores import METRICS  # noqa: PLC0415

    return {
        "notes": list(warnings),
        "bootstrap": {"seed": statistics.SEED, "draws": statistics.DRAWS, "level": statistics.LEVEL},
        "systems": {
            system.name: {
                "info": system.info.model_dump(mode="json"),
                "figures": {
                    metric: {category: asdict(figure) for category, figure in figures.items()}
                    for metric, figures in figures_of(system).items()
                },
                "scenes": {
                    name: {
                        **{metric: scene.score(metric) for metric in METRICS},
                        "why_not": {metric: why for metric in METRICS if (why := scene.why_not(metric))},
                    }
                    for name, scene in sorted(system.scenes.items())
                },
            }
            for system in results.systems
        },
        "comparisons": [asdict(row) for row in comparisons(results, baseline)],
        "ablations": [asdict(row) for row in ablations(results)],
    }


def _estimate_lines(estimated: SweepEstimate) -> Iterator[str]:
    yield (
        f"times measured for {estimated.measured} of {estimated.scenes} scenes; the others get the mean of their "
        "category's, or of all where none of it was"
    )
    steps = {"produced": "making", "audited": "audit", "framed": "frames", "judged": "judge"}
    parts = ", ".join(
        f"{steps[step]} {_format_time(seconds)}" for step, seconds in estimated.work.items() if seconds
    )
    yield f"{estimated.scenes} scenes by one system, one after the other: {_format_time(estimated.one)} ({parts})"
    workers = estimated.machines * estimated.at_a_time
    yield (
        f"{estimated.systems} systems on {estimated.machines} machines, {estimated.at_a_time} scenes in parallel on "
        f"each: {_format_time(estimated.together)}; the longest scene takes {_format_time(estimated.longest)}"
    )
    yield f"that is {estimated.systems * estimated.one / 3600:.1f} hours of work for {workers} workers"


def _format_time(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
