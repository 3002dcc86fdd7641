# SPDX-License-Identifier: Apache-2.0
"""What goes wrong with values of the Interpretable Data Format."""


class IdfError(ValueError):
    """A value, text or bytes that do not fit: the message names what was found and needed."""
