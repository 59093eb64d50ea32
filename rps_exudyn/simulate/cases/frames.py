"""Objects in a stream between processes: each a frame of its length and its pickle."""

import pickle
from collections.abc import Iterator
from struct import calcsize, pack, unpack
from typing import IO, Any

LENGTH = "<Q"  # of a frame's content, before it


def frame_of(content: Any) -> bytes:
    """Return an object's pickle, with its length before it."""
    pickled = pickle.dumps(content, pickle.HIGHEST_PROTOCOL)
    return pack(LENGTH, len(pickled)) + pickled


def frames_in(stream: IO[bytes]) -> Iterator[bytes]:
    """Yield the pickles in a stream of frames; half a frame, of a process that died, is its end."""
    size = calcsize(LENGTH)
    while len(head := stream.read(size)) == size:
        (length,) = unpack(LENGTH, head)
        if len(content := stream.read(length)) < length:
            return
        yield content
