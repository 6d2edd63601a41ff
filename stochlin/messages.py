"""What a user has given, as messages show it: on one line, no control characters, not too long."""

from __future__ import annotations

import difflib
import errno
import inspect
import re
import reprlib
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from stochlin.removed import instead_of

FULL = (errno.ENOSPC, errno.EDQUOT)
NO_SUCH_FILE = (errno.ENOENT, errno.ENOTDIR)
REASONS = dict.fromkeys(NO_SUCH_FILE, "there is no such file; check its name and its folder")
REASONS |= dict.fromkeys(FULL, "the disk is full; make room on it, or write to another one")
LONGEST = 80  # of a value that is shown
LEAST_SHARED_LETTERS = 0.7  # least share of equal letters of names that are mistaken for each other
LONGEST_MESSAGE = 2000  # on a terminal, with all names that are allowed
SMALLER = "take fewer cells or paths, or a shorter motion"
# An argument as Python has it, maybe with its value, and not within a name or a text.
_ARGUMENT = re.compile(
    r"(?<![\w.'\"])([a-z][a-z_0-9]*)=(?!=)('[^']*'|True|False|\d[\w.]*)?(?![\w\"(\[])"
)
# Called before a function is compiled, which takes up to seconds, and then kept.
WHEN_COMPILING: list[Callable[[], None]] = []


class DoubtfulInput(UserWarning):
    """Warning of what is allowed, but looks like a mistake, such as modes with little of the mass.

    Examples
    --------
    >>> import warnings
    >>> import stochlin as sl
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("error", sl.DoubtfulInput)
    ...     tower = sl.ModalBuilding([0.5], [[0.1, 1.0]], [2e5] * 2, [3.5] * 2, damping=0.05)
    Traceback (most recent call last):
    stochlin.messages.DoubtfulInput: ModalBuilding: ...
    """


class ImplausibleInput(DoubtfulInput):
    """Warning of a number that no building, ground motion or gap has.

    Examples
    --------
    >>> import warnings
    >>> import stochlin as sl
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("ignore", sl.ImplausibleInput)
    ...     model = sl.Bilinear(period=500.0, damping=0.05)
    """


class _Short(reprlib.Repr):
    """The ``repr`` of anything, cut while it is made: a million numbers are not written out."""

    def __init__(self) -> None:
        super().__init__()
        self.maxlevel = 3
        self.maxstring = LONGEST
        self.maxother = LONGEST

    def repr_int(self, x: int, level: int) -> str:
        """Python refuses to write out very large ones."""
        power = int(x.bit_length() * 0.30103)
        return repr(x) if power < LONGEST else f"about {'-' if x < 0 else ''}1e{power}"

    def repr_instance(self, x: object, level: int) -> str:
        """What is not built in: of one with parameters its kind and them."""
        describe = getattr(x, "describe", None)
        try:
            return str(describe()) if describe and not isinstance(x, type) else repr(x)
        except Exception:
            return f"a {type(x).__name__}"


_short = _Short()


def brief(value: object) -> str:
    """A value as it would be written in Python, cut."""
    return plain(" ".join(_short.repr(value).split()))


def plain(text: object, longest: int = LONGEST) -> str:
    """A text that stands without quotation marks, such as a name or another's message, cut.

    What cannot be printed is written as Python writes it, for a terminal would obey it.
    """
    line = str(text)
    line = line if len(line) <= longest else f"{line[:longest]} "  # to be cut below
    if not line.isprintable():
        line = "".join(sign if sign.isprintable() else repr(sign)[1:-1] for sign in line)
    return line if len(line) <= longest else f"{line[: longest - 3]}..."


def sentence(error: BaseException, longest: int = 160) -> str:
    """What another error says, on one line."""
    try:
        text = str(error) or type(error).__name__
    except RecursionError:  # of values that are nested too deeply to be written
        text = type(error).__name__
    if isinstance(error, OSError) and error.strerror:  # told by the system, with a number
        name = "" if error.filename is None else f"{error.filename}: "
        text = f"{name}{REASONS.get(error.errno or 0, error.strerror)}"
    if isinstance(error, MemoryError):
        text = f"this machine has too little memory ({str(error) or 'none is left'}); {SMALLER}"
    return plain(" ".join(text.split()), longest)


def nearest(written: str, names: Iterable[str]) -> str:
    """The known name that was probably meant, or an empty text: begun, or spelled alike."""
    mine = _letters(written[:LONGEST])
    candidates = [*names]
    letters = {_letters(name): name for name in reversed(candidates)}
    begun = [form for form in map(_letters, candidates) if mine and form.startswith(mine)]
    if len(mine) < 3 and len(begun) > 1:  # of several names none was meant
        begun = []
    alike = difflib.get_close_matches(mine, letters, 1, LEAST_SHARED_LETTERS)
    return next((letters[form] for form in (mine, *begun, *alike) if form in letters), "")


def hint(written: str, names: Iterable[str]) -> str:
    """Words before a list of known names: what replaces a removed one, or the likely one."""
    near = nearest(written, names) if len(written) > 2 else ""  # shorter texts are like all others
    return instead_of(written) or (f"did you mean {near!r}? " if near else "")


def missing(owner: str, name: str, names: Iterable[str] = ()) -> AttributeError:
    """The error of a name that is none of the known names of a module or class, or no longer."""
    return AttributeError(f"{owner} has no attribute {name!r}; {hint(name, names)}".rstrip("; "))


def missing_in(module: str, name: str) -> AttributeError:
    """The error of a name that the module of this name does not have; it suggests the nearest."""
    public = [attribute for attribute in dir(sys.modules[module]) if not attribute.startswith("_")]
    return missing(f"module {module!r}", name, public)


def check_names(
    owner: str, written: Iterable[str], parameters: Mapping[str, inspect.Parameter]
) -> None:
    """Raise a TypeError, which suggests the nearest one, for a keyword that is no argument."""
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters.values()):
        return
    for name in written:
        if name not in parameters:
            allowed = ", ".join(parameters)
            raise TypeError(
                f"{owner}: {name} is no argument; {hint(name, parameters)}allowed: {allowed}"
            )


def check_call(
    owner: str, signature: inspect.Signature, args: Sequence[object], kwargs: Mapping[str, object]
) -> None:
    """Raise a TypeError, in the name of ``owner``, for arguments with which it cannot be called."""
    parameters = signature.parameters
    check_names(owner, kwargs, parameters)
    try:
        signature.bind(*args, **kwargs)
    except TypeError as error:
        raise TypeError(f"{owner}: {error}; allowed: {', '.join(parameters)}") from None


def as_written(
    text: str, names: Mapping[str, str], written: Callable[[str, str | None], str]
) -> str:
    """A message with arguments such as ``direction='UX'`` or ``units=`` named as a user does.

    ``names`` has the names that the user knows, by those of the arguments, and ``written`` gives
    the text of such a name and of the value, which is None where the message leaves it open.
    """

    def replaced(match: re.Match[str]) -> str:
        user_name = names.get(match[1])
        return match[0] if user_name is None else written(user_name, match[2])

    return _ARGUMENT.sub(replaced, text)


def refuse(name: str, what: str, arguments: Mapping[str, object]) -> None:
    """Raise a ValueError for an argument that is given but does not apply to what this is."""
    for argument, value in arguments.items():
        if value is not None:
            raise ValueError(f"{argument} = {brief(value)} does not apply: {name} is {what}")


class Named(type):
    """Type of dataclasses that answer an unknown argument with the nearest, and removed names."""

    @property
    def __signature__(cls) -> inspect.Signature:
        whole = inspect.signature(cls.__init__)  # type: ignore[misc]
        return whole.replace(parameters=list(whole.parameters.values())[1:])

    def __getattr__(cls, name: str) -> Any:
        raise missing(cls.__name__, name)

    def __call__(cls, *args: Any, **kwargs: Any) -> Any:
        """A new instance."""
        try:
            return super().__call__(*args, **kwargs)
        except TypeError:
            check_call(cls.__name__, inspect.signature(cls), args, kwargs)
            raise


def _letters(name: str) -> str:
    return re.sub("[^a-z0-9]", "", name.lower())


def listed(names: Iterable[object], most: int = 12) -> str:
    """Names that a user has given, as a list in words."""
    texts = list(names)
    more = f" and {len(texts) - most} more" if len(texts) > most else ""
    return ", ".join(plain(name, 40) for name in texts[:most]) + more


def hyphenated(name: str) -> str:
    """``CloughPenzien`` as Clough-Penzien."""
    return re.sub("(?<=[a-z])(?=[A-Z])", "-", name)
