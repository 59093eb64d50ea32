"""A checksum in front of an HDF5 file, by which any byte that was changed later is noticed.

HDF5 allows 512 bytes of any kind in front of its own, and all its readers skip them. Here they hold the
SHA-256 of all bytes that follow, so that numbers, attributes and structure are covered alike:

    rps-exudyn: sha256 of the bytes after the first 512
    4f1c...

Files of earlier versions begin with HDF5's own first bytes; they have no checksum and are read as they are.
"""

import hashlib

HDF5_BEGIN = b"\x89HDF\r\n\x1a\n"
SIZE = 512
HEADING = b"rps-exudyn: sha256 of the bytes after the first 512\n"


def sealed(content: bytes) -> bytes:
    """Return the bytes of an HDF5 file with its checksum before them."""
    return _seal(content) + content


def is_intact(content: bytes) -> bool:
    """Tell whether the bytes of a file fit its checksum, or are those of an HDF5 file that has none."""
    if content.startswith(HDF5_BEGIN):
        return True
    return content[:SIZE] == _seal(memoryview(content)[SIZE:])


def without_seal(content: bytes) -> bytes:
    """Return the bytes of a file as HDF5 itself would have written them, without a checksum."""
    return content if content.startswith(HDF5_BEGIN) else content[SIZE:]


def _seal(content: bytes | memoryview) -> bytes:
    return (HEADING + hashlib.sha256(content).hexdigest().encode()).ljust(SIZE, b"\n")
