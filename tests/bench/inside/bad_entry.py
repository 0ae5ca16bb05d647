"""Stands in the place of the audit's own script in Blender's process, and misbehaves as the file's name tells it."""

import os
import signal
import sys
import time

descriptor = int(sys.argv[-1])
head = os.read(descriptor, 4)
body = os.read(descriptor, int.from_bytes(head, "big")).decode()


def answer(data):
    os.write(descriptor, len(data).to_bytes(4, "big") + data)


if "crash" in body:
    os.kill(os.getpid(), signal.SIGSEGV)
elif "hang" in body:
    time.sleep(600)
elif "garbage" in body:
    answer(b"\x00\xffno JSON")
elif "other" in body:
    answer(b'["what was not asked"]')
elif "long" in body:
    os.write(descriptor, b"\xff\xff\xff\xff")
elif "senseless" in body:
    answer(b'{"value": {"objects": 1}}')
    os.read(descriptor, 65536)
    answer(b'{"value": {"name": 7}}')
    os.read(descriptor, 4)
elif "ends" in body:
    os._exit(3)
elif "playing" in body:
    answer(b'{"value": {"objects": 1}}')
    if b'"play": true' in os.read(descriptor, 65536):
        os.kill(os.getpid(), signal.SIGSEGV)
    answer(b'{"refused": "it was asked without playing"}')
    os.read(descriptor, 4)
