"""Does tasks on a Ray cluster: one task a scene, with a Blender of its own, on whatever node has a processor free.

Nodes share no folder. A scene's files travel to the node and its results back as bytes, known by their content; the
sweep alone writes the results, each scene's record last. A node that dies loses nothing but time: Ray does its tasks
again elsewhere. Every node needs this very version of SimWorlds with its Blender.
"""

from __future__ import annotations

import os
import socket
import tempfile
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.sweep.bundles import Damaged, Parcel, packed, packed_changes, unpacked
from bench.sweep.content_hash import digest_of, files_below
from bench.sweep.executor import Done
from bench.sweep.provenance import code_of, code_of_audit, code_of_frames
from bench.sweep.records import NAME, BadRecord, read_record
from bench.sweep.scene_task import do_scene
from bench.sweep.systems.folder import Folder
from bench.sweep.systems.system import NotReady

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence

    from bench.sweep.scene_task import Task

_RETRIES = 5  # of a task whose node or worker died
_AHEAD = 2  # tasks for each processor of the cluster that wait there with their files
_CONNECT_SECONDS = 10.0
_WAIT_SECONDS = 5.0  # between two looks at how many processors there are


@dataclass(frozen=True, slots=True)
class RayCrew:
    """``address``: "auto" for the cluster that this machine belongs to, or as Ray has it (``HOST:PORT``, ``ray://…``)."""

    address: str

    def work(self, tasks: Sequence[Task], tell: Callable[[Task | None, str], None]) -> Generator[Done]:
        """See Crew. Raises NotReady where there is no cluster, or it is lost."""
        with _connected(self.address) as ray:
            nodes = _nodes(ray)
            tell(None, f"Ray: {nodes} nodes, {int(ray.cluster_resources().get('CPU', 0))} processors")
            remote = ray.remote(num_cpus=1, max_retries=_RETRIES, retry_exceptions=False)(do_remotely)
            waiting = list(reversed(tasks))
            sent: dict[Any, Task] = {}
            try:
                while waiting or sent:
                    room = _AHEAD * int(ray.cluster_resources().get("CPU", 1)) - len(sent)
                    for task in [waiting.pop() for _ in range(min(room, len(waiting)))]:
                        sent[remote.remote(task, *_outward(task), _code())] = task
                        tell(task, "sent")
                    ready, _ = ray.wait(list(sent), timeout=_WAIT_SECONDS)
                    before, nodes = nodes, _nodes(ray)
                    if nodes < before:
                        tell(
                            None,
                            f"Ray: {before - nodes} of {before} nodes are lost; their scenes are done again elsewhere",
                        )
                    for reference in ready:
                        yield _arrived(ray, reference, sent.pop(reference))
            finally:
                for reference in sent:
                    ray.cancel(reference, force=True)


def _nodes(ray: Any) -> int:
    return sum(bool(node["Alive"]) for node in ray.nodes())


@contextmanager
def _connected(address: str) -> Generator[Any]:
    """Ray, connected; no usage statistics, no dashboard. Raises NotReady."""
    os.environ["RAY_USAGE_STATS_ENABLED"] = "0"
    try:
        import ray  # noqa: PLC0415 - an optional extra
        from ray.exceptions import RayError  # noqa: PLC0415
    except ImportError as error:
        raise NotReady("--ray needs Ray: install simworlds with its extra 'ray', on every node.") from error
    try:
        _reach(address)
        ray.init(address=address, log_to_driver=False, configure_logging=False)
    except (OSError, RuntimeError, ValueError) as error:
        raise NotReady(
            f"There is no Ray cluster at {address!r}: {' '.join(str(error).split())[:300]} Start one with 'ray start "
            "--head', and 'ray start --address=HOST:6379' on other machines."
        ) from error
    # Ray prints there what it does about dead nodes, some of it only when it is shut down.
    with Path(os.devnull).open("w") as nowhere, redirect_stdout(nowhere):
        try:
            yield ray
        except (ConnectionError, RayError) as error:
            raise NotReady(
                f"The Ray cluster {address!r} was lost: {' '.join(str(error).split())[:300]}. What was done is kept."
            ) from error
        finally:
            ray.shutdown()


def _reach(address: str) -> None:
    """Raises OSError where nobody listens: Ray would end the whole process over it."""
    host, _, port = address.removeprefix("ray://").rpartition(":")
    if host and port.isdecimal():
        socket.create_connection((host, int(port)), _CONNECT_SECONDS).close()


def _outward(task: Task) -> tuple[Parcel, Parcel | None]:
    """What is in the scene's folder of the results, and the files that the system takes from a folder of its own."""
    held = packed(task.folder, files_below(task.folder)) if task.folder.is_dir() else Parcel()
    source = task.system.source
    taken = packed(source, task.system.files(task.spec)) if source is not None and source.is_dir() else None
    return held, taken


def _arrived(ray: Any, reference: Any, task: Task) -> Done:
    """Writes what came back."""
    try:
        parcel = ray.get(reference)
    except ray.exceptions.RayTaskError as error:
        return Done(
            task, None, f"{type(error.cause).__name__}: {error.cause}" if error.cause else "its task failed"
        )
    except ray.exceptions.RayError as error:
        return Done(task, None, f"{type(error).__name__}: {' '.join(str(error).split())[:300]}")
    try:
        unpacked(parcel, task.folder, last=NAME)
        return Done(task, read_record(task.folder))
    except (Damaged, BadRecord, OSError) as error:
        return Done(task, None, str(error))


# On the node


def do_remotely(task: Task, held: Parcel, taken: Parcel | None, code: str) -> Parcel:
    """Does a task in a folder of its own; what is other in the scene's folder then than it was."""
    if code != _code():
        raise NotReady("this node has another version of SimWorlds than the sweep; install the same on all")
    with tempfile.TemporaryDirectory(prefix="simworlds-sweep-", ignore_cleanup_errors=True) as place:
        folder, source = Path(place, "scene").resolve(), Path(place, "source").resolve()
        before = unpacked(held, folder)
        if taken is not None and isinstance(task.system, Folder):
            unpacked(taken, source)
            source.mkdir(exist_ok=True)
            task = replace(task, system=replace(task.system, source=source))
        do_scene(replace(task, folder=folder), _silent)
        return packed_changes(folder, before)


def _silent(_: str) -> None:
    """Tells nobody."""


def _code() -> str:
    """Digest of the code that scores."""
    return digest_of([code_of("bench.sweep.scene_task"), code_of_audit(), code_of_frames()])
