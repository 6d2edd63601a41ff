"""Formats of record files, each recognized by its header."""

from stochlin.applications.records.formats.record_format import (
    FORMATS,
    HEADER_LINES,
    Format,
    RecordFile,
    Series,
    field_width,
)

__all__ = ["FORMATS", "HEADER_LINES", "Format", "RecordFile", "Series", "field_width"]
