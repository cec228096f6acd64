"""A study on the workers of a Dask cluster, which share a disk.

    from distributed import Client
    import cvtcycle.dask

    study = cvtcycle.dask.run("plan.toml", Client("scheduler:8786"), out="/shared/my_study")
"""

from __future__ import annotations

import os
import shutil
from functools import lru_cache
from typing import TYPE_CHECKING

from ._study import StoredStudy, Study

if TYPE_CHECKING:
    from distributed import Client


@lru_cache(maxsize=1)
def _study(plan: str, samples: int | None, seed: int | None) -> Study:
    return Study(plan, samples=samples, seed=seed)


def _drive(plan: str, samples: int | None, seed: int | None, parts: tuple[int, int], folder: str, threads: int) -> str:
    _study(plan, samples, seed).write_parts(parts, folder, threads=threads)
    return folder


def run(
    plan: str | os.PathLike[str],
    client: Client,
    *,
    out: str | os.PathLike[str],
    samples: int | None = None,
    seed: int | None = None,
    parts_per_task: int = 1,
    threads: int = 1,
    force: bool = False,
) -> StoredStudy:
    """Drives a plan on the workers of ``client`` and merges their parts into the folder ``out``.

    Each task drives ``parts_per_task`` parts with ``threads`` threads into a folder of its own below ``OUT.shards``. A task whose worker
    dies is given to another one, which goes on with the whole parts that are there: at most the parts in flight are driven twice. The
    merged study is byte for byte that of one machine; the shards are removed when it is whole. Called again after an interruption, it goes
    on.
    """
    word = os.path.abspath(os.fspath(plan)) if os.path.exists(plan) else os.fspath(plan)
    whole = os.path.abspath(os.fspath(out))
    shards, parts = f"{whole}.shards", Study(word, samples=samples, seed=seed).parts
    os.makedirs(shards, exist_ok=True)
    ranges = [(a, min(a + parts_per_task, parts)) for a in range(0, parts, parts_per_task)]
    tasks = [
        client.submit(_drive, word, samples, seed, own, os.path.join(shards, f"{own[0]:06}"), threads, pure=False)
        for own in ranges
    ]
    folders = [task.result() for task in tasks]
    study = Study.merge(whole, folders, force=force)
    shutil.rmtree(shards)
    return study
