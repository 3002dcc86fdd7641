# SPDX-License-Identifier: Apache-2.0
"""What can go wrong, as exceptions: one class for each kind of failure, with its whole message."""


class EngramError(Exception):
    """Any failure of a memory; the message names the object, what was found and what was needed."""


class InvalidArgumentError(EngramError, ValueError):
    """What was asked for cannot be."""


class NotFoundError(EngramError, LookupError):
    """The named thing does not exist."""


class AlreadyExistsError(EngramError):
    """The named thing exists and must not."""


class FailedPreconditionError(EngramError):
    """The right request in the wrong state: a closed memory, a format that is newer."""


class DataLossError(EngramError):
    """Bytes are damaged or missing."""


class ResourceExhaustedError(EngramError):
    """Disk, memory or a configured limit is used up."""


class UnavailableError(EngramError):
    """The operating system or a peer refused; it may work later."""


class CancelledError(EngramError):
    """Somebody asked to stop."""
