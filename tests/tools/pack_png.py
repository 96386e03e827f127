"""pack_png.py IN OUT | same A B - a PNG of 8 bits RGB, whose pixels the program stores as they are, filtered and deflated; and whether two
have the same pixels, whatever zlib has packed them."""
import struct, sys, zlib


def pixels(path):
    """Width and the rows of a picture, unfiltered."""
    data = open(path, 'rb').read()
    at, packed = 8, b''
    while at < len(data):
        size, kind = struct.unpack('>I4s', data[at:at + 8])
        if kind == b'IHDR':
            width, height, bits, colour = struct.unpack('>IIBB', data[at + 8:at + 18])
            assert (bits, colour) == (8, 2), path
        if kind == b'IDAT':
            packed += data[at + 8:at + 8 + size]
        at += 12 + size
    raw, row, rows = zlib.decompress(packed), 3 * width, []
    above = bytes(row)
    for y in range(height):
        line = raw[y * (row + 1):(y + 1) * (row + 1)]
        assert line[0] in (0, 2), path
        above = bytes(line[1:]) if line[0] == 0 else bytes((a + b) & 255 for a, b in zip(line[1:], above))
        rows.append(above)
    return width, rows


def chunk(kind, body):
    return struct.pack('>I', len(body)) + kind + body + struct.pack('>I', zlib.crc32(kind + body))


def pack(source, target):
    width, rows = pixels(source)
    above, lines = bytes(3 * width), []
    for row in rows:
        differences = bytes((a - b) & 255 for a, b in zip(row, above))
        lines.append(min((b'\0' + row, b'\2' + differences), key=lambda line: sum(min(v, 256 - v) for v in line[1:])))
        above = row
    body = struct.pack('>IIBBBBB', width, len(rows), 8, 2, 0, 0, 0)
    with open(target, 'wb') as out:
        out.write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', body) + chunk(b'IDAT', zlib.compress(b''.join(lines), 9)) + chunk(b'IEND', b''))


if sys.argv[1] == 'same':
    sys.exit(pixels(sys.argv[2]) != pixels(sys.argv[3]))
pack(sys.argv[1], sys.argv[2])
