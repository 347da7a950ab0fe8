"""How the channels of a file are read: which columns they are in, their units and sensors."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..model.spelling import expected_one_of
from ..model.toml_files import read_tables
from .columns import Named
from .conversion import ByChannel, expand_by_channel
from .record import CHANNELS

ACTING = ("unit", "sensitivity", "scale", "delay")  # keywords of read_record, by channel
SENSOR_WORDS = ("sensor", "serial_number", "calibrated")  # kept as attributes of the channel
KEYS = ("column", *ACTING, *SENSOR_WORDS)
Channels = Mapping[str, Any] | Sequence[str | int] | str | os.PathLike[str] | None


@dataclass(frozen=True)
class ChannelSetup:
    """State how channels are read: columns, and keywords of :func:`.read_record` by channel."""

    columns: Named = None
    words: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)  # by key, then channel
    sample_rate: float | None = None
    resample: bool = False
    file: str = ""  # that it was read from

    @classmethod
    def from_argument(cls, channels: Channels) -> ChannelSetup:
        """Make one from what :func:`.read_record` takes as ``channels``."""
        if channels is None:
            return cls()
        if isinstance(channels, str) and "=" in channels:
            return cls(expand_by_channel("channels", channels, (), ("time", *CHANNELS)))
        if isinstance(channels, str) and "," in channels:
            return cls([text.strip() for text in channels.split(",")])
        text = "expected a TOML file, base=...,face1=..., or a list of columns"
        if isinstance(channels, (str, os.PathLike)):
            if not Path(channels).is_file():
                raise InputError(f"channels = {str(channels)!r}: no such file; {text}")
            setup = cls.from_mapping(str(channels), read_tables(Path(channels)))
            return replace(setup, file=str(channels))
        if isinstance(channels, Mapping):
            return cls.from_mapping("channels", channels)
        if not isinstance(channels, Sequence):
            raise InputError(f"channels = {channels!r}: {text}")
        return cls(channels)

    @classmethod
    def from_mapping(cls, label: str, mapping: Mapping[str, Any]) -> ChannelSetup:
        """Make one from columns or tables by channel, and values that are of all channels."""
        of_all = {name: mapping[name] for name in ("sample_rate", "resample") if name in mapping}
        rest = {name: one for name, one in mapping.items() if name not in of_all}
        columns: dict[str, str | int] = {}
        words: dict[str, dict[str, Any]] = {}
        for name, table in expand_by_channel(label, rest, (), ("time", *CHANNELS)).items():
            if not isinstance(table, Mapping):
                columns[name] = table
                continue
            for key, value in table.items():
                if key not in KEYS:
                    raise InputError(f"{label}, {name}: {key}; {expected_one_of(key, KEYS)}")
                if key == "column":
                    columns[name] = value
                elif value != "":
                    words.setdefault(key, {})[name] = value
        return cls(columns or None, words, **of_all)

    def merge_keywords(self, **keywords: ByChannel) -> dict[str, ByChannel]:
        """Return keywords of :func:`.read_record` by name, each completed by the setup."""
        merged = dict(keywords)
        for name in (name for name in keywords if name in self.words):
            argument, known = keywords[name], self.words[name]
            if argument is None:
                merged[name] = known
            elif isinstance(argument, Mapping) or (isinstance(argument, str) and "=" in argument):
                own = expand_by_channel(name, argument, (), ("time", *CHANNELS))
                merged[name] = {**known, **own}
        return merged

    def sensor_attributes(self, channel: str) -> dict[str, str]:
        """Return what is stated of a channel's sensor, as attributes of the channel."""
        return {
            key: str(self.words[key][channel])
            for key in SENSOR_WORDS
            if channel in self.words.get(key, {})
        }
