"""Bags of ROS 1 (.bag) and ROS 2 (.mcap, .db3), by rosbags (the extra ``ros``): messages' numbers over their stamps."""

from __future__ import annotations

import tempfile
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ssmr_ident.core.recording import Recording
from ssmr_ident.readers.arrays.named import MOST_BYTES
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source, missing_library
from ssmr_ident.readers.table.assemble import recordings_of
from ssmr_ident.readers.table.columns import Column, Table
from ssmr_ident.readers.table.headings import heading_of

NAMES = ("rosbag",)
_SUFFIX = {"rosbag1": "log.bag", "mcap": "log.mcap", "db3": "log.db3"}
_MOST_NUMBERS = 40  # of a message; images and clouds have more and are no channels
_DEEPEST = 6


def recognises(source: Source) -> bool:
    return source.kind in _SUFFIX


def read(source: Source, options: ReadOptions) -> list[Recording]:
    """Recordings of a bag, one per topic whose messages hold numbers.

    Raises
    ------
    InputError
        rosbags is not installed; the bag is damaged, or holds no numbers.
    """
    try:
        from rosbags.highlevel import AnyReader
    except ImportError as error:
        raise missing_library(source, "a ROS bag", "rosbags", "ros") from error
    topics: dict[str, list[tuple[int, dict[str, float]]]] = {}
    left: set[str] = set()
    count = 0
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, _SUFFIX[source.kind])  # what was hashed is what is read
        copy.write_bytes(source.data)
        try:
            with AnyReader([copy]) as bag:
                for connection, arrived, raw in bag.messages():
                    message = bag.deserialize(raw, connection.msgtype)
                    stamp, numbers = _stamp(message, arrived), _numbers(message)
                    if not numbers:
                        left.add(connection.topic)
                        continue
                    count += len(numbers) + 1
                    if count * 100 > MOST_BYTES:
                        raise source.error(f"holds more than {count} numbers", "Cut the bag.")
                    topics.setdefault(connection.topic, []).append((stamp, numbers))
        except (SystemExit, KeyboardInterrupt):
            raise
        except Exception as error:  # rosbags reports damage by whatever its parsing stumbles over
            if hasattr(error, "mend"):
                raise
            reason = f"{type(error).__name__}: {str(error)[:100]}"
            raise source.error(f"is a ROS bag that cannot be read ({reason})", "Copy it again.") from error
    if not topics:
        raise source.error("is a ROS bag without numbers", f"Topics: {', '.join(sorted(left)) or 'none'}.")
    if left:
        source.inform(f"topics without numbers left out: {', '.join(sorted(left))}")
    recordings: list[Recording] = []
    for topic, rows in topics.items():
        recordings += _of_topic(source, topic, rows, options)
    return recordings


def _of_topic(
    source: Source, topic: str, rows: list[tuple[int, dict[str, float]]], options: ReadOptions
) -> list[Recording]:
    names = list(dict.fromkeys(name for _, numbers in rows for name in numbers))
    first = rows[0][0]
    stamps = np.array([(stamp - first) * 1e-9 for stamp, _ in rows])
    columns = [Column("stamp", "s", stamps, quantity="time", number=0)]
    for number, name in enumerate(names, start=1):
        heading = heading_of(f"{topic}/{name}", None, source.vocabulary)
        values = np.array([numbers.get(name, np.nan) for _, numbers in rows])
        if heading.role != "ignored" and (heading.quantity or np.ptp(values[np.isfinite(values)]) > 0):
            columns.append(Column(name, heading.unit, values, source=heading.source, number=number))
    if len(columns) < 2 or len(rows) < 2:
        source.inform(f"topic {topic} has {len(rows)} message(s) without anything that changes; left out")
        return []
    table = Table(columns, lambda row: f"message {row + 1}", f"topic {topic}", split=True)
    return recordings_of(source, "rosbag", table, options)


def _stamp(message: Any, arrived: int) -> int:
    """Nanoseconds since 1970 when a message was made, or when it arrived where it does not say."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    seconds = getattr(stamp, "sec", 0)
    return int(seconds) * 10**9 + int(stamp.nanosec) if stamp is not None and seconds else int(arrived)


def _numbers(message: Any, prefix: str = "", depth: int = 0) -> dict[str, float]:
    """Numbers of a message by their path; none of one that is no set of channels."""
    found: dict[str, float] = {}
    if not is_dataclass(message) or depth > _DEEPEST:
        return found
    for one in fields(message):
        if one.name in ("header", "__msgtype__") or "covariance" in one.name:
            continue
        value, name = getattr(message, one.name), f"{prefix}{one.name}"
        if isinstance(value, (int, float, np.number)) and not isinstance(value, bool):
            found[name] = float(value)
        elif isinstance(value, (list, np.ndarray)) and 0 < len(value) <= _MOST_NUMBERS:
            if all(isinstance(v, (int, float, np.number)) for v in value):
                found |= {f"{name}.{k + 1}": float(v) for k, v in enumerate(value)}
        elif is_dataclass(value):
            found |= _numbers(value, f"{name}.", depth + 1)
    return found if len(found) <= _MOST_NUMBERS else {}
