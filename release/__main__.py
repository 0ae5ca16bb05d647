"""``python -m release``: everything that is handed out, into one folder; its other commands check that."""

from __future__ import annotations

import shutil
import tomllib
from pathlib import Path

import click

from release.build import build_twice, epoch
from release.bundle_file import write_bundle
from release.licences import Dependency, dependencies, page
from release.requirements import runtime_requirements
from release.sbom import hashes, sbom
from release.validate import validate
from simworlds.files import sha256_of_file

REPO = Path(__file__).resolve().parent.parent
_PAGE = REPO / "docs" / "licences.md"
_LARGEST_WHEEL = 15_000_000


@click.group(invoke_without_command=True)
@click.option(
    "--output", type=click.Path(path_type=Path), default=REPO / "dist", help="The folder to write to."
)
@click.pass_context
def main(context: click.Context, output: Path) -> None:
    """Build the wheel, the sdist, their SBOM, the bundle, and what a Docker image installs."""
    if context.invoked_subcommand is not None:
        return
    rows = _checked(dependencies(REPO))
    lock = (REPO / "requirements.lock").read_text(encoding="utf-8")
    project = tomllib.loads((REPO / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    shutil.rmtree(output, ignore_errors=True)
    wheel, sdist = build_twice(REPO, output)
    if wheel.stat().st_size > _LARGEST_WHEEL:
        raise click.ClickException(f"{wheel.name} has more than {_LARGEST_WHEEL:,} bytes.")
    bill = output / f"{wheel.stem}.cdx.json"
    bill.write_text(
        sbom(project["version"], sha256_of_file(wheel), rows, hashes(lock), epoch(REPO)), encoding="utf-8"
    )
    bundle = output / f"simworlds-{project['version']}.mcpb"
    write_bundle(wheel, project["version"], bundle, epoch(REPO))
    requirements = output / "requirements.txt"
    requirements.write_text(runtime_requirements(lock, rows), encoding="utf-8")
    sums = [f"{sha256_of_file(path)}  {path.name}\n" for path in (wheel, sdist, bill, bundle, requirements)]
    (output / "SHA256SUMS").write_text("".join(sums), encoding="utf-8")
    for path in (wheel, sdist, bill, bundle, requirements):
        click.echo(f"{path.stat().st_size:>10,}  {path.name}")


@main.command("validate")
@click.argument("dist", type=click.Path(path_type=Path), default=REPO / "dist")
def validate_command(dist: Path) -> None:
    """Ask each artefact's own validator; npx and uvx fetch them."""
    validate(REPO, dist)


@main.command()
def licences() -> None:
    """Write the page of the dependencies' licences, and check them."""
    rows = dependencies(REPO)
    _PAGE.write_text(page(rows), encoding="utf-8")
    _checked(rows)


def _checked(rows: list[Dependency]) -> list[Dependency]:
    wrong = [f"{row.name} ({row.licence or 'not known'})" for row in rows if not row.compatible]
    if wrong:
        raise click.ClickException(
            f"Licences that a work under the GPL may not depend on, or that are not known: {', '.join(wrong)}. "
            "Leave the package out, or look its licence up and add it to release/licences.py."
        )
    return rows


if __name__ == "__main__":
    main()
