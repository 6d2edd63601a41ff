"""Components of a motion: which are vertical, and which belong to one earthquake."""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import xarray as xr

from stochlin.messages import LONGEST

PLACE_KEYS = ("event", "station")  # attributes that both components of a station share
DISTINCT = 3
COMMON = 2
VAGUE = 1
AMONG_OTHERS = 0  # for files that differ in it


class ComponentWord(NamedTuple):
    """A word for a component."""

    vertical: bool
    angle: float | None = None  # of a horizontal one [deg], if it is known
    weight: int = DISTINCT
    after: str = ""  # what follows it and is no part of it, such as the number of a sensor


# The words of vertical components, and of horizontal ones by their angle. Letters, and words that
# are in names of places as well, weigh less.
_TABLE = {
    ComponentWord(True): "UP DN DWN DOWN UD DU UPD UPDN UPDOWN UPWARD UPWARDS DOWNWARD DOWNWARDS "
    "ZUP ZDN ZDOWN UPZ VT VTC VRT VER VERT VERTIC VERTICAL VERTICALE DUSEY",
    ComponentWord(True, weight=COMMON): "U V Z AZ ACCZ",
    ComponentWord(False, 0.0): "NS SN LN LONG LONGITUDINAL RADIAL H1 HOR1 COMP1 FN",
    ComponentWord(False, 90.0): "EW WE TR TRAN TRANS TRANSVERSE TRANSVERSAL H2 HOR2 COMP2 FP",
    ComponentWord(False, 0.0, COMMON): "N S L R X AX ACCX NORTH SOUTH NORTE SUR NORD SUD KUZEY "
    "GUNEY",
    ComponentWord(False, 90.0, COMMON): "E W T Y AY ACCY EAST WEST ESTE OESTE EST OVEST DOGU BATI",
}
_WORDS = {text: word for word, texts in _TABLE.items() for text in texts.split()}
_BELOW = {"BOREHOLE", "DOWNHOLE", "UNDERGROUND"}
# band, instrument, orientation, location
_SEED = re.compile(r"[BCDEFGHLMS][HLNG]([ZNERT123])(\d{0,2})")
_SEED_ANGLES = {"N": 0.0, "R": 0.0, "1": 0.0, "E": 90.0, "T": 90.0, "2": 90.0}
# vertical where it is stated, of any instrument
_VERTICAL_CHANNEL = re.compile(r"[A-Z]{1,2}Z\d{0,2}")
_QUADRANT = re.compile(r"([NS])(\d{1,2})([EW])")  # N45W
_AZIMUTH = re.compile(r"([0-2]\d\d|3[0-5]\d|360)")
_RIGHT_ANGLE = 5.0  # deg, allowed deviation from 90 degrees between two components
# Words of a text, and where they are attached to others: ELC180, SCT190985NS, EQ5h1, kobeUP,
# NS19950117.
_RUN = re.compile(
    r"(?<![^\W_])(?:N-S|S-N|E-W|W-E|U-D|UP-D(?:OW)?N)(?![^\W_])|[^\W_]+", re.IGNORECASE
)
_AZIMUTH_BEHIND = r".*[^\W\d_](?P<azimuth>\d{3})"
_BEHIND = re.compile(
    rf"{_AZIMUTH_BEHIND}|.*(?:\d(?P<word>[^\W\d_]+[12]?)|[a-z](?P<capitals>[A-Z]+))"
)
_AHEAD = re.compile(r"([^\W\d_]+)\d{3,}")
# the ending of a file name, such as V2 and 191, which is no component
_ENDING = re.compile(r"V?\d+[A-Z]?", re.IGNORECASE)


class Place(NamedTuple):
    """A word in a name, and the name with a sign in its place."""

    rest: str
    word: ComponentWord


def word_of(text: str) -> ComponentWord | None:
    """The component that a word stands for; None if it is no word for one."""
    plain = _in_capitals(text)
    if plain in _WORDS:
        return _WORDS[plain]
    stem = re.sub(r"\d{1,2}$", "", plain)
    if word := _WORDS.get(stem):
        weight = VAGUE if word.vertical and len(stem) == 1 else word.weight
        return word._replace(after=plain[len(stem) :], weight=weight)
    return _by_pattern(plain)


def _by_pattern(plain: str) -> ComponentWord | None:
    """The component of a quadrant, a channel or an azimuth, in capitals."""
    if match := _QUADRANT.fullmatch(plain):
        angle = float(match[2])
        return ComponentWord(
            False, angle if (match[1] == "N") == (match[3] == "E") else 180.0 - angle
        )
    if match := _SEED.fullmatch(plain):
        return ComponentWord(match[1] == "Z", _SEED_ANGLES.get(match[1]), after=match[2])
    return ComponentWord(False, float(plain), COMMON) if _AZIMUTH.fullmatch(plain) else None


def _in_capitals(text: str) -> str:
    """Letters and digits of a text in capitals, without the marks of accents."""
    signs = unicodedata.normalize("NFKD", text.upper())
    return "".join(sign for sign in signs if sign.isalnum())


def stated_as_vertical(text: str) -> bool | None:
    """Whether a component that a file states is vertical; None if its words do not say it."""
    runs = _RUN.findall(text)
    words = [word for run in runs if (word := word_of(run))]
    channels = [run for run in runs if _VERTICAL_CHANNEL.fullmatch(run.upper())]
    if channels or any(word.vertical for word in words):
        return True
    return False if words or re.search(r"\d\s*deg", text, re.IGNORECASE) else None


def is_below(text: str) -> bool:
    """Whether a component that a file states is in a borehole."""
    return any(_in_capitals(run) in _BELOW for run in _RUN.findall(text))


def titled_as_vertical(title: str) -> bool | None:
    """True if a title begins or ends with a vertical component, or has that word; None otherwise.

    A single letter, which may be a name, is a component at the end only. The title is what stands
    behind the last comma, without what is in brackets.
    """
    part = title[:LONGEST].rpartition(",")[2]
    runs = _RUN.findall(re.sub(r"[(\[].*?[)\]]", " ", part))
    if not runs:
        return None
    first = word_of(runs[0])
    last = word_of(runs[-1])
    begins = first is not None and first.vertical and first.weight == DISTINCT
    ends = last is not None and last.vertical and (last.weight >= COMMON or len(runs) == 1)
    return begins or ends or any(_in_capitals(run).startswith("VERTI") for run in runs) or None


def is_vertical(stated: str, title: str, in_name: ComponentWord | None) -> bool:
    """Whether a record is vertical, by the best evidence: a statement, the title, then the name."""
    for said in (stated_as_vertical(stated), titled_as_vertical(title)):
        if said is not None:
            return said
    return in_name is not None and in_name.vertical


def _places(name: str) -> Iterator[Place]:
    """The words for components in the name of a file, from its first one."""
    name = re.sub(r"\.gz$", "", name, flags=re.IGNORECASE)
    folder = name.rfind("/")
    for run in _RUN.finditer(name):
        is_ending = run.end() == len(name) and name[: run.start()].endswith(".")
        if is_ending and _ENDING.fullmatch(run[0]):
            continue
        start, end, word = _word_in(run)
        if word and not (start < folder and run[0].isdigit()):
            if start < folder:
                word = word._replace(weight=AMONG_OTHERS)
            yield Place(f"{name[:start]}*{word.after}{name[end:]}".lower(), word)


def _word_in(run: re.Match[str]) -> tuple[int, int, ComponentWord | None]:
    """Start and end of a word for a component in a run of letters and digits, and the word."""
    if word := word_of(run[0]):
        return run.start(), run.end(), word
    if match := _BEHIND.fullmatch(run[0]):
        kind = match.lastgroup or ""
        word = word_of(match[kind])
        if word and kind == "word":
            weight = DISTINCT if word.weight == DISTINCT else AMONG_OTHERS
        else:
            weight = (
                VAGUE if kind == "azimuth" or (word and word.weight == DISTINCT) else AMONG_OTHERS
            )
        return run.start() + match.start(kind), run.end(), word and word._replace(weight=weight)
    if match := _AHEAD.fullmatch(run[0]):
        word = word_of(match[1])
        return run.start(), run.start() + match.end(1), word and word._replace(weight=AMONG_OTHERS)
    return run.start(), run.end(), None


class FileNames:
    """Names of files that are read together, which tell where each of them has its component.

    That is the last word in which the files of a record differ: two of them have horizontal
    components at right angles there, and a third one may be vertical. Otherwise it is the last one
    of most weight.
    """

    def __init__(self, names: Iterable[str]) -> None:
        self._places = {name: [*_places(name)] for name in names}
        self._words: dict[str, list[ComponentWord]] = {}
        for places in self._places.values():
            for place in places:
                self._words.setdefault(place.rest, []).append(place.word)

    def component(self, name: str) -> ComponentWord | None:
        """The component in the name of a file; None if there is none."""
        if place := self._differing(name):
            return place.word
        words = [place.word for place in self._places[name] if place.word.weight > AMONG_OTHERS]
        return max(reversed(words), key=lambda word: word.weight, default=None)

    def record(self, name: str) -> str:
        """What the files of all components of a record have in common, or else the name."""
        place = self._differing(name)
        return place.rest if place else name

    def _differing(self, name: str) -> Place | None:
        return next(
            (p for p in reversed(self._places[name]) if self._are_of_a_record(p.rest)), None
        )

    def _are_of_a_record(self, rest: str) -> bool:
        words = self._words[rest]
        angles = [word.angle for word in words if word.angle is not None]
        if len(angles) != 2 or len(words) > 3:
            return False
        return abs(abs(angles[0] - angles[1]) % 180 - 90) <= _RIGHT_ANGLE


def identifies(event: str) -> bool:
    """Whether a text is of one earthquake: it has a date, or a number besides the magnitude."""
    return any(sign.isdigit() for sign in re.sub(r"\bM[A-Za-z]?\W*\d+(\.\d+)?\b", "", event))


def events_of(labels: Iterable[str], records: Sequence[xr.DataArray]) -> list[object]:
    """What is equal for the components of a station in one earthquake, for each record.

    This is event and station where both are known. Otherwise the files have names that differ in
    the component alone, or are the same, and the records begin at the same time.
    """
    about = [record.attrs for record in records]
    files = [
        str(of.get("file") or of.get("source") or n) for n, of in zip(labels, about, strict=True)
    ]
    parts = [(file, of.get("component")) for file, of in zip(files, about, strict=True)]
    names = FileNames({*files})
    counted = Counter(parts)
    events: list[object] = []
    for n, (record, part) in enumerate(zip(records, parts, strict=True)):
        event = record.attrs.get("event")
        station = record.attrs.get("station")
        if event and station:
            events.append((event, station))
        elif counted[part] > 1:  # files of the same name in different folders
            events.append(n)
        else:
            start = f"{float(record.time[0]):.6g}"
            events.append((event, station, names.record(part[0]), start))
    return events
