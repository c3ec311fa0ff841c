"""A display that is only memory, for scripts/soak: Xvfb, and what is seen on it."""

import os
import re
import struct
import subprocess
import zlib

SIZE = (1280, 800)


class Screen:
    """A display that is only memory; its pixels are read from the file that it lies in."""

    def __init__(self, work):
        self.file = work / "Xvfb_screen0"
        read, write = os.pipe()
        size = "{}x{}x24".format(*SIZE)
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", size, "-fbdir", work],
            pass_fds=[write], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(write)
        with os.fdopen(read) as number:
            self.name = ":" + number.readline().strip()

    def pixels(self):
        """Blue, green, red and nothing, of each pixel, row by row (the XWD format)."""
        data = self.file.read_bytes()
        header = struct.unpack(">25I", data[:100])
        return data[header[0] + 12 * header[19] :]

    def count(self, colour, near):
        """Pixels of this colour, give or take some levels."""
        red, green, blue = (b"[\\x%02x-\\x%02x]" % (max(0, c - near), min(255, c + near)) for c in colour)
        return len(re.findall(blue + green + red + b"[\\x00\\xff]", self.pixels()))

    def save(self, path):
        """The screen as PNG."""
        width, height = SIZE
        data = self.pixels()
        rgb = bytearray(3 * width * height)
        for channel in range(3):
            rgb[channel::3] = data[2 - channel : 4 * width * height : 4]
        rows = b"".join(b"\0" + rgb[3 * width * y : 3 * width * (y + 1)] for y in range(height))

        def chunk(kind, body):
            return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

        head = struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)
        parts = chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 6)) + chunk(b"IEND", b"")
        path.write_bytes(b"\x89PNG\r\n\x1a\n" + parts)
