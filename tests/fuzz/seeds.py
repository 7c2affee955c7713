#!/usr/bin/env python3
"""seeds.py VECTORS OUT: what the fuzzers start from, one folder per fuzzer: pieces of the recorded streams, and one of
each reply and request, behind the bytes by which a fuzzer's input chooses settings (see the fuzzers)."""
import pathlib
import sys

DESCRIPTORS = ["0500004081", "5400004082", "0D03004083", "8400004084", "5400004085", "AA00004086",
               "1400000004", "0300000006", "0400000015", "0800000020", "0800000021", "04000000FF"]
REPLIES = [
    (0, "181D0107" + "00112233445566778899AABBCCDDEEFF"),
    (1, "000000"), (1, "021280"), (2, "F801FC00"), (3, "01000000"),
    (4, "010000005802 9402"), (4, "70000000 0500"), (4, "71000000 00FA0000"), (4, "74000000 00190000"),
    (4, "75000000 84"), (4, "79000000 010203040506"), (4, "7F000000 426F6F737400"), (4, "7C000000"),
    (4, "C0CC0100 C0A80B02 FFFFFF00 C0A80B01"), (4, "C0CC0100 00000000"), (5, "53656E736974697669747900"),
]
REQUESTS = ["A520A521A525A540A550A552A559", "A5FF04000000005E", "A5F0029402C1", "A5A802580255", "A582050000000000 22",
            "A584047C0000005D A584067100000001 0053", "A590085F5F00C2010000000000", "A5A550A5A582A525"]


def write(folder: pathlib.Path, name: str, content: bytes) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content)


def pieces(stream: bytes, size: int) -> list[bytes]:
    """The beginning and the middle."""
    middle = max(0, len(stream) // 2 - size // 2)
    return [stream[:size], stream[middle : middle + size]]


def main(vectors: pathlib.Path, out: pathlib.Path) -> None:
    for path in sorted(vectors.glob("8[1-6]_*.bin")):
        for i, piece in enumerate(pieces(path.read_bytes(), 1600 if path.name.startswith("83") else 900)):
            folder = out / f"fuzz_decode_{path.name[:2]}"
            duration = {"81": 5, "82": 4, "83": 3, "84": 3}.get(path.name[:2], 2)
            for choice in (duration, 64 + duration, 64):  # as it is, sealed, sealed and without a duration
                write(folder, f"{path.stem}_{i}_{choice}", bytes([choice, 10, i]) + piece)
    for i, descriptor in enumerate(DESCRIPTORS):
        hunted = bytes.fromhex("A55A" + descriptor)
        for choice in range(7):
            write(out / "fuzz_descriptor_hunter", f"{i}_{choice}", bytes([choice, i]) + b"RP LIDAR\xa5\xa5" + hunted)
    for i, (choice, packet) in enumerate(REPLIES):
        write(out / "fuzz_replies", str(i), bytes([choice]) + bytes.fromhex(packet))
    for i, requests in enumerate(REQUESTS):
        write(out / "fuzz_request_parser", str(i), b"\0" + bytes.fromhex(requests))


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
