"""The text of a file whose encoding nobody states."""

from pathlib import Path

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import short

_OTHER_FILES = {
    b"PK\x03\x04": "a spreadsheet or an archive; save its table as CSV",
    b"\xd0\xcf\x11\xe0": "a spreadsheet; save its table as CSV",
    b"\x89HDF": "an HDF5 file; write its curve as CSV",
    b"%PDF": "a PDF; write its curve as CSV",
}
_MARKS = {
    b"\xef\xbb\xbf": "utf-8-sig",
    b"\xff\xfe\x00\x00": "utf-32",
    b"\xff\xfe": "utf-16",
    b"\xfe\xff": "utf-16",
}


def read_text(path: str | Path) -> tuple[str, str]:
    """Return a file's text and its encoding: by its mark, else UTF-8, UTF-16 without a mark, or Windows-1252.

    Raises:
        InputError: the file cannot be read, or is no text.
    """
    try:
        content = Path(path).read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"{short(str(path))} cannot be read: {reason}.") from None
    for begin, what in _OTHER_FILES.items():
        if content.startswith(begin):
            raise InputError(f"{path} is {what}.")
    if 0 not in content[:2000]:
        content = content.rstrip(b"\0")  # of a logger that was switched off
    for encoding in _encodings(content):
        try:
            text = content.decode(encoding)
        except UnicodeDecodeError:
            continue
        if not any(ord(sign) < 32 and not sign.isspace() for sign in text[:20000]):
            return text, encoding
    raise InputError(
        f"{path} cannot be read: it is no text in UTF-8, UTF-16 or Windows-1252; save it as UTF-8."
    )


def _encodings(content: bytes) -> list[str]:
    for mark, encoding in _MARKS.items():
        if content.startswith(mark):
            return [encoding]
    head = content[:2000]
    if head.count(0) > len(head) // 4:  # every other byte of Latin letters in UTF-16
        return ["utf-16-le" if head[1::2].count(0) > head[::2].count(0) else "utf-16-be"]
    return ["utf-8", "cp1252"]
