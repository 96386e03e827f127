"""VTK's XML images with blocks of zlib, as VTK and ParaView write them, become the same file without."""

from __future__ import annotations

import base64
import re
import struct
import zlib
from typing import Any

from ._errors import FormatError, MemoryLimitError

_ARRAY = re.compile(rb"<DataArray\b[^>]*>")


def without_blocks(data: Any, limit: int | None = None) -> Any:
    """The bytes of a .vti whose arrays stand appended as they are; ``data`` itself where nothing is packed by zlib.

    Raises
    ------
    FormatError
        what is wrong with the blocks.
    MemoryLimitError
        they hold more than ``limit`` bytes.
    """
    whole = bytes(data)
    root = re.search(rb"<VTKFile\b[^>]*>", whole)
    if root is None or not re.search(rb"\scompressor=[\"']vtkZLibDataCompressor[\"']", root[0]):
        return data
    order = ">" if b"BigEndian" in root[0] else "<"
    number = order + ("Q" if re.search(rb"\sheader_type=[\"']UInt64[\"']", root[0]) else "I")
    tail = re.compile(rb"<AppendedData\b([^>]*)>\s*_").search(whole, root.end())
    text_end = tail.start() if tail else whole.find(b"</VTKFile", root.end())
    if text_end < 0:
        text_end = len(whole)

    out, arrays, at, size = [whole[: root.start()], re.sub(rb"\scompressor=[\"'][^\"']*[\"']", b"", root[0])], [], root.end(), 0
    for tag in _ARRAY.finditer(whole, root.end(), text_end):
        kind = re.search(rb"\sformat=[\"'](binary|appended)[\"']", tag[0])
        offset = re.search(rb"\soffset=[\"'](\d+)[\"']", tag[0])
        if kind is None or (kind[1] == b"appended" and (tail is None or offset is None)):
            continue
        new = re.sub(rb"\s(format|offset)=[\"'][^\"']*[\"']", b"", tag[0])
        out += [whole[at : tag.start()], new[:10], b' format="appended" offset="%d"' % size, new[10:]]
        if kind[1] == b"binary":
            at = whole.find(b"<", tag.end())
            at = len(whole) if at < 0 else at
            plain = _unpacked(b"".join(whole[tag.end() : at].split()), True, number, limit)
        else:
            assert tail is not None and offset is not None  # else passed over above
            at, first = tag.end(), tail.end() + int(offset[1])
            plain = _unpacked(whole[first:], b"base64" in tail[1], number, limit)
        arrays += [struct.pack(number, len(plain)), plain]
        size += struct.calcsize(number) + len(plain)
        if limit is not None and size > limit:
            raise MemoryLimitError(f"VTI: the unpacked arrays hold more than the {limit} bytes that memory_limit leaves for them")
    out += [whole[at:text_end], b'<AppendedData encoding="raw">_', *arrays, b"</AppendedData></VTKFile>"]
    return b"".join(out)


def _unpacked(body: bytes, packed_text: bool, number: str, limit: int | None) -> bytes:
    """The array whose head stands at the beginning of a file's bytes, or of their base64."""
    step = struct.calcsize(number)

    def taken(at: int, n: int) -> tuple[bytes, int]:
        if not packed_text:
            return body[at : at + n], at + n
        end = at + (n + 2) // 3 * 4
        return base64.b64decode(body[at:end])[:n], end

    try:
        blocks = struct.unpack(number, taken(0, step)[0])[0]
        if blocks * step > len(body):
            raise FormatError("VTI: an array has more blocks than the file has bytes for")
        if blocks == 0:
            return b""
        head, at = taken(0, (3 + blocks) * step)
        _, block, last, *sizes = struct.unpack(f"{number[0]}{3 + blocks}{number[1]}", head)
        if block * (blocks - 1) + (last or block) > 1032 * sum(sizes) + 64 or sum(sizes) > len(body):
            raise FormatError("VTI: packed blocks are said to hold more than they can")
        if limit is not None and block * blocks > limit:
            raise MemoryLimitError(f"VTI: the unpacked arrays hold more than the {limit} bytes that memory_limit leaves for them")
        packed, at = taken(at, sum(sizes))
        parts, first = [], 0
        for i, n in enumerate(sizes):
            plain = zlib.decompress(packed[first : first + n])
            if len(plain) != (last if last and i == blocks - 1 else block):
                raise FormatError("VTI: a packed block is damaged")
            parts.append(plain)
            first += n
    except (struct.error, zlib.error, ValueError) as why:
        raise FormatError(f"VTI: a packed array is damaged ({why})") from None
    return b"".join(parts)
