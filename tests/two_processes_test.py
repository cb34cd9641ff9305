"""Kills the real programs, each while the other runs, and reads what the survivor says.

usage: two_processes_test.py BIN_DIRECTORY      (needs a display: xvfb-run)
"""
import os
import queue
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

BIN = sys.argv.pop(1)
DEADLINE_S = 60  # for anything that must happen at all; a machine may be slow


class Program:
    """A child process whose lines can be awaited."""

    def __init__(self, name, *options):
        self.process = subprocess.Popen(
            [os.path.join(BIN, name), *options],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.said = []
        self.lines = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        for line in self.process.stdout:
            self.lines.put(line)
        self.lines.put(None)

    def wait_for(self, words):
        """The next line with these words, and the time at which it came."""
        end = time.monotonic() + DEADLINE_S
        while True:
            try:
                line = self.lines.get(timeout=max(0.0, end - time.monotonic()))
            except queue.Empty:
                raise AssertionError(f'"{words}" was not said in time; instead: {self.said}') from None
            if line is None:
                raise AssertionError(f'it ended without "{words}": {self.said}')
            self.said.append(line.strip())
            if words in line:
                return line, time.monotonic()

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait(DEADLINE_S)

    def end(self):
        if self.process.poll() is None:
            self.process.terminate()
        return self.process.wait(DEADLINE_S)


class TwoProcesses(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.running = []

    def tearDown(self):
        for program in self.running:
            program.process.kill()
            program.process.wait()
            program.process.stdout.close()
        self.folder.cleanup()

    def start(self, name, *options):
        self.running.append(Program(name, *options))
        return self.running[-1]

    def server(self, port="0"):
        ready = os.path.join(self.folder.name, f"ready{len(self.running)}")
        server = self.start("space-foosball-server", "--port", port, "--team0", "computer", "--team1",
                            "computer", "--ready-file", ready)
        end = time.monotonic() + DEADLINE_S
        while not os.path.exists(ready):
            self.assertLess(time.monotonic(), end, "the server was not ready in time")
            self.assertIsNone(server.process.poll(), "the server ended")
            time.sleep(0.01)  # a file appears without an event to wait for
        with open(ready) as file:
            return server, file.read().strip().removeprefix("port=")

    def renderer(self, port, *options):
        return self.start("space-foosball", "--server", f"127.0.0.1:{port}", "--team", "watch", "--mute",
                          "--size", "320x180", "--quality", "low", *options)

    def test_a_killed_renderer_leaves_the_match_and_a_new_one_is_in_step_within_a_second(self):
        server, port = self.server()
        first = self.renderer(port)
        first.wait_for("synchronised")
        first.kill()
        second = self.renderer(port)
        line, _ = second.wait_for("synchronised")
        # Its own figure: from asking to join to a picture of the match on the screen. Opening a
        # window and building shaders in software come before.
        milliseconds = int(line.rsplit(" ms", 1)[0].rsplit(" ", 1)[1])
        print(f"new renderer in step {milliseconds} ms after it began to connect")
        self.assertLessEqual(milliseconds, 1000)
        self.assertIsNone(server.process.poll(), "the server went with the renderer")
        self.assertEqual(second.end(), 0)
        self.assertEqual(server.end(), 0)

    def test_a_killed_server_is_said_awaited_and_rejoined(self):
        server, port = self.server()
        renderer = self.renderer(port)
        renderer.wait_for("synchronised")
        server.kill()
        killed = time.monotonic()
        _, lost = renderer.wait_for("physics server lost")
        server, _ = self.server(port)
        back = time.monotonic()
        _, joined = renderer.wait_for("synchronised")
        print(f"lost server said after {lost - killed:.2f} s, rejoined {joined - back:.2f} s after its return")
        self.assertLessEqual(lost - killed, 2.0)
        self.assertLessEqual(joined - back, 2.0)
        self.assertEqual(renderer.end(), 0)
        self.assertEqual(server.end(), 0)


if __name__ == "__main__":
    unittest.main(verbosity=2)
