"""Tables: no copy, correct values, no memory freed too early or leaked."""

from __future__ import annotations

import gc
import resource

import cvtcycle as cc
import numpy
import pandas
import polars
import pyarrow
import pytest


@pytest.fixture(scope="module")
def table() -> cc.Table:
    return cc.run("rover_216_cvt", "ece15").trace


def address(array: numpy.ndarray) -> int:
    return array.__array_interface__["data"][0]


def test_numpy_sees_the_cells_themselves(table: cc.Table) -> None:
    first, second = table["speed_kmh"], table["speed_kmh"]
    assert address(first) == address(second) and not first.flags.owndata and not first.flags["W"]
    with pytest.raises(ValueError):
        first[0] = 1.0
    with pytest.raises(ValueError):
        first.setflags(write=True)


def test_arrow_sees_the_cells_themselves(table: cc.Table) -> None:
    arrow = pyarrow.table(table)
    assert arrow.num_rows == len(table) and arrow.column_names == table.columns
    for name in ("time_s", "speed_kmh", "iterations"):
        assert arrow[name].chunk(0).buffers()[1].address == address(table[name]), name
    assert arrow.schema.field("speed_kmh").metadata == {
        b"unit": b"km/h",
        b"doc": table.meanings["speed_kmh"].encode(),
    }
    arrow.validate(full=True)
    assert polars.DataFrame(table)["speed_kmh"].to_numpy().__array_interface__["data"][0] == address(table["speed_kmh"])


def test_all_readers_see_the_same(table: cc.Table) -> None:
    frames = {"polars": table.to_polars(), "pandas": table.to_pandas(), "arrow": pyarrow.table(table)}
    own = table.to_dict()
    for name in table:
        for reader, frame in frames.items():
            column = frame[name].to_pylist() if reader == "arrow" else list(frame[name])
            assert column == own[name] or numpy.array_equal(column, own[name], equal_nan=True), (reader, name)
    assert frames["pandas"].attrs["units"] == table.units
    assert isinstance(frames["polars"], polars.DataFrame) and isinstance(frames["pandas"], pandas.DataFrame)
    assert set(own["phase"]) <= {"ECE15_1", "ECE15_2", "ECE15_3", "ECE15_4", "ece15", ""}


def test_frames_with_missing_values_and_text_in_the_index_are_logs() -> None:
    """Truth: the drive of which the frames are made."""
    speeds = [0.0, 0.0, *[4.0 * k for k in range(15)], *[56.0 - 4.0 * k for k in range(15)], 0.0]
    stamps = pandas.Timestamp("2026-01-05 08:00") + pandas.to_timedelta(range(len(speeds)), unit="s")
    plain = pandas.DataFrame({"speed_kmh": speeds}, index=stamps)
    text = plain.set_index(pandas.Index([f"{stamp.isoformat()}" for stamp in stamps], name="timestamp", dtype=object))
    oil = pandas.array([pandas.NA] * len(speeds), dtype="Float64")
    nullable = plain.reset_index(names="time").convert_dtypes().assign(oil=oil)
    drives = [cc.Cycle.from_frame(frame) for frame in (plain, text, nullable)]
    assert [drive.duration_s for drive in drives] == [len(speeds) - 1.0] * 3
    assert len({drive.distance_m for drive in drives}) == 1


def test_views_outlive_the_table() -> None:
    def views() -> list[numpy.ndarray]:
        table = cc.run("rover_216_cvt", "ece15").trace
        return [table["speed_kmh"], pyarrow.table(table)["speed_kmh"].to_numpy(), polars.DataFrame(table)["speed_kmh"].to_numpy()]

    kept = views()
    gc.collect()
    others = [cc.run("rover_216_cvt", "ece15", ambient_degc=d).trace.to_dict() for d in range(5)]
    assert all(numpy.array_equal(kept[0], view) for view in kept) and max(kept[0]) == pytest.approx(50.0, abs=2) and others


def test_nothing_leaks() -> None:
    """2 000 tables through each reader: a leak of every second buffer would take 300 MB; without leaks the allocator takes some MB."""

    def used_mb() -> float:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

    run = cc.run("rover_216_cvt", "ece15")

    def once() -> None:
        table = cc.Table(run._run.trace(0))
        pyarrow.table(table).schema
        polars.DataFrame(table)
        numpy.asarray(table["speed_kmh"])
        # Capsules without a reader are freed.
        table.__arrow_c_stream__(), table.__arrow_c_schema__()

    for _ in range(200):
        once()
    before = used_mb()
    for _ in range(2000):
        once()
    assert used_mb() - before < 40


def test_columns_that_are_not_there(table: cc.Table) -> None:
    with pytest.raises(KeyError, match="speed"):
        table["speed"]
    assert "speed_kmh" in table and "speed" not in table and list(table) == table.columns


def test_an_empty_table_goes_through() -> None:
    empty = cc.losses("rover_216_cvt", belt_ratio=[], input_speed_rpm=[], output_torque_nm=[], transmission_sump_degc=[], throttle=[])
    assert len(empty) == 0 == len(empty.to_polars()) == len(empty.to_pandas()) == pyarrow.table(empty).num_rows
