"""Shards: the merged study equals that of one machine byte for byte, even if workers are killed."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import cvtcycle as cc
import pytest

PLAN = """[study]
title = "T"
cycle = "ece15"
baselines = ["rover_216_5mt"]
design = { latin_hypercube = { samples = 600, seed = 3 } }

[[factor]]
key = "road_load.mass_kg"
status = "assumed"
distribution = { uniform = { low = 1000, high = 1400 } }
"""


def program(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "cvtcycle", *words], capture_output=True, text=True)


@pytest.fixture(scope="module")
def plan(tmp_path_factory) -> Path:
    file = tmp_path_factory.mktemp("plan") / "plan.toml"
    file.write_text(PLAN)
    done = program("study", str(file), "--out", str(file.parent / "whole"), "--quiet")
    assert done.returncode == 0, done.stderr
    return file


def files(folder: Path) -> dict[str, bytes]:
    return {str(f.relative_to(folder)): f.read_bytes() for f in folder.rglob("*") if f.is_file() and not f.name.startswith(".")}


def same(plan: Path, merged: Path) -> None:
    ours, whole = files(merged), files(plan.parent / "whole")
    assert sorted(ours) == sorted(whole)
    assert [name for name in whole if ours[name] != whole[name]] == []


def test_shards_of_the_program(plan: Path, tmp_path) -> None:
    for k in range(3):
        assert program("study", str(plan), "--out", str(tmp_path / f"s_{k}"), "--shard", f"{k}/3", "--quiet").returncode == 0
    shards = [str(tmp_path / f"s_{k}") for k in range(3)]
    done = program("study", "merge", str(tmp_path / "m"), *shards)
    assert done.returncode == 0, done.stderr
    same(plan, tmp_path / "m")
    cc.Study.merge(tmp_path / "n", shards[::-1])
    same(plan, tmp_path / "n")


def test_workers_that_are_killed(plan: Path, tmp_path) -> None:
    """Kills each shard repeatedly with -9 at many moments, then lets a worker finish."""
    random.seed(1)
    for k in range(2):
        words = ["study", str(plan), "--out", str(tmp_path / f"s_{k}"), "--shard", f"{k}/2", "--quiet", "--threads", "1"]
        for _ in range(12):
            resume = ["--resume"] if (tmp_path / f"s_{k}" / "study.json").exists() else []
            worker = subprocess.Popen([sys.executable, "-m", "cvtcycle", *words, *resume], stderr=subprocess.DEVNULL)
            time.sleep(random.uniform(0.0, 0.5))
            worker.kill()
            worker.wait()
        resume = ["--resume"] if (tmp_path / f"s_{k}" / "study.json").exists() else []
        done = program(*words, *resume)
        assert done.returncode == 0, done.stderr
    cc.Study.merge(tmp_path / "m", [tmp_path / "s_0", tmp_path / "s_1"])
    same(plan, tmp_path / "m")


def test_bad_shards_are_named(plan: Path, tmp_path) -> None:
    study = cc.Study(plan)
    half = study.parts // 2
    study.write_parts((0, half), tmp_path / "a")
    study.write_parts((half, study.parts - 2), tmp_path / "b")
    shards = [tmp_path / "a", tmp_path / "b"]

    def refused(*shards: Path) -> list[cc.Problem]:
        with pytest.raises(cc.InputError) as caught:
            cc.Study.merge(tmp_path / "m", shards)
        assert not (tmp_path / "m").exists()
        return caught.value.problems

    [missing] = refused(*shards)
    assert missing["kind"] == "missing" and f"{study.parts - 2}..{study.parts}" in missing["message"]
    assert [p["kind"] for p in refused(*shards, shards[0])] == ["duplicate"]
    cc.Study(plan, seed=4).write_parts((study.parts - 2, study.parts), tmp_path / "foreign")
    [foreign] = refused(*shards, tmp_path / "foreign")
    assert foreign["kind"] == "conflict" and "seed" in foreign["message"] and "foreign" in foreign["message"]
    assert "there is no study" in refused(*shards, tmp_path)[0]["message"]
    study.write_parts((study.parts - 2, study.parts), tmp_path / "c")
    file = tmp_path / "c" / "parts" / f"runs_{study.parts - 1:05}.parquet"
    good = file.read_bytes()
    file.write_bytes(good[:100] + bytes([good[100] ^ 1]) + good[101:])
    kinds = [p["kind"] for p in refused(*shards, tmp_path / "c")]
    assert kinds == ["damaged", "missing"]
    file.write_bytes(good)
    # A part in two shards is taken once if its bytes are equal.
    shutil.copytree(tmp_path / "c", tmp_path / "d")
    cc.Study.merge(tmp_path / "m", [*shards, tmp_path / "c", tmp_path / "d"])
    same(plan, tmp_path / "m")


def test_dry_run(plan: Path) -> None:
    import json

    found = json.loads(program("study", str(plan), "--dry-run", "--json").stdout)
    study = cc.Study(plan)
    assert (found["points"], found["runs"], found["parts"]) == (study.points, study.runs, study.parts)
    size = sum(f.stat().st_size for f in (plan.parent / "whole" / "parts").glob("*.parquet"))
    assert 0.7 * size < found["bytes"] < 1.3 * size
    assert 0 < found["cpu_s_per_part"] < found["cpu_s"] < 60


@pytest.mark.parametrize("words", [["--shard", "3/3"], ["--shard", "x"], ["--shard", "-1/3"], ["--parts", "2..1"], ["--parts", "0..9999"], ["--shard", "0/2", "--parts", "0..1"]])
def test_bad_shares(plan: Path, tmp_path, words: list[str]) -> None:
    done = program("study", str(plan), "--out", str(tmp_path / "s"), *words)
    assert done.returncode == 2 and words[0] in done.stderr
    assert not (tmp_path / "s").exists()


def test_dask_with_a_worker_killed(plan: Path, tmp_path) -> None:
    distributed = pytest.importorskip("distributed")
    import warnings

    import cvtcycle.dask

    warnings.simplefilter("ignore")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            victims = list(client.run(os.getpid).values())
            client.submit(time.sleep, 0.2)
            os.kill(victims[0], signal.SIGKILL)
            study = cvtcycle.dask.run(plan, client, out=tmp_path / "m", parts_per_task=4)
    assert study.parts[0] == study.parts[1]
    same(plan, tmp_path / "m")
