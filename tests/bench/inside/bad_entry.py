"""Stands in the place of the audit's program in Blender's process, and misbehaves as the file's name tells it."""

import os
import signal
import time

from simworlds.sandbox.inside import channel


def main(arguments):
    descriptor = int(arguments[0])
    key = read(descriptor, channel.KEY_BYTES)
    encode, decode = channel.Encoder(key, channel.WORKER), channel.Decoder(key, channel.SUPERVISOR)

    def send(**message):
        os.write(descriptor, encode(message))

    def receive():
        while not (messages := decode.feed(os.read(descriptor, 65536))):
            pass
        return messages[0]

    send(ready=True)
    request = receive()
    misbehave(descriptor, send, receive, request, os.path.basename(request["arguments"]["path"]))


def read(descriptor, count):
    data = b""
    while len(data) < count:
        data += os.read(descriptor, count - len(data))
    return data


def misbehave(descriptor, send, receive, request, name):
    def answer(request, **reply):
        send(**reply, ticket=request["ticket"], seconds=0.0, left=[])

    if "crash" in name:
        os.kill(os.getpid(), signal.SIGSEGV)
    elif "hang" in name:
        time.sleep(600)
    elif "garbage" in name:
        os.write(descriptor, b"\x00\xffno frame at all, but many bytes of something else")
        time.sleep(600)
    elif "other" in name:
        send(what_was_not_asked=True)
        time.sleep(600)
    elif "long" in name:
        os.write(descriptor, b"\xff\xff\xff\xff" + bytes(16))
        time.sleep(600)
    elif "senseless" in name:
        answer(request, value={"objects": 1})
        answer(receive(), value={"name": 7})
        receive()
    elif "ends" in name:
        os._exit(3)
    elif "playing" in name:
        answer(request, value={"objects": 1})
        asked = receive()
        if asked["arguments"]["play"]:
            os.kill(os.getpid(), signal.SIGSEGV)
        answer(asked, refused="it was asked without playing")
        receive()
