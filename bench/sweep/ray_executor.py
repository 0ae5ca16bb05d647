"""Runs tasks on a Ray cluster: one task a scene, with a Blender of its own, on any node with a free processor.

Nodes share no folder. A scene's files are sent to the node and its results back as bundles; only the sweep writes the
results, each scene's record last. If a node dies, Ray runs its tasks again elsewhere. Every node needs the same version
of SimWorlds with its Blender.
"""

from __future__ import annotations

import os
import socket
import tempfile
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.sweep.bundles import Bundle, DamagedBundle, bundle_changes, bundle_files, unpack_bundle
from bench.sweep.content_hash import digest_of, files_below
from bench.sweep.executor import FinishedTask
from bench.sweep.provenance import code_of, code_of_audit, code_of_frames
from bench.sweep.records import NAME, BadSceneRecord, read_record
from bench.sweep.run_steps import do_scene
from bench.sweep.systems.folder import FolderSystem
from bench.sweep.systems.system import SystemNotReady

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence

    from bench.sweep.scene_task import SceneTask

_RETRIES = 5  # of a task whose node or worker died
_AHEAD = 2  # tasks for each processor that wait on the cluster with their files
_CONNECT_SECONDS = 10.0
_WAIT_SECONDS = 5.0  # between two looks at how many processors there are


@dataclass(frozen=True, slots=True)
class RayExecutor:
    """``address``: "auto" for the cluster that this machine belongs to, or as Ray has it (``HOST:PORT``, ``ray://…``)."""

    address: str

    def work(
        self, tasks: Sequence[SceneTask], tell: Callable[[SceneTask | None, str], None]
    ) -> Generator[FinishedTask]:
        """See Executor. Raises SystemNotReady where there is no cluster, or it is lost."""
        with _connected(self.address) as ray:
            nodes = _nodes(ray)
            tell(None, f"Ray: {nodes} nodes, {int(ray.cluster_resources().get('CPU', 0))} processors")
            remote = ray.remote(num_cpus=1, max_retries=_RETRIES, retry_exceptions=False)(do_remotely)
            waiting = list(reversed(tasks))
            sent: dict[Any, SceneTask] = {}
            try:
                while waiting or sent:
                    room = _AHEAD * int(ray.cluster_resources().get("CPU", 1)) - len(sent)
                    for task in [waiting.pop() for _ in range(min(room, len(waiting)))]:
                        sent[remote.remote(task, *_bundle_inputs(task), _code())] = task
                        tell(task, "sent")
                    ready, _ = ray.wait(list(sent), timeout=_WAIT_SECONDS)
                    before, nodes = nodes, _nodes(ray)
                    if nodes < before:
                        tell(
                            None,
                            f"Ray: {before - nodes} of {before} nodes are lost; their scenes are done again elsewhere",
                        )
                    for reference in ready:
                        yield _receive(ray, reference, sent.pop(reference))
            finally:
                for reference in sent:
                    ray.cancel(reference, force=True)


def _nodes(ray: Any) -> int:
    return sum(bool(node["Alive"]) for node in ray.nodes())


@contextmanager
def _connected(address: str) -> Generator[Any]:
    """Connects to Ray, without usage statistics or dashboard. Raises SystemNotReady."""
    os.environ["RAY_USAGE_STATS_ENABLED"] = "0"
    try:
        import ray  # noqa: PLC0415 - an optional extra
        from ray.exceptions import RayError  # noqa: PLC0415
    except ImportError as error:
        raise SystemNotReady(
            "--ray needs Ray: install simworlds with its extra 'ray', on every node."
        ) from error
    try:
        _check_reachable(address)
        ray.init(address=address, log_to_driver=False, configure_logging=False)
    except (OSError, RuntimeError, ValueError) as error:
        raise SystemNotReady(
            f"There is no Ray cluster at {address!r}: {' '.join(str(error).split())[:300]} Start one with 'ray start "
            "--head', and 'ray start --address=HOST:6379' on other machines."
        ) from error
    # Ray prints messages about dead nodes to stdout, some of them only when it is shut down.
    with Path(os.devnull).open("w") as nowhere, redirect_stdout(nowhere):
        try:
            yield ray
        except (ConnectionError, RayError) as error:
            raise SystemNotReady(
                f"The Ray cluster {address!r} was lost: {' '.join(str(error).split())[:300]}. What was done is kept."
            ) from error
        finally:
            ray.shutdown()


def _check_reachable(address: str) -> None:
    """Raises OSError where nothing listens: Ray would end the whole process."""
    host, _, port = address.removeprefix("ray://").rpartition(":")
    if host and port.isdecimal():
        socket.create_connection((host, int(port)), _CONNECT_SECONDS).close()


def _bundle_inputs(task: SceneTask) -> tuple[Bundle, Bundle | None]:
    """Bundles the scene's folder of the results, and the files that the system takes from its source folder."""
    held = bundle_files(task.folder, files_below(task.folder)) if task.folder.is_dir() else Bundle()
    source = task.system.source
    taken = (
        bundle_files(source, task.system.files(task.spec)) if source is not None and source.is_dir() else None
    )
    return held, taken


def _receive(ray: Any, reference: Any, task: SceneTask) -> FinishedTask:
    """Writes the results that a node has returned."""
    try:
        bundle = ray.get(reference)
    except ray.exceptions.RayTaskError as error:
        return FinishedTask(
            task, None, f"{type(error.cause).__name__}: {error.cause}" if error.cause else "its task failed"
        )
    except ray.exceptions.RayError as error:
        return FinishedTask(task, None, f"{type(error).__name__}: {' '.join(str(error).split())[:300]}")
    try:
        unpack_bundle(bundle, task.folder, last=NAME)
        return FinishedTask(task, read_record(task.folder))
    except (DamagedBundle, BadSceneRecord, OSError) as error:
        return FinishedTask(task, None, str(error))


# On the node


def do_remotely(task: SceneTask, held: Bundle, taken: Bundle | None, code: str) -> Bundle:
    """Runs a task in a folder of its own. Returns what has changed in the scene's folder."""
    if code != _code():
        raise SystemNotReady(
            "this node has another version of SimWorlds than the sweep; install the same version on all"
        )
    with tempfile.TemporaryDirectory(prefix="simworlds-sweep-", ignore_cleanup_errors=True) as place:
        folder, source = Path(place, "scene").resolve(), Path(place, "source").resolve()
        before = unpack_bundle(held, folder)
        if taken is not None and isinstance(task.system, FolderSystem):
            unpack_bundle(taken, source)
            source.mkdir(exist_ok=True)
            task = replace(task, system=replace(task.system, source=source))
        do_scene(replace(task, folder=folder), _silent)
        return bundle_changes(folder, before)


def _silent(_: str) -> None:
    """Ignores progress."""


def _code() -> str:
    """Digest of the code that scores."""
    return digest_of([code_of("bench.sweep.run_steps"), code_of_audit(), code_of_frames()])
