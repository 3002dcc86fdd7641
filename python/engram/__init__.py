# SPDX-License-Identifier: Apache-2.0
"""A deep episodic memory for robots: what Python needs to read and make its values."""
