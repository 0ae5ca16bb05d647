"""The command ``simworlds mcp``."""

from __future__ import annotations

import gc
import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from agents.blender.tool_profiles import DEFAULT, PROFILES
from agents.commands.sandbox_warning import warn
from simworlds.releases import minor_of
from simworlds.terminal import options
from simworlds.terminal.finite_range import FiniteRange

if TYPE_CHECKING:
    from mcp.server.lowlevel import Server

    from agents.blender.blender_sessions import BlenderSessions, SessionSetup
    from agents.blender.tool_profiles import Profile
    from simworlds.sandbox.confinement.confined_command import Kind, Sandbox

_ERROR = 2
_PORT = 8766
_SIGNAL_SECONDS = 1.5  # clients kill two seconds after they have asked to end
_TYPED = click.core.ParameterSource.COMMANDLINE
_ONLY_HTTP = ("host", "port", "token", "allow_host", "sessions", "idle")
_ONLY_AS = ("timeout", "screenshots")
_ADDON = "blender-mcp"
_ASSETS = click.Path(exists=True, file_okay=False, resolve_path=True, path_type=Path)


_blender = options.combine(
    click.option(
        "--run",
        type=click.Path(file_okay=False, resolve_path=True, path_type=Path),
        help="Folder to work in; a run that is in it is continued. Default: a new folder for each client.",
    ),
    options.VERSION,
    options.EXECUTABLE,
    click.option("--read", type=_ASSETS, multiple=True, help="A folder that Blender may read, for assets."),
    click.option("--assets", type=_ASSETS, help="Your asset library: .blend assets, HDRIs, texture sets."),
    click.option("--online", is_flag=True, help="Let assets be fetched from Poly Haven into --assets."),
    options.SANDBOX,
)
_tools = click.option(
    "--tools",
    "profile",
    type=click.Choice(PROFILES),
    default=DEFAULT,
    show_default=True,
    help="docs: the documentation and the check of code, without a Blender; look: also what reads a scene; build: also "
    "what changes it, renders and checks plans; all: every tool, with whole schemas, for programs.",
)
_addon = options.combine(
    click.option(
        "--as",
        "stands_for",
        type=click.Choice([_ADDON]),
        help="Instead of MCP, speak the protocol of blender-mcp's add-on, on 127.0.0.1, port 9876.",
    ),
    click.option(
        "--timeout",
        type=FiniteRange(1, 3600),
        default=170.0,
        show_default=True,
        metavar="SECONDS",
        help="With --as: how long code may run. Its clients wait for 180 seconds.",
    ),
    click.option(
        "--screenshots",
        type=_ASSETS,
        multiple=True,
        help="With --as: a folder that screenshots may be written to, besides the temporary one.",
    ),
)
_attach = click.option(
    "--attach",
    is_flag=False,
    flag_value="open",
    metavar="[auto|WHICH]",
    help="Work in the open Blender; WHICH of several: its process or file. auto: if there is one, else in its own.",
)
_http = options.combine(
    click.option("--http", "over_http", is_flag=True, help="Serve streamable HTTP instead of stdio."),
    click.option("--host", default="127.0.0.1", show_default=True, help="Address to listen on."),
    click.option(
        "--port", type=click.IntRange(0, 65535), default=_PORT, show_default=True, help="0 takes a free port."
    ),
    click.option("--token", envvar="SIMWORLDS_TOKEN", show_envvar=True, help="Token that clients must send."),
    click.option("--allow-host", multiple=True, metavar="NAME", help="Another host name of this server."),
    click.option(
        "--sessions", type=click.IntRange(1), default=4, show_default=True, help="Most Blenders at once."
    ),
    click.option(
        "--idle",
        type=FiniteRange(0, min_open=True),
        default=30.0,
        show_default=True,
        metavar="MINUTES",
        help="Close a Blender after this long without a call.",
    ),
)


@click.command()
@_blender
@_tools
@_addon
@_attach
@_http
@click.pass_context
def mcp(  # noqa: PLR0913 - one for each option
    context: click.Context,
    *,
    run: Path | None,
    blender: str | None,
    blender_exe: Path | None,
    read: tuple[Path, ...],
    assets: Path | None,
    online: bool,
    sandbox: Kind | None,
    profile: Profile,
    stands_for: str | None,
    timeout: float,
    screenshots: tuple[Path, ...],
    attach: str | None,
    over_http: bool,
    host: str,
    port: int,
    token: str | None,
    allow_host: tuple[str, ...],
    sessions: int,
    idle: float,
) -> None:
    """Serve a live Blender over MCP, on stdio or HTTP, with blender_docs beside it.

    Every client has its own Blender and run folder, and finds both as it left them. With --attach, clients work in the
    Blender that the user has open (simworlds extension install). On an address other than
    loopback clients must send a token: Authorization: Bearer …
    """
    _check_options(context)
    if run is not None:
        _check_run(run)
    # Nothing that is loaded is garbage, and looking for it would slow the start.
    gc.disable()
    from agents.blender.blender_sessions import SessionSetup  # noqa: PLC0415
    from simworlds.sandbox.errors import CannotStart  # noqa: PLC0415 - not for --help
    from simworlds.sandbox.launch import find_blender  # noqa: PLC0415

    try:
        if blender_exe is not None:
            find_blender(blender, blender_exe)
        setup = SessionSetup(
            _confined(sandbox, announced=profile != "docs"),
            version=blender,
            blender_exe=blender_exe,
            read=read,
            run=run,
            assets=assets,
            online=online,
        )
        kind = _OwnBlenders(profile) if attach is None else _attached(attach, profile)
        if stands_for is not None:
            _as_addon(setup, port if _is_typed(context, "port") else None, timeout, screenshots)
        elif over_http:
            _over_http(setup, kind, sessions, idle * 60, host, port, token or "", allow_host)
        else:
            _over_stdio(setup, kind)
    except CannotStart as error:
        click.echo(f"Error: {error}", err=True)
        sys.exit(_ERROR)


def _check_options(context: click.Context) -> None:
    """Raises UsageError for options that do not go together."""
    given = context.params
    _check_transport(context, over_http=given["over_http"], stands_for=given["stands_for"])
    if given["online"] and given["assets"] is None:
        raise click.UsageError("--online needs --assets, the folder that assets are fetched into.")
    if given["attach"] is None:
        return
    if given["blender"] is not None or given["blender_exe"] is not None:
        raise click.UsageError(
            "--attach works in the Blender that is open: leave --blender and --blender-exe out."
        )
    if given["stands_for"] is not None:
        raise click.UsageError(
            f"--attach does not go with --as {given['stands_for']}: that serves a Blender of its own."
        )


def _check_transport(context: click.Context, *, over_http: bool, stands_for: str | None) -> None:
    if over_http and stands_for is not None:
        raise click.UsageError(
            f"--http does not go with --as {stands_for}: its clients know no other protocol."
        )
    for_http = [name for name in _ONLY_HTTP if _is_typed(context, name)]
    if for_http and not over_http and not (stands_for is not None and for_http == ["port"]):
        raise click.UsageError(f"--{for_http[0].replace('_', '-')} needs --http.")
    if stands_for is None and (for_addon := [name for name in _ONLY_AS if _is_typed(context, name)]):
        raise click.UsageError(f"--{for_addon[0]} needs --as {_ADDON}.")


def _is_typed(context: click.Context, name: str) -> bool:
    return context.get_parameter_source(name) is _TYPED


def _check_run(run: Path) -> None:
    """Makes the folder of a run. Raises UsageError where that cannot be, or it holds something else."""
    from agents.blender.files.run_folder import RunFolder  # noqa: PLC0415 - not for --help

    if RunFolder.is_foreign(run):
        raise click.UsageError(f"--run: {run} is not empty, and holds no run. Choose another folder.")
    try:
        run.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise click.UsageError(f"--run: {run} cannot be made: {error.strerror or error}.") from error


def _as_addon(setup: SessionSetup, port: int | None, timeout: float, screenshots: tuple[Path, ...]) -> None:
    from agents.blender.drop_in.screenshot_places import ScreenshotPlaces  # noqa: PLC0415 - not for --help
    from agents.blender.drop_in.server import PORT, run_drop_in  # noqa: PLC0415

    _loaded()
    run_drop_in(setup, PORT if port is None else port, timeout, ScreenshotPlaces(screenshots))


class _OwnBlenders:
    """Clients have Blenders of the server's own, and the tools of a profile."""

    def __init__(self, profile: Profile) -> None:
        self.profile: Profile = profile

    def sessions(self, setup: SessionSetup, at_most: int = 1, idle: float | None = None) -> BlenderSessions:
        """The sessions of clients."""
        from agents.blender.blender_sessions import BlenderSessions  # noqa: PLC0415 - not for --help

        return BlenderSessions(setup, at_most=at_most, idle=idle)

    def server(self, setup: SessionSetup, sessions: BlenderSessions) -> Server[None]:
        """The server of these sessions."""
        from agents.blender.docs_client import DocsClient  # noqa: PLC0415
        from agents.blender.server import make_server  # noqa: PLC0415
        from agents.blender.team import Team  # noqa: PLC0415

        return make_server(sessions, DocsClient(_same_blender(setup)), Team(), self.profile)


class _OpenBlender(_OwnBlenders):
    """Clients work in the user's: ``wanted`` says which, ``version`` of which version it is, as far as is known."""

    def __init__(self, profile: Profile, wanted: str, version: str | None) -> None:
        super().__init__(profile)
        self._wanted, self._version = wanted, version

    def sessions(self, setup: SessionSetup, at_most: int = 1, idle: float | None = None) -> BlenderSessions:
        """The sessions of clients."""
        from agents.blender.attached.attached_session import AttachedSession  # noqa: PLC0415
        from agents.blender.blender_sessions import BlenderSessions  # noqa: PLC0415

        return BlenderSessions(setup, at_most=at_most, idle=idle, new=partial(AttachedSession, self._wanted))

    def server(self, setup: SessionSetup, sessions: BlenderSessions) -> Server[None]:
        """The server of these sessions."""
        del setup
        from agents.blender.attached.tool_catalogue import HABITS, OPENING, TOOLS  # noqa: PLC0415
        from agents.blender.docs_client import DocsClient  # noqa: PLC0415
        from agents.blender.server import Suite, make_server  # noqa: PLC0415

        options = ["--blender", self._version] if self._version else []
        suite = Suite(TOOLS, OPENING, HABITS)
        return make_server(sessions, DocsClient(options), profile=self.profile, suite=suite)


def _attached(wanted: str, profile: Profile) -> _OwnBlenders:
    """The Blender to work in: the open one, or with ``auto`` one of its own if none is open."""
    from agents.blender.attached.open_blenders import AUTO, open_blenders  # noqa: PLC0415

    found = open_blenders()
    if wanted == AUTO and not found:
        click.echo("No open Blender listens: working in a Blender of its own.", err=True)
        return _OwnBlenders(profile)
    versions = {blender.about.version for blender in found}
    return _OpenBlender(profile, wanted, minor_of(versions.pop()) if len(versions) == 1 else None)


def _over_stdio(setup: SessionSetup, kind: _OwnBlenders) -> None:
    sessions = kind.sessions(setup)
    # Blender starts while the MCP package is loaded: each takes half a second.
    if kind.profile != "docs":
        sessions.start("")
    from simworlds.mcp_transport.stdio import run_stdio  # noqa: PLC0415

    server = kind.server(setup, sessions)
    _loaded()
    run_stdio(server, partial(sessions.close, _SIGNAL_SECONDS))


def _over_http(setup: SessionSetup, kind: _OwnBlenders, at_most: int, idle: float, *address: Any) -> None:
    from agents.blender.server import make_app  # noqa: PLC0415 - not for --help
    from simworlds.mcp_transport.http import Address, CannotServe, run_http  # noqa: PLC0415
    from simworlds.sandbox.errors import CannotStart  # noqa: PLC0415

    sessions = kind.sessions(setup, at_most, idle)
    server = kind.server(setup, sessions)
    _loaded()
    try:
        run_http(partial(make_app, server, sessions, idle), Address(*address), "Blender")
    except CannotServe as error:
        raise CannotStart(str(error)) from error


def _loaded() -> None:
    gc.freeze()
    gc.enable()


def _same_blender(setup: SessionSetup) -> list[str]:
    """The options by which ``simworlds serve`` answers for the same Blender."""
    options = {"--blender": setup.version, "--blender-exe": setup.blender_exe}
    return [word for name, value in options.items() if value is not None for word in (name, str(value))]


def _confined(wanted: Kind | None, *, announced: bool) -> Sandbox:
    """The sandbox, described on stderr if ``announced``. Raises CannotStart if the wanted one does not work here."""
    from simworlds.sandbox.confinement.confine_self import landlock_abi  # noqa: PLC0415 - not for --help
    from simworlds.sandbox.confinement.confined_command import best_sandbox, bubblewrap_fault  # noqa: PLC0415
    from simworlds.sandbox.errors import CannotStart  # noqa: PLC0415

    if wanted == "bubblewrap" and (fault := bubblewrap_fault()) is not None:
        raise CannotStart(f"bubblewrap does not work here: {fault}")
    if wanted == "landlock" and not (sys.platform == "linux" and landlock_abi()):
        raise CannotStart("This system's kernel has no Landlock.")
    best = best_sandbox(wanted)
    if not announced:
        return best
    click.echo(f"Sandbox ({best.kind}): {'; '.join(best.holds)}.", err=True)
    warn(best)
    return best
