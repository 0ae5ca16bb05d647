"""A Ray cluster of two nodes on this machine's loopback; ``lose`` on stdin kills one of them, the end of it both.

``cluster.py FOLDER`` tells the address, and when a node is lost. A program of its own because Ray stays in the process
that it was started in.
"""

import os
import sys

os.environ |= {
    # Ray listens on loopback alone where it takes clusters of several machines for impossible.
    "RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER": "0",
    "RAY_USAGE_STATS_ENABLED": "0",
    # A dead node is known for one soon.
    "RAY_health_check_initial_delay_ms": "1000",
    "RAY_health_check_period_ms": "1000",
    "RAY_health_check_failure_threshold": "3",
    "TMPDIR": sys.argv[1],  # also what killed processes leave
}

from ray.cluster_utils import Cluster

NODE = {"num_cpus": 1, "object_store_memory": 80_000_000, "include_dashboard": False}


def main() -> None:
    cluster = Cluster(initialize_head=True, head_node_args=NODE)
    other = cluster.add_node(**NODE)
    cluster.wait_for_nodes()
    tell(cluster.address)
    try:
        for line in sys.stdin:
            if line.strip() == "lose":
                cluster.remove_node(other, allow_graceful=False)
                tell("lost")
    finally:
        cluster.shutdown()


def tell(word: str) -> None:
    sys.stdout.write(f"{word}\n")
    sys.stdout.flush()


main()
