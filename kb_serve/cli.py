"""The commands ``simworlds docs`` and ``simworlds serve``."""

from __future__ import annotations

import gc
import json
import sys
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kb_serve.query_limits import LEAST_TOKENS, LIMIT, LONGEST_QUERY, MAX_TOKENS
from simworlds.errors import UserError
from simworlds.releases import minor_of
from simworlds.settings import home_folder
from simworlds.terminal.markdown import print_markdown

if TYPE_CHECKING:
    from kb_serve.answer.docs_answer import DocsAnswer
    from kb_serve.bases import Bases
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.service import Service

_NOTHING_FOUND = 1
_ERROR = 2
_STDIN = "-"
_PORT = 8765
_LONGEST_BYTES = 4 * (LONGEST_QUERY + 1)
_TYPED = click.core.ParameterSource.COMMANDLINE
_BLENDER = click.option("--blender", metavar="VERSION", help="Blender version. Default: the one in use.")


@click.command()
@click.argument("query", nargs=-1, required=True)
@_BLENDER
@click.option(
    "--limit", type=click.IntRange(1), default=LIMIT, show_default=True, help="Maximum number of hits."
)
@click.option(
    "--max-tokens",
    type=click.IntRange(LEAST_TOKENS),
    default=MAX_TOKENS,
    show_default=True,
    help="Maximum length of the answer, in tokens.",
)
@click.option(
    "--part",
    type=click.IntRange(1),
    default=1,
    show_default=True,
    help="The part of a long answer to begin with.",
)
@click.option("--json", "as_json", is_flag=True, help="Print the answer as JSON.")
@click.option("--raw", is_flag=True, help="Print the whole record of the best hit as JSON.")
def docs(  # noqa: PLR0913 - one for each option
    *,
    query: tuple[str, ...],
    blender: str | None,
    limit: int,
    max_tokens: int,
    part: int,
    as_json: bool,
    raw: bool,
) -> None:
    """Query the knowledge base with a name, an expression, an error message, a question or a topic.

    QUERY is its words; - reads it from standard input.
    Prints Markdown. Exit code: 0 when something was found, 1 when nothing was, 2 on errors.
    """
    if as_json and raw:
        raise click.UsageError("--json and --raw exclude each other.")
    # The process ends soon: collecting garbage would only take time.
    gc.disable()
    try:
        from kb_serve.in_use import note_on_base  # noqa: PLC0415 - not for --help
        from kb_serve.service import answer_below, checked_query  # noqa: PLC0415

        with closing(_bases(blender)) as bases:
            base = bases.pick()
            version = base.meta.get("blender", "")
            note = "" if blender else note_on_base(version)
            answer = answer_below(
                note,
                base,
                checked_query(_asked(query)),
                limit=limit,
                max_tokens=max_tokens,
                part=part,
                command="" if as_json else _command(blender, limit),
            )
            if raw:
                if note:
                    click.echo(note, err=True)
                is_found = _print_raw(base, answer)
            else:
                _print_answer(answer, version, as_json=as_json)
                # Of what is gone without a successor, its own notes say all.
                is_found = answer.kind != "none" or any(said != note for said in answer.notes)
    except UserError as error:
        click.echo(f"Error: {error}", err=True)
        sys.exit(_ERROR)
    sys.exit(0 if is_found else _NOTHING_FOUND)


def _asked(words: tuple[str, ...]) -> str:
    """The query: words, or what standard input has."""
    if words != (_STDIN,):
        return " ".join(words)
    # Of longer input, a part is enough to refuse it.
    return sys.stdin.buffer.read(_LONGEST_BYTES).decode(errors="replace")


def _command(blender: str | None, limit: int) -> str:
    """The command with the options that decide what an answer is."""
    from simworlds.own_command import own_command  # noqa: PLC0415 - not for --help

    options = (f" --blender {blender}" if blender else "", f" --limit {limit}" if limit != LIMIT else "")
    return f"{own_command()} docs{''.join(options)}"


def _print_answer(answer: DocsAnswer, version: str, *, as_json: bool) -> None:
    if as_json:
        from dataclasses import asdict  # noqa: PLC0415 - only for --raw

        click.echo(json.dumps({**asdict(answer), "blender": version}, ensure_ascii=False, indent=2))
    else:
        print_markdown(answer.text)


def _print_raw(base: KnowledgeBase, answer: DocsAnswer) -> bool:
    for hit in answer.hits[:1]:
        if record := _record(base, hit.id):
            click.echo(json.dumps(record, ensure_ascii=False, indent=2))
            return True
    click.echo(answer.text, err=True)
    return False


def _record(base: KnowledgeBase, ref: str) -> dict[str, Any]:
    """The record of a symbol or a page, as JSON has it; {} for none."""
    from kb_build.pages.page import page_to_json  # noqa: PLC0415 - only for --raw
    from kb_build.symbols.paths import plain_path  # noqa: PLC0415 - likewise
    from kb_build.symbols.records import to_json  # noqa: PLC0415 - likewise

    if symbol := base.symbol(ref):
        return to_json(symbol)
    if page := base.page(ref):
        return page_to_json(page)
    # Enum items and parameters are in the record of their owner.
    owner = base.symbol(plain_path(ref))
    return to_json(owner) if owner else {}


def _bases(blender: str | None, blender_exe: Path | None = None) -> Bases:
    from kb_serve.bases import Bases  # noqa: PLC0415 - not for --help

    return Bases(home_folder(), default=blender, blender_exe=blender_exe)


@click.command()
@_BLENDER
@click.option("--http", "over_http", is_flag=True, help="Serve streamable HTTP instead of stdio.")
@click.option("--host", default="127.0.0.1", show_default=True, help="Address to listen on.")
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=_PORT,
    show_default=True,
    help="Port; 0 takes a free one.",
)
@click.option("--token", envvar="SIMWORLDS_TOKEN", show_envvar=True, help="Secret that clients must send.")
@click.option("--allow-host", multiple=True, metavar="NAME", help="A further host name of this server.")
@click.option("--blender-exe", type=click.Path(path_type=Path), help="The Blender in use, if not bpy.")
@click.option("--no-rebuild", is_flag=True, help="Do not rebuild the base when Blender is newer.")
@click.pass_context
def serve(  # noqa: PLR0913 - one for each option
    context: click.Context,
    *,
    blender: str | None,
    over_http: bool,
    host: str,
    port: int,
    token: str | None,
    allow_host: tuple[str, ...],
    blender_exe: Path | None,
    no_rebuild: bool,
) -> None:
    """Serve the tools blender_docs and blender_check over MCP, on stdio or HTTP.

    When the Blender in use is newer than its knowledge base, the base is rebuilt in the background. Unless the
    address is loopback, clients must send a token: Authorization: Bearer …
    """
    for_http = [
        name
        for name in ("host", "port", "token", "allow_host")
        if context.get_parameter_source(name) is _TYPED
    ]
    if for_http and not over_http:
        raise click.UsageError("--host, --port, --token and --allow-host go with --http.")
    # Nothing that is loaded is garbage: looking for it would take a tenth of the start-up.
    gc.disable()
    try:
        if blender is not None:
            minor_of(blender)
        if blender_exe is not None:
            blender_exe = _executable(blender_exe)
        service = _service(blender, blender_exe, rebuild=not no_rebuild)
    except UserError as error:
        click.echo(f"Error: {error}", err=True)
        sys.exit(_ERROR)
    try:
        from simworlds.mcp_transport.lean_package import load_server_only  # noqa: PLC0415 - not for --help

        load_server_only()
        from kb_serve.server import make_app, make_server  # noqa: PLC0415 - loads the MCP package

        if over_http:
            from simworlds.mcp_transport.http import Address, run_http  # noqa: PLC0415 - not for stdio

            _loaded()
            run_http(
                partial(make_app, service),
                Address(host, port, token or "", allow_host),
                "blender_docs and blender_check",
            )
        else:
            from simworlds.mcp_transport.stdio import run_stdio  # noqa: PLC0415 - not for HTTP

            _loaded()
            run_stdio(make_server(service), service.upkeep.stop)
    except UserError as error:
        click.echo(f"Error: {error}", err=True)
        sys.exit(_ERROR)
    finally:
        service.bases.close()


def _executable(path: Path) -> Path:
    """The program of a Blender. Raises RuntimeMissing where none is."""
    from simworlds.sandbox.runtime import find_runtime  # noqa: PLC0415 - most name none

    return find_runtime(None, home=home_folder(), blender_exe=path).executable


def _loaded() -> None:
    gc.freeze()
    gc.enable()


def _service(blender: str | None, blender_exe: Path | None, *, rebuild: bool) -> Service:
    from kb_serve.rebuild import Upkeep  # noqa: PLC0415 - not for --help
    from kb_serve.service import Service  # noqa: PLC0415

    bases = _bases(blender, blender_exe)
    return Service(bases, Upkeep(bases, blender_exe, enabled=rebuild))
