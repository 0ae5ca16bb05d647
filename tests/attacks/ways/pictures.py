"""Ways through what decodes pictures and films: other formats, bombs, broken files. A liar stands in for Blender."""

from __future__ import annotations

from way import Tool, Way, way

_RENDER = Tool("blender_render")
_FILM = Tool("blender_render", {"kind": "animation"})
_PREVIEW = Tool("blender_scene_layout_preview")
_MOTION = Tool("blender_motion_sheet_preview", {"actors": ["Cube"]})
_VERIFY = Tool("blender_verify", {"image": True})

_EPS = (
    "b'%!PS-Adobe-3.0 EPSF-3.0\\n%%BoundingBox: 0 0 16 16\\n%%EndComments\\n(x) print\\nshowpage\\n%%EOF\\n'"
)
_IMAGE = "import io, PIL.Image\n"
_FORMATS = {
    "eps": _EPS,
    "eps-in-a-dos-shell": f"struct.pack('<IIIIIIIH', 0xC6D3D0C5, 30, {200}, 0, 0, 0, 0, 0xFFFF) + {_EPS}",
    "bmp": "b'BM' + struct.pack('<IHHIIiiHHIIiiII', 54 + 768, 0, 0, 54, 40, 16, 16, 1, 24, 0, 768, "
    "0, 0, 0, 0) + bytes(768)",
    "gif": "b'GIF89a' + struct.pack('<HHBBB', 16, 16, 0x80, 0, 0) + bytes(6) + b',' + "
    "struct.pack('<HHHHB', 0, 0, 16, 16, 0) + "
    "b'\\x02\\x16\\x84\\x8f\\xa9\\xcb\\xed\\x0f\\xa3\\x9c\\xb4\\xda\\x8b\\xb3\\xde\\xbc\\xfb\\x0f\\x86\\xe2\\x48\\x96\\xe5\\x00\\x3b'",
    "tiff": "b'II*\\0' + struct.pack('<I', 8) + struct.pack('<H', 9) + b''.join(struct.pack('<HHII', "
    "*entry) for entry in "
    "((256, 4, 1, 16), (257, 4, 1, 16), (258, 3, 1, 8), (259, 3, 1, 1), (262, 3, 1, 1), "
    "(273, 4, 1, 122), (277, 3, 1, 1), (278, 4, 1, 16), (279, 4, 1, 256))) + bytes(4) + "
    "bytes(256)",
    "ppm": "b'P6 16 16 255\\n' + bytes(768)",
    "pcx": "b'\\x0a\\x05\\x01\\x08' + struct.pack('<HHHHHH', 0, 0, 15, 15, 72, 72) + bytes(48) + "
    "b'\\0\\x03' + struct.pack('<H', 16) + bytes(58) + b'\\xc0' * 768",
    "tga": "struct.pack('<BBBHHBHHHHBB', 0, 0, 2, 0, 0, 0, 0, 0, 16, 16, 24, 0) + bytes(768)",
    "xpm": 'b\'/* XPM */ static char *x[] = {\\n"1 1 1 1",\\n"a c #000000",\\n"a"};\\n\'',
    "sgi": "struct.pack('>hBBHHHHII', 474, 0, 1, 3, 16, 16, 3, 0, 255) + bytes(84 + 404) + bytes(768)",
    "im": "b'Image type: RGB image\\r\\nFile size (no of images): 1\\r\\nImage size (x*y): "
    "16*16\\r\\n\\x1a' + bytes(600) + bytes(768)",
    "fits": "b'SIMPLE  =                    T'.ljust(80) + b'BITPIX  =                    "
    "8'.ljust(80) + b'NAXIS   =                    2'.ljust(80) + b'NAXIS1  =                "
    "   16'.ljust(80) + b'NAXIS2  =                   16'.ljust(80) + b'END'.ljust(2480) + "
    "bytes(2880)",
    "svg": 'b\'<svg xmlns="http://www.w3.org/2000/svg"><image href="file://\' + '
    "target.file.encode() + b'\"/></svg>'",
    "text": "b'hello'",
    "nothing": "b''",
}
# A picture of few bytes that has very many pixels, and others that are broken or overfull.
_WIDE = (
    "b'\\x89PNG\\r\\n\\x1a\\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', {width}, {height}, "
    "8, 6, 0, 0, 0)) + chunk(b'IDAT', b''.join(pack() for _ in range(1))) + chunk(b'IEND', b'')"
)
# Zeros, compressed in parts that stand for themselves: one is made, and repeated, with the checksum of all.
_PACK = (
    "import zlib\ndef pack(count={mib} + 1):\n    z = zlib.compressobj(9, zlib.DEFLATED, -15)\n"
    "    part = z.compress(bytes(1 << 20)) + z.flush(zlib.Z_FULL_FLUSH)\n"
    "    check = struct.pack('>I', (count << 20) % 65521 << 16 | 1)\n"
    "    return b'x\\xda' + part * count + z.flush() + check\n"
)
_BOMBS = {
    "many-pixels": (_PACK.format(mib=600), _WIDE.format(width=12000, height=12000)),
    "a-claim-of-many-pixels": (_PACK.format(mib=1), _WIDE.format(width=60000, height=60000)),
    "a-claim-of-the-most-pixels": (_PACK.format(mib=1), _WIDE.format(width=2**31 - 1, height=2**31 - 1)),
    "one-endless-row": (_PACK.format(mib=1), _WIDE.format(width=2**31 - 1, height=1)),
    "no-pixels": (_PACK.format(mib=1), _WIDE.format(width=0, height=0)),
    "a-text-that-swells": (
        _PACK.format(mib=59),
        "png(16, 16, extra=b''.join(chunk(b'zTXt', b'n%d\\0\\0' % n + pack()) for n in range(40)))",
    ),
    "a-profile-that-swells": (
        _PACK.format(mib=899),
        "png(16, 16, extra=chunk(b'iCCP', b'p\\0\\0' + pack()))",
    ),
    "a-chunk-of-four-gigabytes": ("", "png()[:33] + struct.pack('>I', (1 << 32) - 1) + b'tEXt' + bytes(99)"),
    "many-chunks": ("", "png(16, 16, extra=chunk(b'tEXt', b'a\\0b') * 400_000)"),
    "pixels-that-end-early": ("", "png()[:60]"),
    "pixels-that-are-wrong": ("", "png().replace(b'IDAT', b'IDAX')"),
    "many-frames": (
        "import zlib\n",
        "png(16, 16, extra=chunk(b'acTL', struct.pack('>II', (1 << 31) - 1, 0)))",
    ),
}


def _frame(name: str, code: str, before: str = "", **more: object) -> Way:
    """A way that hands over such a frame."""
    lie = f"{before}leave = {code}\nwrite(arguments['path'], leave)\nreturn 0.01"
    return way(
        f"a-frame-of-{name}", "decoder", _RENDER, lies={"render_frame": lie}, once=True, seconds=120.0, **more
    )


def _view(name: str, code: str, before: str = "", **more: object) -> Way:
    """A way that hands over such a view."""
    lie = (
        f"{before}value = truth()\n"
        f"write(os.path.join(arguments['folder'], value['views'][0]['file']), {code})\nreturn value"
    )
    return way(
        f"a-view-of-{name}", "decoder", _PREVIEW, lies={"preview": lie}, once=True, seconds=120.0, **more
    )


WAYS = (
    *(_frame(name, code, must_fail=True) for name, code in _FORMATS.items()),
    *(_view(name, _FORMATS[name], must_fail=True) for name in ("eps", "bmp", "ppm", "text")),
    *(_frame(name, code, before) for name, (before, code) in _BOMBS.items()),
    *(
        _view(name, _BOMBS[name][1], _BOMBS[name][0])
        for name in ("many-pixels", "a-claim-of-many-pixels", "a-text-that-swells")
    ),
    way(
        "a-tile-of-eps",
        "decoder",
        _MOTION,
        once=True,
        must_fail=True,
        lies={
            "motion_sheet": f"value = truth()\nwrite(arguments['folder'] + '/0-path-1.png', {_EPS})\nreturn value"
        },
    ),
    way(
        "a-tile-of-many-pixels",
        "decoder",
        _MOTION,
        once=True,
        seconds=120.0,
        lies={
            "motion_sheet": f"{_BOMBS['many-pixels'][0]}value = truth()\n"
            f"write(arguments['folder'] + '/0-path-1.png', {_BOMBS['many-pixels'][1]})\nreturn value"
        },
    ),
    way(
        "a-finding-of-eps",
        "decoder",
        _VERIFY,
        once=True,
        lies={
            "findings_image": f"value = truth()\nwrite(arguments['folder'] + '/.preview-0.png', {_EPS})\nreturn value"
        },
    ),
    way(
        "a-film-of-eps",
        "decoder",
        _FILM,
        once=True,
        lies={"render_video": f"value = truth()\nwrite(arguments['path'], {_EPS})\nreturn value"},
    ),
    way(
        "a-film-of-a-playlist",
        "decoder",
        _FILM,
        once=True,
        lies={
            "render_video": "value = truth()\n"
            "write(arguments['path'], b'#EXTM3U\\n#EXTINF:1,\\nfile://' + target.file.encode())\n"
            "return value"
        },
    ),
    way(
        "frames-of-eps-in-a-film",
        "decoder",
        _FILM,
        once=True,
        must_fail=True,
        lies={"render_frame": f"write(arguments['path'], {_EPS})\nreturn 0.01"},
    ),
    way(
        "a-film-of-bombs",
        "decoder",
        _FILM,
        once=True,
        seconds=120.0,
        lies={
            "render_frame": f"{_BOMBS['many-pixels'][0]}write(arguments['path'], {_BOMBS['many-pixels'][1]})\n"
            f"return 0.01"
        },
    ),
)
