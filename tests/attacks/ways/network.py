"""Ways to reach somebody by a socket."""

from __future__ import annotations

from way import Way, way

_PLANTED = "path = target.sockets + '/{}'\n"


def _socket(name: str, family: int, kind: int, protocol: int = 0) -> Way:
    return way(
        f"open-a-socket-of-{name}",
        "sockets",
        f"c('socket', {family}, {kind}, {protocol})",
        denied=("22", "94"),
    )


def _call(name: str, attacks: str, code: str, **more: object) -> Way:
    return way(name, attacks, code, machine="x86_64", **more)


WAYS = (
    way(
        "connect",
        "sockets namespaces",
        "import socket\nsocket.create_connection(('127.0.0.1', target.tcp), 2)\nTrue",
    ),
    way(
        "connect-by-version-6",
        "sockets namespaces",
        "import socket\nsocket.create_connection(('::1', target.tcp6), 2)\nTrue",
    ),
    way(
        "fetch-a-page",
        "sockets namespaces",
        "import urllib.request\nurllib.request.urlopen(f'http://127.0.0.1:{target.tcp}', timeout=2)",
    ),
    way(
        "send-a-datagram",
        "sockets namespaces",
        "import socket\n"
        "socket.socket(socket.AF_INET, socket.SOCK_DGRAM).sendto(b'x', ('127.0.0.1', target.udp))",
    ),
    way(
        "ask-for-a-name",
        "sockets namespaces",
        "import socket\nsocket.getaddrinfo('example.org', 80)",
        denied=("gaierror",),
    ),
    way("listen", "sockets", "import socket\nsocket.create_server(('127.0.0.1', 0))"),
    way(
        "connect-to-a-path",
        "sockets files",
        "import socket\nsocket.socket(socket.AF_UNIX).connect(target.sockets + '/stream')",
    ),
    way(
        "connect-to-an-abstract-name",
        "sockets namespaces",
        "import socket\nsocket.socket(socket.AF_UNIX).connect('\\0' + target.abstract)",
    ),
    way(
        "connect-a-pair-to-a-path",
        "sockets files",
        "import socket\n"
        "socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)[0].connect(target.sockets + "
        "'/datagram')\nTrue",
    ),
    way(
        "send-from-a-pair-to-a-path",
        "sockets files",
        "import socket\n"
        "socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)[0].sendto(b'x', target.sockets + "
        "'/datagram')",
    ),
    way(
        "send-from-a-pair-to-an-abstract-name",
        "sockets namespaces",
        "import socket\n"
        "socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)[0].sendto(b'x', '\\0' + "
        "target.abstract + '-datagram')",
    ),
    way(
        "send-a-descriptor-from-a-pair",
        "sockets files",
        "import array, socket\nright = [(socket.SOL_SOCKET, socket.SCM_RIGHTS, array.array('i', [0]))]\n"
        "socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)[0].sendmsg([b'x'], right, 0, "
        "target.sockets + '/datagram')",
    ),
    _call(
        "send-many-from-a-pair",
        "sockets files",
        "import socket\npair = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)\n"
        "name = struct.pack('H', 1) + (target.sockets + '/datagram').encode() + b'\\0'\n"
        "name_buffer, data = ctypes.create_string_buffer(name), ctypes.create_string_buffer(b'x')\n"
        "vector = ctypes.create_string_buffer(struct.pack('QQ', ctypes.addressof(data), 1))\n"
        "message = struct.pack('QIxxxxQQQQiI', ctypes.addressof(name_buffer), len(name), "
        "ctypes.addressof(vector), 1, 0, 0, 0, 0)\n"
        "syscall(307, pair[0].fileno(), message + bytes(8), 1, 0)",
    ),
    way(
        "send-through-a-socket-in-the-workspace",
        "sockets",
        "import socket\nos.symlink(target.sockets + '/datagram', 'd')\n"
        "socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)[0].sendto(b'x', 'd')",
    ),
    way("make-a-pair", "sockets", "import socket\nsocket.socketpair()\nTrue"),
    way(
        "send-descriptors-on-the-channel",
        "sockets",
        "import array, socket\nfor number in range(3, 400):\n"
        "    if worked(os.readlink, f'/proc/self/fd/{number}') and "
        "os.readlink(f'/proc/self/fd/{number}').startswith('socket'):\n"
        "        socket.socket(fileno=os.dup(number)).sendmsg([], [(1, 1, array.array('i', [0]))])\n"
        "None",
        denied=("22",),
    ),
    way(
        "speak-by-rpc",
        "sockets namespaces",
        "import xmlrpc.client\nxmlrpc.client.ServerProxy(f'http://127.0.0.1:{target.tcp}').x()",
    ),
    _socket("netlink", 16, 3, 0),
    _socket("netlink-audit", 16, 3, 9),
    _socket("packets", 17, 3, 0x0300),
    _socket("raw-packets", 2, 3, 1),
    _socket("cryptography", 38, 5),
    _socket("the-hypervisor", 40, 1),
    _socket("bluetooth", 31, 3, 1),
    _socket("cans", 29, 3, 1),
    _socket("keys", 15, 3, 2),
    _socket("pings", 2, 2, 1),
    _socket("multipath", 2, 1, 262),
    way(
        "make-a-queue-of-messages",
        "sockets namespaces",
        "libc.mq_open.restype = ctypes.c_int\n"
        "c('mq_open', b'/' + target.mark.encode(), 0o102, 0o600, None) >= 0",
    ),
    way("share-memory-by-key", "sockets namespaces", "c('shmget', 0x5357, 4096, 0o1666) >= 0"),
    way("share-a-semaphore-by-key", "sockets namespaces", "c('semget', 0x5357, 1, 0o1666) >= 0"),
    way("send-messages-by-key", "sockets namespaces", "c('msgget', 0x5357, 0o1666) >= 0"),
)
