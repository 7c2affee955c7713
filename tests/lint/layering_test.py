#!/usr/bin/env python3
"""Tests of layering.py: planted violations are found, in a small tree made for the purpose, and the table is sound."""

import tempfile
import unittest
from pathlib import Path

import layering

# A tree without a fault: path -> text. Each case below plants one file in it.
CLEAN = {
    "driver/protocol/sample.hpp": "#pragma once\n#include <cstdint>\n",
    "driver/protocol/result.hpp": "#include <boost/system/result.hpp>\n",
    "driver/async/task_group.hpp": '#include "driver/protocol/result.hpp"\n#include <boost/asio/awaitable.hpp>\n',
    "driver/device/device.hpp": '#include "driver/async/task_group.hpp"\n',
    "server/frame/frame.hpp": '#include "driver/protocol/sample.hpp"\n',
    "server/frame/encode.cpp": '#include "sweepcast/v1/scan.pb.h"\n#include <zstd.h>\n',
    "server/http/session.cpp": "#include <boost/beast/http.hpp>\n",
    "server/stream/ws_transport.hpp": "#include <boost/beast/websocket.hpp>\n",
    "tests/driver/protocol/sample_test.cpp": '#include "driver/protocol/sample.hpp"\n#include <gtest/gtest.h>\n',
}

# (file, one line planted in it, a part of the sentence expected)
PLANTED = [
    ("driver/protocol/decode.cpp", "#include <boost/asio/awaitable.hpp>", "must not include <boost/asio/awaitable.hpp> (asio)"),
    ("driver/protocol/decode.cpp", "#include <thread>", "must not include <thread> (io_std)"),
    ("driver/protocol/decode.cpp", "#include <spdlog/spdlog.h>", "(spdlog)"),
    ("driver/protocol/decode.cpp", '#include "driver/async/task_group.hpp"', "driver/protocol must not include"),
    ("driver/async/worker.cpp", '#include "driver/protocol/sample.hpp"', "driver/async must not include"),
    ("driver/device/run.cpp", '#include "server/frame/frame.hpp"', 'driver/device must not include "server/frame/frame.hpp"'),
    ("driver/device/run.cpp", '#include "sweepcast/v1/scan.pb.h"', 'must not include "sweepcast/v1/scan.pb.h"'),
    ("driver/device/run.cpp", '#  include "server/frame/frame.hpp"', "driver/device must not include"),
    ("server/frame/encode_more.cpp", '#include "driver/device/device.hpp"', "server/frame must not include"),
    ("server/hub/hub.cpp", '#include "sweepcast/v1/stream.pb.h"', "server/hub must not include"),
    ("server/api/handlers.cpp", "#include <boost/beast/http.hpp>", "server/api must not include <boost/beast/http.hpp>"),
    ("server/http/session.hpp", "#include <boost/beast/http.hpp>", "belongs in a .cpp file"),
    ("server/http/session.hpp", '#include "server/stream/ws_transport.hpp"', "belongs in a .cpp file"),
    ("server/gateway/gateway.cpp", "#include <CLI/CLI.hpp>", "(cli11)"),
    ("server/main.cpp", '#include "server/frame/frame.hpp"', "server/main.cpp must not include"),
    ("tests/driver/protocol/x_test.cpp", '#include "server/frame/frame.hpp"', "tests/driver must not include"),
    ("server/frame/more.cpp", '#include "frame.hpp"', "not found from the root"),
    ("server/frame/more.cpp", '#include "../http/session.hpp"', "not found from the root"),
    ("driver/protocol/decode.cpp", '#include "driver/protocol/../async/task_group.hpp"', "not found from the root"),
    ("server/frame/more.cpp", "#include <server/frame/frame.hpp>", "write it in quotes"),
    ("server/frame/more.cpp", "#include <curl/curl.h>", "belongs to no group"),
    ("server/frame/more.cpp", "#include FRAME_HEADER", "cannot be read"),
    ("server/misc/more.cpp", "#include <vector>", "belongs to no room"),
]


class LayeringTest(unittest.TestCase):
    def setUp(self):
        self.table = layering.load_table()
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = Path(self.folder.name)
        for path, text in CLEAN.items():
            self.plant(path, text)

    def plant(self, path, text):
        (self.root / path).parent.mkdir(parents=True, exist_ok=True)
        (self.root / path).write_text(text, encoding="utf-8")

    def test_a_clean_tree_has_no_violation(self):
        self.assertEqual(layering.violations(self.root, self.table), [])

    def test_each_planted_violation_is_found_where_it_is(self):
        for path, line, sentence in PLANTED:
            with self.subTest(path=path, line=line):
                self.plant(path, f"// planted\n{line}\n")
                found = layering.violations(self.root, self.table)
                (self.root / path).unlink()
                self.assertEqual(len(found), 1, found)
                self.assertTrue(found[0].startswith(path + ":"), found[0])
                self.assertIn(sentence, found[0])

    def test_every_room_and_group_that_the_table_names_is_defined_in_it(self):
        known = [*self.table["rooms"], *self.table["generated"]]
        for name, room in self.table["rooms"].items():
            for other in room["rooms"]:
                fits = any(layering.is_inside(k, other) or layering.is_inside(other, k) for k in known)
                self.assertTrue(fits, f"{name} names {other}")
            self.assertLessEqual(set(room["external"]), set(self.table["external"]), name)

    def test_no_two_rooms_may_include_each_other(self):
        rooms = self.table["rooms"]
        for name, room in rooms.items():
            self.assertEqual(self.reachable(room["rooms"], name, set()), [], f"{name} can reach itself")

    def reachable(self, allowed, goal, seen):
        """The way from the list `allowed` to the room `goal`, as names; empty if there is none."""
        for entry in allowed:
            inside = [r for r in self.table["rooms"] if layering.is_inside(r, entry) or r == layering.room_of(entry, self.table)]
            for room in inside:
                if room == goal:
                    return [room]
                if room not in seen:
                    seen.add(room)
                    rest = self.reachable(self.table["rooms"][room]["rooms"], goal, seen)
                    if rest:
                        return [room, *rest]
        return []


if __name__ == "__main__":
    unittest.main()
