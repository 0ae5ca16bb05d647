"""Downloads: resumed, verified, refused and given up, against a real server on loopback."""

from __future__ import annotations

import hashlib
import io
import os
import socket
import threading
import time
import zipfile
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import TYPE_CHECKING

import pytest
from download_site import Handler, Site

from kb_build.errors import SourceError
from kb_build.pages.download import DownloadPatience, download
from kb_build.pages.sources import DocumentationSource, MissingSource, find_sources

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

MANUAL_PATH = "/manual/en/5.1/blender_manual_html.zip"
GUIDES_PATH = "/api/5.1/blender_python_reference_5_1.zip"


def archive(inner: str, page: str, size: int = 300_000) -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as file:
        file.writestr(f"{inner}/index.html", "<title>Blender 5.1 Manual</title>")
        file.writestr(f"{inner}/{page}", os.urandom(size))
    return data.getvalue()


MANUAL = archive("blender_manual_v510_en.html", "cloth.html")
GUIDES = archive("blender_python_reference_5_1", "info_overview.html")


@pytest.fixture
def site() -> Iterator[Site]:
    server = Site(files={MANUAL_PATH: MANUAL, GUIDES_PATH: GUIDES})
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    yield server
    server.released.set()
    server.shutdown()
    server.server_close()
    thread.join()


@contextmanager
def silent_port() -> Iterator[str]:
    """An address that takes connections and never says a word."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        yield f"http://127.0.0.1:{listener.getsockname()[1]}"


def closed_port() -> str:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        return f"http://127.0.0.1:{listener.getsockname()[1]}"


def look(tmp_path: Path, base_url: str, **options: object) -> dict[str, DocumentationSource | MissingSource]:
    patience = options.pop("patience", DownloadPatience(seconds=60.0))
    found, missing = find_sources(
        "5.1", cache=tmp_path / "cache", base_url=base_url, patience=patience, **options
    )
    return {entry.role: entry for entry in (*found, *missing)}


def source(entry: DocumentationSource | MissingSource) -> DocumentationSource:
    assert isinstance(entry, DocumentationSource), entry
    return entry


def reason(entry: DocumentationSource | MissingSource) -> str:
    assert isinstance(entry, MissingSource), entry
    return entry.reason


def test_a_source_found_nowhere_else_is_downloaded_with_its_digest(tmp_path: Path, site: Site) -> None:
    found = look(tmp_path, site.url)
    manual, guides = source(found["manual"]), source(found["guides"])
    assert manual.sha256 == hashlib.sha256(MANUAL).hexdigest()
    assert (manual.path / "cloth.html").is_file()
    assert [path.name for path in guides.path.glob("info_*")] == ["info_overview.html"]
    stored = sorted(path.name for path in (tmp_path / "cache" / "downloads").iterdir())
    assert stored == [
        ".lock",
        "blender_manual_v510_en.zip",
        "blender_python_reference_5_1.zip",
    ]


def test_downloads_are_not_requested_again(tmp_path: Path, site: Site) -> None:
    first = look(tmp_path, site.url)
    site.requests.clear()
    assert look(tmp_path, site.url) == first
    assert site.requests == []


def test_a_build_waits_for_the_download_of_another_one_and_takes_it(tmp_path: Path, site: Site) -> None:
    begun = threading.Event()

    def half_and_the_rest_later(handler: Handler) -> None:
        del site.faults[MANUAL_PATH]
        handler.send_response(200)
        handler.send_header("Content-Length", str(len(MANUAL)))
        handler.end_headers()
        handler.wfile.write(MANUAL[:150_000])
        handler.wfile.flush()
        begun.set()
        site.released.wait()
        handler.wfile.write(MANUAL[150_000:])

    def waits(what: str, done: int, total: int | None) -> None:
        if what.startswith("waiting"):
            site.released.set()

    site.faults[MANUAL_PATH] = half_and_the_rest_later
    with ThreadPoolExecutor() as pool:
        first = pool.submit(look, tmp_path, site.url)
        begun.wait()
        second = pool.submit(look, tmp_path, site.url, progress=waits)
        second.add_done_callback(lambda _: site.released.set())
        assert source(first.result()["manual"]).sha256 == hashlib.sha256(MANUAL).hexdigest()
        assert second.result() == first.result()
    assert [path for path, _ in site.requests] == [MANUAL_PATH, GUIDES_PATH]


def test_a_newer_manual_is_fetched_when_it_is_asked_for(tmp_path: Path, site: Site) -> None:
    first = source(look(tmp_path, site.url)["manual"])
    site.files[MANUAL_PATH] = archive("blender_manual_v510_en.html", "cloth.html")
    assert source(look(tmp_path, site.url)["manual"]) == first
    newer = source(look(tmp_path, site.url, fresh=True)["manual"])
    assert newer.sha256 == hashlib.sha256(site.files[MANUAL_PATH]).hexdigest() != first.sha256
    assert source(look(tmp_path, site.url)["manual"]) == newer


def test_what_was_downloaded_is_taken_where_no_newer_one_can_be_had(tmp_path: Path, site: Site) -> None:
    first = look(tmp_path, site.url)
    assert look(tmp_path, closed_port(), fresh=True) == first


def test_nothing_is_asked_for_when_downloads_are_off(tmp_path: Path, site: Site) -> None:
    assert "downloads are off" in reason(look(tmp_path, site.url, allow_download=False)["manual"])
    assert site.requests == []


def test_progress_ends_at_the_files_length(tmp_path: Path, site: Site) -> None:
    seen: list[tuple[str, int, int | None]] = []
    download(
        site.url + MANUAL_PATH,
        tmp_path / "m.zip",
        patience=DownloadPatience(seconds=60.0),
        progress=lambda *report: seen.append(report),
    )
    assert len(seen) > 2
    assert seen[-1] == ("downloading m.zip", len(MANUAL), len(MANUAL))


def test_a_dropped_connection_is_taken_up_where_it_broke_off(tmp_path: Path, site: Site) -> None:
    site.faults[MANUAL_PATH] = lambda handler: handler.serve(MANUAL, stop_after=150_000)
    assert source(look(tmp_path, site.url)["manual"]).sha256 == hashlib.sha256(MANUAL).hexdigest()
    ranges = [wanted for path, wanted in site.requests if path == MANUAL_PATH]
    assert ranges[0] is None
    assert len(ranges) > 1
    assert all(wanted is not None for wanted in ranges[1:])


def break_off(tmp_path: Path, site: Site) -> int:
    """Leave the beginning of a manual in the cache; returns its length."""

    def half_once(handler: Handler) -> None:
        site.faults[MANUAL_PATH] = lambda later: later.send_error(500)
        handler.serve(MANUAL, stop_after=150_000)

    site.faults[MANUAL_PATH] = half_once
    assert "500" in reason(look(tmp_path, site.url)["manual"])
    del site.faults[MANUAL_PATH]
    site.requests.clear()
    return (tmp_path / "cache" / "downloads" / "blender_manual_v510_en.zip.part").stat().st_size


def test_the_next_run_goes_on_where_the_last_one_ended(tmp_path: Path, site: Site) -> None:
    length = break_off(tmp_path, site)
    assert 0 < length <= 150_000
    assert source(look(tmp_path, site.url)["manual"]).sha256 == hashlib.sha256(MANUAL).hexdigest()
    assert site.requests[0] == (MANUAL_PATH, f"bytes={length}-")


def test_a_file_that_changed_meanwhile_is_fetched_anew(tmp_path: Path, site: Site) -> None:
    break_off(tmp_path, site)
    site.files[MANUAL_PATH] = newer = archive("blender_manual_v510_en.html", "rigid.html")
    site.etag = '"two"'
    assert source(look(tmp_path, site.url)["manual"]).sha256 == hashlib.sha256(newer).hexdigest()


def test_a_beginning_longer_than_the_file_is_thrown_away(tmp_path: Path, site: Site) -> None:
    break_off(tmp_path, site)
    with (tmp_path / "cache" / "downloads" / "blender_manual_v510_en.zip.part").open("ab") as part:
        part.write(bytes(len(MANUAL)))
    assert source(look(tmp_path, site.url)["manual"]).sha256 == hashlib.sha256(MANUAL).hexdigest()


def test_a_server_that_never_gets_further_is_given_up_with_what_to_do(tmp_path: Path, site: Site) -> None:
    site.faults[MANUAL_PATH] = lambda handler: handler.serve(
        MANUAL, stop_after=70_000 if not handler.headers.get("Range") else 0
    )
    text = reason(look(tmp_path, site.url)["manual"])
    assert site.url + MANUAL_PATH in text
    assert "could not be reached" in text or "broke off" in text
    assert len(site.requests) < 10


def test_a_reply_with_the_wrong_range_is_refused(tmp_path: Path, site: Site) -> None:
    break_off(tmp_path, site)

    def wrong_part(handler: Handler) -> None:
        handler.send_response(206)
        handler.send_header("Content-Range", f"bytes 5-{len(MANUAL) - 1}/{len(MANUAL)}")
        handler.send_header("Content-Length", str(len(MANUAL) - 5))
        handler.end_headers()
        handler.wfile.write(MANUAL[5:])

    site.faults[MANUAL_PATH] = wrong_part
    assert "another part" in reason(look(tmp_path, site.url)["manual"])


def test_a_missing_file_is_named_and_the_other_source_still_fetched(tmp_path: Path, site: Site) -> None:
    del site.files[MANUAL_PATH]
    found = look(tmp_path, site.url)
    assert f"{site.url}{MANUAL_PATH} answered with 404" in reason(found["manual"])
    assert source(found["guides"]).form == "html"


def test_a_page_in_place_of_an_archive_is_refused(tmp_path: Path, site: Site) -> None:
    site.files[MANUAL_PATH] = b"<html>Please log in to this network</html>"
    assert "not a zip archive" in reason(look(tmp_path, site.url)["manual"])
    site.files[MANUAL_PATH] = MANUAL
    assert source(look(tmp_path, site.url)["manual"]).version == "5.1"


def test_an_archive_of_another_version_is_refused(tmp_path: Path, site: Site) -> None:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as file:
        file.writestr("m/index.html", "<title>Blender 4.4 Manual</title>")
    site.files[MANUAL_PATH] = data.getvalue()
    assert "holds Blender 4.4" in reason(look(tmp_path, site.url)["manual"])


def test_an_archive_without_pages_is_refused(tmp_path: Path, site: Site) -> None:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as file:
        file.writestr("m/logo.png", "x")
    site.files[MANUAL_PATH] = data.getvalue()
    assert "holds no manual pages" in reason(look(tmp_path, site.url)["manual"])


def redirect(target: str) -> Callable[[Handler], None]:
    def answer(handler: Handler) -> None:
        handler.send_response(302)
        handler.send_header("Location", target)
        handler.send_header("Content-Length", "0")
        handler.end_headers()

    return answer


def test_redirects_are_followed(tmp_path: Path, site: Site) -> None:
    site.files["/elsewhere.zip"] = MANUAL
    site.faults[MANUAL_PATH] = redirect("/elsewhere.zip")
    assert source(look(tmp_path, site.url)["manual"]).sha256 == hashlib.sha256(MANUAL).hexdigest()


def test_a_circle_of_redirects_ends(tmp_path: Path, site: Site) -> None:
    site.faults[MANUAL_PATH] = redirect(MANUAL_PATH)
    assert "redirects in a circle" in reason(look(tmp_path, site.url)["manual"])
    assert len(site.requests) < 10


def test_a_redirect_to_nonsense_is_named(tmp_path: Path, site: Site) -> None:
    site.faults[MANUAL_PATH] = redirect("gopher://127.0.0.1/manual.zip")
    assert site.url + MANUAL_PATH in reason(look(tmp_path, site.url)["manual"])


def test_a_closed_port_costs_nothing_and_is_asked_once(tmp_path: Path) -> None:
    base = closed_port()
    found = look(tmp_path, base)
    assert "could not be reached" in reason(found["manual"])
    assert "was not tried" in reason(found["guides"])


def test_a_name_that_does_not_exist_is_named(tmp_path: Path) -> None:
    assert "could not be reached" in reason(
        look(tmp_path, "http://docs.invalid", patience=DownloadPatience(seconds=5.0))["manual"]
    )


def test_an_address_that_never_answers_costs_what_patience_allows_for_both_sources(tmp_path: Path) -> None:
    patience = DownloadPatience(seconds=0.3)
    started = time.monotonic()
    with silent_port() as base:
        found = look(tmp_path, base, patience=patience)
    assert "could not be reached" in reason(found["manual"])
    assert "was not tried" in reason(found["guides"])
    assert patience.seconds == 0.0
    assert time.monotonic() - started < 60  # without patience, the system waits for two minutes


def test_silent_hosts_share_one_patience(tmp_path: Path) -> None:
    patience = DownloadPatience(seconds=0.3)
    with silent_port() as one, silent_port() as two:
        for base in (one, two):
            with pytest.raises(SourceError, match="could not be reached"):
                download(base + MANUAL_PATH, tmp_path / "m.zip", patience=patience)
    assert patience.seconds == 0.0
    assert len(patience.silent_hosts) == 2


def test_headers_without_a_body_count_as_silence(tmp_path: Path, site: Site) -> None:
    def only_headers(handler: Handler) -> None:
        handler.send_response(200)
        handler.send_header("Content-Length", "1000000")
        handler.end_headers()
        handler.wfile.flush()
        site.released.wait()

    site.faults[MANUAL_PATH] = only_headers
    patience = DownloadPatience(seconds=0.3)
    assert "could not be reached" in reason(look(tmp_path, site.url, patience=patience)["manual"])
    assert patience.seconds == 0.0


def test_the_default_patience_is_ten_seconds() -> None:
    assert DownloadPatience().seconds == 10.0


def test_a_file_of_absurd_length_is_not_begun(tmp_path: Path, site: Site) -> None:
    def absurd(handler: Handler) -> None:
        handler.send_response(200)
        handler.send_header("Content-Length", str(1 << 50))
        handler.end_headers()

    site.faults[MANUAL_PATH] = absurd
    assert "more than such a file has" in reason(look(tmp_path, site.url)["manual"])


def test_an_interrupt_keeps_what_has_arrived_for_the_next_run(tmp_path: Path, site: Site) -> None:
    def interrupt(what: str, done: int, total: int | None) -> None:
        raise KeyboardInterrupt

    target = tmp_path / "m.zip"
    with pytest.raises(KeyboardInterrupt):
        download(site.url + MANUAL_PATH, target, patience=DownloadPatience(seconds=60.0), progress=interrupt)
    assert not target.exists()
    download(site.url + MANUAL_PATH, target, patience=DownloadPatience(seconds=60.0))
    assert target.read_bytes() == MANUAL


def test_a_folder_of_downloads_that_cannot_be_written_to_is_named(tmp_path: Path, site: Site) -> None:
    (tmp_path / "cache").mkdir()
    (tmp_path / "cache" / "downloads").touch()
    said = reason(look(tmp_path, site.url)["manual"])
    assert f"{tmp_path / 'cache' / 'downloads'} cannot be written to (File exists)" in said
    assert site.requests == []


def test_a_beginning_is_never_taken_for_that_of_a_newer_file(tmp_path: Path, site: Site) -> None:
    part = tmp_path / "m.zip.part"
    part.write_bytes(b"an older file's beginning")
    (tmp_path / "m.zip.part.json").mkdir()  # as if the process ended there
    with pytest.raises(SourceError, match="could not be stored"):
        download(site.url + MANUAL_PATH, tmp_path / "m.zip", patience=DownloadPatience(seconds=60.0))
    assert part.read_bytes() == b""


def test_a_place_that_cannot_be_written_to_is_named(tmp_path: Path, site: Site) -> None:
    (tmp_path / "m.zip.part").mkdir()
    with pytest.raises(SourceError, match="could not be stored"):
        download(site.url + MANUAL_PATH, tmp_path / "m.zip", patience=DownloadPatience(seconds=60.0))
