"""The exceptions and warnings of tokosen."""


class Error(Exception):
    """Something that tokosen could not do. The text says what is wrong, where, and what to do."""


class InputError(Error, ValueError):
    """The input is faulty, or something cannot be made of it."""


class ParameterError(Error, ValueError):
    """An argument has a value that is not possible, or contradicts another one."""


class FileError(Error, OSError):
    """The operating system refused to read or write a file."""


class OutOfMemoryError(Error, MemoryError):
    """The work needs more memory than there is. It was not begun."""


class FindingWarning(UserWarning):
    """Findings about the input that may make the result wrong: one warning for each kind."""
