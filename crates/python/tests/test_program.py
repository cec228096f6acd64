"""Command line of the package."""

from __future__ import annotations

import signal
import subprocess
import sys
import time

import cvtcycle as cc


def program(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "cvtcycle", *words], capture_output=True, text=True)


def test_exit_codes_and_streams() -> None:
    done = program("--version")
    assert done.returncode == 0 and done.stdout.strip() == f"cvtcycle {cc.__version__} (build {cc.__build__})"
    bad = program("run", "--cycle", "ece15_euc")
    assert bad.returncode == 2 and "ece15_eudc" in bad.stderr and bad.stdout == ""
    assert program("nothing").returncode == 2


def test_ctrl_c_ends_it() -> None:
    words = ["losses", "--speed", "100..9000:1", "--temp", "0..100:1", "--format", "csv"]
    running = subprocess.Popen([sys.executable, "-m", "cvtcycle", *words], stdout=subprocess.DEVNULL)
    time.sleep(1.0)
    running.send_signal(signal.SIGINT)
    assert running.wait(10) == -signal.SIGINT
